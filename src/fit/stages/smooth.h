/* Raises each scale to a lower limit, in proportion to a pixel's size in the sharpest photograph that sees the
 * Gaussian. This is the 3D smoothing filter of Yu et al. 2024 ("Mip-Splatting"), used as a bound. */
#ifndef FXS_FIT_SMOOTH_H
#define FXS_FIT_SMOOTH_H

#include "fit_gaussian.h"

#define FXS_FIT_SMOOTH 0.447213595f    /* sqrt(0.2) pixels */
#define FXS_FIT_BESIDE 0.15f       /* A centre outside a picture counts as seen up to this share of the picture's size
                                      away. */

/* Returns the smaller of least_so_far and depth / focal length (the size of a pixel there) if the camera sees the
   place. Else returns least_so_far. */
static inline real finest_of(const fxs_fit_camera *c, const real place[3], real least_so_far)
{
    const int32_t size[2] = {c->width, c->height};
    real offset[3], at[3];
    for (int i = 0; i < 3; i++)
        offset[i] = place[i] - c->eye[i];
    for (int i = 0; i < 3; i++)
        at[i] = (c->rotation[3 * i] * offset[0] + c->rotation[3 * i + 1] * offset[1]) +
                c->rotation[3 * i + 2] * offset[2];
    mask seen = below(all(c->near), at[2]);
    for (int i = 0; i < 2; i++) {
        const real pixel = c->focal[i] * at[i] + c->middle[i] * at[2];
        seen = both(seen, both(below(at[2] * (-FXS_FIT_BESIDE * (float)size[i]), pixel),
                               below(pixel, at[2] * ((1.0f + FXS_FIT_BESIDE) * (float)size[i]))));
    }
    const real own = at[2] / (c->focal[0] > c->focal[1] ? c->focal[0] : c->focal[1]);
    return choose(both(seen, below(own, least_so_far)), own, least_so_far);
}

static inline real place_along(const float *at, size_t stride, int i)
{
    return load(at + (FXS_FIT_POSITION + i) * (ptrdiff_t)stride);
}

/* Raises the scales of LANES Gaussians to sqrt(0.2) `divisor` finest, with `finest` the smallest depth / focal length
   of the cameras that see the centre. Gaussians that no camera sees have FXS_FIT_FARTHEST_PLACE, and keep their
   scales. */
static inline void raise_scales(real finest, int divisor, float *at, size_t stride)
{
    const mask is_seen = below(finest, all(FXS_FIT_FARTHEST_PLACE));
    const real low = ln(most(finest, all(1e-16f)) * (FXS_FIT_SMOOTH * (float)divisor));    /* range: -37.6..29 */
    for (int i = 0; i < 3; i++) {
        float *to = at + (FXS_FIT_SCALE + i) * (ptrdiff_t)stride;
        const real scale = load(to);
        store(to, choose(both(is_seen, below(scale, low)), low, scale));
    }
}

static inline void smooth_scales(const fxs_fit_cameras *cameras, int divisor, float *at, size_t stride)
{
    const real place[3] = {place_along(at, stride, 0), place_along(at, stride, 1), place_along(at, stride, 2)};
    real finest = all(FXS_FIT_FARTHEST_PLACE);
    for (uint32_t i = 0; i < cameras->count; i++)
        finest = finest_of(&cameras->of[i], place, finest);
    raise_scales(finest, divisor, at, stride);
}

#endif
