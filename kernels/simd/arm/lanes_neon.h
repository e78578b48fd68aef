/* Vector operations of 4 lanes with NEON on AArch64. vectors.h describes the operations. */
#ifndef FXS_LANES_NEON_H
#define FXS_LANES_NEON_H

#include <arm_neon.h>

#define ISA neon
#define LANES 4
#include "src/core/memory.h"
#include <fixsplat/internal/stage.h>
#include "kernels/simd/lanes/vectors.h"

typedef vi mask;

static inline vi all(int32_t x)
{
    return (vi)vdupq_n_s32(x);
}

static inline vi load_u16(const uint16_t *from)
{
    return (vi)vmovl_u16(vld1_u16(from));
}

static inline vi load_i16(const int16_t *from)
{
    return (vi)vmovl_s16(vld1_s16(from));
}

static inline void store_u16(uint16_t *to, vi x)
{
    vst1_u16(to, vmovn_u32((uint32x4_t)x));
}

static inline vi load_i8(const int8_t *from)
{
    uint32_t four;
    memcpy(&four, from, sizeof four);
    return (vi)vmovl_s16(vget_low_s16(vmovl_s8(vcreate_s8(four))));
}

static inline void transpose_4(vi *a, vi *b, vi *c, vi *d)
{
    const int64x2_t ab_low = (int64x2_t)vzip1q_s32((int32x4_t)*a, (int32x4_t)*b);
    const int64x2_t ab_high = (int64x2_t)vzip2q_s32((int32x4_t)*a, (int32x4_t)*b);
    const int64x2_t cd_low = (int64x2_t)vzip1q_s32((int32x4_t)*c, (int32x4_t)*d);
    const int64x2_t cd_high = (int64x2_t)vzip2q_s32((int32x4_t)*c, (int32x4_t)*d);
    *a = (vi)vzip1q_s64(ab_low, cd_low);
    *b = (vi)vzip2q_s64(ab_low, cd_low);
    *c = (vi)vzip1q_s64(ab_high, cd_high);
    *d = (vi)vzip2q_s64(ab_high, cd_high);
}

static inline void load_fours(vi words[4], const int32_t *from, int stride, const int32_t at[LANES])
{
    words[0] = load(from + stride * at[0]);
    words[1] = load(from + stride * at[1]);
    words[2] = load(from + stride * at[2]);
    words[3] = load(from + stride * at[3]);
    transpose_4(words, words + 1, words + 2, words + 3);
}

static inline void store_pairs(void *to, vi a, vi b)
{
    const int32x4x2_t pairs = {{(int32x4_t)a, (int32x4_t)b}};
    vst2q_s32(to, pairs);
}

static inline int any(mask which)
{
    return vget_lane_u64(vreinterpret_u64_u16(vmovn_u32((uint32x4_t)which)), 0) != 0;
}

static inline unsigned bits(mask which)
{
    return vaddvq_u32(vandq_u32((uint32x4_t)which, (uint32x4_t){1, 2, 4, 8}));
}

static inline void load_pairs(const void *from, vi *a, vi *b)
{
    const int32x4x2_t pairs = vld2q_s32(from);
    *a = (vi)pairs.val[0];
    *b = (vi)pairs.val[1];
}

static inline void store_compressed(void *to, vi x, mask which)
{
    store(to, (vi)vqtbl1q_u8((uint8x16_t)x, (uint8x16_t)load(compress_order[bits(which)])));
}

static inline mask equal(vi a, vi b)
{
    return (mask)vceqq_s32((int32x4_t)a, (int32x4_t)b);
}

static inline mask greater(vi a, vi b)
{
    return (mask)vcgtq_s32((int32x4_t)a, (int32x4_t)b);
}

static inline vi choose(mask which, vi a, vi b)
{
    return (vi)vbslq_s32((uint32x4_t)which, (int32x4_t)a, (int32x4_t)b);
}

