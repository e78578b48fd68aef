/* Vector operations of 4 lanes with WebAssembly's simd128. Its shifts use one count for all lanes, so shifts per
   lane multiply by 2^shift. vectors.h describes the operations. */
#ifndef FXS_LANES_SIMD128_H
#define FXS_LANES_SIMD128_H

#include <wasm_simd128.h>

#define ISA simd128
#define LANES 4
#include "src/core/memory.h"
#include <fixsplat/internal/stage.h>
#include "kernels/simd/lanes/vectors.h"

typedef vi mask;

static inline vi all(int32_t x)
{
    return (vi)wasm_i32x4_splat(x);
}

static inline vi load_u16(const uint16_t *from)
{
    return (vi)wasm_u32x4_load16x4(from);
}

static inline vi load_i16(const int16_t *from)
{
    return (vi)wasm_i32x4_load16x4(from);
}

static inline void store_u16(uint16_t *to, vi x)
{
    wasm_v128_store64_lane(to, wasm_u16x8_narrow_i32x4((v128_t)x, (v128_t)x), 0);
}

static inline vi load_i8(const int8_t *from)
{
    return (vi)wasm_i32x4_extend_low_i16x8(wasm_i16x8_extend_low_i8x16(wasm_v128_load32_zero(from)));
}

static inline void transpose_4(vi out[4], const vi rows[4])
{
    const v128_t ab_low = wasm_i32x4_shuffle((v128_t)rows[0], (v128_t)rows[1], 0, 4, 1, 5);
    const v128_t ab_high = wasm_i32x4_shuffle((v128_t)rows[0], (v128_t)rows[1], 2, 6, 3, 7);
    const v128_t cd_low = wasm_i32x4_shuffle((v128_t)rows[2], (v128_t)rows[3], 0, 4, 1, 5);
    const v128_t cd_high = wasm_i32x4_shuffle((v128_t)rows[2], (v128_t)rows[3], 2, 6, 3, 7);
    out[0] = (vi)wasm_i64x2_shuffle(ab_low, cd_low, 0, 2);
    out[1] = (vi)wasm_i64x2_shuffle(ab_low, cd_low, 1, 3);
    out[2] = (vi)wasm_i64x2_shuffle(ab_high, cd_high, 0, 2);
    out[3] = (vi)wasm_i64x2_shuffle(ab_high, cd_high, 1, 3);
}

static inline void load_fours(vi words[4], const int32_t *from, int stride, const int32_t at[LANES])
{
    const vi rows[4] = {load(from + stride * at[0]), load(from + stride * at[1]), load(from + stride * at[2]),
                        load(from + stride * at[3])};
    transpose_4(words, rows);
}

static inline void store_pairs(void *to, vi a, vi b)
{
    store(to, (vi)wasm_i32x4_shuffle((v128_t)a, (v128_t)b, 0, 4, 1, 5));
    store((int32_t *)to + 4, (vi)wasm_i32x4_shuffle((v128_t)a, (v128_t)b, 2, 6, 3, 7));
}

static inline void load_pairs(const void *from, vi *a, vi *b)
{
    const v128_t low = (v128_t)load(from), high = (v128_t)load((const int32_t *)from + 4);
    *a = (vi)wasm_i32x4_shuffle(low, high, 0, 2, 4, 6);
    *b = (vi)wasm_i32x4_shuffle(low, high, 1, 3, 5, 7);
}

static inline int any(mask which)
{
    return wasm_v128_any_true((v128_t)which);
}

static inline unsigned bits(mask which)
{
    return wasm_i32x4_bitmask((v128_t)which);
}

static inline void store_compressed(void *to, vi x, mask which)
{
    store(to, (vi)wasm_i8x16_swizzle((v128_t)x, (v128_t)load(compress_order[bits(which)])));
}

static inline mask equal(vi a, vi b)
{
    return (mask)wasm_i32x4_eq((v128_t)a, (v128_t)b);
}

static inline mask greater(vi a, vi b)
{
    return (mask)wasm_i32x4_gt((v128_t)a, (v128_t)b);
}

static inline vi choose(mask which, vi a, vi b)
{
    return (vi)wasm_v128_bitselect((v128_t)a, (v128_t)b, (v128_t)which);
}

static inline vi least(vi a, vi b)
{
    return (vi)wasm_i32x4_min((v128_t)a, (v128_t)b);
}

static inline vi most(vi a, vi b)
{
    return (vi)wasm_i32x4_max((v128_t)a, (v128_t)b);
}

/* Counts leading zeros with the exponent of x as a float. Clearing the 8th bit below the highest bit stops rounding
   from carrying into the exponent. From 2^31 on, the float is negative. */
static inline vi clz(vu x)
{
    const vu exponent = (vu)wasm_f32x4_convert_i32x4((v128_t)(x & ~(x >> 8))) >> 23;
    return least(most((vi)(158 - exponent), all(0)), all(32));
}

