/* 16 lanes of 32 bits in AVX-512 (F, BW, DQ, VL, CD): what + - * & | and constant shifts of a vector do not say. */
#ifndef FXS_LANES_AVX512_H
#define FXS_LANES_AVX512_H

#include <immintrin.h>
#include <stdint.h>

#define LANES 16

typedef int32_t vi __attribute__((vector_size(64)));
typedef uint32_t vu __attribute__((vector_size(64)));
typedef uint64_t vw __attribute__((vector_size(64)));
typedef __mmask16 mask;

static inline vi all(int32_t x)
{
    return (vi)_mm512_set1_epi32(x);
}

static inline vi load(const void *from)
{
    return (vi)_mm512_loadu_si512(from);
}

static inline vi load_u16(const uint16_t *from)
{
    return (vi)_mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)(const void *)from));
}

static inline vi load_i8(const int8_t *from)
{
    return (vi)_mm512_cvtepi8_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
}

/* The four words at from + stride * at[0], from + stride * at[4], ... */
static inline __m512i every_fourth(const int32_t *from, int stride, const int32_t *at)
{
    __m256i low = _mm256_loadu2_m128i((const __m128i *)(const void *)(from + stride * at[4]),
                                      (const __m128i *)(const void *)(from + stride * at[0]));
    __m256i high = _mm256_loadu2_m128i((const __m128i *)(const void *)(from + stride * at[12]),
                                       (const __m128i *)(const void *)(from + stride * at[8]));
    return _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}

/* The four words at from + stride * at[lane], of each lane. Quicker than gathers, and constant offsets fold. */
static inline __attribute__((always_inline)) void load_fours(vi words[4], const int32_t *from, int stride,
                                                             const int32_t at[LANES])
{
    __m512i x = every_fourth(from, stride, at), y = every_fourth(from, stride, at + 1);
    __m512i z = every_fourth(from, stride, at + 2), w = every_fourth(from, stride, at + 3);
    __m512i xy = _mm512_unpacklo_epi32(x, y), zw = _mm512_unpacklo_epi32(z, w);
    words[0] = (vi)_mm512_unpacklo_epi64(xy, zw);
    words[1] = (vi)_mm512_unpackhi_epi64(xy, zw);
    xy = _mm512_unpackhi_epi32(x, y), zw = _mm512_unpackhi_epi32(z, w);
    words[2] = (vi)_mm512_unpacklo_epi64(xy, zw);
    words[3] = (vi)_mm512_unpackhi_epi64(xy, zw);
}

static inline void store(void *to, vi x)
{
    _mm512_storeu_si512(to, (__m512i)x);
}

/* a[0], b[0], a[1], b[1], ... */
static inline void store_pairs(void *to, vi a, vi b)
{
    const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const __m512i high = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    _mm512_storeu_si512(to, _mm512_permutex2var_epi32((__m512i)a, low, (__m512i)b));
    _mm512_storeu_si512((__m512i *)to + 1, _mm512_permutex2var_epi32((__m512i)a, high, (__m512i)b));
}

/* Stores the lanes of `which`, in order, without gaps; the rest of a vector behind them is overwritten. */
static inline void store_compressed(void *to, vi x, mask which)
{
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(which, (__m512i)x));
}

static inline unsigned bits(mask which)
{
    return which;
}

static inline mask equal(vi a, vi b)
{
    return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
}

static inline mask greater(vi a, vi b)
{
    return _mm512_cmpgt_epi32_mask((__m512i)a, (__m512i)b);
}

static inline vi choose(mask which, vi a, vi b)
{
    return (vi)_mm512_mask_mov_epi32((__m512i)b, which, (__m512i)a);
}

static inline vi least(vi a, vi b)
{
    return (vi)_mm512_min_epi32((__m512i)a, (__m512i)b);
}

static inline vi most(vi a, vi b)
{
    return (vi)_mm512_max_epi32((__m512i)a, (__m512i)b);
}

/* Shifts by lane: 0 where the shift is not in 0..31. */
static inline vu shift_left(vu x, vi shift)
{
    return (vu)_mm512_sllv_epi32((__m512i)x, (__m512i)shift);
}

static inline vu shift_right(vu x, vi shift)
{
    return (vu)_mm512_srlv_epi32((__m512i)x, (__m512i)shift);
}

/* Leading zeros; 32 for 0. */
static inline vi clz(vu x)
{
    return (vi)_mm512_lzcnt_epi32((__m512i)x);
}

/* Low 16 bits of a, signed, times b, which fits 16 bits too and has 0 above them. */
static inline vi mul_16(vi a, vi b)
{
    return (vi)_mm512_madd_epi16((__m512i)a, (__m512i)b);
}

/* 64-bit numbers: those of the even lanes, and those of the odd ones. */
typedef struct wide {
    vw even, odd;
} wide;

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vw)_mm512_mul_epi32((__m512i)a, (__m512i)b),
                  (vw)_mm512_mul_epi32((__m512i)((vw)a >> 32), (__m512i)((vw)b >> 32))};
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){(vw)_mm512_mul_epu32((__m512i)a, (__m512i)b),
                  (vw)_mm512_mul_epu32((__m512i)((vw)a >> 32), (__m512i)((vw)b >> 32))};
}

/* Products of the low halves. */
static inline vw mul_low(vw a, vw b)
{
    return (vw)_mm512_mul_epu32((__m512i)a, (__m512i)b);
}

/* Even lanes of a, odd lanes of b. */
static inline vu interleave(vw a, vw b)
{
    return (vu)_mm512_mask_mov_epi32((__m512i)a, 0xaaaa, (__m512i)b);
}

static inline vw shift_right_64(vw x, vw shift)
{
    return (vw)_mm512_srav_epi64((__m512i)x, (__m512i)shift);
}

static inline vw magnitude_64(vw x)
{
    return (vw)_mm512_abs_epi64((__m512i)x);
}

#endif
