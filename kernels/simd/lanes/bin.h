/* Finds the tiles that splats (projected Gaussians) touch, for LANES splats together. The first pass finds bounding
 * boxes, and the tile masks of splats within one tile row. Taller splats that fit in an fxs_box, a mask of 6x6 tiles,
 * are collected until they fill a vector. The second pass finds the tiles of collected splats row by row. */
#include "lanes.h"
#include "stages.h"

/* Limit of a splat's half width: 256 pixels. Up to this limit, the numbers of the second pass fit in 31 bits. The C
   version handles wider splats. */
#define HALF_WIDTH_LIMIT_Q8 (1 << 16)

typedef struct job {
    const fxs_stage_view *view;
    const fxs_splat *splats;
    const fxs_bounds *bounds;
    fxs_box *boxes;
} job;

typedef struct list {
    uint32_t count;
    int32_t index[2 * LANES];
} list;

enum { VY, OFFSET, CLIP = 3, CX = 0, CY, BREADTH = 0, SHEAR, HALF_WIDTH };

#define LOAD_FOURS(words, structs, member, at) \
    load_fours(words, (const int32_t *)(const void *)&(structs)->member, (int)sizeof *(structs) / 4, at)

/* Computes the first and last tile column between two x coordinates, per lane. Returns the lanes of splats without a
   pixel between the coordinates. */
static inline mask columns_between(vi *first, vi *last, const fxs_stage_view *view, vi left_q8, vi right_q8)
{
    vi first_pixel = most((left_q8 + 255) >> 8, all(0)), last_pixel = least(right_q8 >> 8, all(view->width - 1));
    *first = first_pixel >> 4;
    *last = last_pixel >> 4;
    return greater(first_pixel, last_pixel);
}

typedef struct ellipse {
    vi v_q24, vy_q24;          /* splat coordinate v on the first pixel row of a tile row, and its step per pixel row */
    vi cx_q8, breadth_q8, shear_q8, reach_q8, margin_q8, r_q12, tangent;
    vi first_column;
    vi first_row, more_rows;
} ellipse;

/* Moves the bits of six tiles in a row to the masks of three macro tiles (blocks of 2x2 tiles). */
static inline vi spread_row(vi tiles)
{
    return (tiles & 3) | (tiles & 12) << 2 | (tiles & 48) << 4;
}

static inline void store_boxes(fxs_box *boxes, const fxs_stage_view *view, vi low, vi high, vi row, vi column,
                               mask none)
{
    const vi macro = (row >> 1) * (int32_t)fxs_macros(view->tiles_x) + (column >> 1);
    store_pairs(boxes, choose(none, all(0), low | high << FXS_BOX_LOW_BITS),
                choose(none, all(0), high >> (32 - FXS_BOX_LOW_BITS) | macro << (FXS_BOX_BITS - 32)));
}

static inline void set_radius(ellipse *e, const fxs_stage_view *view, vi offset_q11)
{
    const vi limit_q11 = least(offset_q11 + view->cut_q11, all(FXS_FAINT_Q11));
    e->margin_q8 = (e->reach_q8 >> 8) + 32;
    e->r_q12 = radius_q12(limit_q11 - offset_q11);
    const vi widest = e->shear_q8 * e->r_q12;
    e->tangent = ((widest + (widest >> 31 & 4095)) >> 12) * e->r_q12;
}

/* Prepares the ellipses of LANES splats. At pixel row y, the splat coordinate v = ((y << 14) - cy) vy >> 26 is computed
   as ((-cy vy >> 14) + y vy) >> 12. 32 bits are enough, because the tile rows are less than 16 pixels off the
   ellipse. */
