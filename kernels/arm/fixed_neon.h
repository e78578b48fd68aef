/* src/fixed.h for four lanes: the same integers. */
#ifndef FXS_FIXED_NEON_H
#define FXS_FIXED_NEON_H

#include <arm_neon.h>

/* a * b >> shift, low 32 bits; shift a constant in 1..32. */
#define MUL_SHIFT(a, b, shift) \
    vshrn_high_n_u64(vshrn_n_u64(vmull_u32(vget_low_u32(a), vget_low_u32(b)), shift), vmull_high_u32(a, b), shift)

static inline int any(uint32x4_t mask)
{
    return vget_lane_u64(vreinterpret_u64_u16(vmovn_u32(mask)), 0) != 0;
}

static inline uint32x4_t u32(int32x4_t x)
{
    return vreinterpretq_u32_s32(x);
}

static inline int32x4_t s32(uint32x4_t x)
{
    return vreinterpretq_s32_u32(x);
}

static inline uint32x4_t mulhi(uint32x4_t a, uint32x4_t b)
{
    uint64x2_t low = vmull_u32(vget_low_u32(a), vget_low_u32(b)), high = vmull_high_u32(a, b);
    return vuzp2q_u32(vreinterpretq_u32_u64(low), vreinterpretq_u32_u64(high));
}

static inline int32x4_t mul_q15(int32x4_t a, int32x4_t b)
{
    return vrshrq_n_s32(vmulq_s32(a, b), 15);
}

static inline int32x4_t mul_n_q15(int32x4_t a, int32_t b)
{
    return vrshrq_n_s32(vmulq_n_s32(a, b), 15);
}

/* fxs_round_shift(a * b, shift), low 32 bits. */
static inline int32x4_t mul_round_shift(int32x4_t a, int32x4_t b, int32x4_t shift)
{
    int32x4_t left = vnegq_s32(shift);
    int64x2_t low = vmull_s32(vget_low_s32(a), vget_low_s32(b)), high = vmull_high_s32(a, b);
    return vcombine_s32(vmovn_s64(vrshlq_s64(low, vmovl_s32(vget_low_s32(left)))),
                        vmovn_s64(vrshlq_s64(high, vmovl_high_s32(left))));
}

static inline int32x4_t clz64(uint64x2x2_t x)
{
    uint32x4_t a = vreinterpretq_u32_u64(x.val[0]), b = vreinterpretq_u32_u64(x.val[1]);
    uint32x4_t upper = vuzp2q_u32(a, b), lower = vuzp1q_u32(a, b);
    return vreinterpretq_s32_u32(vaddq_u32(vclzq_u32(upper), vandq_u32(vclzq_u32(lower), vceqzq_u32(upper))));
}

/* x << zeros >> 32 */
static inline uint32x4_t top32(uint64x2x2_t x, int32x4_t zeros)
{
    uint64x2_t low = vshlq_u64(x.val[0], vmovl_s32(vget_low_s32(zeros)));
    uint64x2_t high = vshlq_u64(x.val[1], vmovl_high_s32(zeros));
    return vuzp2q_u32(vreinterpretq_u32_u64(low), vreinterpretq_u32_u64(high));
}

/* clz & ~1 */
static inline int32x4_t even_zeros(uint32x4_t x)
{
    return vreinterpretq_s32_u32(vbicq_u32(vclzq_u32(x), vdupq_n_u32(1)));
}

/* fxs_reciprocal, at most 2^31 - 1. */
static inline uint32x4_t reciprocal(uint32x4_t m)
{
    uint32x4_t y_q30 = vsubq_u32(vdupq_n_u32(3031741620u), mulhi(m, vdupq_n_u32(2021161081u)));
    for (int i = 0; i < 3; i++) {
        uint32x4_t rest = vsubq_u32(vdupq_n_u32(0x80000000u), mulhi(m, y_q30));
        y_q30 = MUL_SHIFT(y_q30, rest, 30);
    }
    return y_q30;
}

/* fxs_rsqrt, at most 2^31 - 7. */
static inline uint32x4_t rsqrt(uint32x4_t m)
{
    uint32x4_t y_q30 = vsubq_u32(vdupq_n_u32(2369829601u), mulhi(m, vdupq_n_u32(1431655765u)));
    for (int i = 0; i < 3; i++) {
        uint32x4_t square_q29 = MUL_SHIFT(y_q30, y_q30, 31);
        uint32x4_t rest = vsubq_u32(vdupq_n_u32(0x60000000u), mulhi(m, square_q29));
        y_q30 = MUL_SHIFT(y_q30, rest, 30);
    }
    return y_q30;
}

/* fxs_sqrt; 0 for 0 */
static inline uint32x4_t sqrt_32(uint32x4_t x)
{
    int32x4_t zeros = even_zeros(x);
    uint32x4_t m = vshlq_u32(x, zeros);
    return vshlq_u32(mulhi(m, rsqrt(m)), vsubq_s32(vdupq_n_s32(-14), vshrq_n_s32(zeros, 1)));
}

#endif
