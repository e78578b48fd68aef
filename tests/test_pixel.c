/* Tests the functions of pixel.h over their whole input range against 64-bit integers and doubles. */
#include <math.h>
#include <stdint.h>

#include "check.h"

#define FXS_FN static inline
#include <fixsplat/internal/pixel.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(SANITIZED)
enum { COARSE = 61 };   /* step between tested numbers: a prime; above 1, since builds with a sanitizer are slow */
#else
enum { COARSE = 1 };
#endif

enum { Q15_ONE = 32768 };

static int next(int x, int stride, int last)
{
    return x < last && last - x < stride ? last : x + stride;
}

/* Compares fxs_mul_q15, round(a b / 2^15), with 64-bit integers for a given a and all b. Returns the differing
   bits. */
static unsigned row_difference(int a)
{
    unsigned difference = 0;
    int64_t rounded_q15 = -(int64_t)a * Q15_ONE + 16384;
    for (int b = -Q15_ONE; b <= Q15_ONE; b++, rounded_q15 += a)
        difference |= (unsigned)fxs_mul_q15(a, b) ^ (unsigned)(rounded_q15 >> 15);
    return difference;
}

static void test_mul_q15_all_pairs(void)
{
    unsigned difference = 0;
    for (int a = -Q15_ONE; a <= Q15_ONE; a = next(a, COARSE, Q15_ONE))
        difference |= row_difference(a);
    CHECK(difference == 0);
}

static void test_min(void)
{
    CHECK(fxs_min(-3, 2) == -3 && fxs_min(2, -3) == -3 && fxs_min(7, 7) == 7);
    CHECK(fxs_min(INT32_MIN, INT32_MAX) == INT32_MIN);
}

static int coordinate_is_right(int64_t coordinate_q24)
{
    double expected = floor(ldexp((double)coordinate_q24, -11));
    return fxs_coordinate_q13((int)coordinate_q24) == (int)fmax(-32767, fmin(32767, expected));
}

static void test_coordinate(void)
{
    int64_t wrong = 0;
    for (int64_t c = INT32_MIN; c <= INT32_MAX; c += 97 * COARSE)
        wrong += !coordinate_is_right(c);
    for (int64_t edge = -(4 << 24); edge <= 4 << 24; edge += 4 << 24)
        for (int64_t c = edge - 100000; c <= edge + 100000; c++)
            wrong += !coordinate_is_right(c);
    for (int64_t c = 0; c < 10000; c++)
        wrong += !coordinate_is_right(INT32_MIN + c) || !coordinate_is_right(INT32_MAX - c);
    CHECK(wrong == 0);
}

/* Counts wrong results of a function that computes coordinate^2 + base. A result may be half a unit off and is
   limited at the top. */
static int64_t wrong_levels(int (*level)(int coordinate_q13, int base_q11), int base_q11)
{
    int64_t wrong = 0;
    for (int c = -32767; c <= 32767; c++) {
        /* coordinate^2 rounded to nearest, half up */
        int64_t twice = 2 * (((int64_t)c * c + 16384) / Q15_ONE + base_q11);
        int64_t got = level(c, base_q11);
        wrong += got != (twice > 2 * FXS_LEVEL_MAX_Q11 ? FXS_LEVEL_MAX_Q11 : twice / 2);
    }
    return wrong;
}

static void test_levels(void)
{
    int64_t wrong = 0;
    for (int offset = 0; offset <= FXS_FAINT_Q11; offset = next(offset, 23 * COARSE, FXS_FAINT_Q11))
        wrong += wrong_levels(fxs_row_level_q11, offset);
    for (int row = 0; row <= FXS_LEVEL_MAX_Q11; row = next(row, 29 * COARSE, FXS_LEVEL_MAX_Q11))
        wrong += wrong_levels(fxs_level_q11, row);
    CHECK(wrong == 0);
    CHECK(fxs_row_level_q11(32767, 0) > FXS_FAINT_Q11 && fxs_row_level_q11(-32767, 0) > FXS_FAINT_Q11);
}

static void test_limit(void)
{
    double cut_q11 = FXS_CUT_Q11, faint_q11 = FXS_FAINT_Q11;
    CHECK(cut_q11 == 9 * 2048 && fabs(faint_q11 - 2 * log(255) * 2048) <= 0.5);
    for (int offset = 0; offset <= FXS_FAINT_Q11; offset++) {
        int cut = fxs_limit_q11(offset, FXS_CUT_Q11), faint = fxs_limit_q11(offset, FXS_LEVEL_MAX_Q11);
        if (!CHECK(cut >= offset && cut <= faint && faint == FXS_FAINT_Q11))
            return;
    }
}

