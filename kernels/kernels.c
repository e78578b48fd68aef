#include <fixsplat/kernels.h>
#include "kernels/simd/lanes/stages.h"

#if defined(__x86_64__) || defined(__i386__)
FXS_PROJECT(sse41);
FXS_PROJECT(avx2);
FXS_PROJECT(avx512);
FXS_SHADE(sse41);
FXS_SHADE(avx2);
FXS_SHADE(avx512);
FXS_BIN(sse41);
FXS_SPANS(sse41);
FXS_NOTE(sse41);
FXS_LIST(sse41);
FXS_BIN(avx2);
FXS_SPANS(avx2);
FXS_NOTE(avx2);
FXS_LIST(avx2);
FXS_BIN(avx512);
FXS_SPANS(avx512);
FXS_NOTE(avx512);
FXS_LIST(avx512);
FXS_SORT(avx512);
FXS_BLEND(sse41);
FXS_TRACE(sse41);
FXS_BLEND(avx2);
FXS_TRACE(avx2);
FXS_BLEND(avx512);
FXS_TRACE(avx512);
FXS_RESOLVE(sse41);
FXS_RESOLVE(avx2);

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
#elif defined(__aarch64__) && !defined(__AARCH64EB__)
FXS_PROJECT(neon);
FXS_SHADE(neon);
FXS_BIN(neon);
FXS_SPANS(neon);
FXS_NOTE(neon);
FXS_LIST(neon);
FXS_BLEND(neon);
FXS_TRACE(neon);
FXS_RESOLVE(neon);

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_NEON;           /* every AArch64 processor has it */
}
#elif defined(__ARM_FEATURE_MVE)
FXS_PROJECT(mve);
FXS_SHADE(mve);
FXS_BIN(mve);
FXS_SPANS(mve);
FXS_NOTE(mve);
FXS_LIST(mve);
FXS_BLEND(mve);
FXS_TRACE(mve);
FXS_RESOLVE(mve);

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_MVE;            /* whoever builds for it has it */
}
#elif __ARM_ARCH_PROFILE == 'M'
FXS_BLEND(cortexm);
FXS_RESOLVE(cortexm);

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_CORTEX_M;
}
#elif defined(__wasm_simd128__)
FXS_PROJECT(simd128);
FXS_SHADE(simd128);
FXS_BIN(simd128);
FXS_SPANS(simd128);
FXS_NOTE(simd128);
FXS_LIST(simd128);
FXS_BLEND(simd128);
FXS_TRACE(simd128);
FXS_RESOLVE(simd128);

unsigned fxs_cpu_detect(void)
{
    return FXS_CPU_SIMD128;        /* a module with it is refused where it is missing */
}
#else
unsigned fxs_cpu_detect(void)
{
    return 0;
}
#endif

const char *fxs_cpu_name(unsigned flag)
{
    switch (flag) {
    case FXS_CPU_SSE41: return "sse41";
    case FXS_CPU_AVX2: return "avx2";
    case FXS_CPU_AVX512: return "avx512";
    case FXS_CPU_NEON: return "neon";
    case FXS_CPU_MVE: return "mve";
    case FXS_CPU_CORTEX_M: return "cortexm";
    case FXS_CPU_SIMD128: return "simd128";
    default: return 0;
    }
}

#define USE(stage, function, isa) kernels->function = fxs_##function##_##isa, kernels->name[stage] = #isa

#define USE_LISTS(isa) kernels->spans = fxs_spans_##isa, kernels->note = fxs_note_##isa, kernels->list = fxs_list_##isa

void fxs_kernels_choose(fxs_kernels *kernels, unsigned cpu)
{
    cpu &= fxs_cpu_detect();
#if defined(__x86_64__) || defined(__i386__)
    if (cpu & FXS_CPU_SSE41) {
        USE(FXS_PROJECT, project, sse41);
        USE(FXS_SHADE, shade, sse41);
        USE(FXS_BIN, bin, sse41);
        USE_LISTS(sse41);
        USE(FXS_BLEND, blend, sse41);
        kernels->trace = fxs_trace_sse41;
        USE(FXS_RESOLVE, resolve, sse41);
    }
    if (cpu & FXS_CPU_AVX2) {
        USE(FXS_PROJECT, project, avx2);
        USE(FXS_SHADE, shade, avx2);
        USE(FXS_BIN, bin, avx2);
        USE_LISTS(avx2);
        USE(FXS_BLEND, blend, avx2);
        kernels->trace = fxs_trace_avx2;
        USE(FXS_RESOLVE, resolve, avx2);
    }
    if (cpu & FXS_CPU_AVX512) {
        USE(FXS_PROJECT, project, avx512);
        USE(FXS_SHADE, shade, avx512);
        USE(FXS_BIN, bin, avx512);
        USE_LISTS(avx512);
        USE(FXS_SORT, sort, avx512);
        USE(FXS_BLEND, blend, avx512);
        kernels->trace = fxs_trace_avx512;
    }
#elif defined(__aarch64__) && !defined(__AARCH64EB__)
    if (cpu & FXS_CPU_NEON) {
        USE(FXS_PROJECT, project, neon);
        USE(FXS_SHADE, shade, neon);
        USE(FXS_BIN, bin, neon);
        USE_LISTS(neon);
        USE(FXS_BLEND, blend, neon);
        kernels->trace = fxs_trace_neon;
        USE(FXS_RESOLVE, resolve, neon);
    }
#elif defined(__ARM_FEATURE_MVE)
    if (cpu & FXS_CPU_MVE) {
        USE(FXS_PROJECT, project, mve);
        USE(FXS_SHADE, shade, mve);
        USE(FXS_BIN, bin, mve);
        USE_LISTS(mve);
        USE(FXS_BLEND, blend, mve);
        kernels->trace = fxs_trace_mve;
        USE(FXS_RESOLVE, resolve, mve);
    }
#elif __ARM_ARCH_PROFILE == 'M'
    if (cpu & FXS_CPU_CORTEX_M) {
        USE(FXS_BLEND, blend, cortexm);
        USE(FXS_RESOLVE, resolve, cortexm);
    }
#elif defined(__wasm_simd128__)
    if (cpu & FXS_CPU_SIMD128) {
        USE(FXS_PROJECT, project, simd128);
        USE(FXS_SHADE, shade, simd128);
        USE(FXS_BIN, bin, simd128);
        USE_LISTS(simd128);
        USE(FXS_BLEND, blend, simd128);
        kernels->trace = fxs_trace_simd128;
        USE(FXS_RESOLVE, resolve, simd128);
    }
#else
    (void)kernels, (void)cpu;
#endif
}
