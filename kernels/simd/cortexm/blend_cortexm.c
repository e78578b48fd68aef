/* Blends the splats of a tile on Cortex-M processors without vectors. Uses the arithmetic of src/core/blend.c on fewer
 * pixels: skips pixels that a splat cannot reach, and rows with only opaque pixels. */
#include <fixsplat/internal/pixel.h>
#include "src/core/draw.h"
#include "kernels/simd/lanes/stages.h"

/* Table of splat coordinates: entry i is the largest |u| with u^2 at most 1024 (i + 1) in Q11, plus one unit of Q13. */
static const uint16_t reach_q13[(FXS_FAINT_Q11 >> 10) + 1] = {
    5794, 8193, 10035, 11587, 12954, 14190, 15327, 16385, 17379, 18319, 19213, 20068, 20887, 21675, 22436, 23172, 23885,
    24577, 25251, 25907, 26547, 27171, 27782};

/* Returns the rounded product a b >> 15. `half` is 16384, hidden from the compiler to make it use a multiply-add. */
static inline int mul(int a, int b, int half)
{
    return (a * b + half) >> 15;
}

/* Returns a splat's alpha at a pixel, exp(-level / 2) capped at 0.99, in Q15. The result equals that of
   fxs_alpha_q15. */
static inline int alpha_of(int level_q11, int half)
{
    int p = mul(-4236, level_q11, half) + 16016;
    p = mul(p, level_q11, half) - 32730;
    p = mul(p, level_q11, half) + 32767;
    p = mul(p, p, half);
    p = mul(p, p, half);
    p = mul(p, p, half);
    return fxs_min(p, FXS_ALPHA_MAX_Q15);
}

#define FOUR_Q24 (4u << 24)

typedef struct at_row {
    int32_t u_q24, ux_q24;         /* splat coordinate u at the row's first pixel, and its step per pixel */
    uint32_t per_u;
    int level_q11, limit_q11;
    int red_q13, green_q13, blue_q13;
} at_row;

static inline int cut(int x)
{
#ifdef __ARM_FEATURE_SAT
    return (int)__builtin_arm_ssat(x, 16);
#else
    return fxs_min(x, 32767);
#endif
}

static inline void accumulate(int16_t *sum_q13, int weight_q15, int colour_q13, int half)
{
    *sum_q13 = (int16_t)cut(*sum_q13 + mul(weight_q15, colour_q13, half));
}

/* Returns the first pixel of a row that a splat may reach, or FXS_TILE or more if there is none. */
static inline uint32_t first_of(const at_row *r, int left_q11)
{
    const int32_t reach_q24 = reach_q13[left_q11 >> 10] << 11, before = -reach_q24 - r->u_q24;
    if (before > 0)
        return (uint32_t)((uint64_t)(uint32_t)before * r->per_u >> 32);
    return r->u_q24 > reach_q24 ? FXS_TILE : 0;
}

/* Blends a splat into a row of pixels, and returns the number of pixels that became opaque. From the first reached
   pixel on, the splat coordinate |u| is below 8, so u^2 fits in 32 bits. */
static inline int blend_row(int16_t *t, const at_row *r)
{
    const int left_q11 = r->limit_q11 - r->level_q11;
    const uint32_t first = first_of(r, left_q11), end_q26 = (uint32_t)(left_q11 + 1) << 15;
    if (first >= FXS_TILE)
        return 0;
    int32_t u_q24 = r->u_q24 + (int32_t)first * r->ux_q24;
    int closed = 0, half = 1 << 14;
    __asm__("" : "+r"(half));
    for (int16_t *end = t + FXS_TILE, *at = t + first; at < end; at++, u_q24 += r->ux_q24) {
        const int32_t u_q13 = u_q24 >> 11;
        const uint32_t square_q26 = (uint32_t)u_q13 * (uint32_t)u_q13 + (uint32_t)half;
        if (square_q26 >= end_q26) {
            if (u_q13 > 0)
                break;
            continue;
        }
        const int transmittance = *at;
        if (transmittance < FXS_CLOSED_Q15)
            continue;
        const int weight = mul(alpha_of(r->level_q11 + (int)(square_q26 >> 15), half), transmittance, half);
        *at = (int16_t)(transmittance - weight);
        closed += transmittance - weight < FXS_CLOSED_Q15;
        accumulate(at + FXS_TILE_PIXELS, weight, r->red_q13, half);
        accumulate(at + 2 * FXS_TILE_PIXELS, weight, r->green_q13, half);
        accumulate(at + 3 * FXS_TILE_PIXELS, weight, r->blue_q13, half);
    }
    return closed;
}

static int blend_splat(fxs_tile *tile, uint8_t open[FXS_TILE], const fxs_stage_view *view, const fxs_splat *splat,
                       int32_t x, int32_t y)
{
    const uint32_t ux = (uint32_t)splat->ux_q24;
    const int32_t first = splat->first_row > y ? splat->first_row - y : 0;
    const int32_t last = fxs_min(splat->last_row - y, FXS_TILE - 1);
    uint32_t u_q24 = splat->u0_q24 + (uint32_t)x * ux + (uint32_t)(y + first) * (uint32_t)splat->uy_q24;
    uint32_t v_q24 = splat->v0_q24 + (uint32_t)(y + first) * (uint32_t)splat->vy_q24;
    at_row r = {0, splat->ux_q24, UINT32_MAX / (ux ? ux : 1), 0, fxs_limit_q11(splat->offset_q11, view->cut_q11),
                splat->colour_q13[0], splat->colour_q13[1], splat->colour_q13[2]};
    int closed = 0;
    for (int32_t row = first; row <= last; row++) {
        const uint32_t v_q13 = (uint32_t)((int32_t)v_q24 >> 11);
        r.level_q11 = splat->offset_q11 + (int)((v_q13 * v_q13 + 16384) >> 15);
        if (v_q24 + FOUR_Q24 < 2 * FOUR_Q24 && r.level_q11 <= r.limit_q11 && open[row]) {
            r.u_q24 = (int32_t)u_q24;
            const int by_row = blend_row(tile->transmittance_q15 + row * FXS_TILE, &r);
            open[row] = (uint8_t)(open[row] - by_row);
            closed += by_row;
        }
        u_q24 += (uint32_t)splat->uy_q24;
        v_q24 += (uint32_t)splat->vy_q24;
    }
    return closed;
}

FXS_BLEND(cortexm)
{
    uint8_t open[FXS_TILE];
    int pixels = FXS_TILE_PIXELS;
    fxs_tile_clear(tile);
    for (int row = 0; row < FXS_TILE; row++)
        open[row] = FXS_TILE;
    for (uint32_t i = 0; i < count && pixels; i++)
        if (!(entries[i] & FXS_ENTRY_CUT_OFF))
            pixels -= blend_splat(tile, open, view, &splats[entries[i]], x, y);
}
