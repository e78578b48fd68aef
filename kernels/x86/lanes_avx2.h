/* 8 lanes of 32 bits in AVX2: what + - * & | and constant shifts of a vector do not say. */
#ifndef FXS_LANES_AVX2_H
#define FXS_LANES_AVX2_H

#include <immintrin.h>
#include <stdint.h>

#define LANES 8

typedef int32_t vi __attribute__((vector_size(32)));
typedef uint32_t vu __attribute__((vector_size(32)));
typedef uint64_t vw __attribute__((vector_size(32)));
typedef vi mask;                   /* -1 or 0 */

static inline vi all(int32_t x)
{
    return (vi)_mm256_set1_epi32(x);
}

static inline vi load(const void *from)
{
    return (vi)_mm256_loadu_si256(from);
}

static inline vi load_u16(const uint16_t *from)
{
    return (vi)_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
}

static inline vi load_i8(const int8_t *from)
{
    return (vi)_mm256_cvtepi8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from));
}

/* The four words at from + stride * at[0], from + stride * at[4], ... */
static inline __m256i every_fourth(const int32_t *from, int stride, const int32_t *at)
{
    return _mm256_loadu2_m128i((const __m128i *)(const void *)(from + stride * at[4]),
                               (const __m128i *)(const void *)(from + stride * at[0]));
}

/* The four words at from + stride * at[lane], of each lane. Quicker than gathers, and constant offsets fold. */
static inline __attribute__((always_inline)) void load_fours(vi words[4], const int32_t *from, int stride,
                                                             const int32_t at[LANES])
{
    __m256i x = every_fourth(from, stride, at), y = every_fourth(from, stride, at + 1);
    __m256i z = every_fourth(from, stride, at + 2), w = every_fourth(from, stride, at + 3);
    __m256i xy = _mm256_unpacklo_epi32(x, y), zw = _mm256_unpacklo_epi32(z, w);
    words[0] = (vi)_mm256_unpacklo_epi64(xy, zw);
    words[1] = (vi)_mm256_unpackhi_epi64(xy, zw);
    xy = _mm256_unpackhi_epi32(x, y), zw = _mm256_unpackhi_epi32(z, w);
    words[2] = (vi)_mm256_unpacklo_epi64(xy, zw);
    words[3] = (vi)_mm256_unpackhi_epi64(xy, zw);
}

static inline void store(void *to, vi x)
{
    _mm256_storeu_si256(to, (__m256i)x);
}

/* a[0], b[0], a[1], b[1], ... */
static inline void store_pairs(void *to, vi a, vi b)
{
    __m256i low = _mm256_unpacklo_epi32((__m256i)a, (__m256i)b), high = _mm256_unpackhi_epi32((__m256i)a, (__m256i)b);
    _mm256_storeu_si256(to, _mm256_permute2x128_si256(low, high, 0x20));
    _mm256_storeu_si256((__m256i *)to + 1, _mm256_permute2x128_si256(low, high, 0x31));
}

static inline unsigned bits(mask which)
{
    __m128i high = _mm256_extracti128_si256((__m256i)which, 1);
    __m128i words = _mm_packs_epi32(_mm256_castsi256_si128((__m256i)which), high);
    return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(words, _mm_setzero_si128()));
}

/* Bytes of four lanes, those of a mask first. */
#define BYTES(lane) (0x03020100 + 0x04040404 * (lane))
#define ORDER(a, b, c, d) {BYTES(a), BYTES(b), BYTES(c), BYTES(d)}
static const int32_t compress_order[16][4] __attribute__((aligned(16))) = {
    ORDER(0, 1, 2, 3), ORDER(0, 1, 2, 3), ORDER(1, 0, 2, 3), ORDER(0, 1, 2, 3),
    ORDER(2, 0, 1, 3), ORDER(0, 2, 1, 3), ORDER(1, 2, 0, 3), ORDER(0, 1, 2, 3),
    ORDER(3, 0, 1, 2), ORDER(0, 3, 1, 2), ORDER(1, 3, 0, 2), ORDER(0, 1, 3, 2),
    ORDER(2, 3, 0, 1), ORDER(0, 2, 3, 1), ORDER(1, 2, 3, 0), ORDER(0, 1, 2, 3),
};
#undef ORDER
#undef BYTES

