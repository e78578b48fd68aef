/* The library's back ends, by name. Stable from version 1.0 on. A program that renders on the processor:
 *
 *     const fxs_backend *cpu = fxs_backend_find("cpu");
 *     void *self;
 *     if (cpu->open(&self, &options, &why)) ...            options: all fields 0
 *     cpu->render(self, &request, NULL, &why);
 *     cpu->close(self); */
#ifndef FXS_BACKENDS_H
#define FXS_BACKENDS_H

#include "backend.h"

/* The message of the back end "cuda" in a build without nvcc. */
#ifdef _WIN32
#define FXS_WITHOUT_CUDA "not in the build for Windows"
#else
#define FXS_WITHOUT_CUDA "this build is without nvcc, the compiler of the CUDA toolkit"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A back end by number, from 0 on, the processor first; null beyond the last. The list is the same in every build: for
   a back end that the build lacks, `device` and `open` report the reason. */
FXS_API const fxs_backend *fxs_backend_at(int index);

/* A back end by name: cpu, auto (also the processor), gles, gles-fetch, gles-compute, osmesa, cuda; null for other
   names. */
FXS_API const fxs_backend *fxs_backend_find(const char *name);

FXS_API extern const fxs_backend fxs_backend_cpu, fxs_backend_gles, fxs_backend_gles_fetch, fxs_backend_gles_compute,
                         fxs_backend_osmesa, fxs_backend_cuda;

#ifdef __cplusplus
}
#endif

#endif
