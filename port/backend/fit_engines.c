/* Chooses what runs a fit of a scene: the fitting stages for this processor's instruction sets, CUDA, or Vulkan. */
#include <fixsplat/backend.h>
#include <fixsplat/internal/message.h>

#include "src/fit/fit_internal.h"
#include "without.h"
#ifdef FXS_WITH_CUDA
#include "kernels/fit/cuda/cuda_fit.h"
#endif
#ifdef FXS_WITH_VULKAN
#include "kernels/fit/vulkan/vulkan_fit.h"
#endif
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

static int open_cuda(fxs_fit *f, fxs_message *message)
{
#ifdef FXS_WITH_CUDA
    return fxs_cuda_fit_engine(&f->engine, &f->self, &f->model, &f->options, message);
#else
    (void)f;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, FXS_WITHOUT_CUDA);
#endif
}

static int open_vulkan(fxs_fit *f, fxs_message *message)
{
#ifdef FXS_WITH_VULKAN
    return fxs_vulkan_fit_engine(&f->engine, &f->self, &f->model, &f->options, message);
#else
    (void)f;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, FXS_WITHOUT_HEADERS("libvulkan-dev"));
#endif
}

int fxs_fit_choose_engine(fxs_fit *f, fxs_message *message)
{
    if (!f->options.device_count) {
        f->engine = &fxs_fit_engine_cpu;
        f->self = f;
        return 0;
    }
    const int error = f->options.vulkan ? open_vulkan(f, message) : open_cuda(f, message);
    if (error)
        f->engine = NULL;
    return error;
}

#ifdef FXS_KERNELS_X86
extern const fxs_fit_stages fxs_fit_stages_sse41, fxs_fit_stages_avx2, fxs_fit_stages_avx512;
#elif defined(FXS_KERNELS_AARCH64)
extern const fxs_fit_stages fxs_fit_stages_neon;
#endif

const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu)
{
    const fxs_fit_stages *chosen = &fxs_fit_stages_c;
#ifdef FXS_WITH_KERNELS
    cpu &= fxs_cpu_detect();
#ifdef FXS_KERNELS_X86
    if (cpu & FXS_CPU_SSE41)
        chosen = &fxs_fit_stages_sse41;
    if (cpu & FXS_CPU_AVX2)
        chosen = &fxs_fit_stages_avx2;
    if (cpu & FXS_CPU_AVX512)
        chosen = &fxs_fit_stages_avx512;
#elif defined(FXS_KERNELS_AARCH64)
    if (cpu & FXS_CPU_NEON)
        chosen = &fxs_fit_stages_neon;
#endif
#endif
    (void)cpu;
    return chosen;
}
