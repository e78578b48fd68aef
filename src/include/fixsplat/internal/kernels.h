/* Faster versions of the rendering stages, chosen at run time for the processor's instruction sets. All versions give
 * the same bytes as plain C.
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

/* The processor with kernels that this file is compiled for. Kernels for x86 need compiler flags for each file, which
   Swift packages do not have (FXS_SAME_FLAGS). */
#if (defined(__x86_64__) || defined(__i386__)) && !defined(FXS_SAME_FLAGS)
#define FXS_KERNELS_X86
#elif defined(__aarch64__) && !defined(__AARCH64EB__)
#define FXS_KERNELS_AARCH64
#endif

enum fxs_cpu {
    FXS_CPU_SSE41 = 1,
    FXS_CPU_AVX2 = 2,
    FXS_CPU_AVX512 = 4,            /* instruction sets AVX-512 F, BW, DQ, VL, CD and VBMI */
    FXS_CPU_NEON = 8,
    FXS_CPU_MVE = 16,              /* Helium, the vector instructions of some Cortex-M processors */
    FXS_CPU_CORTEX_M = 32,         /* Cortex-M processors without the vector instructions Helium */
    FXS_CPU_SIMD128 = 64           /* WebAssembly */
};

/* Returns the instruction sets of the running processor, as flags of enum fxs_cpu. */
FXS_EXPERIMENTAL unsigned fxs_cpu_detect(void);

/* Returns the name of one instruction set flag, such as "avx2", or null for any other value. */
FXS_EXPERIMENTAL const char *fxs_cpu_name(unsigned flag);

/* Fills in *kernels with the fastest version of each rendering stage, for the instruction sets in `cpu` that the
   running processor has. A stage without a faster version gets plain C. */
FXS_EXPERIMENTAL void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu);

#ifdef __cplusplus
}
#endif

#endif
