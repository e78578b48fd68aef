/* Compiles the fit's vector code in src/fit/fit_isa.h for AVX2, with 8 floats per vector. */
#include <immintrin.h>
#define ISA avx2
#define LANES 8
#define MASK whole
#define ROOT(x) ((real)_mm256_sqrt_ps((__m256)(x)))
#define BELOW(a, b) ((a) < (b))
#define AT_MOST(a, b) ((a) <= (b))
#define ANY(which) (!_mm256_testz_si256((__m256i)(which), (__m256i)(which)))
#define CHOOSE(which, a, b) ((real)_mm256_blendv_ps((__m256)(b), (__m256)(a), (__m256)(which)))
#define BITS(which) ((uint32_t)_mm256_movemask_ps((__m256)(which)))
#include "src/fit/fit_isa.h"
