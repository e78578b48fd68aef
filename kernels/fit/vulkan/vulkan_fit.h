/* Fits Gaussians on a GPU through Vulkan 1.1, with the same results as on the CPU, byte for byte. */
#ifndef FXS_VULKAN_FIT_H
#define FXS_VULKAN_FIT_H

#include "src/fit/engine.h"

/* Creates an engine that fits `model` on the Vulkan device of number options->devices[0], in at most
   options->max_memory bytes of its memory (0: no limit). The device first computes a thousand test values. A device
   that does not compute as IEEE 754 asks is refused. (*engine)->free frees *self. Errors: FXS_ERR_DEVICE,
   FXS_ERR_UNSUPPORTED, FXS_ERR_MEMORY. */
int fxs_vulkan_fit_engine(const fxs_fit_engine **engine, void **self, fxs_fit_model *model,
                          const fxs_fit_options *options, fxs_message *why);

#endif
