/* Faster versions of the stages, for the instruction sets of several processors, chosen at run time. They are optional:
   fxs_init fills in the plain C versions, which give the same bytes. */
#ifndef FXS_KERNELS_H
#define FXS_KERNELS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

enum fxs_cpu {
    FXS_CPU_SSE41 = 1,
    FXS_CPU_AVX2 = 2,
    FXS_CPU_AVX512 = 4,            /* F, BW, DQ, VL, CD and VBMI */
    FXS_CPU_NEON = 8,
    FXS_CPU_MVE = 16,              /* Helium, on Cortex-M */
    FXS_CPU_CORTEX_M = 32,         /* Cortex-M without Helium */
    FXS_CPU_SIMD128 = 64           /* WebAssembly */
};

/* The instruction sets of this processor, flags of enum fxs_cpu. */
FXS_API unsigned fxs_cpu_detect(void);

/* The name of one flag, such as "avx2"; null for any other value. */
FXS_API const char *fxs_cpu_name(unsigned flag);

/* Replaces the functions of *kernels by the best versions for the instruction sets in `cpu` (flags of enum fxs_cpu), as
   far as this processor has them. */
FXS_API void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu);

#ifdef __cplusplus
}
#endif

#endif
