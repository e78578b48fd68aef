/* Measures the sizes of Gaussians beyond the scene's radius as angles. Compiled for the CPU and for CUDA. */
#ifndef FXS_FIT_DISTANT_H
#define FXS_FIT_DISTANT_H

#include "fit_lanes.h"
#include "fit_stage.h"

/* Returns the unit of sizes of LANES Gaussians: 1 within the scene's radius, |position - middle| / radius beyond it. */
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
