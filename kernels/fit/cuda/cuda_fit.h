/* Fit on NVIDIA GPUs: an engine (src/fit/engine.h) that keeps the model on devices. Same bytes as the CPU engine. */
#ifndef FXS_CUDA_FIT_H
#define FXS_CUDA_FIT_H

#include "src/fit/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Creates an engine for `model` on the devices in `options`. A batch's photographs are distributed over the devices;
   each has a copy of the model. Each device uses at most options->max_memory bytes (0: no limit). *self goes to
   engine->free. Errors: FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
int fxs_cuda_fit_engine(const fxs_fit_engine **engine, void **self, fxs_fit_model *model,
                        const fxs_fit_options *options, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
