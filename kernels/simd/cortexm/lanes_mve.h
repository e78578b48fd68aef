/* Vector operations of 4 lanes with Helium (MVE) on Cortex-M. vectors.h describes the operations. */
#ifndef FXS_LANES_MVE_H
#define FXS_LANES_MVE_H

#include <arm_mve.h>

#define ISA mve
#define LANES 4
#define AT_ONCE 8
#include "src/core/memory.h"
#include <fixsplat/internal/stage.h>
#include "kernels/simd/lanes/vectors.h"

typedef unsigned mask;             /* mask of lanes with 4 bits per lane; bits 16 and up are ignored */

static inline mve_pred16_t pred(mask which)
{
    return (mve_pred16_t)which;
}

static inline vi all(int32_t x)
{
    return (vi)vdupq_n_s32(x);
}

static inline vi load_u16(const uint16_t *from)
{
    return (vi)vldrhq_u32(from);
}

static inline vi load_i16(const int16_t *from)
{
    return (vi)vldrhq_s32(from);
}

static inline void store_u16(uint16_t *to, vi x)
{
    vstrhq_u32(to, (uint32x4_t)x);
}

static inline vi load_i8(const int8_t *from)
{
    return (vi)vldrbq_s32(from);
}

static inline void load_fours(vi words[4], const int32_t *from, int stride, const int32_t at[LANES])
{
    const uint32x4_t offset = (uint32x4_t)(load(at) * stride);
    for (int i = 0; i < 4; i++)
        words[i] = (vi)vldrwq_gather_shifted_offset_s32(from + i, offset);
}

static inline void store_pairs(void *to, vi a, vi b)
{
    const int32x4x2_t pairs = {{(int32x4_t)a, (int32x4_t)b}};
    vst2q_s32(to, pairs);
}

static inline void load_pairs(const void *from, vi *a, vi *b)
{
    const int32x4x2_t pairs = vld2q_s32(from);
    *a = (vi)pairs.val[0];
    *b = (vi)pairs.val[1];
}

static inline int any(mask which)
{
    return pred(which) != 0;
}

/* Converts a mask of lanes to one bit per lane: bits 0, 4, 8 and 12 of the mask. */
static inline unsigned bits(mask which)
{
    return (which & 0x1111) * 0x1248 >> 12 & 15;
}

static inline void store_compressed(void *to, vi x, mask which)
{
    static const uint8_t places[16][4] = {{0}, {0}, {0, 0}, {0, 1}, {0, 0, 0}, {0, 1, 1}, {0, 0, 1}, {0, 1, 2}, {0},
                                          {0, 1, 1, 1}, {0, 0, 1, 1}, {0, 1, 2, 2}, {0, 0, 0, 1}, {0, 1, 1, 2},
                                          {0, 0, 1, 2}, {0, 1, 2, 3}};
    vstrwq_scatter_shifted_offset_p_s32(to, vldrbq_u32(places[bits(which)]), (int32x4_t)x, pred(which));
}

static inline mask equal(vi a, vi b)
{
    return vcmpeqq_s32((int32x4_t)a, (int32x4_t)b);
}

static inline mask greater(vi a, vi b)
{
    return vcmpgtq_s32((int32x4_t)a, (int32x4_t)b);
}

static inline vi choose(mask which, vi a, vi b)
{
    return (vi)vpselq_s32((int32x4_t)a, (int32x4_t)b, pred(which));
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

/* Vectors of 64-bit numbers. Two vectors hold the low and high words, because Helium has no lanes of 64 bits. */

typedef struct wide {
    vu low, high;
} wide;

static inline vu mul_high(vu a, vu b)
{
    return (vu)vmulhq_u32((uint32x4_t)a, (uint32x4_t)b);
}

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vu)a * (vu)b, (vu)vmulhq_s32((int32x4_t)a, (int32x4_t)b)};
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){a * b, mul_high(a, b)};
}

/* Adds the carry of a 64-bit addition: returns `high`, plus 1 if the sum of the low words wrapped below one of its
   terms. */
static inline vu carry(vu high, vu sum, vu term)
{
    return (vu)vaddq_m_n_u32((uint32x4_t)high, (uint32x4_t)high, 1, vcmphiq_u32((uint32x4_t)term, (uint32x4_t)sum));
}

static inline wide add_wide(wide a, wide b)
{
    const vu low = a.low + b.low;
    return (wide){low, carry(a.high + b.high, low, a.low)};
}

static inline wide offset_wide(wide a, int64_t b)
{
    return add_wide(a, (wide){(vu)all((int32_t)b), (vu)all((int32_t)(b >> 32))});
}

static inline wide shift_left_wide(wide x, int shift)
{
    return (wide){x.low << shift, x.high << shift | shift_left(x.low, all(shift - 32))};
}

static inline wide or_magnitude(wide a, wide b)
{
    const vu sign = (vu)((vi)b.high >> 31), low = b.low ^ sign, high = b.high ^ sign;
    const vu magnitude = low - sign;
    return (wide){a.low | magnitude, a.high | carry(high, magnitude, low)};
}

#define narrow(x, shift) ((vu)vsliq_n_u32((uint32x4_t)((x).low >> (shift)), (uint32x4_t)(x).high, 32 - (shift)))

static inline vu low_half(wide x)
{
    return x.low;
}

static inline vu high_half(wide x)
{
    return x.high;
}

static inline vi narrow_by(wide x, vi shift)
{
    return (vi)shift_right(x.low, shift) | (vi)vshlq_s32((int32x4_t)x.high, (int32x4_t)(32 - shift));
}

static inline vi scale_down_wide(wide x, vi shift)
{
    return round_shift(narrow_by(x, shift - 1), 1);
}

