/* Tests PSNR after the best affine map of colours, and the effect of masks on each metric. */
#include <math.h>
#include <string.h>

#include "src/base/random.h"
#include "tools/command/metrics.h"
#include "check.h"

enum { WIDTH = 60, HEIGHT = 40, PIXELS = WIDTH * HEIGHT };

static uint8_t drawn[4 * PIXELS], photograph[4 * PIXELS];
static const uint8_t *mask;        /* mask of the photograph, 0 for ignored pixels; null: all pixels count */

static double left(void)
{
    return fxs_metrics_affine_psnr(drawn, photograph, mask, WIDTH, HEIGHT);
}

static uint8_t random_level(uint64_t number, double low, double high)
{
    return (uint8_t)(low + (high - low) * (double)fxs_random_uniform(fxs_random(3, 1, number)));
}

static void map_colours(const double map[3][4])
{
    for (int i = 0; i < 4 * PIXELS; i++) {
        const uint8_t *at = drawn + i / 4 * 4;
        const double *row = map[i % 4 < 3 ? i % 4 : 0];
        photograph[i] = (uint8_t)(row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3] + 0.5);
    }
}

static void fill(double low, double high)
{
    for (uint64_t i = 0; i < 4 * PIXELS; i++)
        drawn[i] = random_level(i, low, high);
}

