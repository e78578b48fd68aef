/* Beyond a radius, sizes are measured as angles from the cameras. Compiled for the CPU and for CUDA. */
#ifndef FXS_FIT_DISTANT_H
#define FXS_FIT_DISTANT_H

#include "fit_lanes.h"
#include "fit_stage.h"

/* The unit of sizes for LANES Gaussians: 1 up to far->radius from the middle, beyond it |p - middle| / radius. */
static inline real unit_at(const fxs_fit_far *far, const float *at, size_t stride)
{
    real square = all(0);
    for (int k = 0; k < 3; k++) {
        const real away = load(at + (FXS_FIT_POSITION + k) * (ptrdiff_t)stride) - far->middle[k];
        square += away * away;
    }
    return most(root(square) * far->inverse, all(1));
}

#endif
