/* Faster versions of the stages, for the instruction sets of several processors, chosen at run time. The renderer does
   not need them: fxs_init fills in the plain C versions, which give the same bytes. */
#ifndef FXS_KERNELS_H
#define FXS_KERNELS_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

enum fxs_cpu {
    FXS_CPU_SSE41 = 1,
    FXS_CPU_AVX2 = 2,
    FXS_CPU_AVX512 = 4,            /* F, BW, DQ, VL, CD and VBMI */
    FXS_CPU_NEON = 8,
    FXS_CPU_MVE = 16,              /* Helium, of Cortex-M */
    FXS_CPU_CORTEX_M = 32,         /* Cortex-M without it */
    FXS_CPU_SIMD128 = 64           /* of WebAssembly */
};

/* What this processor has. */
FXS_API unsigned fxs_cpu_detect(void);

/* The name of one flag, as in "avx2"; null for any other value. */
FXS_API const char *fxs_cpu_name(unsigned flag);

/* Replaces the functions of *kernels by the best versions that there are for the instruction sets in `cpu` (of enum
   fxs_cpu, or'ed), as far as this processor has them. */
FXS_API void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu);

#ifdef __cplusplus
}
#endif

#endif
