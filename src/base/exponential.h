/* Computes e^x and ln x with only + - * and /, within 2 units in the last place. Results are the same on every
   machine. */
#ifndef FXS_EXPONENTIAL_H
#define FXS_EXPONENTIAL_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* upper bits of ln 2; the product with an integer up to 2^20 is exact */
#define FXS_LN_2_HIGH 0x1.62e42fee00000p-1
#define FXS_LN_2_LOW 0x1.a39ef35793c76p-33

/* Returns 2^n for n from -1022 to 1023. */
static inline double fxs_power_of_two(int n)
{
    const uint64_t bits = (uint64_t)(n + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* Returns x * 2^n. The result is exact unless it is subnormal. */
static inline double fxs_scaled(double x, int n)
{
    return n < -1021 || n > 1023 ? ldexp(x, n) : x * fxs_power_of_two(n);
}

/* Computes e^x = 2^n e^r for x from -746 to 710. Stores n in *exponent and returns e^r, with x = n ln 2 + r and |r| <=
   ln 2 / 2. The series is e^r = 1 + r (1 + r / 2 (1 + r / 3 (...))), up to r^14. r / 6 is computed from r / 3. */
static inline double fxs_exp_series(double x, int *exponent)
{
    const double scaled = x * 1.4426950408889634 + 0.5;
    const int n = (int)scaled - ((int)scaled > scaled);
    const double r = (x - n * FXS_LN_2_HIGH) - n * FXS_LN_2_LOW;
    const double r3 = r / 3, r5 = r / 5, r7 = r / 7, r9 = r / 9, r11 = r / 11, r13 = r / 13;
    double sum = 1 + r13 * (1 + r7 / 2);
    sum = 1 + r11 * (1 + r3 / 4 * sum);
    sum = 1 + r9 * (1 + r5 / 2 * sum);
    sum = 1 + r7 * (1 + r / 8 * sum);
    sum = 1 + r5 * (1 + r3 / 2 * sum);
    sum = 1 + r3 * (1 + r / 4 * sum);
    sum = 1 + r * (1 + r / 2 * sum);
    *exponent = n;
    return sum;
}

static inline double fxs_exp(double x)
{
    int exponent;
    if (!(x > -746 && x < 710))
        return x > 0 ? INFINITY : x < 0 ? 0 : x;
    const double series = fxs_exp_series(x, &exponent);
    return fxs_scaled(series, exponent);
}

/* Returns ln x. With x = 2^n m and m from sqrt(1/2) to sqrt(2), ln x = n ln 2 + ln m. The series is ln m = 2 (s + s^3 /
   3 + s^5 / 5 + ...), s = (m - 1) / (m + 1), up to s^23. */
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