/* Stores the lanes of `which`, in order, without gaps; the rest of a vector behind them is overwritten. */
static inline void store_compressed(void *to, vi x, mask which)
{
    unsigned low = bits(which) & 15, high = bits(which) >> 4;
    __m128i low_order = _mm_load_si128((const __m128i *)(const void *)compress_order[low]);
    __m128i high_order = _mm_load_si128((const __m128i *)(const void *)compress_order[high]);
    _mm_storeu_si128(to, _mm_shuffle_epi8(_mm256_castsi256_si128((__m256i)x), low_order));
    _mm_storeu_si128((void *)((int32_t *)to + __builtin_popcount(low)),
                     _mm_shuffle_epi8(_mm256_extracti128_si256((__m256i)x, 1), high_order));
}

static inline mask equal(vi a, vi b)
{
    return (mask)_mm256_cmpeq_epi32((__m256i)a, (__m256i)b);
}

static inline mask greater(vi a, vi b)
{
    return (mask)_mm256_cmpgt_epi32((__m256i)a, (__m256i)b);
}

static inline vi choose(mask which, vi a, vi b)
{
    return (vi)_mm256_blendv_epi8((__m256i)b, (__m256i)a, (__m256i)which);
}

static inline vi least(vi a, vi b)
{
    return (vi)_mm256_min_epi32((__m256i)a, (__m256i)b);
}

static inline vi most(vi a, vi b)
{
    return (vi)_mm256_max_epi32((__m256i)a, (__m256i)b);
}

/* Shifts by lane: 0 where the shift is not in 0..31. */
static inline vu shift_left(vu x, vi shift)
{
    return (vu)_mm256_sllv_epi32((__m256i)x, (__m256i)shift);
}

static inline vu shift_right(vu x, vi shift)
{
    return (vu)_mm256_srlv_epi32((__m256i)x, (__m256i)shift);
}

/* Leading zeros; 32 for 0. Those of each half byte from a table; then a lower part counts where the upper one is 0. */
static inline vi clz(vu x)
{
    const __m128i table = _mm_setr_epi8(4, 3, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0);
    const __m256i zeros_of = _mm256_broadcastsi128_si256(table);
    const __m256i nibble = _mm256_set1_epi8(15);
    __m256i low = _mm256_shuffle_epi8(zeros_of, _mm256_and_si256((__m256i)x, nibble));
    __m256i high = _mm256_shuffle_epi8(zeros_of, _mm256_and_si256((__m256i)(x >> 4), nibble));
    __m256i n = _mm256_add_epi8(high, _mm256_and_si256(low, _mm256_cmpeq_epi8(high, _mm256_set1_epi8(4))));
    low = _mm256_and_si256(n, _mm256_set1_epi16(255));
    high = _mm256_srli_epi16(n, 8);
    n = _mm256_add_epi16(high, _mm256_and_si256(low, _mm256_cmpeq_epi16(high, _mm256_set1_epi16(8))));
    low = _mm256_and_si256(n, _mm256_set1_epi32(65535));
    high = _mm256_srli_epi32(n, 16);
    low = _mm256_and_si256(low, _mm256_cmpeq_epi32(high, _mm256_set1_epi32(16)));
    return (vi)_mm256_add_epi32(high, low);
}

/* Low 16 bits of a, signed, times b, which fits 16 bits too and has 0 above them. */
static inline vi mul_16(vi a, vi b)
{
    return (vi)_mm256_madd_epi16((__m256i)a, (__m256i)b);
}

/* 64-bit numbers: those of the even lanes, and those of the odd ones. */
typedef struct wide {
    vw even, odd;
} wide;

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vw)_mm256_mul_epi32((__m256i)a, (__m256i)b),
                  (vw)_mm256_mul_epi32((__m256i)((vw)a >> 32), (__m256i)((vw)b >> 32))};
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){(vw)_mm256_mul_epu32((__m256i)a, (__m256i)b),
                  (vw)_mm256_mul_epu32((__m256i)((vw)a >> 32), (__m256i)((vw)b >> 32))};
}

/* Products of the low halves. */
static inline vw mul_low(vw a, vw b)
{
    return (vw)_mm256_mul_epu32((__m256i)a, (__m256i)b);
}

/* Even lanes of a, odd lanes of b. */
static inline vu interleave(vw a, vw b)
{
    return (vu)_mm256_blend_epi32((__m256i)a, (__m256i)b, 0xaa);
}

static inline vw sign_64(vw x)
{
    return (vw)_mm256_cmpgt_epi64(_mm256_setzero_si256(), (__m256i)x);
}

static inline vw shift_right_64(vw x, vw shift)
{
    vw sign = sign_64(x);
    return (vw)_mm256_srlv_epi64((__m256i)(x ^ sign), (__m256i)shift) ^ sign;
}

static inline vw magnitude_64(vw x)
{
    vw sign = sign_64(x);
    return (x ^ sign) - sign;
}

#endif
