/* bin: which tiles a splat touches. On a tile row the ellipse u^2 + v^2 = r^2 spans x = cx + shear v +- breadth sqrt(r^2 - v^2), v between the row's
 * first and last pixel row; the widest points are at v = +- r shear / sqrt(A). A margin of 1/8 pixel and 1/128 of the size makes up for rounding, so a list
 * never misses a pixel that passes the test in pixel.h. */
#include "fixed.h"
#include "memory.h"
#include "stage.h"

typedef struct ellipse {
    const fxs_splat *splat;
    const fxs_bounds *bounds;
    int64_t cx_q8, margin_q8;
    int32_t r_q12;
    int32_t first_row, last_row;       /* tile rows of the ellipse */
} ellipse;

static void ellipse_init(ellipse *e, const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds)
{
    int32_t limit_q11 = fxs_limit_q11(splat->offset_q11, view->cut_q11);
    e->splat = splat;
    e->bounds = bounds;
    e->cx_q8 = bounds->cx_q14 >> 6;
    e->margin_q8 = (bounds->half_width_q8 >> 7) + 32;
    e->r_q12 = (int32_t)fxs_sqrt((uint32_t)(limit_q11 - splat->offset_q11) << 13) + 1;
    e->first_row = splat->first_row / FXS_TILE;
    e->last_row = splat->last_row / FXS_TILE;
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

static fxs_span columns(const fxs_view *view, int64_t left_q8, int64_t right_q8)
{
    int64_t first = (left_q8 + 255) >> 8, last = right_q8 >> 8;
    if (last < 0 || first >= view->width || first > last)
        return (fxs_span){0, -1};
    return (fxs_span){first < 0 ? 0 : (int32_t)(first / FXS_TILE),
                      last >= view->width ? view->tiles_x - 1 : (int32_t)(last / FXS_TILE)};
}

static fxs_span ellipse_span(const ellipse *e, const fxs_view *view, int32_t row)
{
    int64_t reach_q8 = e->bounds->half_width_q8;
    fxs_span box = columns(view, e->cx_q8 - reach_q8, e->cx_q8 + reach_q8);
    if (!view->square && (box.first >= box.last || e->first_row == e->last_row))
        return box;
    int64_t top_q12 = v_at_row(e, row * FXS_TILE), bottom_q12 = v_at_row(e, row * FXS_TILE + FXS_TILE - 1);
    if (top_q12 > e->r_q12 + 1024 || bottom_q12 < -e->r_q12 - 1024)   /* 1/4: a margin of 1/8 pixel */
        return (fxs_span){0, -1};
    int32_t top = cut_to(e->r_q12, top_q12), bottom = cut_to(e->r_q12, bottom_q12);
    int64_t x_top_q8 = (int64_t)e->bounds->shear_q8 * top >> 12;
    int64_t x_bottom_q8 = (int64_t)e->bounds->shear_q8 * bottom >> 12;
    int64_t half_top_q8 = half_width_q8(e, top), half_bottom_q8 = half_width_q8(e, bottom);
    int64_t left_q8 = x_top_q8 - half_top_q8 < x_bottom_q8 - half_bottom_q8 ? x_top_q8 - half_top_q8
                                                                            : x_bottom_q8 - half_bottom_q8;
    int64_t right_q8 = x_top_q8 + half_top_q8 > x_bottom_q8 + half_bottom_q8 ? x_top_q8 + half_top_q8
                                                                             : x_bottom_q8 + half_bottom_q8;
    /* v sqrt(A) against +- r shear: is a widest point on this tile row? */
    int64_t tangent = (int64_t)e->bounds->shear_q8 * e->r_q12 / 4096 * e->r_q12;
    if (top * reach_q8 <= tangent && tangent <= bottom * reach_q8)
        right_q8 = reach_q8;
    if (top * reach_q8 <= -tangent && -tangent <= bottom * reach_q8)
        left_q8 = -reach_q8;
    return columns(view, e->cx_q8 + left_q8 - e->margin_q8, e->cx_q8 + right_q8 + e->margin_q8);
}

/* Tile rows and columns of the square: floor((c - radius) / 16) to floor((c + radius + 15) / 16), exclusive. */
static fxs_span square_span(int32_t centre_q14, uint32_t radius, int32_t tiles)
{
    int64_t first = (centre_q14 - ((int64_t)radius << 14)) >> 18;
    int64_t last = ((centre_q14 + ((int64_t)(radius + 15) << 14)) >> 18) - 1;
    return (fxs_span){first < 0 ? 0 : (int32_t)(first < tiles ? first : tiles),
                      last < tiles ? (int32_t)(last < -1 ? -1 : last) : tiles - 1};
}

static fxs_span rows(const ellipse *e, const fxs_view *view)
{
    if (view->square)
        return square_span(e->bounds->cy_q14, e->bounds->radius, view->tiles_y);
    return (fxs_span){e->first_row, e->last_row};
}

static fxs_span span(const ellipse *e, const fxs_view *view, int32_t row)
{
    if (view->square)
        return square_span(e->bounds->cx_q14, e->bounds->radius, view->tiles_x);
    return ellipse_span(e, view, row);
}

void fxs_bin_count(const fxs_view *view, const fxs_key *keys, uint32_t count, const fxs_splat *splats,
                   const fxs_bounds *bounds, uint32_t *counts)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = FXS_KEY_SLOT(keys[i]);
        ellipse e;
        ellipse_init(&e, view, &splats[slot], &bounds[slot]);
        fxs_span r = rows(&e, view);
        for (int32_t row = r.first; row <= r.last; row++) {
            fxs_span s = span(&e, view, row);
            for (int32_t column = s.first; column <= s.last; column++)
                counts[row * view->tiles_x + column]++;
        }
    }
}

void fxs_bin_fill(const fxs_view *view, const fxs_key *keys, uint32_t count, const fxs_splat *splats,
                  const fxs_bounds *bounds, int32_t first_tile, int32_t last_tile, uint32_t *next, uint32_t *entries)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = FXS_KEY_SLOT(keys[i]);
        ellipse e;
        ellipse_init(&e, view, &splats[slot], &bounds[slot]);
        fxs_span r = rows(&e, view);
        for (int32_t row = r.first; row <= r.last; row++) {
            fxs_span s = span(&e, view, row), near = s;
            if (view->square)
                near = ellipse_span(&e, view, row);
            for (int32_t column = s.first; column <= s.last; column++) {
                int32_t tile = row * view->tiles_x + column;
                if (tile < first_tile || tile > last_tile)
                    continue;
                uint32_t far = column < near.first || column > near.last ? FXS_ENTRY_FAR : 0;
                entries[next[tile]++] = slot | far;
            }
        }
    }
}
