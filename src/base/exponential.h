/* e^x and ln x by + - * / alone, within 2 units in the last place. Unlike the functions of C libraries, they give the
 * same bits on every machine. */
#ifndef FXS_EXPONENTIAL_H
#define FXS_EXPONENTIAL_H

#include <math.h>

#define FXS_LN_2_HIGH 0x1.62e42fee00000p-1    /* its product with an integer up to 2^20 is exact */
#define FXS_LN_2_LOW 0x1.a39ef35793c76p-33

/* x = n ln 2 + r, |r| <= ln 2 / 2; e^r = 1 + r (1 + r / 2 (1 + r / 3 (...))), up to r^14. */
static inline double fxs_exp(double x)
{
    if (!(x > -746 && x < 710))
        return x > 0 ? INFINITY : x < 0 ? 0 : x;
    const double n = floor(x * 1.4426950408889634 + 0.5), r = (x - n * FXS_LN_2_HIGH) - n * FXS_LN_2_LOW;
    double sum = 1;
    for (int k = 14; k > 0; k--)
        sum = 1 + r / k * sum;
    return ldexp(sum, (int)n);
}

/* x = 2^n m, m in sqrt(1/2)..sqrt(2); ln m = 2 (s + s^3 / 3 + s^5 / 5 + ...), s = (m - 1) / (m + 1), up to s^23. */
static inline double fxs_log(double x)
{
    int n;
    if (!(x > 0 && x < INFINITY))
        return x > 0 ? x : x == 0 ? -INFINITY : NAN;
    double m = frexp(x, &n);
    if (m < 0.70710678118654752) {
        m *= 2;
        n--;
    }
    const double s = (m - 1) / (m + 1), s2 = s * s;
    double sum = 0;
    for (int k = 23; k > 0; k -= 2)
        sum = 1.0 / k + s2 * sum;
    return n * FXS_LN_2_HIGH + (2 * s * sum + n * FXS_LN_2_LOW);
}

#endif
