/* What AVX2 and AVX-512 share, around the operations that differ. */
#ifndef FXS_AVX_H
#define FXS_AVX_H

/* 64-bit numbers: those of the even lanes, and those of the odd ones. */
typedef struct wide {
    vw even, odd;
} wide;

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vw)MM(mul_epi32)((V)a, (V)b), (vw)MM(mul_epi32)((V)((vw)a >> 32), (V)((vw)b >> 32))};
}

/* Products of the low halves. */
static inline vw mul_low(vw a, vw b)
{
    return (vw)MM(mul_epu32)((V)a, (V)b);
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){mul_low((vw)a, (vw)b), mul_low((vw)a >> 32, (vw)b >> 32)};
}

static inline wide add_wide(wide a, wide b)
{
    return (wide){a.even + b.even, a.odd + b.odd};
}

static inline wide offset_wide(wide a, int64_t b)
{
    return (wide){a.even + (uint64_t)b, a.odd + (uint64_t)b};
}

static inline wide shift_left_wide(wide x, int shift)
{
    return (wide){x.even << shift, x.odd << shift};
}

/* a | the magnitude of b */
static inline wide or_magnitude(wide a, wide b)
{
    return (wide){a.even | magnitude_64(b.even), a.odd | magnitude_64(b.odd)};
}

/* Bits shift to shift + 31 of each number; shift a constant in 1..31. */
static inline vu narrow(wide x, const int shift)
{
    return interleave(x.even >> shift, x.odd << (32 - shift));
}

static inline vu low_half(wide x)
{
    return interleave(x.even, x.odd << 32);
}

static inline vu high_half(wide x)
{
    return interleave(x.even >> 32, x.odd);
}

/* Shifts by lane: 0 where the shift is not in 0..31. */
static inline vu shift_left(vu x, vi shift)
{
    return (vu)MM(sllv_epi32)((V)x, (V)shift);
}

static inline vu shift_right(vu x, vi shift)
{
    return (vu)MM(srlv_epi32)((V)x, (V)shift);
}

/* x * 2^-shift, rounded to nearest; 0 where nothing is left. shift above 0. */
static inline vu scale_down(vu x, vi shift)
{
    return (shift_right(x, shift - 1) + 1) >> 1;
}

/* x * 2^-shift, rounded down, where that fits 32 bits; shift in 0..63 by lane. */
static inline vi narrow_by(wide x, vi shift)
{
    vw odd = (vw)shift >> 32, even = ((vw)shift << 32) >> 32;
    return (vi)low_half((wide){shift_right_64(x.even, even), shift_right_64(x.odd, odd)});
}

/* The same, rounded to nearest; shift above 0. */
static inline vi scale_down_wide(wide x, vi shift)
{
    return (narrow_by(x, shift - 1) + 1) >> 1;
}

/* Leading zeros; 64 for 0. */
static inline vi clz_wide(wide x)
{
    const vu high = high_half(x);
    const mask empty = equal((vi)high, all(0));
    return clz((vu)choose(empty, (vi)low_half(x), (vi)high)) + choose(empty, all(32), all(0));
}

/* (x << shift) >> 32; shift in 0..63. */
static inline vu top_half(wide x, vi shift)
{
    const vu high = high_half(x), low = low_half(x);
    return shift_left(high, shift) | shift_right(low, 32 - shift) | shift_left(low, shift - 32);
}

