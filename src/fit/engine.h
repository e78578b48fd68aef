/* An engine makes the steps of a fit: on the CPU (fit_engine.c) or on GPUs (kernels/fit/cuda).
 *
 * It is created for one model, which must not move in memory. The model's `count` is always current; its planes are
 * current after a fetch (on the CPU always). Functions return 0, or an error and a message. */
#ifndef FXS_FIT_ENGINE_H
#define FXS_FIT_ENGINE_H

#include "model.h"
#include "stepper.h"

typedef struct fxs_fit_engine {
    const char *name;
    /* Makes a step with the photographs of a batch. If `report` is null, the function may return before the step is
       complete. */
    int (*step)(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
                fxs_fit_report *report, fxs_message *message);
    /* As the functions of model.h. */
    int (*densify)(void *self, const fxs_fit_densify *densify, fxs_message *message);
    int (*relocate)(void *self, const fxs_fit_relocate *relocate, fxs_message *message);
    int (*order)(void *self, fxs_message *message);
    int (*reset_opacity)(void *self, float opacity, fxs_message *message);
    /* Update the model's planes on the host; fetch_masters only the masters of a model that has them. */
    int (*fetch)(void *self, fxs_message *message);
    int (*fetch_masters)(void *self, fxs_message *message);
    /* Takes over the model's planes after they were changed or replaced. */
    int (*give)(void *self, fxs_message *message);
    /* Quantises the masters again after the model's grid was changed, and sets the parameters to the result. */
    int (*quantise)(void *self, fxs_message *message);
    void (*free)(void *self);
} fxs_fit_engine;

#endif
