/* Computes the place of a Gaussian's centre on a Morton curve. Compiled for the CPU and for CUDA. */
#ifndef FXS_FIT_CURVE_H
#define FXS_FIT_CURVE_H

#include "planes.h"

/* Number of partial sums in a sum over all Gaussians. To fix the order of addition, number i is added to partial sum i
   % CURVE_SUMS. Then the partial sums are added in order. */
enum { CURVE_SUMS = 1024 };

typedef struct curve {
    float middle[3], spread;
} curve;

static inline double curve_term(float x, const float *middle)
{
    return middle ? fabs((double)(x - *middle)) : (double)x;
}

static inline double curve_sum(const double sums[CURVE_SUMS])
{
    double sum = 0;
    for (int i = 0; i < CURVE_SUMS; i++)
        sum += sums[i];
    return sum;
}

static inline float curve_middle(double sum, size_t count)
{
    return (float)(sum / (double)count);
}

static inline float curve_spread(const double sums[3], size_t count)
{
    return (float)((sums[0] + sums[1] + sums[2]) / (3 * (double)count) + 1e-6);
}

static inline uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
}

/* Returns the Morton code of a Gaussian's centre. Coordinates x become x / (1 + |x|), so that distant centres share the
   outer cells. */
static inline uint32_t code_of(const fxs_fit_model *m, const curve *of, size_t i)
{
    uint32_t code = 0;
    for (int k = 0; k < 3; k++) {
        const float x = (plane(m, FXS_FIT_POSITION + k)[i] - of->middle[k]) / of->spread, y = x / (1.0f + fabsf(x));
        code |= spread_bits(y > -1 ? (uint32_t)((y + 1.0f) * 511.5f) : 0) << k;    /* A coordinate that is NaN goes to
                                                                                      cell 0. */
    }
    return code;
}

#endif
