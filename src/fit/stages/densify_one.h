/* Decides whether a Gaussian is cloned, split or removed, and splits it. Compiled for the CPU and for CUDA. */
#ifndef FXS_FIT_DENSIFY_ONE_H
#define FXS_FIT_DENSIFY_ONE_H

#include "distant.h"
#include "planes.h"

#define SPLIT_SHARE 0.707106781f    /* a child's largest sigma after a split, relative to the parent's */

static inline float largest_scale(const fxs_fit_model *m, size_t i)
{
    const float x = plane(m, FXS_FIT_SCALE)[i], y = plane(m, FXS_FIT_SCALE + 1)[i], z = plane(m, FXS_FIT_SCALE + 2)[i];
    return exp_e(fmaxf(fmaxf(x, y), z));
}

/* Turns a Gaussian into a child of a split along its longest axis, which gives two children; `side`, 1 or -1, chooses
   the child. A sigma s becomes s k, with k = 1 - (1 - 1 / sqrt(2)) (s / longest)^2 and the longest sigma. The centre
   moves by s sqrt(1 - k^2) along each axis, which keeps the variance. The opacity o becomes 1 - (1 - o)^(1 / sqrt(2)).
   Formulas: Brush, pull request 479. */
static inline void set_child(fxs_fit_model *m, size_t i, float side)
{
    float q[4], r[3][3], at[3], length = 0;
    const float longest = largest_scale(m, i), rest = 1.0f - opacity_at(m, i);
    for (int k = 0; k < 4; k++) {
        q[k] = plane(m, FXS_FIT_ROTATION + k)[i];
        length += q[k] * q[k];
    }
    length = sqrtf(length);
    for (int k = 0; k < 4; k++)
        q[k] /= length;
    const float w = q[0], x = q[1], y = q[2], z = q[3];
    const float rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                              {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                              {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(r, rows, sizeof r);
    for (int k = 0; k < 3; k++) {
        float *scale = &plane(m, FXS_FIT_SCALE + k)[i];
        const float sigma = exp_e(*scale), part = sigma / longest, kept = 1.0f - 0.292893219f * (part * part);
        at[k] = side * (sigma * sqrtf(1.0f - kept * kept));
        *scale += ln(kept);
    }
    for (int k = 0; k < 3; k++)
        plane(m, FXS_FIT_POSITION + k)[i] += (r[k][0] * at[0] + r[k][1] * at[1]) + r[k][2] * at[2];
    plane(m, FXS_FIT_OPACITY)[i] =
        logit_of(1.0f - exp_e(SPLIT_SHARE * ln(fmaxf(rest, 0x1p-24f))));
}

enum { GOES, STAYS, CLONED, SPLIT };

static inline float mean_gradient(const fxs_fit_model *m, size_t i)
{
    return m->views[i] > 0 ? m->by_centre[i] / m->views[i] : 0;
}

static inline int has_rotation(const fxs_fit_model *m, size_t i)
{
    float square = 0;
    for (int k = 0; k < 4; k++)
        square += plane(m, FXS_FIT_ROTATION + k)[i] * plane(m, FXS_FIT_ROTATION + k)[i];
    return square > 1e-20f;
}

/* Returns a Gaussian's largest scale. Beyond the scene's radius the scale is divided by the relative distance, so that
   it measures an angle. */
static inline float looked_at_scale(const fxs_fit_model *m, const fxs_fit_densify *d, size_t i)
{
    return largest_scale(m, i) / unit_at(&d->far, m->parameters + i, m->stride);
}

static inline uint8_t fate_of(const fxs_fit_model *m, const fxs_fit_densify *d, float least_logit, size_t i)
{
    const float scale = looked_at_scale(m, d, i);
    const int is_wanted = mean_gradient(m, i) >= d->gradient, is_split = is_wanted && scale > d->small;
    if (!(plane(m, FXS_FIT_OPACITY)[i] >= least_logit) || (is_split ? scale * SPLIT_SHARE : scale) > d->large ||
        !has_rotation(m, i))
        return GOES;
    return is_split ? SPLIT : is_wanted ? CLONED : STAYS;
}

static inline uint8_t fate_without_room(const fxs_fit_model *m, const fxs_fit_densify *d, size_t i)
{
    return looked_at_scale(m, d, i) > d->large ? GOES : STAYS;
}

#endif
