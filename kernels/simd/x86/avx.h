/* Vector operations shared by AVX2 and AVX-512. */
#ifndef FXS_AVX_H
#define FXS_AVX_H

static inline vu shift_left(vu x, vi shift)
{
    return (vu)MM(sllv_epi32)((V)x, (V)shift);
}

static inline vu shift_right(vu x, vi shift)
{
    return (vu)MM(srlv_epi32)((V)x, (V)shift);
}

#include "wide.h"

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

static inline octet load_16(const int8_t *from)
{
    return _mm256_cvtepi8_epi16(_mm_loadu_si128((const __m128i *)(const void *)from));
}

static inline octet add_16(octet x, const int8_t *from, int negative)
{
    return _mm256_add_epi16(x, _mm256_sign_epi16(load_16(from), _mm256_set1_epi16(negative ? -1 : 1)));
}

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

#endif
