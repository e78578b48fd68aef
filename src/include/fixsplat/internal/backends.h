/* Declares the library's back ends (ways to render frames on the processor or on a GPU). */
#ifndef FXS_INTERNAL_BACKENDS_H
#define FXS_INTERNAL_BACKENDS_H

#include <fixsplat/backend.h>

#ifdef __cplusplus
extern "C" {
#endif

FXS_EXPERIMENTAL extern const fxs_backend fxs_backend_cpu, fxs_backend_gles, fxs_backend_gles_fetch,
    fxs_backend_gles_compute,
                         fxs_backend_osmesa, fxs_backend_vulkan, fxs_backend_cuda;

#ifdef __cplusplus
}
#endif

#endif