static void test_alpha(void)
{
    double most = 0, squares = 0;
    int rises = 0, previous = FXS_ALPHA_MAX_Q15, inside = 1;
    for (int level = 0; level <= FXS_FAINT_Q11; level++) {
        int alpha = fxs_alpha_q15(level);
        double error = ldexp(alpha, -15) - fmin(0.99, exp(-ldexp(level, -12)));
        most = fmax(most, fabs(error));
        squares += error * error;
        inside = inside && alpha >= 0 && alpha <= FXS_ALPHA_MAX_Q15;
        rises = alpha - previous > rises ? alpha - previous : rises;
        previous = alpha;
    }
    double rms = sqrt(squares / (FXS_FAINT_Q11 + 1));
    if (!CHECK(most < 3.6e-4) || !CHECK(rms < 4.5e-5) || !CHECK(rises == 0))
        printf("  alpha: error at most %.3g, rms %.3g, largest rise %d\n", most, rms, rises);
    CHECK(inside);
    CHECK(fxs_alpha_q15(0) == FXS_ALPHA_MAX_Q15 && fxs_alpha_q15(FXS_FAINT_Q11) > 0);
}

static void test_weight(void)
{
    int least = 0, most = 0, over = 0;
    for (int alpha = 0; alpha <= FXS_ALPHA_MAX_Q15; alpha = next(alpha, COARSE, FXS_ALPHA_MAX_Q15))
        for (int t = 0; t <= FXS_CLEAR_Q15; t++) {
            int weight = fxs_weight_q15(alpha, t);
            least |= weight;
            most |= t - weight;
            over |= FXS_CLEAR_Q15 - (t - weight);
        }
    CHECK(least >= 0 && most >= 0 && over >= 0);   /* no result may be negative */
}

static void test_accumulate(void)
{
    int sign = 0, most = 0, wrong = 0;
    for (int weight = 0; weight <= 32767; weight = next(weight, COARSE, 32767))
        for (int colour = 0; colour <= 32767; colour++) {
            int sum = fxs_accumulate_q13(0, weight, colour);
            sign |= sum;
            most = sum > most ? sum : most;
        }
    CHECK(sign >= 0 && most <= 32767);
    for (int weight = 0; weight <= 32767; weight = next(weight, 3 * COARSE, 32767))
        for (int sum = 0; sum <= 32767; sum++) {
            int64_t exact = sum + (((int64_t)weight * 32767 + 16384) >> 15);
            wrong |= fxs_accumulate_q13(sum, weight, 32767) ^ (int)(exact > 32767 ? 32767 : exact);
        }
    CHECK(wrong == 0);
}

static void test_weights_add_up(void)
{
    for (int start = 0; start < FXS_FAINT_Q11; start += 7) {
        int t = FXS_CLEAR_Q15, sum = 0, white = 0, level = start;
        for (int i = 0; i < 2000 && t >= FXS_CLOSED_Q15; i++, level = (level * 5 + 4099) % FXS_FAINT_Q11) {
            int weight = fxs_weight_q15(fxs_alpha_q15(level), t);
            t -= weight;
            sum += weight;
            white = fxs_accumulate_q13(white, weight, 8192);
        }
        if (!CHECK(t >= 0 && sum + t == FXS_CLEAR_Q15) || !CHECK(white <= 8192 + 2000 / 2))
            return;
    }
}

static void test_resolve(void)
{
    int wrong = 0, previous;
    for (int sum = 0; sum <= 32767; sum++) {
        int64_t rounded = ((int64_t)sum * 255 + 4096) / 8192;
        wrong += fxs_resolve_8bit(sum, 0, 8192) != (rounded > 255 ? 255 : (int)rounded);
    }
    CHECK(wrong == 0);
    for (int t = 0; t <= FXS_CLEAR_Q15; t = next(t, 641, FXS_CLEAR_Q15))
        for (int background = 0; background <= 255; background++) {
            previous = 0;
            for (int sum = 0; sum <= 32767; sum = next(sum, 257 * COARSE, 32767)) {
                int got = fxs_resolve_8bit(sum, t, (background * 8192 + 127) / 255);
                wrong += got < previous || got > 255;
                previous = got;
            }
        }
    CHECK(wrong == 0);
}

static void test_resolve_background(void)
{
    for (int background = 0; background <= 255; background++)
        CHECK(fxs_resolve_8bit(0, FXS_CLEAR_Q15, (background * 8192 + 127) / 255) == background);
}

static void test_coverage(void)
{
    int wrong = 0, previous = 255;
    for (int t = 0; t <= FXS_CLEAR_Q15; t++) {
        int coverage = fxs_coverage_8bit(t);
        wrong += coverage > previous || fabs(coverage - 255 * (1 - ldexp(t, -15))) > 0.51;
        previous = coverage;
    }
    CHECK(wrong == 0 && fxs_coverage_8bit(0) == 255 && fxs_coverage_8bit(FXS_CLEAR_Q15) == 0);
}

int main(void)
{
    RUN(test_mul_q15_all_pairs);
    RUN(test_min);
    RUN(test_coordinate);
    RUN(test_levels);
    RUN(test_limit);
    RUN(test_alpha);
    RUN(test_weight);
    RUN(test_accumulate);
    RUN(test_weights_add_up);
    RUN(test_resolve);
    RUN(test_resolve_background);
    RUN(test_coverage);
    return check_report();
}
