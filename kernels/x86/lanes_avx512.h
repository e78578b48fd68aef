/* 16 lanes of 32 bits in AVX-512 (F, BW, DQ, VL, CD). */
#ifndef FXS_LANES_AVX512_H
#define FXS_LANES_AVX512_H

#define ISA avx512
#define LANES 16
#define V __m512i
#define MM(name) _mm512_##name
#include "../../src/stage.h"
#include "common.h"

typedef __mmask16 mask;

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

/* Leading zeros; 32 for 0. */
static inline vi clz(vu x)
{
    return (vi)_mm512_lzcnt_epi32((__m512i)x);
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

#include "avx.h"

/* ---- Pixels: packing leaves two rows in turns of four, r0 x 0..3, r1 x 0..3, r0 x 4..7, ... ---------------------- */

typedef __mmask32 mask_h;

/* The pixels that take more. */
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

/* x, or 0 */
static inline vh where(mask_h which, vh x)
{
    return (vh)_mm512_maskz_mov_epi16(which, (__m512i)x);
}

static inline mask_h greater_h(vh a, vh b)
{
    return _mm512_cmpgt_epi16_mask((__m512i)a, (__m512i)b);
}

/* a, or b */
static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)_mm512_mask_mov_epi16((__m512i)b, which, (__m512i)a);
}

/* From the order of pixels to that of pack_q13, and back. */
static inline vh load_in_order(const int16_t *from)
{
    return (vh)_mm512_permutexvar_epi64(_mm512_set_epi64(7, 3, 6, 2, 5, 1, 4, 0), (__m512i)load_h(from));
}

static inline void store_in_order(int16_t *to, vh x)
{
    store_h(to, (vh)_mm512_permutexvar_epi64(_mm512_set_epi64(7, 5, 3, 1, 6, 4, 2, 0), (__m512i)x));
}

/* v^2 + offset of the 16 rows. */
typedef struct row_levels {
    vh of_row;                     /* in the low half */
} row_levels;

static inline row_levels row_levels_of(uint32_t v_q24, uint32_t vy_q24, uint16_t offset_q11)
{
    const __m256i v_q13 = _mm512_cvtsepi32_epi16(_mm512_srai_epi32((__m512i)ramp(v_q24, vy_q24), 11));
    const __m256i square_q11 = _mm256_mulhrs_epi16(v_q13, v_q13);
    const __m256i level_q11 = _mm256_adds_epu16(square_q11, _mm256_set1_epi16((int16_t)offset_q11));
    return (row_levels){(vh)_mm512_castsi256_si512(level_q11)};
}

/* Those of rows 2 step and 2 step + 1, four times each, in turns. */
static inline vh row_level(const row_levels *levels, int step)
{
    const __m512i turns = _mm512_maskz_mov_epi64(0xaa, _mm512_set1_epi64(0x0001000100010001));
    const __m512i which = _mm512_add_epi16(_mm512_set1_epi16((int16_t)(2 * step)), turns);
    return (vh)_mm512_permutexvar_epi16(which, (__m512i)levels->of_row);
}

#endif
