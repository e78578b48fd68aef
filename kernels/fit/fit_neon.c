/* Compiles the stages of the fit in src/fit/stages/fit_isa.h for NEON on AArch64, with 4 lanes. */
#ifdef __aarch64__
#include <arm_neon.h>
#define ISA neon
#define LANES 4
#define MASK whole
#define ROOT(x) ((real)vsqrtq_f32((float32x4_t)(x)))
#define BELOW(a, b) ((a) < (b))
#define AT_MOST(a, b) ((a) <= (b))
#define ANY(which) (vmaxvq_u32((uint32x4_t)(which)) != 0)
#define CHOOSE(which, a, b) ((real)vbslq_f32((uint32x4_t)(which), (float32x4_t)(a), (float32x4_t)(b)))
#define BITS(which) vaddvq_u32((uint32x4_t)(which) & (uint32x4_t){1, 2, 4, 8})
#include "src/fit/stages/fit_isa.h"
#endif