static void maps_are_found(void)
{
    static const double same[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    static const double turned[3][4] = {{0, 1, 0, 7}, {1, 0, 1, -20}, {1, -1, 0, 100}};
    static const double rounded[3][4] = {{0.7, 0.1, 0.05, 3}, {-0.1, 1.2, 0.2, 10}, {0, 0.3, 0.5, 0.25}};
    fill(20, 120);
    map_colours(same);
    CHECK(isinf(left()));
    map_colours(turned);
    CHECK(isinf(left()));
    map_colours(rounded);          /* rounding to 8 bits adds an error of variance 1/12 levels^2 */
    CHECK(fabs(left() - 10 * log10(255.0 * 255 * 12)) < 0.1);
}

static void pictures_without_colours(void)
{
    double sum = 0, squares = 0;
    memset(drawn, 77, sizeof drawn);
    for (uint64_t i = 0; i < 4 * PIXELS; i++) {
        photograph[i] = random_level(i, 0, 256);
        sum += i % 4 == 0 ? photograph[i] : 0;
    }
    for (int c = 1; c < 3; c++)
        for (int i = 0; i < PIXELS; i++)
            photograph[4 * i + c] = photograph[4 * i];
    for (int i = 0; i < PIXELS; i++)
        squares += pow(photograph[4 * i] - sum / PIXELS, 2);
    CHECK(fabs(left() - 10 * log10(255.0 * 255 * PIXELS / squares)) < 1e-6);
    for (int i = 0; i < 4 * PIXELS; i++)
        drawn[i] = (uint8_t)(photograph[i / 4 * 4] / 2);
    CHECK(left() > 10 * log10(255.0 * 255 * 3));
    memset(drawn, 0, sizeof drawn);
    CHECK(fabs(left() - 10 * log10(255.0 * 255 * PIXELS / squares)) < 1e-6);
}

static void colours_that_follow_from_each_other(void)
{
    double sums[5] = {0};          /* means over the pixels of x, y, x^2, x y, y^2 */
    for (uint64_t i = 0; i < PIXELS; i++) {
        uint8_t *at = drawn + 4 * i, *to = photograph + 4 * i;
        at[0] = random_level(i, 0, 120);
        at[1] = (uint8_t)(2 * at[0] + 7);
        at[2] = (uint8_t)(250 - 2 * at[0]);
        to[0] = to[1] = to[2] = (uint8_t)(at[0] + random_level(PIXELS + i, 30, 90));
        const double x = at[0], y = to[0], terms[5] = {x, y, x * x, x * y, y * y};
        for (int k = 0; k < 5; k++)
            sums[k] += terms[k] / PIXELS;
    }
    const double xx = sums[2] - sums[0] * sums[0], xy = sums[3] - sums[0] * sums[1], yy = sums[4] - sums[1] * sums[1];
    CHECK(fabs(left() - 10 * log10(255.0 * 255 / (yy - xy * xy / xx))) < 1e-6);
}

static void maps_are_cut(void)
{
    for (int i = 0; i < 4 * PIXELS; i++) {
        const int pixel = i / 4 % 4;
        drawn[i] = (uint8_t)(pixel == 0 ? 0 : pixel == 1 ? 100 : 200);
        photograph[i] = (uint8_t)(pixel ? 255 : 0);
    }
    /* The best affine map is 46.3636 + 115.9091 x / 100 for the level x of a pixel, clamped at 255. */
    const double at[3] = {46.363636, 162.272727, 255};
    const double mean = (at[0] * at[0] + (255 - at[1]) * (255 - at[1]) + 2 * (255 - at[2]) * (255 - at[2])) / 4;
    CHECK(fabs(left() - 10 * log10(255.0 * 255 / mean)) < 1e-4);
}

static void ignored_pixels_have_no_part(void)
{
    enum { LEFT = 25, NARROW = WIDTH - LEFT };
    static uint8_t counts[PIXELS], part[2][4 * NARROW * HEIGHT];
    struct fxs_metrics found, wanted;
    for (uint64_t i = 0; i < 4 * PIXELS; i++) {
        const uint64_t x = i / 4 % WIDTH, to = (i / 4 / WIDTH * NARROW + x - LEFT) * 4 + i % 4;
        drawn[i] = random_level(i, 20, 200);
        counts[i / 4] = x >= LEFT ? 7 : 0;
        photograph[i] = (uint8_t)(x < LEFT ? 255 - drawn[i] : drawn[i] + random_level(4 * PIXELS + i, 0, 30));
        if (x >= LEFT) {
            part[0][to] = drawn[i];
            part[1][to] = photograph[i];
        }
    }
    CHECK(!fxs_metrics_compare(part[0], part[1], NARROW, HEIGHT, &wanted) && wanted.ssim < 0.99);
    CHECK(!fxs_metrics_compare_masked(drawn, photograph, counts, WIDTH, HEIGHT, &found));
    CHECK(found.largest == wanted.largest && fabs(found.mse - wanted.mse) < 1e-9);
    CHECK(fabs(found.psnr - wanted.psnr) < 1e-9 && fabs(found.ssim - wanted.ssim) < 1e-9);
    mask = counts;
    const double affine = left();
    mask = NULL;
    CHECK(fabs(affine - fxs_metrics_affine_psnr(part[0], part[1], NULL, NARROW, HEIGHT)) < 1e-9);
    CHECK(fabs(affine - left()) > 1);
}

/* SSIM leaves out windows with an ignored pixel. An ignored pixel in every 11 x 11 pixels leaves no window, so
   SSIM is undefined. */
static void windows_without_ignored_pixels(void)
{
    static uint8_t counts[PIXELS];
    struct fxs_metrics found, wanted;
    static uint8_t part[2][4 * 11 * 11];
    for (int i = 0; i < PIXELS; i++)
        counts[i] = i % WIDTH % 11 != 10 || i / WIDTH % 11 != 10;
    CHECK(!fxs_metrics_compare_masked(drawn, photograph, counts, WIDTH, HEIGHT, &found));
    CHECK(isnan(found.ssim) && isfinite(found.psnr));
    counts[10 * WIDTH + 10] = 1;
    for (int i = 0; i < PIXELS; i++)
        if (i % WIDTH == 11 || i / WIDTH == 11)
            counts[i] = 0;
    for (int i = 0; i < 4 * 11 * 11; i++) {
        part[0][i] = drawn[i / 44 * 4 * WIDTH + i % 44];
        part[1][i] = photograph[i / 44 * 4 * WIDTH + i % 44];
    }
    CHECK(!fxs_metrics_compare_masked(drawn, photograph, counts, WIDTH, HEIGHT, &found));
    CHECK(!fxs_metrics_compare(part[0], part[1], 11, 11, &wanted) && fabs(found.ssim - wanted.ssim) < 1e-9);
    memset(counts, 0, sizeof counts);
    CHECK(!fxs_metrics_compare_masked(drawn, photograph, counts, WIDTH, HEIGHT, &found));
    CHECK(isnan(found.ssim) && isinf(found.psnr) && found.largest == 0);
}

int main(void)
{
    RUN(maps_are_found);
    RUN(pictures_without_colours);
    RUN(colours_that_follow_from_each_other);
    RUN(maps_are_cut);
    RUN(ignored_pixels_have_no_part);
    RUN(windows_without_ignored_pixels);
    return check_report();
}
