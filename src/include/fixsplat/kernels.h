/* Faster versions of the stages, chosen at run time. This folder can be deleted: src/ renders without it. */
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
unsigned fxs_cpu_detect(void);

/* The name of one flag, as in "avx2"; null for any other value. */
const char *fxs_cpu_name(unsigned flag);

/* Overwrites the stages of *kernels that have a version for one of the instruction sets in `cpu`, the best last. */
void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu);

#ifdef __cplusplus
}
#endif

#endif
