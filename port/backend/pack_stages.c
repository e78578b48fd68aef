/* Chooses the functions that pack scenes, for this processor's instruction sets. */
#include "src/pack/pack_stage.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

#if defined(FXS_WITH_KERNELS) && (defined(__x86_64__) || defined(__i386__))
extern const fxs_pack_stages fxs_pack_stages_avx2;
#endif

const fxs_pack_stages *fxs_pack_stages_choose(unsigned cpu)
{
    const fxs_pack_stages *chosen = &fxs_pack_stages_c;
#if defined(FXS_WITH_KERNELS) && (defined(__x86_64__) || defined(__i386__))
    if (cpu & fxs_cpu_detect() & FXS_CPU_AVX2)
        chosen = &fxs_pack_stages_avx2;
#endif
    (void)cpu;
    return chosen;
}
