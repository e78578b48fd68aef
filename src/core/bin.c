/* The stage `bin` finds the tiles that a splat (projected Gaussian) touches.
 *
 * In the splat's coordinates u and v, its edge is u^2 + v^2 = r^2, an ellipse in the picture. At a given v the ellipse
 * spans x = cx + shear v +- breadth sqrt(r^2 - v^2). On a tile row, v lies between its values at the row's first and
 * last pixel row. The ellipse's leftmost and rightmost points are at v = +- r shear / sqrt(A), where A is the variance
 * of x. A margin of 1/8 pixel and 1/256 of the ellipse's size covers rounding errors. Thus a tile's list has every
 * splat that passes the test in pixel.h at a pixel of the tile. */
#include <fixsplat/internal/fixed.h>
#include "lister.h"
#include "memory.h"

#define SPANS 32
#ifdef FXS_SMALL_STACK
#define SOME 8u
#else
#define SOME 64u
#endif

typedef fxs_span span;

typedef struct ellipse {
    const fxs_splat *splat;
    const fxs_bounds *bounds;
    span columns, rows;
    int32_t r_q12;
} ellipse;

static span columns_between(const fxs_stage_view *view, int32_t left_q8, int32_t right_q8)
{
    int32_t first = (left_q8 + 255) >> 8, last = right_q8 >> 8;
    if (last < 0 || first >= view->width || first > last)
        return (span){0, -1};
    return (span){first < 0 ? 0 : first / FXS_TILE, last >= view->width ? view->tiles_x - 1 : last / FXS_TILE};
}

static ellipse ellipse_of(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds)
{
    int32_t cx_q8 = bounds->cx_q14 >> 6, reach_q8 = (int32_t)bounds->half_width_q8;
    return (ellipse){splat, bounds, columns_between(view, cx_q8 - reach_q8, cx_q8 + reach_q8),
                     {splat->first_row / FXS_TILE, splat->last_row / FXS_TILE}, 0};
}

static void add_radius(ellipse *e, const fxs_stage_view *view)
{
    int32_t offset_q11 = e->splat->offset_q11, limit_q11 = fxs_limit_q11(offset_q11, view->cut_q11);
    e->r_q12 = (int32_t)fxs_sqrt((uint32_t)(limit_q11 - offset_q11 + 1) << 13) + 1;
}

static int64_t v_at_row(const ellipse *e, int32_t row)
{
    return (((int64_t)row << 14) - e->bounds->cy_q14) * e->splat->vy_q24 >> 26;
}

static int32_t cut_to(int32_t r, int64_t v)
{
    return v < -r ? -r : v > r ? r : (int32_t)v;
}

/* Returns half the width in pixels of a splat's ellipse, u^2 + v^2 = r^2, at a given v. The middle is at x = cx + shear
   v. */
static int32_t half_width_q8(const ellipse *e, int32_t v_q12)
{
    uint32_t square_q24 = (uint32_t)(e->r_q12 * e->r_q12 - v_q12 * v_q12);
    return (int32_t)((uint64_t)e->bounds->breadth_q8 * (fxs_sqrt(square_q24) + 1) >> 12);
}

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* Returns the tile columns that a splat's ellipse touches in a tile row. A veil, a splat too large for `bounds`,
   touches all columns. */
