/* Arithmetic of one splat (a projected Gaussian) at LANES pixels, in blending and in the backward pass. */
#ifndef FXS_FIT_PIXEL_H
#define FXS_FIT_PIXEL_H

#include "fit_lanes.h"
#include "fit_stage.h"

static inline mask takes_of(real level, real limit, real transmittance)
{
    return both(at_most(level, limit), at_most(all(FXS_FIT_CLOSED), transmittance));
}

/* Returns a splat's blending weight, transmittance times alpha, in the lanes of the mask `takes`; 0 in the other
   lanes. */
static inline real weight_of(mask takes, real level, real transmittance)
{
    return keep(takes, least(exp_2_minus(level), all(FXS_FIT_ALPHA_MOST)) * transmittance);
}

#ifndef FXS_FIT_ODDS
static inline real odds_of(real alpha)
{
    return alpha / (1.0f - alpha);
}
#endif

/* A pixel in the backward pass, after some splats from near to far. `behind` is the colour of everything further back
   times dL/dcolour. */
typedef struct passed_pixel {
    real transmittance, behind;
} passed_pixel;

/* Passes a splat in the backward pass. Returns h = -alpha dL/dalpha, with dL/dalpha = T (c . g) - behind / (1 - alpha).
   T: transmittance; c: the splat's colour; g: dL/dcolour of the pixel; of_colour: c . g. */
static inline real pass_splat(mask takes, real level, real of_colour, passed_pixel *p, real *weight)
{
    const real exact = exp_2_minus(level), alpha = least(exact, all(FXS_FIT_ALPHA_MOST));
    *weight = keep(takes, alpha * p->transmittance);
    const real own = keep(takes, *weight * of_colour);
    p->transmittance = p->transmittance - *weight;
    p->behind = p->behind - own;
    return keep(both(takes, below(exact, all(FXS_FIT_ALPHA_MOST))), p->behind * odds_of(alpha) - own);
}

static inline void sums_of(real h, real weight, real u, real v, real red, real green, real blue,
                           real sums[FXS_FIT_SUMS])
{
    const real hu = h * u, hv = h * v;
    sums[FXS_FIT_SUM] = h;
    sums[FXS_FIT_SUM_U] = hu;
    sums[FXS_FIT_SUM_V] = hv;
    sums[FXS_FIT_SUM_UU] = hu * u;
    sums[FXS_FIT_SUM_UV] = hu * v;
    sums[FXS_FIT_SUM_VV] = hv * v;
    sums[FXS_FIT_RED] = weight * red;
    sums[FXS_FIT_GREEN] = weight * green;
    sums[FXS_FIT_BLUE] = weight * blue;
}

#endif
