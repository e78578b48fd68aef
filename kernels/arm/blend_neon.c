/* blend: a row of 16 pixels a step, in two vectors. vqrdmulhq_s16 is fxs_mul_q15 but for -32768 squared, which it cuts
 * to 32767. Only a coordinate below -4 becomes -32768 (in pixel.h -32767), and either square is above every limit. */
#include <arm_neon.h>

#include "arm.h"

#define AHEAD 2u                               /* entries between the splat fetched and the splat blended */
#define ROW_BITS 0x1111111111111111u           /* sets of rows have four bits a row; the lowest counts */

/* A splat at a tile. */
typedef struct placed {
    uint32x4_t u_q24[4];                       /* on the first row */
    int16x8_t limit_q11, colour_q13[3];
    int16_t row_level_q11[FXS_TILE];
    uint32_t uy_q24;
} placed;

/* out[i] = first + i step, modulo 2^32 */
static inline void ramp(uint32x4_t out[4], uint32_t first, uint32_t step)
{
    static const uint32_t lanes[4] = {0, 1, 2, 3};
    const uint32x4_t four = vdupq_n_u32(4 * step);
    out[0] = vmlaq_n_u32(vdupq_n_u32(first), vld1q_u32(lanes), step);
    out[1] = vaddq_u32(out[0], four);
    out[2] = vaddq_u32(out[1], four);
    out[3] = vaddq_u32(out[2], four);
}

/* u^2 or v^2 */
static inline int16x8_t square_q11(uint32x4_t low_q24, uint32x4_t high_q24)
{
    int16x4_t low_q13 = vqshrn_n_s32(vreinterpretq_s32_u32(low_q24), 11);
    int16x8_t c_q13 = vqshrn_high_n_s32(low_q13, vreinterpretq_s32_u32(high_q24), 11);
    return vqrdmulhq_s16(c_q13, c_q13);
}

/* a + b c, cut to 16 bits */
static inline int16x8_t add_product(int16x8_t a, int16x8_t b_q15, int16x8_t c)
{
#ifdef __ARM_FEATURE_QRDMX
    return vqrdmlahq_s16(a, b_q15, c);
#else
    return vqaddq_s16(a, vqrdmulhq_s16(b_q15, c));
#endif
}

/* fxs_alpha_q15 */
static inline int16x8_t alpha_q15(int16x8_t level_q11)
{
    int16x8_t p = add_product(vdupq_n_s16(16016), level_q11, vdupq_n_s16(-4236));
    p = add_product(vdupq_n_s16(-32730), level_q11, p);
    p = add_product(vdupq_n_s16(32767), level_q11, p);
    p = vqrdmulhq_s16(p, p);
    p = vqrdmulhq_s16(p, p);
    p = vqrdmulhq_s16(p, p);
    return vminq_s16(p, vdupq_n_s16(FXS_ALPHA_MAX_Q15));
}

/* Two masks, four bits a lane: `low` in bits 31..0. */
static inline uint64_t bits_of(uint16x8_t low, uint16x8_t high)
{
    uint8x16_t bytes = vuzp1q_u8(vreinterpretq_u8_u16(low), vreinterpretq_u8_u16(high));
    return vget_lane_u64(vreinterpret_u64_u8(vshrn_n_u16(vreinterpretq_u16_u8(bytes), 4)), 0);
}

static inline void accumulate(int16_t sum_q13[8], int16x8_t weight_q15, int16x8_t colour_q13)
{
    vst1q_s16(sum_q13, add_product(vld1q_s16(sum_q13), weight_q15, colour_q13));
}

/* Blends the lanes of `mask` into the 8 pixels from i on. */
static inline void blend_lanes(fxs_tile *tile, int i, int16x8_t transmittance_q15, int16x8_t level_q11, uint16x8_t mask,
                               const placed *p)
{
    int16x8_t alpha = vandq_s16(alpha_q15(level_q11), vreinterpretq_s16_u16(mask));
    int16x8_t weight = vqrdmulhq_s16(alpha, transmittance_q15);
    vst1q_s16(tile->transmittance_q15 + i, vsubq_s16(transmittance_q15, weight));
    accumulate(tile->sum_q13[0] + i, weight, p->colour_q13[0]);
    accumulate(tile->sum_q13[1] + i, weight, p->colour_q13[1]);
    accumulate(tile->sum_q13[2] + i, weight, p->colour_q13[2]);
}

