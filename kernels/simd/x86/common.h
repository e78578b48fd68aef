/* Vector operations that take one instruction at every x86 width. V is the vector type; MM(name) is the intrinsic. */
#ifndef FXS_X86_COMMON_H
#define FXS_X86_COMMON_H

#include <immintrin.h>

#include "kernels/simd/lanes/vectors.h"

static inline vi all(int32_t x)
{
    return (vi)MM(set1_epi32)(x);
}

static inline vi least(vi a, vi b)
{
    return (vi)MM(min_epi32)((V)a, (V)b);
}

static inline vi most(vi a, vi b)
{
    return (vi)MM(max_epi32)((V)a, (V)b);
}

#if LANES < 16                     /* AVX-512 has an instruction for this */
/* Counts leading zeros with the exponent of x as a float. Clearing the 8th bit below the highest bit stops rounding
   from carrying into the exponent. From 2^31 on, the float is negative. */
static inline vi clz(vu x)
{
    const vu exponent = (vu)MM(cvtepi32_ps)((V)(x & ~(x >> 8))) >> 23;
    return least(most((vi)(158 - exponent), all(0)), all(32));
}
#endif

static inline vh all_h(int x)
{
    return (vh)MM(set1_epi16)((int16_t)x);
}

/* Returns rounded Q15 products; -32768 squared gives -32768. */
static inline vh mul_h(vh a, vh b)
{
    return (vh)MM(mulhrs_epi16)((V)a, (V)b);
}

static inline vh mul_add_h(vh a, vh b, vh c)
{
    return mul_h(a, b) + c;
}

static inline vh mul_add_cut_h(vh a, vh b, vh c)
{
    return (vh)MM(adds_epi16)((V)c, (V)mul_h(a, b));
}

static inline vh least_h(vh a, vh b)
{
    return (vh)MM(min_epi16)((V)a, (V)b);
}

static inline vh most_h(vh a, vh b)
{
    return (vh)MM(max_epi16)((V)a, (V)b);
}

/* Adds levels, -2 ln(alpha) of a splat. Sums saturate at 65535, in the C version at 32767; both are above every limit
   of levels. */
static inline vh add_level(vh a, vh b)
{
    return (vh)MM(adds_epu16)((V)a, (V)b);
}

/* Interleaves four channels to pixels of 8 bits per channel, saturated, four pixels per 128 bits. */
static inline void mix_bytes(V fours[2], vh r, vh g, vh b, vh a)
{
    const V rb = MM(packus_epi16)((V)r, (V)b), ga = MM(packus_epi16)((V)g, (V)a);
    const V rg = MM(unpacklo_epi8)(rb, ga), ba = MM(unpackhi_epi8)(rb, ga);
    fours[0] = MM(unpacklo_epi16)(rg, ba);
    fours[1] = MM(unpackhi_epi16)(rg, ba);
}

static inline void mix_words(V twos[4], vh r, vh g, vh b, vh a)
{
    const V rg_low = MM(unpacklo_epi16)((V)r, (V)g), rg_high = MM(unpackhi_epi16)((V)r, (V)g);
    const V ba_low = MM(unpacklo_epi16)((V)b, (V)a), ba_high = MM(unpackhi_epi16)((V)b, (V)a);
    twos[0] = MM(unpacklo_epi32)(rg_low, ba_low);
    twos[1] = MM(unpackhi_epi32)(rg_low, ba_low);
    twos[2] = MM(unpacklo_epi32)(rg_high, ba_high);
    twos[3] = MM(unpackhi_epi32)(rg_high, ba_high);
}

/* Packs numbers a and b from Q24 to Q13 with 16 bits. Vectors beyond 128 bits alternate four numbers of a and four of
   b. */
static inline vh pack_q13(vu a_q24, vu b_q24)
{
    return (vh)MM(packs_epi32)((V)((vi)a_q24 >> 11), (V)((vi)b_q24 >> 11));
}

#endif