static span ellipse_span(const ellipse *e, const fxs_stage_view *view, int32_t row)
{
    int64_t top_q12 = v_at_row(e, row * FXS_TILE), bottom_q12 = v_at_row(e, row * FXS_TILE + FXS_TILE - 1);
    if ((top_q12 > e->r_q12 + 2 || bottom_q12 < -e->r_q12 - 2) && e->bounds->half_width_q8 != FXS_EVERYWHERE_Q8)
        return (span){0, -1};
    int32_t top = cut_to(e->r_q12, top_q12), bottom = cut_to(e->r_q12, bottom_q12 + 1);
    int32_t x_top_q8 = (int32_t)((int64_t)e->bounds->shear_q8 * top >> 12), half_top_q8 = half_width_q8(e, top);
    int32_t x_bottom_q8 = (int32_t)((int64_t)e->bounds->shear_q8 * bottom >> 12);
    int32_t half_bottom_q8 = half_width_q8(e, bottom);
    int32_t left_q8 = -larger(half_top_q8 - x_top_q8, half_bottom_q8 - x_bottom_q8);
    int32_t right_q8 = larger(half_top_q8 + x_top_q8, half_bottom_q8 + x_bottom_q8);
    /* The ellipse's leftmost or rightmost point lies in this tile row if v sqrt(A) = +- r shear for a v between top and
       bottom. A is the variance of x. */
    int32_t reach_q8 = (int32_t)e->bounds->half_width_q8;
    int64_t tangent = (int64_t)e->bounds->shear_q8 * e->r_q12 / 4096 * e->r_q12;
    int64_t low = (int64_t)top * reach_q8, high = (int64_t)bottom * reach_q8;
    if (low <= tangent && tangent <= high)
        right_q8 = reach_q8;
    if (low <= -tangent && -tangent <= high)
        left_q8 = -reach_q8;
    int32_t cx_q8 = e->bounds->cx_q14 >> 6, margin_q8 = (reach_q8 >> 8) + 32;
    left_q8 = larger(left_q8 - margin_q8, -reach_q8);
    right_q8 = -larger(-right_q8 - margin_q8, -reach_q8);
    return columns_between(view, cx_q8 + left_q8, cx_q8 + right_q8);
}

/* Returns the tile columns (or rows) that a square of half size `radius` around a splat's centre c covers. The tiles
   are floor((c - radius) / 16) to floor((c + radius + 15) / 16) - 1. */
static span square_span(int32_t centre_q14, uint32_t radius, int32_t tiles)
{
    int64_t first = (centre_q14 - ((int64_t)radius << 14)) >> 18;
    int64_t last = ((centre_q14 + ((int64_t)(radius + 15) << 14)) >> 18) - 1;
    return (span){first < 0 ? 0 : (int32_t)(first < tiles ? first : tiles),
                  last < tiles ? (int32_t)(last < -1 ? -1 : last) : tiles - 1};
}

FXS_STAGE fxs_span fxs_bin_rows(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds)
{
    return view->cutoff == FXS_CUTOFF_SQUARE ? square_span(bounds->cy_q14, bounds->square_radius, view->tiles_y)
                                             : (span){splat->first_row / FXS_TILE, splat->last_row / FXS_TILE};
}

FXS_STAGE fxs_span fxs_bin_columns(const fxs_stage_view *view, const fxs_bounds *bounds)
{
    const int32_t cx_q8 = bounds->cx_q14 >> 6, reach_q8 = (int32_t)bounds->half_width_q8;
    return view->cutoff == FXS_CUTOFF_SQUARE ? square_span(bounds->cx_q14, bounds->square_radius, view->tiles_x)
           : reach_q8 == FXS_EVERYWHERE_Q8   ? (span){0, view->tiles_x - 1}
                                             : columns_between(view, cx_q8 - reach_q8, cx_q8 + reach_q8);
}

static span span_of(const ellipse *e, const fxs_stage_view *view, int32_t row)
{
    return view->cutoff == FXS_CUTOFF_SQUARE ? square_span(e->bounds->cx_q14, e->bounds->square_radius, view->tiles_x)
                                             : ellipse_span(e, view, row);
}

static uint64_t spread_row(uint32_t tiles, int32_t row)
{
    return (uint64_t)((tiles & 3) | (tiles & 12) << 2 | (tiles & 48) << 4) << (row / 2 * 12 + row % 2 * 2);
}

/* Returns a bit mask of a range of tile columns. Bit 0 is column `from`; the range has at most 31 tiles. */
static uint32_t tiles_of(span s, int32_t from)
{
    return s.first > s.last ? 0 : (2u << (s.last - from)) - (1u << (s.first - from));
}

