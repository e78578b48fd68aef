/* A step of the Adam optimiser (Kingma and Ba 2015) for LANES parameters at once. Also the gradients of the loss terms
 * that penalise opacity and scale. */
#ifndef FXS_FIT_ADAM_H
#define FXS_FIT_ADAM_H

#include "distant.h"
#include "fit_gaussian.h"

#define FXS_FIT_TINY 7.88860905e-31f    /* 2^-100 */

static inline real without_tiny(real x)
{
    return choose(below(absolute(x), all(FXS_FIT_TINY)), all(0), x);
}

static inline void adam_step(const fxs_fit_adam *adam, float rate, real g, real *at, real *mean, real *square)
{
    const real next_mean = without_tiny(*mean * 0.9f + g * 0.1f);
    const real next_square = without_tiny(*square * 0.999f + g * g * 0.001f);
    const real next = *at - rate * next_mean / (root(next_square * adam->correction) + adam->epsilon);
    *mean = next_mean;
    *square = next_square;
    *at = choose(below(absolute(next), all(FXS_FIT_FARTHEST_PLACE)), next, *at);
}

static inline real opacity_regularised(const fxs_fit_adam *adam, real gradient, real logit)
{
    const real opacity = 1.0f / (1.0f + exp_of_minus(logit));
    return gradient + adam->by_opacity * (opacity * (1.0f - opacity));
}

static inline real scale_regularised(const fxs_fit_adam *adam, real gradient, real ln_scale, real unit)
{
    return least(gradient + adam->by_scale * exp_e(ln_scale) / unit, all(FXS_FIT_FARTHEST_GRADIENT));
}

/* Returns the length of the loss gradient by a Gaussian's centre in the picture, which decides on densification.
   `centre` is the gradient per pixel of a sum over pixels and channels. The result is the gradient of the mean instead,
   per half the side of the picture. */
static inline real centre_gradient(const fxs_fit_camera *camera, const real centre[2])
{
    const real x = centre[0] * (1.0f / (6.0f * (float)camera->height));
    const real y = centre[1] * (1.0f / (6.0f * (float)camera->width));
    return root(x * x + y * y);
}

#endif
