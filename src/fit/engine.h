/* Interface of an engine, which computes the steps of a fit on the CPU or on GPUs. The engine's model must not move in
 * memory. On GPUs the model's planes are current only after a fetch. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_ENGINE_H
#define FXS_FIT_ENGINE_H

#include "model.h"
#include "stepper.h"

typedef struct fxs_fit_engine {
    const char *name;
    /* Makes a step with a batch of photographs. report null: may return before the step is complete. */
    int (*step)(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
                fxs_fit_report *report, fxs_message *message);
    int (*densify)(void *self, const fxs_fit_densify *densify, fxs_message *message);
    int (*relocate)(void *self, const fxs_fit_relocate *relocate, fxs_message *message);
    int (*order)(void *self, fxs_message *message);
    int (*reset_opacity)(void *self, float opacity, fxs_message *message);
    /* Update the model's parameters on the host; fetch_masters only the parameters before quantisation. */
    int (*fetch)(void *self, fxs_message *message);
    int (*fetch_masters)(void *self, fxs_message *message);
    /* Takes over the model's parameters after the host changed them. */
    int (*give)(void *self, fxs_message *message);
    int (*quantise)(void *self, fxs_message *message);
    void (*free)(void *self);
} fxs_fit_engine;

#endif