static fxs_box box_of(const fxs_stage_view *view, ellipse *e)
{
    const int32_t row = e->rows.first & ~1, column = e->columns.first & ~1;
    const uint32_t macro = (uint32_t)row / FXS_MACRO * fxs_macros(view->tiles_x) + (uint32_t)column / FXS_MACRO;
    uint64_t mask = 0;
    if (view->cutoff == FXS_CUTOFF_SQUARE)
        return FXS_LARGE;
    if (e->columns.first > e->columns.last)
        return FXS_NOWHERE;
    if (e->columns.last - column >= FXS_BOX_TILES || e->rows.last - row >= FXS_BOX_TILES)
        return FXS_LARGE;
    if (e->rows.first == e->rows.last && e->columns.last - e->columns.first < FXS_NARROW &&
        e->splat->first_row > 0 && e->splat->last_row < view->height - 1) {
        mask = spread_row(tiles_of(e->columns, column), e->rows.first - row);
    } else {
        add_radius(e, view);
        for (int32_t r = e->rows.first; r <= e->rows.last; r++)
            mask |= spread_row(tiles_of(ellipse_span(e, view, r), column), r - row);
    }
    return mask ? (fxs_box){mask | (uint64_t)macro << FXS_BOX_BITS} : FXS_NOWHERE;
}

void fxs_bin_c(const fxs_stage_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count,
               fxs_box *boxes)
{
    for (uint32_t i = 0; i < count; i++) {
        ellipse e = ellipse_of(view, &splats[i], &bounds[i]);
        boxes[i] = box_of(view, &e);
    }
}

void fxs_spans_c(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row,
                 int32_t rows, span *spans)
{
    ellipse e = ellipse_of(view, splat, bounds);
    add_radius(&e, view);
    for (int32_t i = 0; i < rows; i++)
        spans[i] = span_of(&e, view, row + i);
}

/* Writes a key for each splat to the lists of the macro tiles (2x2 tiles) that list it. If `keys` is null, counts the
   keys instead, and notes the results for the second pass. */
static inline void put(fxs_lister *l, fxs_key *keys, const uint32_t *macros, const uint32_t *listed, uint32_t count)
{
    const uint32_t first = l->first_macro, more = l->last_macro - first, room = l->room, *depths = l->depths;
    uint32_t *next = l->next, taken = l->taken;
    uint64_t *notes = l->notes;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t macro = macros[i];
        if (macro - first > more)
            continue;
        const uint32_t at = next[macro]++;
        if (keys)
            keys[at] = FXS_KEY(depths[FXS_LISTED_SLOT(listed[i])], listed[i]);
        else if (taken < room)
            notes[taken++] = FXS_KEY(macro, listed[i]);
        else
            taken = UINT32_MAX;
    }
    l->taken = taken;
}

uint32_t fxs_note_c(const fxs_stage_view *view, const fxs_box *boxes, uint32_t first, uint32_t count, uint32_t *macros,
                    uint32_t *listed)
{
    const uint32_t across = fxs_macros(view->tiles_x);
    uint32_t noted = 0;
    for (uint32_t slot = first; slot < first + count; slot++) {
        const uint64_t box = boxes[slot].bits;
        for (uint64_t rest = box & (((uint64_t)1 << FXS_BOX_BITS) - 1); rest; noted++) {
            const int at = fxs_ctz64(rest) & ~3;
            macros[noted] = (uint32_t)(box >> FXS_BOX_BITS) + (uint32_t)at / 12 * across + (uint32_t)at / 4 % 3;
            listed[noted] = FXS_LISTED(slot, rest >> at & 15);
            rest &= ~((uint64_t)15 << at);
        }
    }
    return noted;
}

static uint32_t pair_of(span s, int32_t c)
{
    const int32_t left = 2 * c, right = left + 1;
    return (uint32_t)(s.first <= left && left <= s.last) | (uint32_t)(s.first <= right && right <= s.last) << 1;
}

