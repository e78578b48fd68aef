/* Exposures of photographs. Before a rendered picture is compared with a photograph, each colour I becomes I M + m,
 * with a 3x3 matrix M and a row vector m. An affine exposure fits these 12 numbers by Adam (Inria's code, 2024).
 * Otherwise M is diagonal with 2^(e + r), 2^(e - (r + b)), 2^(e + b), and m is 0. The three numbers e, r, b move
 * towards the ratio of the sums of photograph and picture in each step. A scene's SH can take up a part of the
 * exposures that is linear in the camera's direction. So this part and the mean over the photographs stay as they
 * began. */
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

/* Returns the factor of Adam's step for number k of an affine exposure, a colour matrix M and an offset m. The factor
   is 1/4 off M's diagonal, so that brighter photographs do not become greyer. It is 1/32 for m, because its gradients
   in black areas are very large. */
static inline float gain_unit(int k)
{
    return gain_neutral(1, k) > 0 ? 1.0f : k < 9 ? 0.25f : 0.03125f;
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
    return is_affine || k < 6;
}

/* Returns the summand of sum k for a pixel, if the three numbers of an exposure are fitted: the exposed picture a for
   k = 0..2 and the photograph b for k = 3..5. Pixels with a saturated a or b do not count. */
static inline float gain_summand(int k, float a, float b)
{
    return a < 1 && b < 1 ? (k < 3 ? a : b) : 0.0f;
}

/* Returns number k of an affine exposure (M, m) after a step (W, w): M + M W, m + m W + w. */
static inline float affine_after(const fxs_fit_gain *gain, const float step[FXS_FIT_GAIN], int k)
{
    const float *of_row = gain->at + k / 3 * 3, *by = step + k % 3;
    const float moved = gain->at[k] + ((of_row[0] * by[0] + of_row[1] * by[3]) + of_row[2] * by[6]);
    return k < 9 ? moved : moved + by[9];
}

/* Makes a step of Adam for an affine exposure, with one second moment for the squared length of the gradient. With the
   exposed colour a = I M + m, sum 3 k + c is the mean of dL/da_c a_k over pixels and channels, and sum 9 + c of
   dL/da_c. These are the gradients by a step that maps a to a + a W + w. Moments are divided by the moments of a
   constant gradient of 1, as bias correction. decay: share of the difference from the neutral exposure to subtract
   (decoupled weight decay, Loshchilov and Hutter 2019). */
static inline void affine_step(fxs_fit_gain *gain, const float sums[FXS_FIT_GAIN], float rate, float decay,
                               float next[FXS_FIT_GAIN])
{
    float step[FXS_FIT_GAIN], square = 0;
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        square += (gain_unit(k) * sums[k]) * (gain_unit(k) * sums[k]);
    gain->of_one[0] = gain->of_one[0] * 0.9f + 0.1f;
    gain->of_one[1] = gain->of_one[1] * 0.999f + 0.001f;
    gain->square = without_tiny(gain->square * 0.999f + square * 0.001f);
    const float share = rate / gain->of_one[0] / (root(gain->square / gain->of_one[1]) + 1e-15f);
    for (int k = 0; k < FXS_FIT_GAIN; k++) {
        gain->mean[k] = without_tiny(gain->mean[k] * 0.9f + gain_unit(k) * sums[k] * 0.1f);
        step[k] = -(share * gain->mean[k]) * gain_unit(k);
    }
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        next[k] = affine_after(gain, step, k) - decay * (gain->at[k] - gain_neutral(1, k));
}

/* Moves the three numbers of an exposure by the share `rate` of the way to the best gains, log2(sum b / sum a) for each
   channel. Unlike least squares, this does not underestimate gains if the picture a is still blurred. The constant
   0.0003 keeps the exposures of black photographs. */
static inline void factor_step(const fxs_fit_gain *gain, const float sums[FXS_FIT_GAIN], float rate,
                               float next[FXS_FIT_GAIN])
{
    float to[3];
    for (int c = 0; c < 3; c++)
        to[c] = 1.44269504f * ln((sums[3 + c] + 0.0003f) / (sums[c] + 0.0003f));
    const float all = ((to[0] + to[1]) + to[2]) / 3.0f;
    next[0] = gain->at[0] + rate * all;
    next[1] = gain->at[1] + rate * (to[0] - all);
    next[2] = gain->at[2] + rate * (to[2] - all);
}

/* Makes a step of an exposure. Adds its changes, times the photograph's row of the basis, to `moved`. */
static inline void gain_step(fxs_fit_gain *gain, int is_affine, const float sums[FXS_FIT_GAIN], float rate,
                             float decay, float moved[FXS_FIT_GAIN][FXS_FIT_BASIS])
{
    float next[FXS_FIT_GAIN];
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        if (!(absolute(sums[k]) < FXS_FIT_FARTHEST_GRADIENT))
            return;
    if (is_affine)
        affine_step(gain, sums, rate, decay, next);
    else
        factor_step(gain, sums, rate, next);
    for (int k = 0; k < gain_numbers(is_affine); k++) {
        next[k] = least(most(next[k], -FXS_FIT_GAIN_MOST), FXS_FIT_GAIN_MOST);
        for (int i = 0; i < FXS_FIT_BASIS; i++)
            moved[k][i] += (next[k] - gain->at[k]) * gain->basis[i];
        gain->at[k] = next[k];
    }
}

/* Removes the changes of a step from an exposure as far as they lie in the basis. */
static inline void gain_project(fxs_fit_gain *gain, int is_affine, float moved[FXS_FIT_GAIN][FXS_FIT_BASIS])
{
    const float *b = gain->basis;
    for (int k = 0; k < gain_numbers(is_affine); k++)
        gain->at[k] -= (moved[k][0] * b[0] + moved[k][1] * b[1]) + (moved[k][2] * b[2] + moved[k][3] * b[3]);
}

#endif