/* x * 2^-shift, rounded to nearest, halves up; shift a constant. */
static inline vi round_shift(vi x, const int shift)
{
    const int32_t half = 1 << (shift - 1);
    return (x + half) >> shift;
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

/* The four words at from + stride * at[lane], of each lane. Quicker than gathers, and constant offsets fold. */
static inline __attribute__((always_inline)) void load_fours(vi words[4], const int32_t *from, int stride,
                                                             const int32_t at[LANES])
{
    V x = every_fourth(from, stride, at), y = every_fourth(from, stride, at + 1);
    V z = every_fourth(from, stride, at + 2), w = every_fourth(from, stride, at + 3);
    V xy = MM(unpacklo_epi32)(x, y), zw = MM(unpacklo_epi32)(z, w);
    words[0] = (vi)MM(unpacklo_epi64)(xy, zw);
    words[1] = (vi)MM(unpackhi_epi64)(xy, zw);
    xy = MM(unpackhi_epi32)(x, y), zw = MM(unpackhi_epi32)(z, w);
    words[2] = (vi)MM(unpacklo_epi64)(xy, zw);
    words[3] = (vi)MM(unpackhi_epi64)(xy, zw);
}

/* ---- One Gaussian ---------------------------------------------------------------------------------------------- */

/* 8 words, or 16 numbers of 16 bits. */
typedef __m256i octet;

static inline void store_8(void *to, octet x)
{
    _mm256_storeu_si256(to, x);
}

static inline void store_6(void *to, octet x)
{
    _mm_storeu_si128(to, _mm256_castsi256_si128(x));
    _mm_storel_epi64((__m128i *)to + 1, _mm256_extracti128_si256(x, 1));
}

/* What 8 rows have in lanes first to first + 3. */
static inline void transpose(octet out[4], const vi rows[8], int first)
{
    const __m128i *four = (const __m128i *)(const void *)rows + first / 4;
    __m256i in[4];
    for (int i = 0; i < 4; i++)
        in[i] = _mm256_loadu2_m128i(four + (i + 4) * (LANES / 4), four + i * (LANES / 4));
    __m256i a = _mm256_unpacklo_epi32(in[0], in[1]), b = _mm256_unpacklo_epi32(in[2], in[3]);
    __m256i c = _mm256_unpackhi_epi32(in[0], in[1]), d = _mm256_unpackhi_epi32(in[2], in[3]);
    out[0] = _mm256_unpacklo_epi64(a, b);
    out[1] = _mm256_unpackhi_epi64(a, b);
    out[2] = _mm256_unpacklo_epi64(c, d);
    out[3] = _mm256_unpackhi_epi64(c, d);
}

static inline octet load_16(const int8_t *from)
{
    return _mm256_cvtepi8_epi16(_mm_loadu_si128((const __m128i *)(const void *)from));
}

/* x + from, or x - from */
static inline octet add_16(octet x, const int8_t *from, int negative)
{
    return _mm256_add_epi16(x, _mm256_sign_epi16(load_16(from), _mm256_set1_epi16(negative ? -1 : 1)));
}

/* sum[i] = x[i][0] y[0] + x[i][1] y[1] + ... */
static inline void dot_16(int32_t sum[3], const octet x[3], octet y)
{
    int32_t sums[4];
    __m256i pairs = _mm256_hadd_epi32(_mm256_madd_epi16(x[0], y), _mm256_madd_epi16(x[1], y));
    __m256i third = _mm256_madd_epi16(x[2], y);
    pairs = _mm256_hadd_epi32(pairs, _mm256_hadd_epi32(third, third));
    _mm_storeu_si128((__m128i *)(void *)sums,
                     _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1)));
    for (int i = 0; i < 3; i++)
        sum[i] = sums[i];
}

/* 15 codes of 3 bits each from the low end of `codes` as odd numbers -7 to 7: each in a window of 16 bits that is moved
   up until it is on top. */
static inline octet odd_numbers(uint64_t codes)
{
#define WINDOW(k) (char)(3 * (k) / 8), (char)(3 * (k) / 8 + 1)
#define UP(k) (short)(1 << (13 - 3 * (k) % 8))
    const __m256i windows = _mm256_setr_epi8(
        WINDOW(0), WINDOW(1), WINDOW(2), WINDOW(3), WINDOW(4), WINDOW(5), WINDOW(6), WINDOW(7),
        WINDOW(8), WINDOW(9), WINDOW(10), WINDOW(11), WINDOW(12), WINDOW(13), WINDOW(14), -1, -1);
    const __m256i up = _mm256_setr_epi16(UP(0), UP(1), UP(2), UP(3), UP(4), UP(5), UP(6), UP(7), UP(8), UP(9), UP(10),
                                         UP(11), UP(12), UP(13), UP(14), 0);
#undef WINDOW
#undef UP
    __m256i x = _mm256_shuffle_epi8(_mm256_set1_epi64x((int64_t)codes), windows);
    x = _mm256_srai_epi16(_mm256_mullo_epi16(x, up), 13);
    return _mm256_or_si256(_mm256_add_epi16(x, x), _mm256_set1_epi16(1));
}

/* ---- PARTS vectors, and one function's numbers of 16 bits for all of their Gaussians ---------------------------- */

#define PARTS 1
typedef vi factor;                 /* with 0 above the 16 bits */

static inline factor factor_of(vi first, vi last)
{
    (void)last;
    return first & 65535;
}

/* sum += codes x; a code a Gaussian */
static inline void add_products(vi sum[PARTS], const int8_t *codes, factor x)
{
    sum[0] += (vi)MM(madd_epi16)((V)load_i8(codes), (V)x);
}

#endif
