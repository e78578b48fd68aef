#define ISA c
#include "stages.h"

#include "../../kernels/kernels.h"

#if defined(__x86_64__) || defined(__i386__)
extern const fxs_fit_stages fxs_fit_stages_avx2, fxs_fit_stages_avx512;
#endif

const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu)
{
    const fxs_fit_stages *chosen = &fxs_fit_stages_c;
    cpu &= fxs_cpu_detect();
#if defined(__x86_64__) || defined(__i386__)
    if (cpu & FXS_CPU_AVX2)
        chosen = &fxs_fit_stages_avx2;
    if (cpu & FXS_CPU_AVX512)
        chosen = &fxs_fit_stages_avx512;
#endif
    return chosen;
}