static inline ellipse ellipse_of(const job *j, const int32_t index[LANES])
{
    vi splat[4], centre[4], shape[4], last;
    LOAD_FOURS(splat, j->splats, vy_q24, index);
    LOAD_FOURS(centre, j->bounds, cx_q14, index);
    LOAD_FOURS(shape, j->bounds, breadth_q8, index);
    const vu first_row = (vu)splat[CLIP] & 65535 & ~15u;
    ellipse e;
    e.vy_q24 = splat[VY];
    e.v_q24 = (vi)(narrow(mul_wide(-centre[CY], splat[VY]), 14) + first_row * (vu)splat[VY]);
    e.cx_q8 = centre[CX] >> 6;
    e.breadth_q8 = shape[BREADTH];
    e.shear_q8 = shape[SHEAR];
    e.reach_q8 = shape[HALF_WIDTH];
    set_radius(&e, j->view, splat[OFFSET] & 65535);
    columns_between(&e.first_column, &last, j->view, e.cx_q8 - e.reach_q8, e.cx_q8 + e.reach_q8);
    e.first_column &= ~1;
    e.first_row = (vi)(first_row >> 4);
    e.more_rows = (vi)((vu)splat[CLIP] >> 20) - e.first_row;
    return e;
}

/* Returns half the width of a splat's ellipse at splat coordinate v. The middle at v is x = cx + shear v. */
static inline vi half_width_q8(const ellipse *e, vi v_q12)
{
    vi square_q24 = e->r_q12 * e->r_q12 - v_q12 * v_q12;
    /* skips the slow square root if all lanes are above or below their ellipses */
    if (!any(greater(square_q24, all(0))))
        return e->breadth_q8 >> 12;
    return e->breadth_q8 * ((vi)root((vu)square_q24) + 1) >> 12;
}

static inline mask span_of_row(const ellipse *e, const fxs_stage_view *view, vi *first, vi *last)
{
    const vi r = e->r_q12, reach = e->reach_q8;
    const vi top_q12 = e->v_q24 >> 12, bottom_q12 = (e->v_q24 + (FXS_TILE - 1) * e->vy_q24) >> 12;
    const vi top = clamp(top_q12, -r, r), bottom = clamp(bottom_q12 + 1, -r, r);
    vi x_top_q8 = e->shear_q8 * top >> 12, half_top_q8 = half_width_q8(e, top);
    vi x_bottom_q8 = e->shear_q8 * bottom >> 12, half_bottom_q8 = half_width_q8(e, bottom);
    vi left_q8 = most(half_top_q8 - x_top_q8, half_bottom_q8 - x_bottom_q8);
    vi right_q8 = most(half_top_q8 + x_top_q8, half_bottom_q8 + x_bottom_q8);
    /* a tile row with the ellipse's leftmost or rightmost point takes the ellipse's full half width */
    vi low = top * reach, high = bottom * reach;
    left_q8 = choose(greater(low, -e->tangent) | greater(-e->tangent, high), left_q8, reach);
    right_q8 = choose(greater(low, e->tangent) | greater(e->tangent, high), right_q8, reach);
    left_q8 = least(left_q8 + e->margin_q8, reach);
    right_q8 = least(right_q8 + e->margin_q8, reach);
    return columns_between(first, last, view, e->cx_q8 - left_q8, e->cx_q8 + right_q8) | greater(top_q12, r + 2) |
           greater(-r - 2, bottom_q12);
}

static inline vi tiles_of_row(const ellipse *e, const fxs_stage_view *view)
{
    vi first, last;
    const mask none = span_of_row(e, view, &first, &last);
    vu tiles = shift_left((vu)all(2), last - e->first_column) - shift_left((vu)all(1), first - e->first_column);
    return choose(none, all(0), (vi)tiles);
}

