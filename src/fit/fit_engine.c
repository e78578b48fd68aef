/* The engines: the processor, whose model is the fit's; and devices. */
#include <stdlib.h>

#include <fixsplat/backends.h>
#include <fixsplat/message.h>
#include "fit_internal.h"
#ifdef FXS_WITH_CUDA
#include "kernels/fit/cuda/cuda_fit.h"
#endif

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

/* The model is here, and what the stepper has is its own. */
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

static const fxs_fit_engine here = {"cpu", step, densify, relocate, order, reset_opacity, stay, stay, stay, quantise,
                                    leave};

int fxs_fit_choose_engine(fxs_fit *f, fxs_message *message)
{
    if (!f->options.device_count) {
        f->engine = &here;
        f->self = f;
        return 0;
    }
#ifdef FXS_WITH_CUDA
    const int error = fxs_cuda_fit_engine(&f->engine, &f->self, &f->model, &f->options, message);
    if (error)
        f->engine = NULL;
    return error;
#else
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, FXS_WITHOUT_CUDA);
#endif
}
