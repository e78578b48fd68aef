/* blend, AVX-512: a step is two rows of 16 pixels. Packing two rows of 32-bit coordinates leaves them in turns of
   four: r0 x 0..3, r1 x 0..3, r0 x 4..7, ... */
#include <immintrin.h>

#include "x86.h"

#define V __m512i
#define STEPS 8
#define V_SET1(x) _mm512_set1_epi16(x)
#define V_MUL(a, b) _mm512_mulhrs_epi16(a, b)
#define V_ADD(a, b) _mm512_add_epi16(a, b)
#define V_SUB(a, b) _mm512_sub_epi16(a, b)
#define V_MIN(a, b) _mm512_min_epi16(a, b)
#define V_ADD_SIGNED(a, b) _mm512_adds_epi16(a, b)
#define V_ADD_UNSIGNED(a, b) _mm512_adds_epu16(a, b)
#define V_NONE_OPEN(t) (_mm512_cmpgt_epi16_mask(t, _mm512_set1_epi16(FXS_CLOSED_Q15 - 1)) == 0)
#define V_COUNTED(x, level, limit, t) \
    _mm512_maskz_mov_epi16(_mm512_mask_cmple_epu16_mask( \
        _mm512_cmpgt_epi16_mask(t, _mm512_set1_epi16(FXS_CLOSED_Q15 - 1)), level, limit), x)
#define V_STORE_IN_ORDER(to, x) \
    _mm512_storeu_si512(to, _mm512_permutexvar_epi64(_mm512_set_epi64(7, 5, 3, 1, 6, 4, 2, 0), x))
#define BLEND_FUNCTION fxs_blend_avx512

static inline __m512i ramp(int32_t base, int32_t step)
{
    const __m512i iota = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    return _mm512_add_epi32(_mm512_set1_epi32(base), _mm512_mullo_epi32(_mm512_set1_epi32(step), iota));
}

typedef struct coordinates {
    __m512i even_q24, odd_q24, step_q24;
} coordinates;

static inline coordinates coordinates_at(int32_t u_q24, int32_t ux_q24, int32_t uy_q24, int step)
{
    coordinates c;
    c.even_q24 = ramp(u_q24 + 2 * step * uy_q24, ux_q24);
    c.odd_q24 = _mm512_add_epi32(c.even_q24, _mm512_set1_epi32(uy_q24));
    c.step_q24 = _mm512_set1_epi32(2 * uy_q24);
    return c;
}

static inline __m512i coordinates_next(coordinates *c, int step)
{
    (void)step;
    __m512i u = _mm512_packs_epi32(_mm512_srai_epi32(c->even_q24, 11), _mm512_srai_epi32(c->odd_q24, 11));
    c->even_q24 = _mm512_add_epi32(c->even_q24, c->step_q24);
    c->odd_q24 = _mm512_add_epi32(c->odd_q24, c->step_q24);
    return u;
}

typedef struct row_levels {
    __m512i of_row;                /* 16 levels in the low half */
} row_levels;

static inline row_levels row_levels_of(int32_t v_q24, int32_t vy_q24, uint16_t offset_q11)
{
    __m256i v = _mm512_cvtsepi32_epi16(_mm512_srai_epi32(ramp(v_q24, vy_q24), 11));
    __m256i level = _mm256_adds_epu16(_mm256_mulhrs_epi16(v, v), _mm256_set1_epi16((int16_t)offset_q11));
    return (row_levels){_mm512_castsi256_si512(level)};
}

static inline __m512i row_level(const row_levels *levels, int step)
{
    /* words: row 2 step four times, row 2 step + 1 four times, and so on */
    const __m512i turns = _mm512_set1_epi64(0x0001000100010001);
    __m512i which = _mm512_add_epi16(_mm512_set1_epi16((int16_t)(2 * step)),
                                     _mm512_maskz_mov_epi64(0xaa, turns));
    return _mm512_permutexvar_epi16(which, levels->of_row);
}

#include "blend.h"
