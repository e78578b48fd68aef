/* Interface of an engine, which computes the steps of a fit on the CPU or on GPUs. The fit's Gaussians (the model) must
 * not move in memory. On GPUs the arrays in host memory are current only after a fetch. Functions return 0, or an error
 * and a message. */
#ifndef FXS_FIT_ENGINE_H
#define FXS_FIT_ENGINE_H

#include "model.h"
#include "stepper.h"

typedef struct fxs_fit_engine {
    const char *name;
    /* Makes a fitting step with a batch of photographs. With a null report, the function may return before the step is
       complete. */
    int (*step)(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
                fxs_fit_report *report, fxs_message *message);
    int (*densify)(void *self, const fxs_fit_densify *densify, fxs_message *message);
    int (*relocate)(void *self, const fxs_fit_relocate *relocate, fxs_message *message);
    int (*order)(void *self, fxs_message *message);
    int (*reset_opacity)(void *self, float opacity, fxs_message *message);
    /* Copy the Gaussians' parameters from the device to host memory; fetch_masters copies only the exact parameters
       (before quantisation). */
    int (*fetch)(void *self, fxs_message *message);
    int (*fetch_masters)(void *self, fxs_message *message);
    /* Copies the Gaussians' parameters to the device after they were changed in host memory. */
    int (*give)(void *self, fxs_message *message);
    int (*quantise)(void *self, fxs_message *message);
    void (*free)(void *self);
} fxs_fit_engine;

#endif
