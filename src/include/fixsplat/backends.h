/* The library's back ends, by name. A program is fast from its first line with the processor's:
 *
 *     const fxs_backend *cpu = fxs_backend_find("cpu");
 *     void *self;
 *     if (cpu->open(&self, &options, &why)) ...            options: all 0
 *     cpu->render(self, &request, NULL, &why);
 *     cpu->close(self); */
#ifndef FXS_BACKENDS_H
#define FXS_BACKENDS_H

#include "backend.h"

/* Why a build without nvcc has no CUDA. */
#define FXS_WITHOUT_CUDA "this build is without nvcc, the compiler of the CUDA toolkit"

#ifdef __cplusplus
extern "C" {
#endif

/* From 0 on, the processor first; null beyond the last. One that this build is without is there all the same: its
   `device` and `open` say why, and what it would take. */
const fxs_backend *fxs_backend_at(int index);

/* By name: cpu, auto (the same), gles, gles-fetch, gles-quads, osmesa, cuda. Null where there is none of that name. */
const fxs_backend *fxs_backend_find(const char *name);

extern const fxs_backend fxs_backend_cpu, fxs_backend_gles, fxs_backend_gles_fetch, fxs_backend_gles_quads,
                         fxs_backend_osmesa, fxs_backend_cuda;

#ifdef __cplusplus
}
#endif

#endif
