/* bin: which tiles a splat touches. On a tile row the ellipse u^2 + v^2 = r^2 spans x = cx + shear v +- breadth
 * sqrt(r^2 - v^2), v between the row's first and last pixel row; the widest points are at v = +- r shear / sqrt(A). A
 * margin of 1/8 pixel and 1/256 of the size makes up for rounding, so a list never misses a pixel that passes the
 * test in pixel.h. */
#include "fixed.h"
#include "memory.h"
#include "parts.h"

#define AHEAD 16                   /* keys */

typedef fxs_span span;

typedef struct ellipse {
    const fxs_splat *splat;
    const fxs_bounds *bounds;
    span columns, rows;            /* of its bounding box */
    int32_t r_q12;                 /* add_radius */
} ellipse;

/* The tile columns of the pixels between two points. */
static span columns_between(const fxs_view *view, int64_t left_q8, int64_t right_q8)
{
    int64_t first = (left_q8 + 255) >> 8, last = right_q8 >> 8;
    if (last < 0 || first >= view->width || first > last)
        return (span){0, -1};
    return (span){first < 0 ? 0 : (int32_t)(first / FXS_TILE),
                  last >= view->width ? view->tiles_x - 1 : (int32_t)(last / FXS_TILE)};
}

static ellipse ellipse_of(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds)
{
    int64_t cx_q8 = bounds->cx_q14 >> 6, reach_q8 = bounds->half_width_q8;
    return (ellipse){splat, bounds, columns_between(view, cx_q8 - reach_q8, cx_q8 + reach_q8),
                     {splat->first_row / FXS_TILE, splat->last_row / FXS_TILE}, 0};
}

/* What ellipse_span needs: apart, as many a splat has no tile row cut. */
static void add_radius(ellipse *e, const fxs_view *view)
{
    int32_t offset_q11 = e->splat->offset_q11, limit_q11 = fxs_limit_q11(offset_q11, view->cut_q11);
    e->r_q12 = (int32_t)fxs_sqrt((uint32_t)(limit_q11 - offset_q11 + 1) << 13) + 1;
}

/* v at a pixel row. */
static int64_t v_at_row(const ellipse *e, int32_t row)
{
    return (((int64_t)row << 14) - e->bounds->cy_q14) * e->splat->vy_q24 >> 26;
}

static int32_t cut_to(int32_t r, int64_t v)
{
    return v < -r ? -r : v > r ? r : (int32_t)v;
}

