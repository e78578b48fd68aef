/* src/fixed.h, LANES numbers at a time. Include lanes_avx2.h or lanes_avx512.h first. */
#ifndef FXS_LANES_H
#define FXS_LANES_H

static const int32_t lane_numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

static inline wide add_wide(wide a, wide b)
{
    return (wide){a.even + b.even, a.odd + b.odd};
}

static inline wide offset_wide(wide a, int64_t b)
{
    return (wide){a.even + (uint64_t)b, a.odd + (uint64_t)b};
}

/* Bits shift to shift + 31 of each number; shift in 0..32. */
static inline vu narrow(wide x, const int shift)
{
    if (shift == 0)
        return interleave(x.even, x.odd << 32);
    if (shift == 32)
        return interleave(x.even >> 32, x.odd);
    return interleave(x.even >> shift, x.odd << (32 - shift));
}

/* x * 2^-shift, rounded down, where that fits 32 bits; shift in 0..63 by lane. */
static inline vi narrow_by(wide x, vi shift)
{
    vw odd = (vw)shift >> 32, even = ((vw)shift << 32) >> 32;
    return (vi)narrow((wide){shift_right_64(x.even, even), shift_right_64(x.odd, odd)}, 0);
}

/* x * 2^-shift, rounded to nearest; 0 where nothing is left. shift above 0. */
static inline vu scale_down(vu x, vi shift)
{
    return (shift_right(x, shift - 1) + 1) >> 1;
}

static inline vi scale_down_wide(wide x, vi shift)
{
    return (narrow_by(x, shift - 1) + 1) >> 1;
}

static inline vu mulhi(vu a, vu b)
{
    return narrow(mul_wide_u(a, b), 32);
}

static inline vi mul_q15(vi a, vi b)
{
    return (a * b + 16384) >> 15;
}

static inline vi clamp(vi x, vi low, vi high)
{
    return least(most(x, low), high);
}

/* Above, the high and the low half of a 64-bit number. */
static inline vi clz_64(vu high, vu low)
{
    mask empty = equal((vi)high, all(0));
    return clz((vu)choose(empty, (vi)low, (vi)high)) + choose(empty, all(32), all(0));
}

/* (x << shift) >> 32 for x = high, low; shift in 0..63. */
static inline vu mantissa_64(vu high, vu low, vi shift)
{
    return shift_left(high, shift) | shift_right(low, 32 - shift) | shift_left(low, shift - 32);
}

/* Newton's steps as in src/fixed.h, on the low halves of 64-bit numbers: the results need no narrowing in between. */
static inline vw reciprocal_step(vw m, vw y_q30)
{
    return mul_low(y_q30, 0x80000000u - (mul_low(m, y_q30) >> 32)) >> 30;
}

static inline vw rsqrt_step(vw m, vw y_q30)
{
    return mul_low(y_q30, 0x60000000u - (mul_low(m, mul_low(y_q30, y_q30) >> 31) >> 32)) >> 30;
}

static inline vw reciprocal_low(vw m)
{
    vw y_q30 = 3031741620u - (mul_low(m, (vw)all(2021161081)) >> 32);
    return reciprocal_step(m, reciprocal_step(m, reciprocal_step(m, y_q30)));
}

static inline vw rsqrt_low(vw m)
{
    vw y_q30 = 2369829601u - (mul_low(m, (vw)all(1431655765)) >> 32);
    return rsqrt_step(m, rsqrt_step(m, rsqrt_step(m, y_q30)));
}

/* Below 2^31. */
static inline vu reciprocal(vu m)
{
    return interleave(reciprocal_low((vw)m), reciprocal_low((vw)m >> 32) << 32);
}

/* Below 2^31. */
static inline vu rsqrt(vu m)
{
    return interleave(rsqrt_low((vw)m), rsqrt_low((vw)m >> 32) << 32);
}

static inline vu root(vu x)
{
    vi shift = clz(x) & ~1;
    vu m = shift_left(x, shift);
    return shift_right(mulhi(m, rsqrt(m)), 14 + (shift >> 1));
}

static inline vi exp2_q15(vi f_q15)
{
    vi p = (256 * f_q15 + 16384) >> 15;
    p = mul_q15(p - 1820, f_q15);
    p = mul_q15(p + 7904, f_q15);
    p = mul_q15(p - 22724, f_q15);
    return 32768 + p;
}

static inline vi log2_q16(vu high, vu low)
{
    vi n = clz_64(high, low), t_q15 = (vi)(mantissa_64(high, low, n) >> 16) & 32767;
    vi q = mul_q15(all(-2776), t_q15);
    q = mul_q15(q + 6897, t_q15);
    q = mul_q15(q - 9697, t_q15);
    q = mul_q15(q + 14605, 32768 - t_q15);
    return (63 - n) * 65536 + 2 * (((32768 + q) * (t_q15 >> 1) + 8192) >> 14);
}

/* Columns first to first + 3 of 8 rows, as 4 structures of 8 words. */
static inline void transpose(__m256i out[4], int32_t rows[8][LANES], int first)
{
    __m256i in[4];
    for (int i = 0; i < 4; i++)
        in[i] = _mm256_loadu2_m128i((const __m128i *)(const void *)&rows[i + 4][first],
                                    (const __m128i *)(const void *)&rows[i][first]);
    __m256i a = _mm256_unpacklo_epi32(in[0], in[1]), b = _mm256_unpacklo_epi32(in[2], in[3]);
    __m256i c = _mm256_unpackhi_epi32(in[0], in[1]), d = _mm256_unpackhi_epi32(in[2], in[3]);
    out[0] = _mm256_unpacklo_epi64(a, b);
    out[1] = _mm256_unpackhi_epi64(a, b);
    out[2] = _mm256_unpacklo_epi64(c, d);
    out[3] = _mm256_unpackhi_epi64(c, d);
}

#endif
