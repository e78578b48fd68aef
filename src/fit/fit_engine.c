/* Computes the steps of a fit on the CPU, directly on the fit's Gaussians. */
#include <stdlib.h>

#include <fixsplat/internal/message.h>
#include "fit_internal.h"

static int fail(int error, fxs_message *message)
{
    return error ? fxs_fail_memory(message, "a fit", 0) : 0;
}

static int step(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
                fxs_fit_report *report, fxs_message *message)
{
    fxs_fit *f = self;
    fxs_fit_report unwanted;
    return fail(fxs_fit_stepper_step(f->stepper, &f->model, photographs, count, options, report ? report : &unwanted),
                message);
}

static int densify(void *self, const fxs_fit_densify *how, fxs_message *message)
{
    return fail(fxs_fit_model_densify(&((fxs_fit *)self)->model, how), message);
}

static int relocate(void *self, const fxs_fit_relocate *how, fxs_message *message)
{
    return fail(fxs_fit_model_relocate(&((fxs_fit *)self)->model, how), message);
}

static int order(void *self, fxs_message *message)
{
    return fail(fxs_fit_model_order(&((fxs_fit *)self)->model), message);
}

static int reset_opacity(void *self, float opacity, fxs_message *message)
{
    (void)message;
    fxs_fit_model_reset_opacity(&((fxs_fit *)self)->model, opacity);
    return 0;
}

/* Does nothing: on the CPU the Gaussians are always in host memory and need no copy. */
static int stay(void *self, fxs_message *message)
{
    (void)self, (void)message;
    return 0;
}

static int quantise(void *self, fxs_message *message)
{
    fxs_fit *f = self;
    (void)message;
    fxs_fit_quantise(f->stepper, &f->model);
    return 0;
}

static void leave(void *self)
{
    (void)self;
}

const fxs_fit_engine fxs_fit_engine_cpu = {"cpu", step, densify, relocate, order, reset_opacity, stay, stay, stay,
                                           quantise, leave};
