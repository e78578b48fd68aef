/* The loss between a rendered picture and a photograph: the sum over pixels and channels of 0.8 |a - b| + 0.2 (1 -
 * SSIM(a, b)), with the picture a and the photograph b. SSIM: Wang et al. 2004, windows of 11x11, sigma 1.5, zeros
 * beyond the edges. Where the mask excludes a pixel, a = b = 0 and the gradient is 0. If exposures are fitted, a counts
 * as min(a, 1) where b is white, with gradient 0 if a > 1. */
#ifndef FXS_FIT_LOSS_H
#define FXS_FIT_LOSS_H

#include "fit_lanes.h"

#define FXS_FIT_WINDOW 11

/* Returns true where the photograph's value b is white (saturated) and the picture's value a is brighter. */
static inline mask is_beyond_white(real a, real b)
{
    return both(below(all(1), a), at_most(all(1), b));
}

static inline real recorded(real a, real b)
{
    return choose(is_beyond_white(a, b), all(1), a);
}

static inline float window_weight(int i)
{
    const float weights[FXS_FIT_WINDOW] = {0.00102838008f, 0.00759875814f, 0.0360007721f, 0.10936069f, 0.213005538f,
                                           0.266011725f, 0.213005538f, 0.10936069f, 0.0360007721f, 0.00759875814f,
                                           0.00102838008f};
    return weights[i];
}

static inline real window_sum(const float *at, ptrdiff_t step)
{
    real sum = load(at - 5 * step) * window_weight(0);
    for (int i = 1; i < FXS_FIT_WINDOW; i++)
        sum += load(at + (i - 5) * step) * window_weight(i);
    return sum;
}

typedef struct similarity {
    real value, by_mean, by_square, by_product;   /* value: SSIM; by_...: its derivatives by the window means of a, a^2
                                                     and ab */
} similarity;

/* Computes SSIM of picture a and photograph b from weighted window sums of a, b, a^2, b^2 and ab. */
static inline similarity similarity_of(real mean_a, real mean_b, real aa, real bb, real ab)
{
    const real c1 = all(0.0001f), c2 = all(0.0009f);
    const real product = mean_a * mean_b, squares = mean_a * mean_a + mean_b * mean_b;
    const real luminance = 2.0f * product + c1, structure = 2.0f * (ab - product) + c2;
    const real below_l = squares + c1, below_s = ((aa + bb) - squares) + c2;
    const real inverse = 1.0f / (below_l * below_s), value = luminance * structure * inverse;
    similarity s;
    s.value = value;
    s.by_product = 2.0f * luminance * inverse;
    s.by_square = -(value / below_s);
    s.by_mean = 2.0f * mean_b * (structure - luminance) * inverse -
                2.0f * mean_a * (value / below_l - value / below_s);
    return s;
}

/* Returns the loss gradient by a pixel a of the picture, with pixel b of the photograph: 0.8 sign(a - b) - 0.2 (by_mean
   + 2 a by_square + b by_product). The by_... are window sums of SSIM's derivatives. */
static inline real gradient_of(real a, real b, real by_mean, real by_square, real by_product)
{
    const real similar = (by_mean + 2.0f * a * by_square) + b * by_product;
    const real sign = choose(below(b, a), all(0.8f), keep(below(a, b), all(-0.8f)));
    return sign - 0.2f * similar;
}

#endif