/* Finds the tiles of `count` collected splats. The list must hold LANES valid indices, even for fewer splats. */
static void fill_boxes(const job *j, const list *l, uint32_t count)
{
    fxs_box boxes[LANES];
    vi low = all(0), high = all(0);
    ellipse e = ellipse_of(j, l->index);
    for (int k = 0; any(greater(e.more_rows, all(k - 1))); k++) {
        const vi row = (e.first_row & 1) + k, at = (row >> 1) * 12 + (row & 1) * 2;
        const vu tiles = (vu)choose(greater(e.more_rows, all(k - 1)), spread_row(tiles_of_row(&e, j->view)), all(0));
        low |= (vi)shift_left(tiles, at);
        high |= (vi)shift_left(tiles, at - FXS_BOX_LOW_BITS);
        e.v_q24 += FXS_TILE * e.vy_q24;
    }
    store_boxes(boxes, j->view, low, high, e.first_row, e.first_column, equal(low | high, all(0)));
    for (uint32_t i = 0; i < count; i++)
        j->boxes[l->index[i]] = boxes[i];
}

static inline void append(const job *j, list *l, vi index, mask which)
{
    store_compressed(l->index + l->count, index, which);
    l->count += lanes_of(which);
    if (l->count < LANES)
        return;
    fill_boxes(j, l, LANES);
    l->count -= LANES;
    store(l->index, load(l->index + LANES));
}

static inline void find_boxes(const job *j, list lists[FXS_BOX_TILES], uint32_t i)
{
    vi splat[4], centre[4], shape[4], first, last;
    LOAD_FOURS(splat, j->splats + i, vy_q24, lane_numbers);
    LOAD_FOURS(centre, j->bounds + i, cx_q14, lane_numbers);
    LOAD_FOURS(shape, j->bounds + i, breadth_q8, lane_numbers);
    const vi cx_q8 = centre[CX] >> 6, reach_q8 = shape[HALF_WIDTH], index = load(lane_numbers) + (int32_t)i;
    const vi first_row = splat[CLIP] & 65535, last_row = (vi)((vu)splat[CLIP] >> 16);
    const vi first_tile_row = first_row >> 4, last_tile_row = last_row >> 4, row = first_tile_row & 1;
    mask none = columns_between(&first, &last, j->view, cx_q8 - reach_q8, cx_q8 + reach_q8);
    const vi column = first & ~1;
    mask fits = greater(all(FXS_BOX_TILES), last_tile_row - first_tile_row + row) &
                greater(all(FXS_BOX_TILES), last - column) & ~none;
    mask whole = fits & equal(first_tile_row, last_tile_row) & greater(all(FXS_NARROW), last - first) &
                 greater(first_row, all(0)) & greater(all(j->view->height - 1), last_row);
    const vu on_row = shift_left((vu)all(2), last - column) - shift_left((vu)all(1), first - column);
    const vi on_rows = choose(whole, spread_row((vi)on_row) << 2 * row, all(0));
    store_boxes(j->boxes + i, j->view, on_rows, all(0), first_tile_row, column, none);
    mask large = greater(reach_q8, all(HALF_WIDTH_LIMIT_Q8));
    /* One list of splats is kept per height in tile rows. List 0 is for splats near the edge of a tile row. */
    mask at_edge = equal(first_row & 15, all(0)) | equal(last_row & 15, all(15));
    vi list_number = choose(at_edge, all(0), last_tile_row - first_tile_row);
    for (int k = 0; k < FXS_BOX_TILES; k++) {
        mask which = fits & ~whole & ~large & equal(list_number, all(k));
        if (any(which))
            append(j, &lists[k], index, which);
    }
    for (unsigned left = bits(~none & ~fits); left; left &= left - 1)
        j->boxes[i + (uint32_t)__builtin_ctz(left)] = FXS_LARGE;
    for (unsigned left = bits(fits & ~whole & large); left; left &= left - 1) {
        uint32_t k = i + (uint32_t)__builtin_ctz(left);
        fxs_bin_c(j->view, j->splats + k, j->bounds + k, 1, j->boxes + k);
    }
}