static void list_large(fxs_lister *l, fxs_key *keys, uint32_t slot, uint32_t across)
{
    const fxs_stage_view *view = l->view;
    const span rows = fxs_bin_rows(view, &l->splats[slot], &l->bounds[slot]);
    const int32_t first = larger(rows.first, (int32_t)(l->first_macro / across * FXS_MACRO));
    const int32_t last = fxs_min(rows.last, (int32_t)(l->last_macro / across * FXS_MACRO + FXS_MACRO - 1));
    span s[SPANS + FXS_SPANS_MORE + 1];
    for (int32_t row = first & ~1; row <= last; row += SPANS) {
        const int32_t from = row < first ? first : row, end = fxs_min(row + SPANS, last + 1);
        l->spans(view, &l->splats[slot], &l->bounds[slot], from, end - from, s + (from - row));
        s[end - row] = (span){0, -1};
        s[0] = from > row ? (span){0, -1} : s[0];
        for (int32_t r = row; r < end; r += FXS_MACRO) {
            const span a = s[r - row], b = s[r - row + 1];
            const int32_t left = a.first > a.last || (b.first <= b.last && b.first < a.first) ? b.first : a.first;
            const int32_t right = a.last > b.last ? a.last : b.last;
            for (int32_t c = left / FXS_MACRO; c <= right / FXS_MACRO && right >= 0; c++) {
                const uint32_t macro = (uint32_t)r / FXS_MACRO * across + (uint32_t)c;
                const uint32_t listed = FXS_LISTED(slot, pair_of(a, c) | pair_of(b, c) << 2);
                put(l, keys, &macro, &listed, 1);
            }
        }
    }
}

static inline void list(fxs_lister *l, fxs_key *keys, uint32_t first, uint32_t count)
{
    const uint32_t across = fxs_macros(l->view->tiles_x), end = first + count;
    uint32_t macros[9 * SOME + FXS_NOTES_MORE], listed[9 * SOME + FXS_NOTES_MORE];
    for (uint32_t slot = first; slot < end; slot += SOME) {
        const uint32_t some = end - slot < SOME ? end - slot : SOME;
        const uint32_t noted = l->note(l->view, l->boxes, slot, some, macros, listed);
        put(l, keys, macros, listed, noted);
        for (uint32_t i = slot; i < slot + some; i++)
            if (l->boxes[i].bits == FXS_LARGE.bits)
                list_large(l, keys, i, across);
        if (!keys && l->taken <= l->room) {
            l->noted = l->taken;
            l->from = slot + some;
        }
    }
}

void fxs_bin_count(fxs_lister *l, uint32_t first, uint32_t count)
{
    list(l, 0, first, count);
}

void fxs_bin_fill(fxs_lister *l, uint32_t first, uint32_t count, fxs_key *keys)
{
    list(l, keys, first, count);
}

void fxs_bin_fill_noted(fxs_lister *l, fxs_key *keys)
{
    const uint32_t first = l->first_macro, more = l->last_macro - first, noted = l->noted, *depths = l->depths;
    const uint64_t *notes = l->notes;
    uint32_t *next = l->next;
    for (uint32_t i = 0; i < noted; i++) {
        const uint32_t macro = (uint32_t)(notes[i] >> 32), listed = (uint32_t)notes[i];
        if (macro - first > more)
            continue;
        const uint32_t at = next[macro]++;
        FXS_PREFETCH(&keys[at + 16]);
        keys[at] = FXS_KEY(depths[FXS_LISTED_SLOT(listed)], listed);
    }
}

static int touches(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds, uint32_t tile)
{
    const int32_t row = (int32_t)tile / view->tiles_x, column = (int32_t)tile % view->tiles_x;
    ellipse e = ellipse_of(view, splat, bounds);
    add_radius(&e, view);
    const span s = ellipse_span(&e, view, row);
    return column >= s.first && column <= s.last;
}

uint32_t fxs_list_c(const fxs_key *keys, uint32_t count, uint32_t tile, uint32_t *entries)
{
    uint32_t listed = 0;
    for (uint32_t i = 0; i < count; i++) {         /* the loop has no branch, because the processor could not predict
                                                      it */
        entries[listed] = FXS_LISTED_SLOT(keys[i]);
        listed += (uint32_t)keys[i] >> tile & 1;
    }
    return listed;
}

void fxs_mark_cut_off(const fxs_lister *l, uint32_t tile, uint32_t *entries, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        entries[i] |= touches(l->view, &l->splats[entries[i]], &l->bounds[entries[i]], tile) ? 0 : FXS_ENTRY_CUT_OFF;
}
