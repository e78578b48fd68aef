/* blend, SSE4.1: a step is half a row, 8 pixels. */
#include <smmintrin.h>

#include "x86.h"

#define V __m128i
#define STEPS 32
#define V_SET1(x) _mm_set1_epi16(x)
#define V_MUL(a, b) _mm_mulhrs_epi16(a, b)
#define V_ADD(a, b) _mm_add_epi16(a, b)
#define V_SUB(a, b) _mm_sub_epi16(a, b)
#define V_MIN(a, b) _mm_min_epi16(a, b)
#define V_ADD_SIGNED(a, b) _mm_adds_epi16(a, b)
#define V_ADD_UNSIGNED(a, b) _mm_adds_epu16(a, b)
#define V_OPEN(t) _mm_cmpgt_epi16(t, _mm_set1_epi16(FXS_CLOSED_Q15 - 1))
#define V_NONE_OPEN(t) _mm_testz_si128(V_OPEN(t), V_OPEN(t))
#define V_COUNTED(x, level, limit, t) \
    _mm_and_si128(_mm_and_si128(x, V_OPEN(t)), _mm_cmpeq_epi16(_mm_min_epu16(level, limit), level))
#define V_STORE_IN_ORDER(to, x) _mm_storeu_si128((__m128i *)(void *)(to), x)
#define BLEND_FUNCTION fxs_blend_sse41

typedef struct coordinates {
    __m128i quarter_q24[4], step_q24;
} coordinates;

static inline __m128i ramp(int32_t base, int32_t step)
{
    return _mm_add_epi32(_mm_set1_epi32(base), _mm_mullo_epi32(_mm_set1_epi32(step), _mm_set_epi32(3, 2, 1, 0)));
}

static inline coordinates coordinates_at(int32_t u_q24, int32_t ux_q24, int32_t uy_q24, int step)
{
    coordinates c;
    for (int i = 0; i < 4; i++)
        c.quarter_q24[i] = ramp(u_q24 + step / 2 * uy_q24 + 4 * i * ux_q24, ux_q24);
    c.step_q24 = _mm_set1_epi32(uy_q24);
    return c;
}

static inline __m128i coordinates_next(coordinates *c, int step)
{
    __m128i *quarter = c->quarter_q24 + step % 2 * 2;
    __m128i u = _mm_packs_epi32(_mm_srai_epi32(quarter[0], 11), _mm_srai_epi32(quarter[1], 11));
    quarter[0] = _mm_add_epi32(quarter[0], c->step_q24);
    quarter[1] = _mm_add_epi32(quarter[1], c->step_q24);
    return u;
}

typedef struct row_levels {
    int16_t of_row[16];
} row_levels;

static inline row_levels row_levels_of(int32_t v_q24, int32_t vy_q24, uint16_t offset_q11)
{
    row_levels levels;
    for (int half = 0; half < 2; half++) {
        __m128i v = _mm_packs_epi32(_mm_srai_epi32(ramp(v_q24 + 8 * half * vy_q24, vy_q24), 11),
                                    _mm_srai_epi32(ramp(v_q24 + (8 * half + 4) * vy_q24, vy_q24), 11));
        __m128i level = _mm_adds_epu16(_mm_mulhrs_epi16(v, v), _mm_set1_epi16((int16_t)offset_q11));
        _mm_storeu_si128((__m128i *)(void *)(levels.of_row + 8 * half), level);
    }
    return levels;
}

static inline __m128i row_level(const row_levels *levels, int step)
{
    return _mm_set1_epi16(levels->of_row[step / 2]);
}

#include "blend.h"