static inline vi least(vi a, vi b)
{
    return (vi)vminq_s32((int32x4_t)a, (int32x4_t)b);
}

static inline vi most(vi a, vi b)
{
    return (vi)vmaxq_s32((int32x4_t)a, (int32x4_t)b);
}

static inline vu shift_left(vu x, vi shift)
{
    return (vu)vshlq_u32((uint32x4_t)x, (int32x4_t)shift);
}

static inline vu shift_right(vu x, vi shift)
{
    return shift_left(x, -shift);
}

static inline vu scale_down(vu x, vi shift)
{
    return (vu)vrshlq_u32((uint32x4_t)x, (int32x4_t)-shift);
}

#define round_shift(x, shift) ((vi)vrshrq_n_s32((int32x4_t)(x), shift))

static inline vi clz(vu x)
{
    return (vi)vclzq_u32((uint32x4_t)x);
}

typedef struct wide {
    vw low, high;                  /* low: 64-bit numbers of lanes 0 and 1; high: of lanes 2 and 3 */
} wide;

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vw)vmull_s32(vget_low_s32((int32x4_t)a), vget_low_s32((int32x4_t)b)),
                  (vw)vmull_high_s32((int32x4_t)a, (int32x4_t)b)};
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){(vw)vmull_u32(vget_low_u32((uint32x4_t)a), vget_low_u32((uint32x4_t)b)),
                  (vw)vmull_high_u32((uint32x4_t)a, (uint32x4_t)b)};
}

static inline wide add_wide(wide a, wide b)
{
    return (wide){a.low + b.low, a.high + b.high};
}

static inline wide offset_wide(wide a, int64_t b)
{
    return (wide){a.low + (uint64_t)b, a.high + (uint64_t)b};
}

static inline wide shift_left_wide(wide x, int shift)
{
    return (wide){x.low << shift, x.high << shift};
}

static inline wide or_magnitude(wide a, wide b)
{
    return (wide){a.low | (vw)vabsq_s64((int64x2_t)b.low), a.high | (vw)vabsq_s64((int64x2_t)b.high)};
}

#define narrow(x, shift) \
    ((vu)vshrn_high_n_u64(vshrn_n_u64((uint64x2_t)(x).low, shift), (uint64x2_t)(x).high, shift))

static inline vu low_half(wide x)
{
    return (vu)vuzp1q_u32((uint32x4_t)x.low, (uint32x4_t)x.high);
}

static inline vu high_half(wide x)
{
    return (vu)vuzp2q_u32((uint32x4_t)x.low, (uint32x4_t)x.high);
}

static inline vi narrow_by(wide x, vi shift)
{
    const int32x4_t left = (int32x4_t)-shift;
    return (vi)low_half((wide){(vw)vshlq_s64((int64x2_t)x.low, vmovl_s32(vget_low_s32(left))),
                               (vw)vshlq_s64((int64x2_t)x.high, vmovl_high_s32(left))});
}

static inline vi scale_down_wide(wide x, vi shift)
{
    const int32x4_t left = (int32x4_t)-shift;
    return (vi)low_half((wide){(vw)vrshlq_s64((int64x2_t)x.low, vmovl_s32(vget_low_s32(left))),
                               (vw)vrshlq_s64((int64x2_t)x.high, vmovl_high_s32(left))});
}

static inline vi clz_wide(wide x)
{
    const vu high = high_half(x);
    return clz(high) + (clz(low_half(x)) & equal((vi)high, all(0)));
}

static inline vu top_half(wide x, vi shift)
{
    return high_half((wide){(vw)vshlq_u64((uint64x2_t)x.low, vmovl_s32(vget_low_s32((int32x4_t)shift))),
                            (vw)vshlq_u64((uint64x2_t)x.high, vmovl_high_s32((int32x4_t)shift))});
}

