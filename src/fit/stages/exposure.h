/* Exposures of photographs. Before a rendered picture is compared with a photograph, each colour I becomes I M + m,
 * with a 3x3 matrix M and a row vector m. An affine exposure fits these 12 numbers (Inria's code, 2024). Otherwise
 * three numbers e, r, b are fitted: M is diagonal with 2^(e + r), 2^(e - (r + b)), 2^(e + b), and m is 0. */
#ifndef FXS_FIT_EXPOSURE_H
#define FXS_FIT_EXPOSURE_H

#include "adam.h"

static inline int gain_numbers(int is_affine)
{
    return is_affine ? FXS_FIT_GAIN : 3;
}

/* Returns number k of the neutral exposure, which changes no colour of the picture. */
static inline float gain_neutral(int is_affine, int k)
{
    return is_affine && k < 9 && k % 4 == 0 ? 1.0f : 0.0f;
}

/* Returns the factor of Adam's step for number k of an exposure, a colour matrix M and an offset m. The factor is 1/4
   off M's diagonal, so that brighter photographs do not become greyer. It is 1/32 for m, because its gradients in black
   areas are very large. */
static inline float gain_unit(int is_affine, int k)
{
    return !is_affine || gain_neutral(1, k) > 0 ? 1.0f : k < 9 ? 0.25f : 0.03125f;
}

static inline void gain_factors(const fxs_fit_gain *gain, int is_affine, float factors[FXS_FIT_GAIN])
{
    const float e = gain->at[0], r = gain->at[1], b = gain->at[2];
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        factors[k] = is_affine ? gain->at[k] : 0.0f;
    if (is_affine)
        return;
    factors[0] = exp_2_minus(-(e + r));
    factors[4] = exp_2_minus((r + b) - e);
    factors[8] = exp_2_minus(-(e + b));
}

/* Applies an exposure to a colour: returns a channel of I M + m, with colour I, matrix M and offset m. */
static inline float exposed(const float factors[FXS_FIT_GAIN], const float colour[3], int channel)
{
    const int m = channel;
    return ((colour[0] * factors[m] + colour[1] * factors[m + 3]) + colour[2] * factors[m + 6]) + factors[m + 9];
}

/* Returns the loss gradient by a channel of the rendered colour, from the gradient by the colour with exposure. */
static inline float gradient_before(const float factors[FXS_FIT_GAIN], const float gradient[3], int channel)
{
    const int m = 3 * channel;
    return (gradient[0] * factors[m] + gradient[1] * factors[m + 1]) + gradient[2] * factors[m + 2];
}

/* Number of partial sums in a sum over pixels or photographs. To fix the order of addition, number i is added to part i
   % GAIN_PARTS. Then the parts are added in order. */
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

static inline float gain_mean(const fxs_fit_gains *gains, int k)
{
    double parts[GAIN_PARTS];
    for (size_t i = 0; i < GAIN_PARTS; i++)
        parts[i] = gain_part(&gains->of->at[k], GAIN_STEP, gains->count, i);
    return gain_sum(parts, gains->count);
}

static inline int gain_needs(int is_affine, int k)
{
    return is_affine || (k < 9 && k % 4 == 0);
}

/* Computes the loss gradient by an exposure (matrix M, offset m) from means over all pixels and channels. With the
   exposed colour a = I M + m, mean 3 k + c is of dL/da_c a_k, and mean 9 + c is of dL/da_c. For an affine exposure, a
   step maps a to a + a W + w; the result is the gradient by W and w. Else, with red, green and blue the means of
   dL/da_c a_c, the result is: dL/de = ln 2 (red + green + blue), dL/dr = ln 2 (red - green), dL/db = ln 2 (blue -
   green). */
static inline void gain_gradient(int is_affine, const float sums[FXS_FIT_GAIN], float gradient[FXS_FIT_GAIN])
{
    const float red = sums[0], green = sums[4], blue = sums[8];
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        gradient[k] = is_affine ? gain_unit(1, k) * sums[k] : 0.0f;
    if (is_affine)
        return;
    gradient[0] = 0.693147181f * ((red + green) + blue);
    gradient[1] = 0.693147181f * (red - green);
    gradient[2] = 0.693147181f * (blue - green);
}

/* Returns number k of an exposure after an optimiser step. A step (W, w) changes an affine exposure (M, m) to (M + M W,
   m + m W + w). */
static inline float gain_after(const fxs_fit_gain *gain, int is_affine, const float step[FXS_FIT_GAIN], int k)
{
    const float *of_row = gain->at + k / 3 * 3, *by = step + k % 3;
    if (!is_affine)
        return gain->at[k] + step[k];
    const float moved = gain->at[k] + ((of_row[0] * by[0] + of_row[1] * by[3]) + of_row[2] * by[6]);
    return k < 9 ? moved : moved + by[9];
}

/* Makes a step of Adam for an exposure, with one second moment for the squared length of the gradient. Moments are
   divided by the moments of a constant gradient of 1, as bias correction. decay: share of the difference from the
   neutral exposure to subtract (decoupled weight decay, Loshchilov and Hutter 2019). */
static inline void gain_step(fxs_fit_gain *gain, int is_affine, const float sums[FXS_FIT_GAIN], float rate,
                             float decay)
{
    float gradient[FXS_FIT_GAIN], step[FXS_FIT_GAIN], next[FXS_FIT_GAIN], square = 0;
    const int numbers = gain_numbers(is_affine);
    gain_gradient(is_affine, sums, gradient);
    for (int k = 0; k < numbers; k++) {
        if (!(absolute(gradient[k]) < FXS_FIT_FARTHEST_GRADIENT))
            return;
        square += gradient[k] * gradient[k];
    }
    gain->of_one[0] = gain->of_one[0] * 0.9f + 0.1f;
    gain->of_one[1] = gain->of_one[1] * 0.999f + 0.001f;
    gain->square = without_tiny(gain->square * 0.999f + square * 0.001f);
    const float share = rate / gain->of_one[0] / (root(gain->square / gain->of_one[1]) + 1e-15f);
    for (int k = 0; k < numbers; k++) {
        gain->mean[k] = without_tiny(gain->mean[k] * 0.9f + gradient[k] * 0.1f);
        step[k] = -(share * gain->mean[k]) * gain_unit(is_affine, k);
    }
    for (int k = 0; k < numbers; k++)
        next[k] = gain_after(gain, is_affine, step, k) - decay * (gain->at[k] - gain_neutral(is_affine, k));
    for (int k = 0; k < numbers; k++)
        gain->at[k] = least(most(next[k], -FXS_FIT_GAIN_MOST), FXS_FIT_GAIN_MOST);
}

#endif
