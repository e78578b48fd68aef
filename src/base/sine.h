/* Computes sines with only + - and *, with the same result on every machine. */
#ifndef FXS_SINE_H
#define FXS_SINE_H

#include <stdint.h>

/* Returns floor(x) for |x| < 2^62, faster than the function of the C library. */
static inline double fxs_floor(double x)
{
    const double towards_zero = (double)(int64_t)x;
    return towards_zero > x ? towards_zero - 1 : towards_zero;
}

/* Returns sin(2 pi t) by a Taylor series up to x^15, after t is reduced to -1/4 to 1/4. */
static inline double fxs_sine(double t)
{
    static const double taylor[] = {
        -7.6471637318198165e-13, 1.6059043836821615e-10, -2.5052108385441719e-8, 2.7557319223985891e-6,
        -1.9841269841269841e-4, 8.3333333333333333e-3, -0.16666666666666667, 1,
    };
    t -= fxs_floor(t + 0.5);
    t = t > 0.25 ? 0.5 - t : t < -0.25 ? -0.5 - t : t;
    const double x = 2 * 3.14159265358979324 * t;
    double sum = 0;
    for (int k = 0; k < 8; k++)
        sum = sum * (x * x) + taylor[k];
    return x * sum;
}

#endif
