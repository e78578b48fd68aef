/* The exposure of photographs. The picture that is compared with a photograph is multiplied by its factors of red,
 * green and blue, 2^(e + r), 2^(e - (r + b)) and 2^(e + b). The processor and CUDA compile this same text. */
#ifndef FXS_FIT_EXPOSURE_H
#define FXS_FIT_EXPOSURE_H

#include "adam.h"

static inline void gain_factors(const fxs_fit_gain *gain, float factors[3])
{
    const float e = gain->at[0], r = gain->at[1], b = gain->at[2];
    factors[0] = exp_2_minus(-(e + r));
    factors[1] = exp_2_minus((r + b) - e);
    factors[2] = exp_2_minus(-(e + b));
}

/* The order of sums over rows and over photographs: number i is added to part i % GAIN_PARTS, in ascending order, and
   then these parts are added in order. Numbers are `step` apart. */
enum { GAIN_PARTS = 64, GAIN_STEP = sizeof(fxs_fit_gain) / sizeof(float) };

static inline double gain_part(const float *numbers, size_t step, size_t count, size_t part)
{
    double sum = 0;
    for (size_t i = part; i < count; i += GAIN_PARTS)
        sum += (double)numbers[i * step];
    return sum;
}

static inline float gain_sum(const double parts[GAIN_PARTS], double divisor)
{
    double sum = 0;
    for (int i = 0; i < GAIN_PARTS; i++)
        sum += parts[i];
    return (float)(sum / divisor);
}

/* A step of Adam. `of_channels`: for each channel the sum over pixels of dL/da a, with a the picture times its factor,
   over the number of pixels and channels. dL/de = ln 2 (red + green + blue), dL/dr = ln 2 (red - green), dL/db = ln 2
   (blue - green). The second moment is of the gradient's squared length, so that a number whose gradient is small
   beside the others' moves little; all are corrected by those of a gradient of 1. The rate is also the share of each
   number that is taken off (decoupled decay, Loshchilov and Hutter 2019), as a scene could else become brighter from
   one side, and the photographs from there darker. A gradient that is not finite, or beyond
   FXS_FIT_FARTHEST_GRADIENT, changes nothing. */
static inline void gain_step(fxs_fit_gain *gain, const float of_channels[3], float rate)
{
    const float red = of_channels[0], green = of_channels[1], blue = of_channels[2];
    const float gradient[3] = {0.693147181f * ((red + green) + blue), 0.693147181f * (red - green),
                               0.693147181f * (blue - green)};
    float square = 0;
    for (int k = 0; k < 3; k++) {
        if (!(absolute(gradient[k]) < FXS_FIT_FARTHEST_GRADIENT))
            return;
        square += gradient[k] * gradient[k];
    }
    gain->of_one[0] = gain->of_one[0] * 0.9f + 0.1f;
    gain->of_one[1] = gain->of_one[1] * 0.999f + 0.001f;
    gain->square = without_tiny(gain->square * 0.999f + square * 0.001f);
    const float share = rate / gain->of_one[0] / (root(gain->square / gain->of_one[1]) + 1e-15f);
    for (int k = 0; k < 3; k++) {
        gain->mean[k] = without_tiny(gain->mean[k] * 0.9f + gradient[k] * 0.1f);
        const float at = gain->at[k] * (1.0f - rate) - share * gain->mean[k];
        gain->at[k] = least(most(at, -FXS_FIT_GAIN_MOST), FXS_FIT_GAIN_MOST);
    }
}

#endif
