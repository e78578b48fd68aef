/* Checks the error bounds that fixed.h states for fixed-point functions. The inputs are every STRIDE-th mantissa and
   edge cases. */
#include <math.h>

#include <fixsplat/internal/fixed.h>
#include "check.h"

enum { STRIDE = 251 };   /* step between tested numbers; a prime, so that all low bits vary */

static int clz_by_loop(uint64_t x, int bits)
{
    int n = 0;
    while (n < bits && !(x >> (bits - 1 - n) & 1))
        n++;
    return n;
}

static void test_clz_and_ctz(void)
{
    for (int bit = 0; bit < 64; bit++)
        for (int below = 0; below <= bit; below++) {
            uint64_t x = (uint64_t)1 << bit | (((uint64_t)1 << below) - 1);
            if (bit < 32)
                CHECK(fxs_clz32((uint32_t)x) == clz_by_loop(x, 32));
            CHECK(fxs_clz64(x) == clz_by_loop(x, 64));
        }
    CHECK(fxs_clz32(UINT32_MAX) == 0 && fxs_clz64(UINT64_MAX) == 0);
    for (int bit = 0; bit < 32; bit++)
        CHECK(fxs_ctz32(1u << bit) == bit && fxs_ctz32(UINT32_MAX << bit) == bit);
}

static void test_mulhi(void)
{
    CHECK(fxs_mulhi(UINT32_MAX, UINT32_MAX) == UINT32_MAX - 1);
    CHECK(fxs_mulhi(1u << 31, 1u << 31) == 1u << 30);
    CHECK(fxs_mulhi(0, UINT32_MAX) == 0 && fxs_mulhi(65536, 65535) == 0 && fxs_mulhi(65536, 65536) == 1);
}

/* Shifts right with rounding to nearest: floor, plus the highest bit shifted out. */
static int64_t rounded(int64_t x, int shift)
{
    return (x >> shift) + (x >> (shift - 1) & 1);
}

static void test_round_shift(void)
{
    for (int shift = 1; shift <= 62; shift++)
        for (int bit = 0; bit < 62; bit++)
            for (int64_t near = -3; near <= 3; near++) {
                int64_t x = ((int64_t)1 << bit) + near;
                if (!CHECK(fxs_round_shift(x, shift) == rounded(x, shift)) ||
                    !CHECK(fxs_round_shift(-x, shift) == rounded(-x, shift)))
                    return;
            }
    CHECK(fxs_round_shift(1, 1) == 1 && fxs_round_shift(-1, 1) == 0 && fxs_round_shift(-3, 1) == -1);
}

static void test_clamp(void)
{
    CHECK(fxs_clamp(-5, -4, 9) == -4 && fxs_clamp(10, -4, 9) == 9 && fxs_clamp(3, -4, 9) == 3);
    CHECK(fxs_clamp(INT32_MIN, INT32_MIN, 0) == INT32_MIN && fxs_clamp(INT32_MAX, 0, INT32_MAX) == INT32_MAX);
}

/* Calls `visit` with 2^bit, 2^bit + STRIDE, ... below 2^32, and with numbers around each power of two. */
static void sweep(int bit, void (*visit)(uint32_t m))
{
    for (uint64_t m = (uint64_t)1 << bit; m >> 32 == 0; m += STRIDE)
        visit((uint32_t)m);
    for (; bit < 32; bit++)
        for (uint32_t m = 0; m < 10000; m++) {
            visit((1u << bit) + m);
            visit((1u << bit) + ((1u << bit) - 1 - m));
        }
}

static double worst;
static int outside;

static void visit_reciprocal(uint32_t m)
{
    uint32_t got = fxs_reciprocal(m);
    double exact = ldexp(1, 62) / m;
    worst = fmax(worst, fabs(got - exact) / exact);
    outside += got < 1u << 30 || got > 1u << 31;
}

static void test_reciprocal(void)
{
    worst = outside = 0;
    sweep(31, visit_reciprocal);
    if (!CHECK(worst < ldexp(1, -28)) || !CHECK(outside == 0))
        printf("  relative error 2^%.2f, %d outside\n", log2(worst), outside);
}

static void visit_rsqrt(uint32_t m)
{
    uint32_t got = fxs_rsqrt(m);
    double exact = ldexp(1, 30) / sqrt(ldexp(m, -32));
    worst = fmax(worst, fabs(got - exact) / exact);
    outside += got < (1u << 30) - (1u << 10) || got > 1u << 31;
}

static void test_rsqrt(void)
{
    worst = outside = 0;
    sweep(30, visit_rsqrt);
    if (!CHECK(worst < ldexp(1, -19)) || !CHECK(outside == 0))
        printf("  relative error 2^%.2f, %d outside\n", log2(worst), outside);
}

/* Measures the error of fxs_sqrt. The square root is rounded down, so a result that is less than 1 too small is
   no error. */
static void visit_sqrt(uint32_t x)
{
    double exact = sqrt(x), got = fxs_sqrt(x);
    worst = fmax(worst, fmax(got - exact, exact - got - 1) / (x ? exact : 1));
}

static void test_sqrt(void)
{
    worst = 0;
    for (uint32_t x = 0; x < 1u << 20; x++)
        visit_sqrt(x);
    for (uint32_t root = 0; root < 65536; root++) {
        visit_sqrt(root * root);
        visit_sqrt(root * root - (root > 0));
    }
    sweep(20, visit_sqrt);
    if (!CHECK(worst < ldexp(1, -18)))
        printf("  relative error 2^%.2f\n", log2(worst));
    CHECK(fxs_sqrt(0) == 0);
}

static void test_exp2(void)
{
    int rise = 0, previous = 32768;
    worst = outside = 0;
    for (int f = 0; f <= 32767; f++) {
        int got = fxs_exp2_q15(f);
        double exact = ldexp(exp2(-ldexp(f, -15)), 15);
        worst = fmax(worst, fabs(got - exact) / exact);
        outside += got <= 1 << 14 || got > 1 << 15;
        rise = got - previous > rise ? got - previous : rise;
        previous = got;
    }
    CHECK(fxs_exp2_q15(0) == 32768);
    if (!CHECK(worst < ldexp(1, -13)) || !CHECK(outside == 0) || !CHECK(rise <= 1))
        printf("  relative error 2^%.2f, %d outside, a rise of %d\n", log2(worst), outside, rise);
}

static void visit_log2(uint64_t x)
{
    worst = fmax(worst, fabs(ldexp(fxs_log2_q16(x), -16) - log2((double)x)));
}

static void test_log2(void)
{
    worst = 0;
    for (uint64_t x = 1; x < 1 << 20; x++)
        visit_log2(x);
    for (int bit = 20; bit < 64; bit++)
        for (uint64_t t = 0; t < 1 << 15; t += 7) {
            uint64_t power = (uint64_t)1 << bit;
            visit_log2(power + (power >> 15) * t);
            visit_log2(power - 1 - t);
            visit_log2(power + t);
        }
    visit_log2(UINT64_MAX);
    if (!CHECK(worst < ldexp(1, -12)))
        printf("  error 2^%.2f\n", log2(worst));
    for (int bit = 0; bit < 64; bit++)
        CHECK(fxs_log2_q16((uint64_t)1 << bit) == bit * 65536);
}

int main(void)
{
    RUN(test_clz_and_ctz);
    RUN(test_mulhi);
    RUN(test_round_shift);
    RUN(test_clamp);
    RUN(test_reciprocal);
    RUN(test_rsqrt);
    RUN(test_sqrt);
    RUN(test_exp2);
    RUN(test_log2);
    return check_report();
}
