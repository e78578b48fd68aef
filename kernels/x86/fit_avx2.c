#include <immintrin.h>
#define ISA avx2
#define LANES 8
#define ROOT(x) ((real)_mm256_sqrt_ps((__m256)(x)))
#define ANY(which) (!_mm256_testz_si256((__m256i)(which), (__m256i)(which)))
#include "../../port/fit/stages.h"
