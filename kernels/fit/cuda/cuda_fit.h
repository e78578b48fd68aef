/* Fits on NVIDIA GPUs: the engine of src/fit/engine.h whose model is on a device, with the same bytes. */
#ifndef FXS_CUDA_FIT_H
#define FXS_CUDA_FIT_H

#include "src/fit/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An engine for `model`, on the devices that `options` names: a batch's photographs are shared out among them, and each
   has a copy of the model. What is taken of each device is at most options->max_memory bytes (0: any). *self is for
   engine->free. Errors: FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
int fxs_cuda_fit_engine(const fxs_fit_engine **engine, void **self, fxs_fit_model *model,
                        const fxs_fit_options *options, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
