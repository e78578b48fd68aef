/* blend, AVX2: a step is a row of 16 pixels. Packing leaves them in the order 0..3, 8..11, 4..7, 12..15. */
#include <immintrin.h>

#include "x86.h"

#define V __m256i
#define STEPS 16
#define V_SET1(x) _mm256_set1_epi16(x)
#define V_MUL(a, b) _mm256_mulhrs_epi16(a, b)
#define V_ADD(a, b) _mm256_add_epi16(a, b)
#define V_SUB(a, b) _mm256_sub_epi16(a, b)
#define V_MIN(a, b) _mm256_min_epi16(a, b)
#define V_ADD_SIGNED(a, b) _mm256_adds_epi16(a, b)
#define V_ADD_UNSIGNED(a, b) _mm256_adds_epu16(a, b)
#define V_OPEN(t) _mm256_cmpgt_epi16(t, _mm256_set1_epi16(FXS_CLOSED_Q15 - 1))
#define V_NONE_OPEN(t) _mm256_testz_si256(V_OPEN(t), V_OPEN(t))
#define V_COUNTED(x, level, limit, t) \
    _mm256_and_si256(_mm256_and_si256(x, V_OPEN(t)), _mm256_cmpeq_epi16(_mm256_min_epu16(level, limit), level))
#define V_STORE_IN_ORDER(to, x) _mm256_storeu_si256((__m256i *)(void *)(to), _mm256_permute4x64_epi64(x, 0xd8))
#define BLEND_FUNCTION fxs_blend_avx2

/* base + step * (from + 0..7) */
static inline __m256i ramp(int32_t base, int32_t step, int from)
{
    const __m256i iota = _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    return _mm256_add_epi32(_mm256_set1_epi32(base + step * from),
                            _mm256_mullo_epi32(_mm256_set1_epi32(step), iota));
}

typedef struct coordinates {
    __m256i left_q24, right_q24, step_q24;
} coordinates;

static inline coordinates coordinates_at(int32_t u_q24, int32_t ux_q24, int32_t uy_q24, int step)
{
    coordinates c;
    c.left_q24 = ramp(u_q24 + step * uy_q24, ux_q24, 0);
    c.right_q24 = _mm256_add_epi32(c.left_q24, _mm256_set1_epi32(8 * ux_q24));
    c.step_q24 = _mm256_set1_epi32(uy_q24);
    return c;
}

static inline __m256i coordinates_next(coordinates *c, int step)
{
    (void)step;
    __m256i u = _mm256_packs_epi32(_mm256_srai_epi32(c->left_q24, 11), _mm256_srai_epi32(c->right_q24, 11));
    c->left_q24 = _mm256_add_epi32(c->left_q24, c->step_q24);
    c->right_q24 = _mm256_add_epi32(c->right_q24, c->step_q24);
    return u;
}

typedef struct row_levels {
    int16_t of_row[16] __attribute__((aligned(32)));
} row_levels;

static inline row_levels row_levels_of(int32_t v_q24, int32_t vy_q24, uint16_t offset_q11)
{
    row_levels levels;
    __m256i v = _mm256_packs_epi32(_mm256_srai_epi32(ramp(v_q24, vy_q24, 0), 11),
                                   _mm256_srai_epi32(ramp(v_q24, vy_q24, 8), 11));
    __m256i level = _mm256_adds_epu16(_mm256_mulhrs_epi16(v, v), _mm256_set1_epi16((int16_t)offset_q11));
    _mm256_store_si256((__m256i *)(void *)levels.of_row, _mm256_permute4x64_epi64(level, 0xd8));
    return levels;
}

static inline __m256i row_level(const row_levels *levels, int step)
{
    return _mm256_set1_epi16(levels->of_row[step]);
}

#include "blend.h"
