/* Compiles the stages of the fit in src/fit/stages/fit_isa.h for AVX-512, with 16 lanes. */
#include <immintrin.h>
#define ISA avx512
#define LANES 16
#define MASK __mmask16
#define ROOT(x) ((real)_mm512_sqrt_ps((__m512)(x)))
#define BELOW(a, b) _mm512_cmp_ps_mask((__m512)(a), (__m512)(b), _CMP_LT_OQ)
#define AT_MOST(a, b) _mm512_cmp_ps_mask((__m512)(a), (__m512)(b), _CMP_LE_OQ)
#define ANY(which) ((which) != 0)
#define CHOOSE(which, a, b) ((real)_mm512_mask_blend_ps(which, (__m512)(b), (__m512)(a)))
#define BITS(which) ((uint32_t)(which))

/* Adds halves of two vectors of 16 floats. Lower half of the result: a[i] + a[i + 8] for i = 0..7. Upper half: b[i] +
   b[i + 8]. */
static inline __m512 halves(__m512 a, __m512 b)
{
    return _mm512_shuffle_f32x4(a, b, 0x44) + _mm512_shuffle_f32x4(a, b, 0xee);
}

/* Adds lanes i and i + 4 of each half of the vectors a and b, and packs the results into one vector. */
static inline __m512 quarters(__m512 a, __m512 b)
{
    return _mm512_shuffle_f32x4(a, b, 0x88) + _mm512_shuffle_f32x4(a, b, 0xdd);
}

static inline __m512 pairs(__m512 a, __m512 b)
{
    return _mm512_shuffle_ps(a, b, 0x44) + _mm512_shuffle_ps(a, b, 0xee);
}

/* Sums the 16 lanes of each of nine vectors. Lanes p and p + 8 are added first, then p + 4, p + 2 and p + 1. */
static inline void add_vectors(const __m512 *v, float *sums)
{
    const __m512 a = quarters(halves(v[0], v[1]), halves(v[2], v[3]));
    const __m512 b = quarters(halves(v[4], v[5]), halves(v[6], v[7]));
    const __m512 two = pairs(a, b), one = two + _mm512_permute_ps(two, 0xb1);
    /* Even lanes hold the sums of vectors 0, 2, 1, 3; odd lanes the sums of vectors 4, 6, 5, 7. */
    const __m512i order = _mm512_setr_epi32(0, 4, 8, 12, 2, 6, 10, 14, 0, 0, 0, 0, 0, 0, 0, 0);
    _mm256_storeu_ps(sums, _mm512_castps512_ps256(_mm512_permutexvar_ps(order, one)));
    const __m256 eight = _mm512_castps512_ps256(v[8]) + _mm512_extractf32x8_ps(v[8], 1);
    const __m128 four = _mm256_castps256_ps128(eight) + _mm256_extractf128_ps(eight, 1);
    const __m128 last = four + _mm_movehl_ps(four, four);
    sums[8] = _mm_cvtss_f32(last) + _mm_cvtss_f32(_mm_movehdup_ps(last));
}

#define ADD_PLACES(vectors, sums) add_vectors((const __m512 *)(vectors), sums)
#include "src/fit/stages/fit_isa.h"
