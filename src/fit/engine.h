/* What makes the steps of a fit: the processor (fit_engine.c), or GPUs (kernels/cuda/fit).
 *
 * An engine is made for one model, which stays where it is. The model's `count` is always right. Its planes are those
 * of the last fetch; the processor has no others. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_ENGINE_H
#define FXS_FIT_ENGINE_H

#include "model.h"
#include "stepper.h"

typedef struct fxs_fit_engine {
    const char *name;
    /* A step by the photographs of a batch. `report` may be null: then it need not be complete when this returns. */
    int (*step)(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
                fxs_fit_report *report, fxs_message *message);
    /* As the functions of model.h. */
    int (*densify)(void *self, const fxs_fit_densify *densify, fxs_message *message);
    int (*relocate)(void *self, const fxs_fit_relocate *relocate, fxs_message *message);
    int (*order)(void *self, fxs_message *message);
    int (*reset_opacity)(void *self, float opacity, fxs_message *message);
    /* The model's planes become what they are now; or the masters alone, of a model that has them. */
    int (*fetch)(void *self, fxs_message *message);
    int (*fetch_masters)(void *self, fxs_message *message);
    /* The model's planes were changed, or are others: so they are from now on. */
    int (*give)(void *self, fxs_message *message);
    /* The model's grid was changed: the parameters become what it makes of the masters. */
    int (*quantise)(void *self, fxs_message *message);
    void (*free)(void *self);
} fxs_fit_engine;

#endif