/* Returns 2^shift per lane, or 0 for a shift of 32 to 127 or -128 to -1. A table gives each byte of the power. */
static inline vu power(vi shift)
{
    const v128_t bits = wasm_i8x16_const(1, 2, 4, 8, 16, 32, 64, -128, 0, 0, 0, 0, 0, 0, 0, 0);
    const v128_t first = wasm_i8x16_const(0, 8, 16, 24, 0, 8, 16, 24, 0, 8, 16, 24, 0, 8, 16, 24);
    const v128_t in_bytes = wasm_i8x16_shuffle((v128_t)shift, (v128_t)shift, 0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12,
                                               12, 12);
    return (vu)wasm_i8x16_swizzle(bits, wasm_i8x16_sub(in_bytes, first));
}

typedef struct wide {
    vw low, high;                  /* low: 64-bit numbers of lanes 0 and 1; high: of lanes 2 and 3 */
} wide;

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vw)wasm_i64x2_extmul_low_i32x4((v128_t)a, (v128_t)b),
                  (vw)wasm_i64x2_extmul_high_i32x4((v128_t)a, (v128_t)b)};
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){(vw)wasm_u64x2_extmul_low_u32x4((v128_t)a, (v128_t)b),
                  (vw)wasm_u64x2_extmul_high_u32x4((v128_t)a, (v128_t)b)};
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
    return (wide){a.low | (vw)wasm_i64x2_abs((v128_t)b.low), a.high | (vw)wasm_i64x2_abs((v128_t)b.high)};
}

static inline vu low_half(wide x)
{
    return (vu)wasm_i32x4_shuffle((v128_t)x.low, (v128_t)x.high, 0, 2, 4, 6);
}

static inline vu high_half(wide x)
{
    return (vu)wasm_i32x4_shuffle((v128_t)x.low, (v128_t)x.high, 1, 3, 5, 7);
}

static inline vu narrow(wide x, const int shift)
{
    return low_half((wide){x.low >> shift, x.high >> shift});
}

static inline vu shift_left(vu x, vi shift)
{
    return x * power(shift);
}

static inline vu shift_right(vu x, vi shift)
{
    return high_half(mul_wide_u(x, power(32 - shift))) | (x & (vu)equal(shift, all(0)));
}

static inline vu scale_down(vu x, vi shift)
{
    return high_half(offset_wide(mul_wide_u(x, power(32 - shift)), INT64_C(1) << 31));
}

static inline vi narrow_by(wide x, vi shift)
{
    const vu sign = (vu)((vi)high_half(x) >> 31), low = low_half(x) ^ sign, high = high_half(x) ^ sign;
    const vu up = power(32 - shift);
    const vu y = high_half(mul_wide_u(low, up)) | high * up | high_half(mul_wide_u(high, power(64 - shift)));
    return (vi)((y | (low & (vu)equal(shift, all(0)))) ^ sign);
}

static inline vi scale_down_wide(wide x, vi shift)
{
    return (narrow_by(x, shift - 1) + 1) >> 1;
}

static inline vi clz_wide(wide x)
{
    const vu high = high_half(x);
    const mask empty = equal((vi)high, all(0));
    return clz((vu)choose(empty, (vi)low_half(x), (vi)high)) + (empty & 32);
}

static inline vu top_half(wide x, vi shift)
{
    const vu low = low_half(x), up = power(shift);
    return high_half(x) * up | high_half(mul_wide_u(low, up)) | low * power(shift - 32);
}

static inline vi round_shift(vi x, const int shift)
{
    const int32_t half = 1 << (shift - 1);
    return (x + half) >> shift;
}

static inline vu mul_high(vu a, vu b)
{
    return high_half(mul_wide_u(a, b));
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
    wasm_v128_store64_lane((int32_t *)to + 4, (v128_t)x.high, 0);
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
    return (octet){(vi)wasm_i16x8_load8x8(from), (vi)wasm_i16x8_load8x8(from + 8)};
}

static inline octet add_16(octet x, const int8_t *from, int negative)
{
    const vh sign = (vh)wasm_i16x8_splat((int16_t)(negative ? -1 : 1));
    const octet entry = load_16(from);
    return (octet){(vi)((vh)x.low + (vh)entry.low * sign), (vi)((vh)x.high + (vh)entry.high * sign)};
}

static inline void dot_16(int32_t sum[3], const octet x[3], octet y)
{
    for (int i = 0; i < 3; i++) {
        const vi four = (vi)wasm_i32x4_dot_i16x8((v128_t)x[i].low, (v128_t)y.low) +
                        (vi)wasm_i32x4_dot_i16x8((v128_t)x[i].high, (v128_t)y.high);
        sum[i] = four[0] + four[1] + four[2] + four[3];
    }
}