/* Returns 2^62 / m by Newton's method, as in src/include/fixsplat/internal/fixed.h. The result is below 2^31. */
static inline vu reciprocal(vu m)
{
    vu y_q30 = 3031741620u - high_half(mul_wide_u(m, (vu)all(2021161081)));
    for (int i = 0; i < 3; i++)
        y_q30 = narrow(mul_wide_u(y_q30, 0x80000000u - high_half(mul_wide_u(m, y_q30))), 30);
    return y_q30;
}

static inline vu rsqrt(vu m)
{
    vu y_q30 = 2369829601u - high_half(mul_wide_u(m, (vu)all(1431655765)));
    for (int i = 0; i < 3; i++) {
        const vu square_q29 = narrow(mul_wide_u(y_q30, y_q30), 31);
        y_q30 = narrow(mul_wide_u(y_q30, 0x60000000u - high_half(mul_wide_u(m, square_q29))), 30);
    }
    return y_q30;
}

typedef struct octet {
    vi low, high;
} octet;

static inline void store_8(void *to, octet x)
{
    store(to, x.low);
    store((int32_t *)to + 4, x.high);
}

static inline void store_6(void *to, octet x)
{
    store(to, x.low);
    vst1_s32((int32_t *)to + 4, vget_low_s32((int32x4_t)x.high));
}

static inline void transpose(octet out[4], const vi rows[8], int first)
{
    (void)first;
    out[0] = (octet){rows[0], rows[4]};
    out[1] = (octet){rows[1], rows[5]};
    out[2] = (octet){rows[2], rows[6]};
    out[3] = (octet){rows[3], rows[7]};
    transpose_4(&out[0].low, &out[1].low, &out[2].low, &out[3].low);
    transpose_4(&out[0].high, &out[1].high, &out[2].high, &out[3].high);
}

static inline octet load_16(const int8_t *from)
{
    const int8x16_t x = vld1q_s8(from);
    return (octet){(vi)vmovl_s8(vget_low_s8(x)), (vi)vmovl_high_s8(x)};
}

static inline octet add_16(octet x, const int8_t *from, int negative)
{
    const int8x16_t entry = vld1q_s8(from);
    const int8x8_t sign = vdup_n_s8(negative ? -1 : 1);
    return (octet){(vi)vmlal_s8((int16x8_t)x.low, vget_low_s8(entry), sign),
                   (vi)vmlal_s8((int16x8_t)x.high, vget_high_s8(entry), sign)};
}

static inline int32x4_t products(octet x, octet y)
{
    const int16x8_t a = (int16x8_t)x.low, b = (int16x8_t)x.high, c = (int16x8_t)y.low, d = (int16x8_t)y.high;
    int32x4_t sum = vmull_s16(vget_low_s16(a), vget_low_s16(c));
    sum = vmlal_high_s16(sum, a, c);
    sum = vmlal_s16(sum, vget_low_s16(b), vget_low_s16(d));
    return vmlal_high_s16(sum, b, d);
}

static inline void dot_16(int32_t sum[3], const octet x[3], octet y)
{
    for (int i = 0; i < 3; i++)
        sum[i] = vaddvq_s32(products(x[i], y));
}

static inline octet odd_numbers(uint64_t codes)
{
#define WINDOW(k) 3 * (k) / 8, 3 * (k) / 8 + 1
#define UP(k) 13 - 3 * (k) % 8
    const uint8x16_t word = (uint8x16_t)vdupq_n_u64(codes);
    const uint8x16_t low = {WINDOW(0), WINDOW(1), WINDOW(2), WINDOW(3), WINDOW(4), WINDOW(5), WINDOW(6), WINDOW(7)};
    const uint8x16_t high = {WINDOW(8), WINDOW(9), WINDOW(10), WINDOW(11), WINDOW(12), WINDOW(13), WINDOW(14), 255,
                             255};
    const int16x8_t low_up = {UP(0), UP(1), UP(2), UP(3), UP(4), UP(5), UP(6), UP(7)};
    const int16x8_t high_up = {UP(8), UP(9), UP(10), UP(11), UP(12), UP(13), UP(14), 0};
#undef WINDOW
#undef UP
    const vh a = (vh)vshlq_s16((int16x8_t)vqtbl1q_u8(word, low), low_up) >> 13;
    const vh b = (vh)vshlq_s16((int16x8_t)vqtbl1q_u8(word, high), high_up) >> 13;
    return (octet){(vi)(2 * a + 1), (vi)(2 * b + 1)};
}

