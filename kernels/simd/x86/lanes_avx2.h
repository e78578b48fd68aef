/* Vector operations of 8 lanes with AVX2. vectors.h describes the operations. */
#ifndef FXS_LANES_AVX2_H
#define FXS_LANES_AVX2_H

#define ISA avx2
#define LANES 8
#define V __m256i
#define MM(name) _mm256_##name
#include <fixsplat/internal/stage.h>
#include "common.h"

typedef vi mask;

static inline vi load_u16(const uint16_t *from)
{
    return (vi)_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
}

static inline vi load_i16(const int16_t *from)
{
    return (vi)_mm256_cvtepi16_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
}

static inline void store_u16(uint16_t *to, vi x)
{
    const __m128i high = _mm256_extracti128_si256((__m256i)x, 1);
    _mm_storeu_si128((__m128i *)(void *)to, _mm_packus_epi32(_mm256_castsi256_si128((__m256i)x), high));
}

static inline vi load_i8(const int8_t *from)
{
    return (vi)_mm256_cvtepi8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from));
}

/* Loads the four words at from + stride * at[i] for i = 0 and 4. */
static inline __m256i every_fourth(const int32_t *from, int stride, const int32_t *at)
{
    return _mm256_loadu2_m128i((const __m128i *)(const void *)(from + stride * at[4]),
                               (const __m128i *)(const void *)(from + stride * at[0]));
}

static inline void store_pairs(void *to, vi a, vi b)
{
    __m256i low = _mm256_unpacklo_epi32((__m256i)a, (__m256i)b), high = _mm256_unpackhi_epi32((__m256i)a, (__m256i)b);
    _mm256_storeu_si256(to, _mm256_permute2x128_si256(low, high, 0x20));
    _mm256_storeu_si256((__m256i *)to + 1, _mm256_permute2x128_si256(low, high, 0x31));
}

static inline int any(mask which)
{
    return !_mm256_testz_si256((__m256i)which, (__m256i)which);
}

static inline unsigned bits(mask which)
{
    __m128i high = _mm256_extracti128_si256((__m256i)which, 1);
    __m128i words = _mm_packs_epi32(_mm256_castsi256_si128((__m256i)which), high);
    return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(words, _mm_setzero_si128()));
}

static inline void load_pairs(const void *from, vi *a, vi *b)
{
    const __m256 low = (__m256)load(from), high = (__m256)load((const __m256i *)from + 1);
    *a = (vi)_mm256_permute4x64_epi64((__m256i)_mm256_shuffle_ps(low, high, 0x88), 0xd8);
    *b = (vi)_mm256_permute4x64_epi64((__m256i)_mm256_shuffle_ps(low, high, 0xdd), 0xd8);
}

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

/* Returns the even lanes of a and the odd lanes of b. */
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

#include "avx.h"

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

typedef vh mask_h;

static inline mask_h open_of(vh transmittance_q15)
{
    return (mask_h)_mm256_cmpgt_epi16((__m256i)transmittance_q15, _mm256_set1_epi16(FXS_CLOSED_Q15 - 1));
}

static inline mask_h within(vh level, vh limit)
{
    return (mask_h)_mm256_cmpeq_epi16(_mm256_min_epu16((__m256i)level, (__m256i)limit), (__m256i)level);
}

static inline int any_h(mask_h which)
{
    return !_mm256_testz_si256((__m256i)which, (__m256i)which);
}

static inline vh where(mask_h which, vh x)
{
    return which & x;
}

static inline mask_h greater_h(vh a, vh b)
{
    return (mask_h)_mm256_cmpgt_epi16((__m256i)a, (__m256i)b);
}

static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)_mm256_blendv_epi8((__m256i)b, (__m256i)a, (__m256i)which);
}

static inline uint32_t bits_h(mask_h which)
{
    const __m256i bytes = _mm256_packs_epi16((__m256i)which, (__m256i)which);
    const uint32_t bits = (uint32_t)_mm256_movemask_epi8(bytes);
    return (bits & 0xff) | (bits >> 8 & 0xff00);
}

/* Returns x * column + y * row for pixels in the columns 0, 1, 4 and 5 of a patch (block of pixels). */
static inline vu pattern_of(uint32_t x, uint32_t y)
{
    return x * (vu)_mm256_setr_epi32(0, 0, 1, 1, 4, 4, 5, 5) + y * (vu)_mm256_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1);
}

/* Interleaves the levels of pairs of pixel rows, so that the levels of a splat are adjacent. A level is v^2 +
   offset. */
static inline void order_levels(vh levels_q11[FXS_TILE])
{
    for (int row = 0; row < FXS_TILE; row += 2) {
        const __m256i upper = (__m256i)levels_q11[row], lower = (__m256i)levels_q11[row + 1];
        levels_q11[row] = (vh)_mm256_unpacklo_epi16(upper, lower);
        levels_q11[row + 1] = (vh)_mm256_unpackhi_epi16(upper, lower);
    }
}

static inline vh spread_levels(const vh *levels_q11, uint32_t entry)
{
    const int32_t *pairs = (const int32_t *)(levels_q11 + (entry >> 2 & 1)) + (entry >> 3) * 4 + (entry & 3);
    return (vh)_mm256_set1_epi32(*pairs);
}

/* Reorders the pixels of a patch from columns of two to rows of eight. */
static inline vh rows_of(vh columns)
{
    const __m256i by_row = _mm256_setr_epi64x(0x0d0c090805040100, 0x0f0e0b0a07060302, 0x0d0c090805040100,
                                              0x0f0e0b0a07060302);
    return (vh)_mm256_permute4x64_epi64(_mm256_shuffle_epi8((__m256i)columns, by_row), 0xd8);
}

static inline vh columns_of(vh rows)
{
    const __m256i by_column = _mm256_setr_epi64x(0x0b0a030209080100, 0x0f0e07060d0c0504, 0x0b0a030209080100,
                                                 0x0f0e07060d0c0504);
    return (vh)_mm256_shuffle_epi8(_mm256_permute4x64_epi64((__m256i)rows, 0xd8), by_column);
}

/* Stores the lower 128 bits of x and y at `to`, and the upper 128 bits `apart` bytes later. */
static inline void store_halves(unsigned char *to, size_t apart, __m256i x, __m256i y)
{
    _mm256_storeu_si256((__m256i *)(void *)to, _mm256_permute2x128_si256(x, y, 0x20));
    _mm256_storeu_si256((__m256i *)(void *)(to + apart), _mm256_permute2x128_si256(x, y, 0x31));
}

static inline void store_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    __m256i fours[2];
    mix_bytes(fours, r, g, b, a);
    store_halves(to, 32, fours[0], fours[1]);
}

static inline void store_wide_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    __m256i twos[4];
    mix_words(twos, r, g, b, a);
    store_halves(to, 64, twos[0], twos[1]);
    store_halves(to + 32, 64, twos[2], twos[3]);
}

#endif
