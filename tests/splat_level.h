/* Computes level = -2 ln(alpha) of a splat (projected Gaussian) at any pixel, without tiles or lists. */
#ifndef SPLAT_LEVEL_H
#define SPLAT_LEVEL_H

#include <math.h>

#include <fixsplat/internal/stage.h>

/* Restores the high bits of a Q24 number: returns the value nearest to `about_q24` with the given low 32 bits. */
static inline int64_t unwrap_q24(uint32_t low_bits, int64_t about_q24)
{
    return about_q24 + (int32_t)(low_bits - (uint32_t)about_q24);
}

static inline int coordinate(int64_t q24)
{
    return fxs_coordinate_q13((int)(q24 < INT32_MIN ? INT32_MIN : q24 > INT32_MAX ? INT32_MAX : q24));
}

static inline int splat_level(const fxs_splat *s, const fxs_bounds *b, int x, int y)
{
    int64_t dx_q14 = ((int64_t)x << 14) - b->cx_q14, dy_q14 = ((int64_t)y << 14) - b->cy_q14;
    uint32_t u = s->u0_q24 + (uint32_t)x * (uint32_t)s->ux_q24 + (uint32_t)y * (uint32_t)s->uy_q24;
    uint32_t v = s->v0_q24 + (uint32_t)y * (uint32_t)s->vy_q24;
    int64_t u_q24 = unwrap_q24(u, (dx_q14 * s->ux_q24 + dy_q14 * s->uy_q24) >> 14);
    int64_t v_q24 = unwrap_q24(v, dy_q14 * s->vy_q24 >> 14);
    return fxs_level_q11(coordinate(u_q24), fxs_row_level_q11(coordinate(v_q24), s->offset_q11));
}

/* True if a splat is drawn in the tile of pixel x, y. Kerbl et al. 2023 draw a splat with centre c and radius r in
   tiles floor((c - r) / 16) to floor((c + r + 15) / 16) - 1. */
static inline int splat_has_tile(const fxs_bounds *b, int x, int y)
{
    double cx = ldexp(b->cx_q14, -14), cy = ldexp(b->cy_q14, -14), radius = b->square_radius;
    int tile_x = x / FXS_TILE, tile_y = y / FXS_TILE;
    return tile_x >= floor((cx - radius) / 16) && tile_x < floor((cx + radius + 15) / 16) &&
           tile_y >= floor((cy - radius) / 16) && tile_y < floor((cy + radius + 15) / 16);
}

#endif