#define PARTS 2
typedef int16x8_t factor;

static inline factor factor_of(vi first, vi last)
{
    return vuzp1q_s16((int16x8_t)first, (int16x8_t)last);
}

static inline void add_products(vi sum[PARTS], const int8_t *codes, factor x)
{
    const int16x8_t code = vmovl_s8(vld1_s8(codes));
    sum[0] = (vi)vmlal_s16((int32x4_t)sum[0], vget_low_s16(x), vget_low_s16(code));
    sum[1] = (vi)vmlal_high_s16((int32x4_t)sum[1], x, code);
}

typedef vh mask_h;

static inline vh all_h(int x)
{
    return (vh)vdupq_n_s16((int16_t)x);
}

/* Returns rounded Q15 products; -32768 squared gives 32767. */
static inline vh mul_h(vh a, vh b)
{
    return (vh)vqrdmulhq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh mul_add_cut_h(vh a, vh b, vh c)
{
#ifdef __ARM_FEATURE_QRDMX
    return (vh)vqrdmlahq_s16((int16x8_t)c, (int16x8_t)a, (int16x8_t)b);
#else
    return (vh)vqaddq_s16((int16x8_t)c, (int16x8_t)mul_h(a, b));
#endif
}

static inline vh mul_add_h(vh a, vh b, vh c)
{
    return mul_add_cut_h(a, b, c);
}

static inline vh least_h(vh a, vh b)
{
    return (vh)vminq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh most_h(vh a, vh b)
{
    return (vh)vmaxq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh add_level(vh a, vh b)
{
    return (vh)vqaddq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh pack_q13(vu a_q24, vu b_q24)
{
    return (vh)vqshrn_high_n_s32(vqshrn_n_s32((int32x4_t)a_q24, 11), (int32x4_t)b_q24, 11);
}

static inline mask_h open_of(vh transmittance_q15)
{
    return (mask_h)vcgeq_s16((int16x8_t)transmittance_q15, vdupq_n_s16(FXS_CLOSED_Q15));
}

static inline mask_h within(vh level, vh limit)
{
    return (mask_h)vcleq_s16((int16x8_t)level, (int16x8_t)limit);
}

static inline vh where(mask_h which, vh x)
{
    return which & x;
}

static inline mask_h greater_h(vh a, vh b)
{
    return (mask_h)vcgtq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)vbslq_s16((uint16x8_t)which, (int16x8_t)a, (int16x8_t)b);
}

static inline int any_h(mask_h which)
{
    return vmaxvq_u16((uint16x8_t)which) != 0;
}

static inline uint32_t bits_h(mask_h which)
{
    const uint16x8_t lanes = {1, 2, 4, 8, 16, 32, 64, 128};
    return vaddvq_u16(vandq_u16((uint16x8_t)which, lanes));
}

static inline void store_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const uint8x8x4_t rgba = {{vqmovun_s16((int16x8_t)r), vqmovun_s16((int16x8_t)g), vqmovun_s16((int16x8_t)b),
                               vqmovun_s16((int16x8_t)a)}};
    vst4_u8(to, rgba);
}

static inline void store_wide_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const uint16x8x4_t rgba = {{(uint16x8_t)r, (uint16x8_t)g, (uint16x8_t)b, (uint16x8_t)a}};
    vst4q_u16((uint16_t *)(void *)to, rgba);
}

#endif
