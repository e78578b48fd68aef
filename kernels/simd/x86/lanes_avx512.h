/* Vector operations of 16 lanes with AVX-512 (F, BW, DQ, VL, CD). vectors.h describes the operations. */
#ifndef FXS_LANES_AVX512_H
#define FXS_LANES_AVX512_H

#define ISA avx512
#define LANES 16
#define V __m512i
#define MM(name) _mm512_##name
#include <fixsplat/internal/stage.h>
#include "common.h"

typedef __mmask16 mask;

static inline vi load_u16(const uint16_t *from)
{
    return (vi)_mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)(const void *)from));
}

static inline vi load_i16(const int16_t *from)
{
    return (vi)_mm512_cvtepi16_epi32(_mm256_loadu_si256((const __m256i *)(const void *)from));
}

static inline void store_u16(uint16_t *to, vi x)
{
    _mm256_storeu_si256((__m256i *)(void *)to, _mm512_cvtepi32_epi16((__m512i)x));
}

static inline vi load_i8(const int8_t *from)
{
    return (vi)_mm512_cvtepi8_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
}

/* Loads the four words at from + stride * at[i] for i = 0, 4, 8 and 12. */
static inline __m512i every_fourth(const int32_t *from, int stride, const int32_t *at)
{
    __m256i low = _mm256_loadu2_m128i((const __m128i *)(const void *)(from + stride * at[4]),
                                      (const __m128i *)(const void *)(from + stride * at[0]));
    __m256i high = _mm256_loadu2_m128i((const __m128i *)(const void *)(from + stride * at[12]),
                                       (const __m128i *)(const void *)(from + stride * at[8]));
    return _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}

static inline void store_pairs(void *to, vi a, vi b)
{
    const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const __m512i high = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    _mm512_storeu_si512(to, _mm512_permutex2var_epi32((__m512i)a, low, (__m512i)b));
    _mm512_storeu_si512((__m512i *)to + 1, _mm512_permutex2var_epi32((__m512i)a, high, (__m512i)b));
}

static inline void load_pairs(const void *from, vi *a, vi *b)
{
    const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    const __m512i low = _mm512_loadu_si512(from), high = _mm512_loadu_si512((const __m512i *)from + 1);
    *a = (vi)_mm512_permutex2var_epi32(low, even, high);
    *b = (vi)_mm512_permutex2var_epi32(low, _mm512_add_epi32(even, _mm512_set1_epi32(1)), high);
}

static inline void store_compressed(void *to, vi x, mask which)
{
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(which, (__m512i)x));
}

static inline int any(mask which)
{
    return which != 0;
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

static inline vi clz(vu x)
{
    return (vi)_mm512_lzcnt_epi32((__m512i)x);
}

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

#include "avx.h"

static inline void transpose(octet out[4], const vi rows[8], int first)
{
    const __m512i two = first < 8 ? _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11)
                                  : _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    __m512i fours[2][4];
    for (int i = 0; i < 2; i++) {
        const __m512i *four = (const __m512i *)(const void *)rows + 4 * i;
        const __m512i a = _mm512_unpacklo_epi32(four[0], four[1]), b = _mm512_unpacklo_epi32(four[2], four[3]);
        const __m512i c = _mm512_unpackhi_epi32(four[0], four[1]), d = _mm512_unpackhi_epi32(four[2], four[3]);
        fours[i][0] = _mm512_unpacklo_epi64(a, b);
        fours[i][1] = _mm512_unpackhi_epi64(a, b);
        fours[i][2] = _mm512_unpacklo_epi64(c, d);
        fours[i][3] = _mm512_unpackhi_epi64(c, d);
    }
    for (int i = 0; i < 4; i++) {
        const __m512i lanes = _mm512_permutex2var_epi64(fours[0][i], two, fours[1][i]);
        out[i] = first & 4 ? _mm512_extracti64x4_epi64(lanes, 1) : _mm512_castsi512_si256(lanes);
    }
}

typedef __mmask32 mask_h;

static inline mask_h open_of(vh transmittance_q15)
{
    return _mm512_cmpgt_epi16_mask((__m512i)transmittance_q15, _mm512_set1_epi16(FXS_CLOSED_Q15 - 1));
}

static inline mask_h within(vh level, vh limit)
{
    return _mm512_cmple_epu16_mask((__m512i)level, (__m512i)limit);
}

static inline int any_h(mask_h which)
{
    return which != 0;
}

static inline vh where(mask_h which, vh x)
{
    return (vh)_mm512_maskz_mov_epi16(which, (__m512i)x);
}

static inline mask_h greater_h(vh a, vh b)
{
    return _mm512_cmpgt_epi16_mask((__m512i)a, (__m512i)b);
}

static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)_mm512_mask_mov_epi16((__m512i)b, which, (__m512i)a);
}

static inline uint32_t bits_h(mask_h which)
{
    return which;
}

/* Returns x * column + y * row for pixels in the columns 0, 2, 4 and 6 of a patch (block of pixels). */
static inline vu pattern_of(uint32_t x, uint32_t y)
{
    return x * (vu)_mm512_setr_epi32(0, 0, 0, 0, 2, 2, 2, 2, 4, 4, 4, 4, 6, 6, 6, 6) +
           y * (vu)_mm512_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
}

static inline void order_levels(vh levels_q11[FXS_TILE])
{
    for (int row = 0; row < FXS_TILE; row += 4) {
        __m512i *four = (__m512i *)(levels_q11 + row);
        const __m512i a = _mm512_unpacklo_epi16(four[0], four[1]), b = _mm512_unpacklo_epi16(four[2], four[3]);
        const __m512i c = _mm512_unpackhi_epi16(four[0], four[1]), d = _mm512_unpackhi_epi16(four[2], four[3]);
        four[0] = _mm512_unpacklo_epi32(a, b);
        four[1] = _mm512_unpackhi_epi32(a, b);
        four[2] = _mm512_unpacklo_epi32(c, d);
        four[3] = _mm512_unpackhi_epi32(c, d);
    }
}

static inline vh spread_levels(const vh *levels_q11, uint32_t entry)
{
    const int64_t *fours = (const int64_t *)(levels_q11 + (entry >> 1 & 3)) + (entry >> 3) * 2 + (entry & 1);
    return (vh)_mm512_set1_epi64(*fours);
}

/* Reorders the pixels of a patch from columns of four to rows of eight. */
static inline vh rows_of(vh columns)
{
    const __m512i from = _mm512_setr_epi64(0x000c000800040000, 0x001c001800140010, 0x000d000900050001,
                                           0x001d001900150011, 0x000e000a00060002, 0x001e001a00160012,
                                           0x000f000b00070003, 0x001f001b00170013);
    return (vh)_mm512_permutexvar_epi16(from, (__m512i)columns);
}

static inline vh columns_of(vh rows)
{
    const __m512i from = _mm512_setr_epi64(0x0018001000080000, 0x0019001100090001, 0x001a0012000a0002,
                                           0x001b0013000b0003, 0x001c0014000c0004, 0x001d0015000d0005,
                                           0x001e0016000e0006, 0x001f0017000f0007);
    return (vh)_mm512_permutexvar_epi16(from, (__m512i)rows);
}

#endif
