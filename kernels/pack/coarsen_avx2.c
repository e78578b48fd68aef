/* Merging of Gaussians (src/pack/coarsen_stages.h) with AVX2. */
#include <immintrin.h>
#include "src/pack/merger.h"

static inline void transpose(lanes *to, const float *const rows[LANES], int first)
{
    __m256 pairs[8], fours[8];
    for (int i = 0; i < 8; i += 2) {
        const __m256 a = _mm256_loadu_ps(rows[i] + first), b = _mm256_loadu_ps(rows[i + 1] + first);
        pairs[i] = _mm256_unpacklo_ps(a, b);
        pairs[i + 1] = _mm256_unpackhi_ps(a, b);
    }
    for (int i = 0; i < 8; i += 4)
        for (int k = 0; k < 2; k++) {
            fours[i + 2 * k] = _mm256_shuffle_ps(pairs[i + k], pairs[i + 2 + k], 0x44);
            fours[i + 2 * k + 1] = _mm256_shuffle_ps(pairs[i + k], pairs[i + 2 + k], 0xee);
        }
    for (int k = 0; k < 4; k++) {
        _mm256_storeu_ps(to[first + k], _mm256_permute2f128_ps(fours[k], fours[4 + k], 0x20));
        _mm256_storeu_ps(to[first + 4 + k], _mm256_permute2f128_ps(fours[k], fours[4 + k], 0x31));
    }
}

static inline void gather_rows(group *to, const float *const rows[LANES])
{
    for (int first = 0; first < ROW; first += LANES)
        transpose(to->f, rows, first);
}

#define ISA avx2
#include "src/pack/coarsen_stages.h"
