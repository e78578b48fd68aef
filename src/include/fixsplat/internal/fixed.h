/* Integer arithmetic for the rendering stages before blending. A mantissa m stands for m * 2^-32: m is in [2^31, 2^32),
   or in [2^30, 2^32) where the exponent must be even. docs/numbers.md derives the error bounds. */
#ifndef FXS_FIXED_H
#define FXS_FIXED_H

#include <stdint.h>

#if defined(__GNUC__)
#define FXS_PREFETCH(address) __builtin_prefetch(address)
#else
#define FXS_PREFETCH(address) ((void)0)
#endif

/* Relaxed atomic access to a flag that several threads share. */
#if defined(__GNUC__)
#define FXS_SHARED_READ(x) __atomic_load_n(&(x), __ATOMIC_RELAXED)
#define FXS_SHARED_WRITE(x, to) __atomic_store_n(&(x), to, __ATOMIC_RELAXED)
#else
#define FXS_SHARED_READ(x) (*(volatile int *)&(x))
#define FXS_SHARED_WRITE(x, to) (*(volatile int *)&(x) = (to))
#endif

/* Counts the leading zero bits of x, which must be above 0. */
static inline int fxs_clz32(uint32_t x)
{
#if defined(__CUDA_ARCH__)
    return __clz((int)x);
#elif defined(__GNUC__)
    return __builtin_clz(x);
#else
    int n = 0;
    for (; !(x >> 31); x <<= 1)
        n++;
    return n;
#endif
}

static inline int fxs_clz64(uint64_t x)
{
    return x >> 32 ? fxs_clz32((uint32_t)(x >> 32)) : 32 + fxs_clz32((uint32_t)x);
}

/* Counts the trailing zero bits of x, which must be above 0. */
static inline int fxs_ctz32(uint32_t x)
{
    return 31 - fxs_clz32(x & -x);
}

static inline int fxs_ctz64(uint64_t x)
{
    return (uint32_t)x ? fxs_ctz32((uint32_t)x) : 32 + fxs_ctz32((uint32_t)(x >> 32));
}

#define FXS_ONE_Q32 ((int64_t)1 << 32)

/* A positive scale factor: mantissa * 2^(exponent - 31), with the mantissa in [2^31, 2^32). */
typedef struct fxs_scale {
    uint32_t mantissa;
    int32_t exponent;
} fxs_scale;

/* Converts a scale factor in Q32, which must be above 0, to mantissa and exponent. */
static inline fxs_scale fxs_scale_of(int64_t scale_q32)
{
    const int zeros = fxs_clz64((uint64_t)scale_q32);
    const fxs_scale scale = {(uint32_t)((uint64_t)scale_q32 << zeros >> 32), 31 - zeros};
    return scale;
}

/* Returns the high half of the 64-bit product a * b. */
static inline uint32_t fxs_mulhi(uint32_t a, uint32_t b)
{
#if defined(__CUDA_ARCH__)         /* inline assembly, which saves an instruction with nvcc */
    uint32_t high;
    asm("{ .reg .b32 low; .reg .b64 whole; mul.wide.u32 whole, %1, %2; mov.b64 {low, %0}, whole; }"
        : "=r"(high) : "r"(a), "r"(b));
    return high;
#else
    return (uint32_t)((uint64_t)a * b >> 32);
#endif
}

/* Returns a * b + c, exact in 64 bits. */
static inline int64_t fxs_mul_add(int32_t a, int32_t b, int64_t c)
{
#if defined(__CUDA_ARCH__)         /* inline assembly, because nvcc would widen both factors to 64 bits */
    int64_t sum;
    asm("mad.wide.s32 %0, %1, %2, %3;" : "=l"(sum) : "r"(a), "r"(b), "l"(c));
    return sum;
#else
    return (int64_t)a * b + c;
#endif
}