static inline vi clz_wide(wide x)
{
    const vi high = clz(x.high);
    return choose(equal(high, all(32)), clz(x.low) + 32, high);
}

static inline vu top_half(wide x, vi shift)
{
    return shift_left(x.high, shift) | shift_left(x.low, shift - 32);
}

/* Returns 2^62 / m by Newton's method, as in src/include/fixsplat/internal/fixed.h. A product a b >> 30 is the high
   half of 2 a times 2 b, since both are below 2^31. */
static inline vu reciprocal(vu m)
{
    vu y_q30 = 3031741620u - mul_high(m, (vu)all(2021161081));
    for (int i = 0; i < 3; i++)
        y_q30 = mul_high(2 * y_q30, 2 * (0x80000000u - mul_high(m, y_q30)));
    return y_q30;
}

static inline vu rsqrt(vu m)
{
    vu y_q30 = 2369829601u - mul_high(m, (vu)all(1431655765));
    for (int i = 0; i < 3; i++) {
        const vu twice = 2 * y_q30, square_q29 = mul_high(twice, y_q30);
        y_q30 = mul_high(twice, 2 * (0x60000000u - mul_high(m, square_q29)));
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
    vstrwq_p_s32((int32_t *)to + 4, (int32x4_t)x.high, vctp32q(2));
}

static inline void transpose_4(vi out[4], const vi rows[4])
{
    int32_t words[4][LANES];
    const int32x4x4_t fours = {{(int32x4_t)rows[0], (int32x4_t)rows[1], (int32x4_t)rows[2], (int32x4_t)rows[3]}};
    vst4q_s32(words[0], fours);
    for (int i = 0; i < 4; i++)
        out[i] = load(words[i]);
}

static inline void transpose(octet out[4], const vi rows[8], int first)
{
    vi low[4], high[4];
    (void)first;
    transpose_4(low, rows);
    transpose_4(high, rows + 4);
    for (int i = 0; i < 4; i++)
        out[i] = (octet){low[i], high[i]};
}

static inline octet load_16(const int8_t *from)
{
    return (octet){(vi)vldrbq_s16(from), (vi)vldrbq_s16(from + 8)};
}

static inline octet add_16(octet x, const int8_t *from, int negative)
{
    const octet entry = load_16(from);
    const int16_t sign = negative ? -1 : 1;
    return (octet){(vi)vmlaq_n_s16((int16x8_t)x.low, (int16x8_t)entry.low, sign),
                   (vi)vmlaq_n_s16((int16x8_t)x.high, (int16x8_t)entry.high, sign)};
}

static inline void dot_16(int32_t sum[3], const octet x[3], octet y)
{
    for (int i = 0; i < 3; i++)
        sum[i] = vmladavaq_s16(vmladavq_s16((int16x8_t)x[i].low, (int16x8_t)y.low), (int16x8_t)x[i].high,
                               (int16x8_t)y.high);
}

static inline octet odd_numbers(uint64_t codes)
{
    static const int16_t low_up[8] = {13, 10, 7, 4, 1, 13, 10, 7}, high_up[8] = {4, 1, 13, 10, 7, 4, 1, 0};
    const uint16_t fives[3] = {(uint16_t)codes, (uint16_t)(codes >> 15), (uint16_t)(codes >> 30)};
    const uint16x8_t first = vdupq_m_n_u16(vdupq_n_u16(fives[1]), fives[0], vctp16q(5));
    const uint16x8_t last = vdupq_m_n_u16(vdupq_n_u16(fives[2]), fives[1], vctp16q(2));
    const vh a = (vh)vshlq_u16(first, (int16x8_t)load_h(low_up)) >> 13;
    const vh b = (vh)vshlq_u16(last, (int16x8_t)load_h(high_up)) >> 13;
    return (octet){(vi)(2 * a + 1), (vi)(2 * b + 1)};
}

#define PARTS 1
typedef vi factor;

static inline factor factor_of(vi first, vi last)
{
    (void)last;
    return first;
}

static inline void add_products(vi sum[PARTS], const int8_t *codes, factor x)
{
    sum[0] += load_i8(codes) * x;
}

static inline vh all_h(int x)
{
    return (vh)vdupq_n_s16((int16_t)x);
}

/* Returns rounded Q15 products; -32768 squared gives 32767, above every limit that the blending code tests. */
static inline vh mul_h(vh a, vh b)
{
    return (vh)vqrdmulhq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh mul_add_cut_h(vh a, vh b, vh c)
{
    return (vh)vqaddq_s16((int16x8_t)c, (int16x8_t)mul_h(a, b));
}

static inline vh least_h(vh a, vh b)
{
    return (vh)vminq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh most_h(vh a, vh b)
{
    return (vh)vmaxq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline void store_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const uint8x16_t rg = vqmovuntq_s16(vqmovunbq_s16(vdupq_n_u8(0), (int16x8_t)r), (int16x8_t)g);
    const uint8x16_t ba = vqmovuntq_s16(vqmovunbq_s16(vdupq_n_u8(0), (int16x8_t)b), (int16x8_t)a);
    const uint16x8x2_t rgba = {{(uint16x8_t)rg, (uint16x8_t)ba}};
    uint16_t pixels[16];
    vst2q_u16(pixels, rgba);       /* a copy, because vst2q_u16 needs halfword alignment, which `to` may lack */
    store(to, load(pixels));
    store(to + 16, load(pixels + 8));
}

static inline void store_wide_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const uint16x8x4_t rgba = {{(uint16x8_t)r, (uint16x8_t)g, (uint16x8_t)b, (uint16x8_t)a}};
    vst4q_u16((uint16_t *)(void *)to, rgba);
}

#endif
