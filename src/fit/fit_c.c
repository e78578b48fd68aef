#define ISA c
#include "fit_stages.h"

#ifdef FXS_WITH_KERNELS
#include <fixsplat/kernels.h>

#if defined(__x86_64__) || defined(__i386__)
extern const fxs_fit_stages fxs_fit_stages_sse41, fxs_fit_stages_avx2, fxs_fit_stages_avx512;
#elif defined(__aarch64__) && !defined(__AARCH64EB__)
extern const fxs_fit_stages fxs_fit_stages_neon;
#endif

const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu)
{
    const fxs_fit_stages *chosen = &fxs_fit_stages_c;
    cpu &= fxs_cpu_detect();
#if defined(__x86_64__) || defined(__i386__)
    if (cpu & FXS_CPU_SSE41)
        chosen = &fxs_fit_stages_sse41;
    if (cpu & FXS_CPU_AVX2)
        chosen = &fxs_fit_stages_avx2;
    if (cpu & FXS_CPU_AVX512)
        chosen = &fxs_fit_stages_avx512;
#elif defined(__aarch64__) && !defined(__AARCH64EB__)
    if (cpu & FXS_CPU_NEON)
        chosen = &fxs_fit_stages_neon;
#endif
    return chosen;
}
#else
const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu)
{
    (void)cpu;
    return &fxs_fit_stages_c;
}
#endif