static inline octet odd_numbers(uint64_t codes)
{
#define WINDOW(k) 3 * (k) / 8, 3 * (k) / 8 + 1
#define UP(k) (int16_t)(1 << (13 - 3 * (k) % 8))
    const v128_t word = wasm_i64x2_splat((int64_t)codes);
    const v128_t low = wasm_i8x16_const(WINDOW(0), WINDOW(1), WINDOW(2), WINDOW(3), WINDOW(4), WINDOW(5), WINDOW(6),
                                        WINDOW(7));
    const v128_t high = wasm_i8x16_const(WINDOW(8), WINDOW(9), WINDOW(10), WINDOW(11), WINDOW(12), WINDOW(13),
                                         WINDOW(14), -1, -1);
    const vh low_up = {UP(0), UP(1), UP(2), UP(3), UP(4), UP(5), UP(6), UP(7)};
    const vh high_up = {UP(8), UP(9), UP(10), UP(11), UP(12), UP(13), UP(14), 0};
#undef WINDOW
#undef UP
    const vh a = (vh)wasm_i8x16_swizzle(word, low) * low_up >> 13;
    const vh b = (vh)wasm_i8x16_swizzle(word, high) * high_up >> 13;
    return (octet){(vi)(2 * a + 1), (vi)(2 * b + 1)};
}

#define PARTS 1
typedef vi factor;                 /* 16-bit numbers in 32-bit words, with an upper half of 0 */

static inline factor factor_of(vi first, vi last)
{
    (void)last;
    return first & 65535;
}

static inline void add_products(vi sum[PARTS], const int8_t *codes, factor x)
{
    sum[0] += (vi)wasm_i32x4_dot_i16x8((v128_t)load_i8(codes), (v128_t)x);
}

typedef vh mask_h;

static inline vh all_h(int x)
{
    return (vh)wasm_i16x8_splat((int16_t)x);
}

/* Returns rounded Q15 products. -32768 squared gives 32767, or -32768 with the relaxed instruction. */
static inline vh mul_h(vh a, vh b)
{
    return (vh)wasm_i16x8_q15mulr_sat((v128_t)a, (v128_t)b);
}

/* Adds levels, -2 ln(alpha) of a splat. Sums saturate at 65535, in the C version at 32767; both are above every limit
   of levels. */
static inline vh add_level(vh a, vh b)
{
    return (vh)wasm_u16x8_add_sat((v128_t)a, (v128_t)b);
}

static inline vh mul_add_h(vh a, vh b, vh c)
{
    return mul_h(a, b) + c;
}

static inline vh mul_add_cut_h(vh a, vh b, vh c)
{
    return (vh)wasm_i16x8_add_sat((v128_t)mul_h(a, b), (v128_t)c);
}

static inline vh least_h(vh a, vh b)
{
    return (vh)wasm_i16x8_min((v128_t)a, (v128_t)b);
}

static inline vh most_h(vh a, vh b)
{
    return (vh)wasm_i16x8_max((v128_t)a, (v128_t)b);
}

static inline vh pack_q13(vu a_q24, vu b_q24)
{
    return (vh)wasm_i16x8_narrow_i32x4((v128_t)((vi)a_q24 >> 11), (v128_t)((vi)b_q24 >> 11));
}

static inline mask_h greater_h(vh a, vh b)
{
    return (mask_h)wasm_i16x8_gt((v128_t)a, (v128_t)b);
}

static inline mask_h open_of(vh transmittance_q15)
{
    return greater_h(transmittance_q15, all_h(FXS_CLOSED_Q15 - 1));
}

static inline mask_h within(vh level, vh limit)
{
    return (mask_h)wasm_u16x8_le((v128_t)level, (v128_t)limit);
}

static inline vh where(mask_h which, vh x)
{
    return which & x;
}

static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)choose((mask)which, (vi)a, (vi)b);
}

static inline int any_h(mask_h which)
{
    return any((mask)which);
}

static inline uint32_t bits_h(mask_h which)
{
    return wasm_i16x8_bitmask((v128_t)which);
}

static inline void store_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const v128_t rg = wasm_u8x16_narrow_i16x8((v128_t)r, (v128_t)g), ba = wasm_u8x16_narrow_i16x8((v128_t)b, (v128_t)a);
    store(to, (vi)wasm_i8x16_shuffle(rg, ba, 0, 8, 16, 24, 1, 9, 17, 25, 2, 10, 18, 26, 3, 11, 19, 27));
    store(to + 16, (vi)wasm_i8x16_shuffle(rg, ba, 4, 12, 20, 28, 5, 13, 21, 29, 6, 14, 22, 30, 7, 15, 23, 31));
}

static inline void store_wide_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const v128_t rg_low = wasm_i16x8_shuffle((v128_t)r, (v128_t)g, 0, 8, 1, 9, 2, 10, 3, 11);
    const v128_t rg_high = wasm_i16x8_shuffle((v128_t)r, (v128_t)g, 4, 12, 5, 13, 6, 14, 7, 15);
    const v128_t ba_low = wasm_i16x8_shuffle((v128_t)b, (v128_t)a, 0, 8, 1, 9, 2, 10, 3, 11);
    const v128_t ba_high = wasm_i16x8_shuffle((v128_t)b, (v128_t)a, 4, 12, 5, 13, 6, 14, 7, 15);
    store_pairs(to, (vi)rg_low, (vi)ba_low);
    store_pairs(to + 32, (vi)rg_high, (vi)ba_high);
}

#endif
