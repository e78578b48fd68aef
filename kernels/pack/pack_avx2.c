/* Inner loops of packing (src/pack/pack_stages.h) with AVX2. */
#include <immintrin.h>
#define ISA avx2
#include "src/pack/palette_vector.h"

static inline __m256i load(const void *from)
{
    return _mm256_loadu_si256(from);
}

static inline __m256i find_products(const __m256i own[3], const fxs_sh_vector other)
{
    const __m256i a = _mm256_madd_epi16(own[0], load(other)), b = _mm256_madd_epi16(own[1], load(other + 16));
    return _mm256_add_epi32(_mm256_add_epi32(a, b), _mm256_madd_epi16(own[2], load(other + 32)));
}

static inline __m256i find_four(const __m256i own[3], const fxs_sh_vector *others)
{
    const __m256i two = _mm256_hadd_epi32(find_products(own, others[0]), find_products(own, others[1]));
    return _mm256_hadd_epi32(two, _mm256_hadd_epi32(find_products(own, others[2]), find_products(own, others[3])));
}

static inline void find_dots(int32_t dots[FXS_PALETTE_GROUP], const fxs_sh_vector vector, const fxs_sh_vector *others)
{
    const __m256i own[3] = {load(vector), load(vector + 16), load(vector + 32)};
    const __m256i first = find_four(own, others), second = find_four(own, others + 4);
    const __m256i low = _mm256_permute2x128_si256(first, second, 0x20);
    _mm256_storeu_si256((void *)dots, _mm256_add_epi32(low, _mm256_permute2x128_si256(first, second, 0x31)));
}

/* Finds the smallest costs. The costs stay in registers, because a vector load right after a scalar store would
   stall. */
static inline void find_leasts(const int32_t *costs, uint32_t count, fxs_pack_place *found, uint32_t wanted)
{
    __m256i all[6], numbers = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    for (uint32_t i = 0; i < count / 8; i++)
        all[i] = load(costs + 8 * i);
    for (uint32_t n = 0; n < wanted; n++) {
        __m256i eight = all[0];
        uint64_t equal = 0;
        for (uint32_t i = 1; i < count / 8; i++)
            eight = _mm256_min_epi32(eight, all[i]);
        __m128i four = _mm_min_epi32(_mm256_castsi256_si128(eight), _mm256_extracti128_si256(eight, 1));
        four = _mm_min_epi32(four, _mm_shuffle_epi32(four, 0x4e));
        four = _mm_min_epi32(four, _mm_shuffle_epi32(four, 0xb1));
        const __m256i least = _mm256_broadcastd_epi32(four);
        for (uint32_t i = 0; i < count / 8; i++)
            equal |= (uint64_t)(uint32_t)_mm256_movemask_ps((__m256)_mm256_cmpeq_epi32(all[i], least)) << 8 * i;
        found[n] = (fxs_pack_place){_mm_cvtsi128_si32(four), (uint32_t)__builtin_ctzll(equal)};
        for (uint32_t i = 0; i < count / 8 && n + 1 < wanted; i++) {
            const __m256i own = _mm256_set1_epi32((int32_t)found[n].place - 8 * (int32_t)i);
            all[i] = _mm256_blendv_epi8(all[i], _mm256_set1_epi32(INT32_MAX), _mm256_cmpeq_epi32(numbers, own));
        }
    }
}

#include "src/pack/pack_stages.h"