FXS_BIN(ISA)
{
    const job j = {view, splats, bounds, boxes};
    list lists[FXS_BOX_TILES];
    if (view->cutoff == FXS_CUTOFF_SQUARE || count < LANES) {
        fxs_bin_c(view, splats, bounds, count, boxes);
        return;
    }
    for (int k = 0; k < FXS_BOX_TILES; k++)
        lists[k].count = 0;
    for (uint32_t i = 0; i < count; i += LANES)
        find_boxes(&j, lists, i + LANES <= count ? i : count - LANES);
    for (int k = 0; k < FXS_BOX_TILES; k++)
        if (lists[k].count) {
            store(lists[k].index + lists[k].count, all(lists[k].index[0]));
            fill_boxes(&j, &lists[k], lists[k].count);
        }
}

FXS_SPANS(ISA)
{
    if (view->cutoff == FXS_CUTOFF_SQUARE || bounds->half_width_q8 > HALF_WIDTH_LIMIT_Q8) {
        fxs_spans_c(view, splat, bounds, row, rows, spans);
        return;
    }
    const uint32_t vy_q24 = (uint32_t)splat->vy_q24, step_q24 = FXS_TILE * vy_q24;
    const uint32_t v_q24 = (uint32_t)(-(int64_t)bounds->cy_q14 * splat->vy_q24 >> 14) + (uint32_t)row * step_q24;
    ellipse e = {.vy_q24 = all(splat->vy_q24), .cx_q8 = all(bounds->cx_q14 >> 6),
                 .breadth_q8 = all((int32_t)bounds->breadth_q8), .shear_q8 = all(bounds->shear_q8),
                 .reach_q8 = all((int32_t)bounds->half_width_q8), .v_q24 = (vi)ramp(v_q24, step_q24)};
    set_radius(&e, view, all(splat->offset_q11));
    for (int32_t i = 0; i < rows; i += LANES) {
        vi first, last;
        const mask none = span_of_row(&e, view, &first, &last);
        store_pairs(spans + i, choose(none, all(0), first), choose(none, all(-1), last));
        e.v_q24 += (vi)all((int32_t)(LANES * step_q24));
    }
}

typedef struct notes {
    uint32_t *macros, *listed, count;
} notes;

static inline void note_macro(notes *n, vi macro, vi slot, vi tiles)
{
    const mask which = greater(tiles, all(0));
    if (!any(which))
        return;
    store_compressed(n->macros + n->count, macro, which);
    store_compressed(n->listed + n->count, slot << 4 | tiles, which);
    n->count += lanes_of(which);
}

static inline void note_boxes(notes *n, const fxs_box *boxes, uint32_t first, int32_t across)
{
    vi low, high;
    load_pairs(boxes, &low, &high);
    const vi macro = (vi)((vu)high >> (FXS_BOX_BITS - 32)), slot = load(lane_numbers) + (int32_t)first;
    for (int32_t i = 0; i < 8; i++)
        note_macro(n, macro + (i / 3 * across + i % 3), slot, low >> 4 * i & 15);
    note_macro(n, macro + (2 * across + 2), slot, high & 15);
}

FXS_NOTE(ISA)
{
    notes n = {macros, listed, 0};
    const int32_t across = (int32_t)fxs_macros(view->tiles_x);
    const uint32_t end = first + count, rest = count % LANES;
    fxs_box last[LANES] = {FXS_NOWHERE};
    for (uint32_t slot = first; slot + LANES <= end; slot += LANES)
        note_boxes(&n, boxes + slot, slot, across);
    for (uint32_t i = 0; i < rest; i++)
        last[i] = boxes[end - rest + i];
    if (rest)
        note_boxes(&n, last, end - rest, across);
    return n.count;
}

FXS_LIST(ISA)
{
    uint32_t listed = 0, i = 0;
    for (; i + LANES <= count; i += LANES) {
        vi words, depths;
        load_pairs(keys + i, &words, &depths);
        const mask which = ~equal(words & (int32_t)(1u << tile), all(0));
        store_compressed(entries + listed, (vi)((vu)words >> 4), which);
        listed += lanes_of(which);
    }
    return listed + fxs_list_c(keys + i, count - i, tile, entries + listed);
}
