/* Chooses the functions that pack scenes, for this processor's instruction sets. */
#include "src/pack/pack_stage.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

#ifdef FXS_KERNELS_X86
extern const fxs_pack_stages fxs_pack_stages_avx2;
#endif

const fxs_pack_stages *fxs_pack_stages_choose(unsigned cpu)
{
    const fxs_pack_stages *chosen = &fxs_pack_stages_c;
#ifdef FXS_KERNELS_X86
    if (cpu & fxs_cpu_detect() & FXS_CPU_AVX2)
        chosen = &fxs_pack_stages_avx2;
#endif
    (void)cpu;
    return chosen;
}
