/* Access to the parameters of a single Gaussian, which are in planes (arrays with a float for each Gaussian). */
#ifndef FXS_FIT_PLANES_H
#define FXS_FIT_PLANES_H

#include "fit_lanes.h"
#include "src/fit/model.h"

static inline float *plane(const fxs_fit_model *m, int which)
{
    return m->parameters + (size_t)which * m->stride;
}

static inline float logit_of(float opacity)
{
    return ln(opacity / (1.0f - opacity));
}

static inline float opacity_at(const fxs_fit_model *m, size_t i)
{
    return 1.0f / (1.0f + exp_e(-plane(m, FXS_FIT_OPACITY)[i]));
}

#endif