/* Returns x * 2^-shift, rounded down. `shift` is 0 or more, also above 31. */
static inline uint32_t fxs_shift_down(uint32_t x, int shift)
{
#if defined(__CUDA_ARCH__)         /* CUDA's shift instruction accepts any count, also above 31 */
    uint32_t left;
    asm("shr.u32 %0, %1, %2;" : "=r"(left) : "r"(x), "r"(shift));
    return left;
#else
    return shift > 31 ? 0 : x >> shift;
#endif
}

/* Returns x * 2^-shift, rounded to nearest, halves up. `shift` is 1 to 62. */
static inline int64_t fxs_round_shift(int64_t x, int shift)
{
    return ((x >> (shift - 1)) + 1) >> 1;
}

static inline int32_t fxs_clamp(int32_t x, int32_t low, int32_t high)
{
    return x < low ? low : x > high ? high : x;
}

/* Reciprocal: returns about 2^62 / m, in [2^30, 2^31), for m in [2^31, 2^32). With x = m * 2^-32, Newton's method from
   48/17 - 32/17 x (error 1/17), three times: y' = y (2 - x y). fxs_mulhi of doubled factors below 2^31 gives a product
   over 2^30. */
static inline uint32_t fxs_reciprocal(uint32_t m)
{
    uint32_t y_q30 = 3031741620u - fxs_mulhi(m, 2021161081u);
    for (int i = 0; i < 3; i++)
        y_q30 = fxs_mulhi(2 * y_q30, 2 * (0x80000000u - fxs_mulhi(m, y_q30)));
    return y_q30;
}

/* Reciprocal square root: returns about 1 / sqrt(m * 2^-32) in Q30, in [2^30 - 1024, 2^31), for m in [2^30, 2^32). With
   x = m * 2^-32, Newton's method from 2.2 - 1.333 x (error 1/8), three times: y' = y (3 - x y^2) / 2. Relative error
   below 2^-19. */
static inline uint32_t fxs_rsqrt(uint32_t m)
{
    uint32_t y_q30 = 2369829601u - fxs_mulhi(m, 1431655765u);
    for (int i = 0; i < 3; i++) {
        uint32_t square_q29 = fxs_mulhi(2 * y_q30, y_q30);
        y_q30 = fxs_mulhi(2 * y_q30, 2 * (0x60000000u - fxs_mulhi(m, square_q29)));
    }
    return y_q30;
}

/* Square root: returns sqrt(x), with a relative error of at most 2^-18, then rounded down. */
static inline uint32_t fxs_sqrt(uint32_t x)
{
    if (!x)
        return 0;
    int shift = fxs_clz32(x) & ~1;
    uint32_t m = x << shift;
    return fxs_mulhi(m, fxs_rsqrt(m)) >> (14 + shift / 2);
}

/* Power of two: returns 2^-f in Q15, in (2^14, 2^15], for f_q15 in 0..32767. Polynomial of degree 4, relative error
   below 2^-13. */
static inline int32_t fxs_exp2_q15(int32_t f_q15)
{
    int32_t p = (256 * f_q15 + 16384) >> 15;
    p = ((p - 1820) * f_q15 + 16384) >> 15;
    p = ((p + 7904) * f_q15 + 16384) >> 15;
    p = ((p - 22724) * f_q15 + 16384) >> 15;
    return 32768 + p;
}

/* Binary logarithm: returns log2(x) in Q16, for x above 0. log2(1 + t) = t (1 + (1 - t) q(t)) with a cubic q, absolute
   error below 2^-12. */
static inline int32_t fxs_log2_q16(uint64_t x)
{
    int n = fxs_clz64(x);
    int32_t t_q15 = (int32_t)((x << n << 1) >> 49);
    int32_t q = (-2776 * t_q15 + 16384) >> 15;
    q = ((q + 6897) * t_q15 + 16384) >> 15;
    q = ((q - 9697) * t_q15 + 16384) >> 15;
    q = ((q + 14605) * (32768 - t_q15) + 16384) >> 15;
    return (63 - n) * 65536 + 2 * (((32768 + q) * (t_q15 >> 1) + 8192) >> 14);
}

#endif
