/* Declares the versions of the rendering stages for each processor, and chooses among them at run time. */
#include <fixsplat/internal/kernels.h>
#include "kernels/simd/lanes/stages.h"

/* Lists of each processor's instruction sets, slowest first: SET(flag, name, functions of the rendering stages). */
#define X86(SET, X) \
    SET(SSE41, sse41, FXS_VECTOR_STAGES(X, sse41) FXS_RESOLVE_STAGE(X, sse41)) \
    SET(AVX2, avx2, FXS_VECTOR_STAGES(X, avx2) FXS_RESOLVE_STAGE(X, avx2)) \
    SET(AVX512, avx512, FXS_VECTOR_STAGES(X, avx512) FXS_SORT_STAGE(X, avx512))
#define AARCH64(SET, X) SET(NEON, neon, FXS_VECTOR_STAGES(X, neon) FXS_RESOLVE_STAGE(X, neon))
#define HELIUM(SET, X) SET(MVE, mve, FXS_VECTOR_STAGES(X, mve) FXS_RESOLVE_STAGE(X, mve))
#define CORTEX_M(SET, X) SET(CORTEX_M, cortexm, FXS_BLEND_STAGE(X, cortexm) FXS_RESOLVE_STAGE(X, cortexm))
#define WEBASSEMBLY(SET, X) SET(SIMD128, simd128, FXS_VECTOR_STAGES(X, simd128) FXS_RESOLVE_STAGE(X, simd128))
#define OTHER(SET, X)

#if defined(FXS_KERNELS_X86)
#define PROCESSOR X86

unsigned fxs_cpu_detect(void)
{
    unsigned cpu = 0;
    __builtin_cpu_init();
    if (__builtin_cpu_supports("sse4.1"))
        cpu |= FXS_CPU_SSE41;
    if (__builtin_cpu_supports("avx2"))
        cpu |= FXS_CPU_AVX2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512vbmi"))
        cpu |= FXS_CPU_AVX512;
    return cpu;
}
#elif defined(FXS_KERNELS_AARCH64)
#define PROCESSOR AARCH64

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_NEON;
}
#elif defined(__ARM_FEATURE_MVE)
#define PROCESSOR HELIUM

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_MVE;
}
#elif __ARM_ARCH_PROFILE == 'M'
#define PROCESSOR CORTEX_M

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_CORTEX_M;
}
#elif defined(__wasm_simd128__)
#define PROCESSOR WEBASSEMBLY

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_SIMD128;      /* a check is not needed, because a WebAssembly host without SIMD rejects the module */
}
#else
#define PROCESSOR OTHER

unsigned fxs_cpu_detect(void)
{
    return 0;
}
#endif

#define NAME_SET(flag, isa, versions) case FXS_CPU_##flag: return #isa;

const char *fxs_cpu_name(unsigned flag)
{
    switch (flag) {
    X86(NAME_SET, )
    AARCH64(NAME_SET, )
    HELIUM(NAME_SET, )
    CORTEX_M(NAME_SET, )
    WEBASSEMBLY(NAME_SET, )
    default: return 0;
    }
}

#define DECLARE(head, stage, function, isa) head(isa);
#define DECLARE_SET(flag, isa, versions) versions

PROCESSOR(DECLARE_SET, DECLARE)

#define USE(head, stage, function, isa) kernels->function = fxs_##function##_##isa, kernels->name[stage] = #isa;
#define USE_SET(flag, isa, versions) if (cpu & FXS_CPU_##flag) { versions }

void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu)
{
    cpu &= fxs_cpu_detect();
    (void)cpu;                     /* avoids a warning on processors without their own versions of the stages */
    *kernels = fxs_kernels_c;
    PROCESSOR(USE_SET, USE)
}
