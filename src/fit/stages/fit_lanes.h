/* Arithmetic on vectors of LANES floats, or on single floats in plain C if LANES is undefined. For a new instruction
 * set, define the same macros as kernels/fit/fit_avx2.c. All operations are IEEE single precision, so all instruction
 * sets give the same bytes. */
#ifndef FXS_FIT_LANES_H
#define FXS_FIT_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <fixsplat/fixsplat.h>         /* before any arithmetic: its pragma forbids fused a * b + c */

#ifndef LANES
#define LANES 1
typedef float real;
typedef int32_t whole, mask;

static inline real root(real x)
{
    return sqrtf(x);
}

static inline mask below(real a, real b)
{
    return a < b;
}

static inline mask at_most(real a, real b)
{
    return a <= b;
}

static inline int any(mask which)
{
    return which != 0;
}

static inline real choose(mask which, real a, real b)
{
    return which ? a : b;
}

static inline uint32_t bits_of_mask(mask which)
{
    return which != 0;
}

static inline real all(float x)
{
    return x;
}

static inline whole real_to_whole(real x)
{
    return (whole)x;
}

static inline real whole_to_real(whole x)
{
    return (real)x;
}

static inline whole shifted_left(whole x, int bits)
{
    return (whole)((uint32_t)x << bits);
}

/* Returns a vector of the numbers first, first + 1, and so on. */
static inline real numbers_from(int first)
{
    return (real)first;
}
#else
typedef float real __attribute__((vector_size(4 * LANES)));
typedef int32_t whole __attribute__((vector_size(4 * LANES)));
typedef MASK mask;

static inline real root(real x)
{
    return ROOT(x);
}

static inline mask below(real a, real b)
{
    return BELOW(a, b);
}

static inline mask at_most(real a, real b)
{
    return AT_MOST(a, b);
}

static inline int any(mask which)
{
    return ANY(which);
}

static inline real choose(mask which, real a, real b)
{
    return CHOOSE(which, a, b);
}

static inline uint32_t bits_of_mask(mask which)
{
    return BITS(which);
}

static inline real all(float x)
{
    return x - (real){0};
}

/* Rounds each number x of a vector towards 0; x must be in -2^31..2^31 - 1. */
static inline whole real_to_whole(real x)
{
    return __builtin_convertvector(x, whole);
}

static inline real whole_to_real(whole x)
{
    return __builtin_convertvector(x, real);
}

static inline whole shifted_left(whole x, int bits)
{
    return x << bits;
}

static inline real numbers_from(int first)
{
    static const float numbers[32] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                      16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
    real x;
    memcpy(&x, numbers + first, sizeof x);
    return x;
}
#endif

static inline mask both(mask a, mask b)
{
    return (mask)(a & b);
}

static inline mask either(mask a, mask b)
{
    return (mask)(a | b);
}

/* Returns x in the lanes where the mask is set, 0 in the other lanes. */
static inline real keep(mask which, real x)
{
    return choose(which, x, all(0));
}

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
    return choose(below(a, b), a, b);
}

static inline real most(real a, real b)
{
    return choose(below(b, a), a, b);
}

static inline real absolute(real x)
{
    return real_of(bits_of(x) & 0x7fffffff);
}

/* Returns 2^-x for x in -127..126. Rounding splits off the integer part of x; a polynomial computes the power of the
   rest, -1/2..1/2. Relative error: 2e-7 plus rounding. */
static inline real exp_2_minus(real x)
{
    const real n = 12582912.0f - x;
    const real f = (12582912.0f - n) - x;
    real p = f * 0.00133813025f + 0.00966636852f;
    p = p * f + 0.0555038101f;
    p = p * f + 0.24022349f;
    p = p * f + 0.693147181f;
    p = p * f + 1.0f;
    return real_of(bits_of(p) + shifted_left(bits_of(n), 23));
}

/* Returns e^x for x in -87..88. */
static inline real exp_e(real x)
{
    return exp_2_minus(x * -1.44269504f);
}

/* Returns ln x for normal x above 0. With x = 2^n m, m in sqrt(1/2)..sqrt(2) and s = (m - 1) / (m + 1): ln m = 2 (s +
   s^3 / 3 + ... + s^9 / 9). Relative error: 1e-8 plus rounding. */
static inline real ln(real x)
{
    const whole n = (bits_of(x) - 0x3f3504f3) >> 23;
    const real m = real_of(bits_of(x) - shifted_left(n, 23));
    const real s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
    real p = s2 * 0.111111111f + 0.142857143f;
    p = p * s2 + 0.2f;
    p = p * s2 + 0.333333333f;
    p = p * s2 + 1.0f;
    return whole_to_real(n) * 0.693147181f + 2.0f * s * p;
}

#endif
