/* Faster versions of the stages, for the instruction sets of several processors, chosen at run time. They give the same
 * bytes as the plain C versions.
 *
 *     static fxs_kernels fastest;
 *     fxs_kernels_choose(&fastest, fxs_cpu_detect());
 *     config.kernels = &fastest; */
#ifndef FXS_KERNELS_H
#define FXS_KERNELS_H

#include <fixsplat/fixsplat.h>
#include <fixsplat/internal/stage.h>

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

/* Fills in *kernels: for each stage the best version for the instruction sets in `cpu` (flags of enum fxs_cpu) that this
   processor has, else the plain C version. */
FXS_API void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu);

#ifdef __cplusplus
}
#endif

#endif
