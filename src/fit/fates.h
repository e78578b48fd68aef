/* Densification of one Gaussian. The processor and CUDA compile this same text. */
#ifndef FXS_FIT_FATES_H
#define FXS_FIT_FATES_H

#include "planes.h"
#include "random.h"

static inline float largest_scale(const fxs_fit_model *m, size_t i)
{
    const float x = plane(m, FXS_FIT_SCALE)[i], y = plane(m, FXS_FIT_SCALE + 1)[i], z = plane(m, FXS_FIT_SCALE + 2)[i];
    return exp_e(fmaxf(fmaxf(x, y), z));
}

/* The centre of a child is drawn from its parent's distribution; its scales are the parent's over 1.6. */
static inline void set_child(fxs_fit_model *m, size_t i, uint64_t seed, uint64_t step, uint64_t index)
{
    float q[4], r[3][3], at[3], length = 0;
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
        const uint64_t random[3] = {fxs_fit_random(seed, step, 16 * index + 3 * (uint64_t)k),
                                    fxs_fit_random(seed, step, 16 * index + 3 * (uint64_t)k + 1),
                                    fxs_fit_random(seed, step, 16 * index + 3 * (uint64_t)k + 2)};
        float *scale = &plane(m, FXS_FIT_SCALE + k)[i];
        at[k] = exp_e(*scale) * fxs_fit_normal(random);
        *scale -= 0.470003629f;    /* ln 1.6 */
    }
    for (int k = 0; k < 3; k++)
        plane(m, FXS_FIT_POSITION + k)[i] += (r[k][0] * at[0] + r[k][1] * at[1]) + r[k][2] * at[2];
}

/* The fates of a Gaussian: it is removed, stays, is cloned or is split. */
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

static inline uint8_t fate_of(const fxs_fit_model *m, const fxs_fit_densify *d, float least_logit, size_t i)
{
    const float scale = largest_scale(m, i);
    const int is_wanted = mean_gradient(m, i) >= d->gradient, is_split = is_wanted && scale > d->small;
    if (!(plane(m, FXS_FIT_OPACITY)[i] >= least_logit) || (is_split ? scale / 1.6f : scale) > d->large ||
        !has_rotation(m, i))
        return GOES;
    return is_split ? SPLIT : is_wanted ? CLONED : STAYS;
}

/* The fate of a candidate for a clone or split when there is no room for more Gaussians. */
static inline uint8_t fate_without_room(const fxs_fit_model *m, const fxs_fit_densify *d, size_t i)
{
    return largest_scale(m, i) > d->large ? GOES : STAYS;
}

#endif
