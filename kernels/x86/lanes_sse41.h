/* 8 numbers of 16 bits in SSE4.1: what blend and resolve need. */
#ifndef FXS_LANES_SSE41_H
#define FXS_LANES_SSE41_H

#define ISA sse41
#define LANES 4
#define V __m128i
#define MM(name) _mm_##name
#include "../../src/stage.h"
#include "common.h"

/* The four words at from + stride * at[lane], of each lane. */
static inline void load_fours(vi words[4], const int32_t *from, int stride, const int32_t at[LANES])
{
    __m128i in[4];
    for (int i = 0; i < 4; i++)
        in[i] = _mm_loadu_si128((const __m128i *)(const void *)(from + stride * at[i]));
    const __m128i a = _mm_unpacklo_epi32(in[0], in[1]), b = _mm_unpacklo_epi32(in[2], in[3]);
    const __m128i c = _mm_unpackhi_epi32(in[0], in[1]), d = _mm_unpackhi_epi32(in[2], in[3]);
    words[0] = (vi)_mm_unpacklo_epi64(a, b);
    words[1] = (vi)_mm_unpackhi_epi64(a, b);
    words[2] = (vi)_mm_unpacklo_epi64(c, d);
    words[3] = (vi)_mm_unpackhi_epi64(c, d);
}

typedef vh mask_h;                 /* -1 or 0 */

/* The pixels that take more. */
static inline mask_h open_of(vh transmittance_q15)
{
    return (mask_h)_mm_cmpgt_epi16((__m128i)transmittance_q15, _mm_set1_epi16(FXS_CLOSED_Q15 - 1));
}

static inline mask_h within(vh level, vh limit)
{
    return (mask_h)_mm_cmpeq_epi16(_mm_min_epu16((__m128i)level, (__m128i)limit), (__m128i)level);
}

/* x, or 0 */
static inline vh where(mask_h which, vh x)
{
    return which & x;
}

static inline mask_h greater_h(vh a, vh b)
{
    return (mask_h)_mm_cmpgt_epi16((__m128i)a, (__m128i)b);
}

/* a, or b */
static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)_mm_blendv_epi8((__m128i)b, (__m128i)a, (__m128i)which);
}

static inline int any_h(mask_h which)
{
    return !_mm_testz_si128((__m128i)which, (__m128i)which);
}

/* A bit a lane. */
static inline uint32_t bits_h(mask_h which)
{
    return (uint32_t)_mm_movemask_epi8(_mm_packs_epi16((__m128i)which, _mm_setzero_si128()));
}

/* x times 0 to 3 */
static inline vu pattern_of(uint32_t x, uint32_t y)
{
    (void)y;
    return ramp(0, x);
}

static inline void order_levels(vh levels_q11[FXS_TILE])
{
    (void)levels_q11;
}

static inline vh spread_levels(const vh *levels_q11, uint32_t entry)
{
    return all_h(((const int16_t *)levels_q11)[entry]);
}

/* 8 pixels, cut to 255. */
static inline void store_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    const __m128i rb = _mm_packus_epi16((__m128i)r, (__m128i)b), ga = _mm_packus_epi16((__m128i)g, (__m128i)a);
    const __m128i rg = _mm_unpacklo_epi8(rb, ga), ba = _mm_unpackhi_epi8(rb, ga);
    _mm_storeu_si128((__m128i *)(void *)to, _mm_unpacklo_epi16(rg, ba));
    _mm_storeu_si128((__m128i *)(void *)to + 1, _mm_unpackhi_epi16(rg, ba));
}

#endif
