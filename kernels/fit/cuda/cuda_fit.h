/* Fits Gaussians on NVIDIA GPUs, with the same results as on the CPU, byte for byte. */
#ifndef FXS_CUDA_FIT_H
#define FXS_CUDA_FIT_H

#include "src/fit/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Creates an engine that fits `model` on the GPUs given in `options`. Each GPU holds the whole model and computes a
   share of each batch's photographs, in at most options->max_memory bytes (0: no limit). (*engine)->free frees *self.
   Errors: FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
int fxs_cuda_fit_engine(const fxs_fit_engine **engine, void **self, fxs_fit_model *model,
                        const fxs_fit_options *options, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
