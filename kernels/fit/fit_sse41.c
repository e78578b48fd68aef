/* Compiles the fit's vector code in src/fit/fit_isa.h for SSE4.1, with 4 floats per vector. */
#include <smmintrin.h>
#define ISA sse41
#define LANES 4
#define MASK whole
#define ROOT(x) ((real)_mm_sqrt_ps((__m128)(x)))
#define BELOW(a, b) ((a) < (b))
#define AT_MOST(a, b) ((a) <= (b))
#define ANY(which) (!_mm_testz_si128((__m128i)(which), (__m128i)(which)))
#define CHOOSE(which, a, b) ((real)_mm_blendv_ps((__m128)(b), (__m128)(a), (__m128)(which)))
#define BITS(which) ((uint32_t)_mm_movemask_ps((__m128)(which)))
#include "src/fit/fit_isa.h"