/* Returns 0 for a row that was found closed. */
static inline int blend_row(fxs_tile *tile, int row, const placed *p)
{
    const int i = row * FXS_TILE;
    const int16x8_t closed = vdupq_n_s16(FXS_CLOSED_Q15), row_level = vld1q_dup_s16(p->row_level_q11 + row);
    const uint32x4_t down_q24 = vdupq_n_u32((uint32_t)row * p->uy_q24);
    int16x8_t t0 = vld1q_s16(tile->transmittance_q15 + i), t1 = vld1q_s16(tile->transmittance_q15 + i + 8);
    uint16x8_t open0 = vcgeq_s16(t0, closed), open1 = vcgeq_s16(t1, closed);
    int16x8_t level0 = square_q11(vaddq_u32(p->u_q24[0], down_q24), vaddq_u32(p->u_q24[1], down_q24));
    int16x8_t level1 = square_q11(vaddq_u32(p->u_q24[2], down_q24), vaddq_u32(p->u_q24[3], down_q24));
    level0 = vqaddq_s16(level0, row_level);
    level1 = vqaddq_s16(level1, row_level);
    uint16x8_t mask0 = vandq_u16(open0, vcleq_s16(level0, p->limit_q11));
    uint16x8_t mask1 = vandq_u16(open1, vcleq_s16(level1, p->limit_q11));
    const uint64_t counted = bits_of(mask0, mask1);
    if (!counted)
        return bits_of(open0, open1) != 0;
    if (counted << 32)
        blend_lanes(tile, i, t0, level0, mask0, p);
    if (counted >> 32)
        blend_lanes(tile, i + 8, t1, level1, mask1, p);
    return 1;
}

/* v^2 + offset of the 16 rows. Returns the rows within the limit. */
static inline uint64_t place_rows(placed *p, uint32_t v_q24, uint32_t vy_q24, int16x8_t offset_q11)
{
    uint32x4_t v[4];
    ramp(v, v_q24, vy_q24);
    int16x8_t level0 = vqaddq_s16(square_q11(v[0], v[1]), offset_q11);
    int16x8_t level1 = vqaddq_s16(square_q11(v[2], v[3]), offset_q11);
    vst1q_s16(p->row_level_q11, level0);
    vst1q_s16(p->row_level_q11 + 8, level1);
    return bits_of(vcleq_s16(level0, p->limit_q11), vcleq_s16(level1, p->limit_q11)) & ROW_BITS;
}

/* As place() of src/blend.c. Returns the rows that the splat may touch. */
static inline uint64_t place(placed *p, const fxs_view *view, const fxs_splat *splat, uint32_t entry, int32_t x,
                             int32_t y)
{
    const int first = splat->first_row > y ? splat->first_row - y : 0;
    const int last = fxs_min(splat->last_row - y, FXS_TILE - 1);
    if (first > last)
        return 0;
    uint32_t u = splat->u0_q24 + (uint32_t)x * (uint32_t)splat->ux_q24 + (uint32_t)y * (uint32_t)splat->uy_q24;
    uint32_t v = splat->v0_q24 + (uint32_t)y * (uint32_t)splat->vy_q24;
    if (entry & FXS_ENTRY_FAR)
        u = v = FXS_FAR_Q24;
    p->limit_q11 = vdupq_n_s16((int16_t)fxs_limit_q11(splat->offset_q11, view->cut_q11));
    p->uy_q24 = (uint32_t)splat->uy_q24;
    for (int c = 0; c < 3; c++)
        p->colour_q13[c] = vdupq_n_s16(splat->colour_q13[c]);
    ramp(p->u_q24, u, (uint32_t)splat->ux_q24);
    uint64_t rows = place_rows(p, v, (uint32_t)splat->vy_q24, vdupq_n_s16((int16_t)splat->offset_q11));
    return rows & ~(uint64_t)0 << 4 * first & ~(uint64_t)0 >> 4 * (FXS_TILE - 1 - last);
}

static void clear(fxs_tile *tile)
{
    for (int i = 0; i < FXS_TILE_PIXELS; i += 8) {
        vst1q_s16(tile->transmittance_q15 + i, vdupq_n_s16(FXS_CLEAR_Q15));
        for (int c = 0; c < 3; c++)
            vst1q_s16(tile->sum_q13[c] + i, vdupq_n_s16(0));
    }
}

void fxs_blend_neon(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                    uint32_t count, fxs_tile *tile)
{
    uint64_t open = ROW_BITS;
    clear(tile);
    for (uint32_t i = 0; i < count && open; i++) {
        placed p;
        if (i + AHEAD < count)
            __builtin_prefetch(&splats[entries[i + AHEAD] & ~FXS_ENTRY_FAR]);
        uint64_t rows = open & place(&p, view, &splats[entries[i] & ~FXS_ENTRY_FAR], entries[i], x, y);
        for (; rows; rows &= rows - 1)
            if (!blend_row(tile, __builtin_ctzll(rows) / 4, &p))
                open &= ~(rows & (0 - rows));
    }
}
