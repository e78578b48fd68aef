/* The operations of the fit's texts (gaussian.h, tile.h, loss.h, ...) on LANES numbers. Without LANES it is the
 * instance of one, plain C. Others define LANES, ROOT and ANY first, as kernels/x86/fit_avx2.c: vectors of GCC and clang.
 * Every operation is that of IEEE single precision, one by one, so the instances have the same bytes. */
#ifndef FXS_FIT_LANES_H
#define FXS_FIT_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef LANES
#define LANES 1
typedef float real;
typedef int32_t whole;             /* also a mask: 0, or not */

static inline real root(real x)
{
    return sqrtf(x);
}

static inline real choose(whole which, real a, real b)
{
    return which ? a : b;
}

static inline int any(whole which)
{
    return which != 0;
}

static inline real all(float x)
{
    return x;
}

static inline real whole_to_real(whole x)
{
    return (float)x;
}

static inline real column_numbers(void)
{
    return 0;
}
#else
typedef float real __attribute__((vector_size(4 * LANES)));
typedef int32_t whole __attribute__((vector_size(4 * LANES)));   /* also a mask: 0 or -1 */

static inline real root(real x)
{
    return ROOT(x);
}

static inline int any(whole which)
{
    return ANY(which);
}

static inline real choose(whole which, real a, real b)
{
    return (real)((which & (whole)a) | (~which & (whole)b));
}

static inline real all(float x)
{
    return x - (real){0};
}

static inline real whole_to_real(whole x)
{
    return __builtin_convertvector(x, real);
}

/* 0, 1, 2, ... */
static inline real column_numbers(void)
{
    static const float numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    real x;
    memcpy(&x, numbers, sizeof x);
    return x;
}
#endif

static inline real load(const float *from)
{
    real x;
    memcpy(&x, from, sizeof x);
    return x;
}

static inline void store(float *to, real x)
{
    memcpy(to, &x, sizeof x);
}

static inline whole bits_of(real x)
{
    whole i;
    memcpy(&i, &x, sizeof i);
    return i;
}

static inline real real_of(whole i)
{
    real x;
    memcpy(&x, &i, sizeof x);
    return x;
}

static inline real least(real a, real b)
{
    return choose(a < b, a, b);
}

static inline real most(real a, real b)
{
    return choose(a > b, a, b);
}

/* 1 / x, to a rounding or two; x normal. Newton: y' = y (2 - x y), three times from an error of 1/8: a third of what a
   division takes. */
static inline real inverse(real x)
{
    real y = real_of(0x7ef311c7 - bits_of(x));
    for (int i = 0; i < 3; i++)
        y = y * (2.0f - x * y);
    return y;
}

/* 2^x; x in -126..127. A whole part by the rounding of an addition, and a polynomial of the rest, -1/2 to 1/2: relative
   error 2.5e-9 and rounding. */
static inline real exp_2(real x)
{
    const real n = x + 12582912.0f;
    const real f = x - (n - 12582912.0f);
    real p = f * 1.54614447e-4f + 1.34004282e-3f;
    p = p * f + 9.61805668e-3f;
    p = p * f + 5.55032723e-2f;
    p = p * f + 0.240226509f;
    p = p * f + 0.693147207f;
    p = p * f + 1.0f;
    return real_of(bits_of(p) + ((bits_of(n) - 0x4b400000) << 23));
}

/* e^x; x in -87..88 */
static inline real exp_e(real x)
{
    return exp_2(x * 1.44269504f);
}

/* ln x; x normal, above 0. x = 2^n m, m in sqrt(1/2)..sqrt(2); ln m = 2 (s + s^3 / 3 + s^5 / 5 + ...), s = (m - 1) / (m
   + 1), up to s^9: relative error 1e-8 and rounding. */
static inline real ln(real x)
{
    const whole n = (bits_of(x) - 0x3f3504f3) >> 23;
    const real m = real_of(bits_of(x) - (n << 23));
    const real s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
    real p = s2 * 0.111111111f + 0.142857143f;
    p = p * s2 + 0.2f;
    p = p * s2 + 0.333333333f;
    p = p * s2 + 1.0f;
    return whole_to_real(n) * 0.693147181f + 2.0f * s * p;
}

#endif
