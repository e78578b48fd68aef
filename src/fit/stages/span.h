/* Finds the tiles of 16x16 pixels that the ellipses of LANES splats touch, row by row. */
#ifndef FXS_FIT_SPAN_H
#define FXS_FIT_SPAN_H

#include "fit_lanes.h"
#include "fit_stage.h"

/* Ellipses of LANES splats. radius2: squared radius in the normalised coordinates u and v. first, end: rows of tiles
   that an ellipse touches; none for hidden splats. */
typedef struct ellipses {
    real x, y, ux, uy, vy, radius2, half_y, tip, first, end;
} ellipses;

/* Returns the number of the tile with a pixel coordinate, which may be outside of the picture; clamped to
   0..most_of. */
static inline real tile_at(real pixel, int32_t most_of)
{
    const real tile = least(most(pixel * (1.0f / FXS_FIT_TILE), all(0)), all((float)most_of));
    return whole_to_real(real_to_whole(tile));
}

static inline void find_rows(const fxs_fit_camera *camera, mask seen, ellipses *e)
{
    e->first = tile_at(e->y - e->half_y, camera->tiles_y);
    e->end = keep(seen, tile_at((e->y + e->half_y) + FXS_FIT_TILE, camera->tiles_y));
}

/* Finds the columns first..end of tiles that ellipses touch in a row of tiles. With u = r cos and v = r sin, the
   outline is x = (u - uy y) / ux, y = v / vy. x is largest at the y of the rightmost point, clamped to the row. Adds a
   margin of 0.01 pixels. */
static inline void find_columns(const fxs_fit_camera *camera, const ellipses *e, real row, real *first, real *end)
{
    const real top = row * (float)FXS_FIT_TILE + (0.5f - e->y), bottom = top + (float)(FXS_FIT_TILE - 1);
    const mask is_square = below(e->radius2, all(0));
    real reach[2];
    for (int i = 0; i < 2; i++) {
        const real y = least(most(i ? e->tip : -e->tip, top), bottom), v = y * e->vy, along = y * e->uy;
        const real half = root(most(e->radius2 - v * v, all(0)));
        reach[i] = choose(is_square, e->half_y + 0.5f, (i ? half - along : half + along) / e->ux + 0.01f);
    }
    /* Adds half a pixel to coordinates, because a pixel's centre is half a pixel from its sides. */
    *first = tile_at((e->x - reach[0]) + 0.5f, camera->tiles_x);
    *end = keep(below(row, e->end), tile_at((e->x + reach[1]) + (FXS_FIT_TILE - 0.5f), camera->tiles_x));
}

static inline real count_tiles(const fxs_fit_camera *camera, const ellipses *e)
{
    real count = all(0);
    for (real row = e->first; any(below(row, e->end)); row = row + 1.0f) {
        real first, end;
        find_columns(camera, e, row, &first, &end);
        count = count + most(end - first, all(0));
    }
    return count;
}

static inline void put_tiles(const fxs_fit_camera *camera, const ellipses *e, uint32_t *out[LANES])
{
    for (real row = e->first; any(below(row, e->end)); row = row + 1.0f) {
        real first, end;
        float rows[LANES], columns[LANES], ends[LANES];
        find_columns(camera, e, row, &first, &end);
        store(rows, row);
        store(columns, first);
        store(ends, end);
        for (int i = 0; i < LANES; i++) {
            const uint32_t tile = (uint32_t)rows[i] * (uint32_t)camera->tiles_x;
            for (uint32_t x = (uint32_t)columns[i]; x < (uint32_t)ends[i]; x++)
                *out[i]++ = tile + x;
        }
    }
}

#endif
