/* 8 numbers of 16 bits in SSE4.1: what blend and resolve need. */
#ifndef FXS_LANES_SSE41_H
#define FXS_LANES_SSE41_H

#define ISA sse41
#define LANES 4
#define V __m128i
#define MM(name) _mm_##name
#include "../../src/stage.h"
#include "common.h"

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

static inline vh load_in_order(const int16_t *from)
{
    return load_h(from);
}

static inline void store_in_order(int16_t *to, vh x)
{
    store_h(to, x);
}

/* LANE_BITS each, those of a first. */
#define LANE_BITS 1

static inline uint64_t bits_of(mask_h a, mask_h b)
{
    return (uint64_t)_mm_movemask_epi8(_mm_packs_epi16((__m128i)a, (__m128i)b));
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