/* Half the width at v, about x = cx + shear v. */
static int64_t half_width_q8(const ellipse *e, int32_t v_q12)
{
    uint32_t square_q24 = (uint32_t)(e->r_q12 * e->r_q12 - v_q12 * v_q12);
    return (int64_t)e->bounds->breadth_q8 * (fxs_sqrt(square_q24) + 1) >> 12;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* The tiles of a tile row that the ellipse touches. Of a veil, all: it has no centre to know v by, and 2^-8 of its
   reach is 16384 pixels. */
static span ellipse_span(const ellipse *e, const fxs_view *view, int32_t row)
{
    int64_t top_q12 = v_at_row(e, row * FXS_TILE), bottom_q12 = v_at_row(e, row * FXS_TILE + FXS_TILE - 1);
    if ((top_q12 > e->r_q12 + 2 || bottom_q12 < -e->r_q12 - 2) && e->bounds->half_width_q8 != FXS_EVERYWHERE_Q8)
        return (span){0, -1};
    int32_t top = cut_to(e->r_q12, top_q12), bottom = cut_to(e->r_q12, bottom_q12 + 1);   /* rounded outwards */
    int64_t x_top_q8 = (int64_t)e->bounds->shear_q8 * top >> 12, half_top_q8 = half_width_q8(e, top);
    int64_t x_bottom_q8 = (int64_t)e->bounds->shear_q8 * bottom >> 12, half_bottom_q8 = half_width_q8(e, bottom);
    int64_t left_q8 = -larger(half_top_q8 - x_top_q8, half_bottom_q8 - x_bottom_q8);
    int64_t right_q8 = larger(half_top_q8 + x_top_q8, half_bottom_q8 + x_bottom_q8);
    /* v sqrt(A) against +- r shear: is a widest point on this tile row? */
    int64_t reach_q8 = e->bounds->half_width_q8;
    int64_t tangent = (int64_t)e->bounds->shear_q8 * e->r_q12 / 4096 * e->r_q12;
    if (top * reach_q8 <= tangent && tangent <= bottom * reach_q8)
        right_q8 = reach_q8;
    if (top * reach_q8 <= -tangent && -tangent <= bottom * reach_q8)
        left_q8 = -reach_q8;
    int64_t cx_q8 = e->bounds->cx_q14 >> 6, margin_q8 = (reach_q8 >> 8) + 32;
    left_q8 = larger(left_q8 - margin_q8, -reach_q8);
    right_q8 = -larger(-right_q8 - margin_q8, -reach_q8);
    return columns_between(view, cx_q8 + left_q8, cx_q8 + right_q8);
}

/* Tile rows or columns of the square: floor((c - radius) / 16) to floor((c + radius + 15) / 16), exclusive. */
static span square_span(int32_t centre_q14, uint32_t radius, int32_t tiles)
{
    int64_t first = (centre_q14 - ((int64_t)radius << 14)) >> 18;
    int64_t last = ((centre_q14 + ((int64_t)(radius + 15) << 14)) >> 18) - 1;
    return (span){first < 0 ? 0 : (int32_t)(first < tiles ? first : tiles),
                  last < tiles ? (int32_t)(last < -1 ? -1 : last) : tiles - 1};
}

FXS_STAGE fxs_span fxs_bin_rows(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds)
{
    return view->square ? square_span(bounds->cy_q14, bounds->radius, view->tiles_y)
                        : (span){splat->first_row / FXS_TILE, splat->last_row / FXS_TILE};
}

static span rows_of(const ellipse *e, const fxs_view *view)
{
    return fxs_bin_rows(view, e->splat, e->bounds);
}

static span span_of(const ellipse *e, const fxs_view *view, int32_t row)
{
    return view->square ? square_span(e->bounds->cx_q14, e->bounds->radius, view->tiles_x)
                        : ellipse_span(e, view, row);
}

void fxs_bin_c(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count, fxs_box *boxes)
{
    for (uint32_t i = 0; i < count; i++) {
        ellipse e = ellipse_of(view, &splats[i], &bounds[i]);
        boxes[i] = (fxs_box){(uint32_t)(e.rows.first * view->tiles_x + e.columns.first), 0};
        if (view->square || e.columns.first > e.columns.last || e.columns.last - e.columns.first > 3 ||
            e.rows.last - e.rows.first > 3)
            continue;
        /* All of it on one tile row: it touches every column of its box. */
        int whole = splats[i].first_row > 0 && splats[i].last_row < view->height - 1;
        if (whole && e.rows.first == e.rows.last) {
            boxes[i].mask = (2u << (e.columns.last - e.columns.first)) - 1;
            continue;
        }
        add_radius(&e, view);
        for (int32_t row = e.rows.first; row <= e.rows.last; row++) {
            span s = ellipse_span(&e, view, row);
            if (s.first <= s.last)
                boxes[i].mask |= ((2u << (s.last - e.columns.first)) - (1u << (s.first - e.columns.first)))
                                 << 4 * (row - e.rows.first);
        }
    }
}

static uint32_t tile_of_bit(const fxs_view *view, fxs_box box, uint32_t mask)
{
    uint32_t bit = (uint32_t)fxs_ctz32(mask);
    return box.base + bit / 4 * (uint32_t)view->tiles_x + bit % 4;
}

static void count_large(const fxs_view *view, const ellipse *e, uint32_t *counts)
{
    span rows = rows_of(e, view);
    for (int32_t row = rows.first; row <= rows.last; row++) {
        span s = span_of(e, view, row);
        for (int32_t column = s.first; column <= s.last; column++)
            counts[row * view->tiles_x + column]++;
    }
}

void fxs_bin_count(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, const fxs_box *boxes,
                   const fxs_sorted *sorted, uint32_t *counts)
{
    for (uint32_t i = 0; i < sorted->count; i++) {
        uint32_t slot = FXS_KEY_SLOT(sorted->keys[i]);
        if (i + AHEAD < sorted->count)             /* slots are in no order here */
            FXS_PREFETCH(&boxes[FXS_KEY_SLOT(sorted->keys[i + AHEAD])]);
        fxs_box box = sorted->boxes[i] = boxes[slot];
        if (!box.mask && box.base != FXS_NOWHERE) {
            ellipse e = ellipse_of(view, &splats[slot], &bounds[slot]);
            add_radius(&e, view);
            count_large(view, &e, counts);
        }
        for (; box.mask; box.mask &= box.mask - 1)
            counts[tile_of_bit(view, box, box.mask)]++;
    }
}

/* Lists a splat whose tiles do not fit in a box. */
static void fill_large(const fxs_view *view, const ellipse *e, uint32_t slot, uint32_t first_tile, uint32_t last_tile,
                       uint32_t *next, uint32_t *entries)
{
    span rows = rows_of(e, view);
    int32_t first_row = (int32_t)first_tile / view->tiles_x, last_row = (int32_t)last_tile / view->tiles_x;
    first_row = rows.first > first_row ? rows.first : first_row;
    last_row = rows.last < last_row ? rows.last : last_row;
    for (int32_t row = first_row; row <= last_row; row++) {
        span s = span_of(e, view, row), touched = view->square ? ellipse_span(e, view, row) : s;
        for (int32_t column = s.first; column <= s.last; column++) {
            uint32_t tile = (uint32_t)(row * view->tiles_x + column);
            uint32_t far = column < touched.first || column > touched.last ? FXS_ENTRY_FAR : 0;
            if (tile - first_tile <= last_tile - first_tile)
                entries[next[tile]++] = slot | far;
        }
    }
}

void fxs_bin_fill(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, const fxs_sorted *sorted,
                  uint32_t first_tile, uint32_t last_tile, uint32_t *next, uint32_t *entries)
{
    for (uint32_t i = 0; i < sorted->count; i++) {
        uint32_t slot = FXS_KEY_SLOT(sorted->keys[i]);
        fxs_box box = sorted->boxes[i];
        if (!box.mask && box.base != FXS_NOWHERE) {
            ellipse e = ellipse_of(view, &splats[slot], &bounds[slot]);
            add_radius(&e, view);
            fill_large(view, &e, slot, first_tile, last_tile, next, entries);
        }
        for (; box.mask; box.mask &= box.mask - 1) {
            uint32_t tile = tile_of_bit(view, box, box.mask);
            if (tile - first_tile <= last_tile - first_tile)
                entries[next[tile]++] = slot;
        }
    }
}
