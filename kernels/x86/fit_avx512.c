#include <immintrin.h>
#define ISA avx512
#define LANES 16
#define ROOT(x) ((real)_mm512_sqrt_ps((__m512)(x)))
#define ANY(which) (_mm512_test_epi32_mask((__m512i)(which), (__m512i)(which)) != 0)
#include "../../port/fit/stages.h"
