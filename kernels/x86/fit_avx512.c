#include <immintrin.h>
#define ISA avx512
#define LANES 16
#define MASK __mmask16
#define ROOT(x) ((real)_mm512_sqrt_ps((__m512)(x)))
#define BELOW(a, b) _mm512_cmp_ps_mask((__m512)(a), (__m512)(b), _CMP_LT_OQ)
#define AT_MOST(a, b) _mm512_cmp_ps_mask((__m512)(a), (__m512)(b), _CMP_LE_OQ)
#define ANY(which) ((which) != 0)
#define CHOOSE(which, a, b) ((real)_mm512_mask_blend_ps(which, (__m512)(b), (__m512)(a)))
#include "../../port/fit/stages.h"
