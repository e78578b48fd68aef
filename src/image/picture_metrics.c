/* Image metrics: MSE, PSNR, SSIM (Wang et al. 2004) with a separable Gaussian window, and PSNR after the best affine
   map of colours by least squares. */
#include <fixsplat/internal/picture_metrics.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WINDOW 11
#define SIGMA 1.5

/* Local means that SSIM needs: of image A, of image B, of their squares, and of their product. */
enum { A, B, SQUARES, PRODUCT, MAPS };

/* Computes the Gaussian window of SSIM: weights with the sum 1 over at most WINDOW pixels. Returns their number. */
static int window(int side, double weights[WINDOW])
{
    int taps = side < WINDOW ? side : WINDOW;
    double sum = 0;
    for (int i = 0; i < taps; i++) {
        double x = i - 0.5 * (taps - 1);
        sum += weights[i] = exp(-x * x / (2 * SIGMA * SIGMA));
    }
    for (int i = 0; i < taps; i++)
        weights[i] /= sum;
    return taps;
}

static void add_scaled(double *restrict out, const double *restrict in, double weight, size_t count)
{
    for (size_t i = 0; i < count; i++)
        out[i] += weight * in[i];
}

static void fill_maps(const uint8_t *a, const uint8_t *b, size_t width, double *maps)
{
    for (size_t i = 0; i < width; i++) {
        double p = a[4 * i], q = b[4 * i];
        maps[A * width + i] = p;
        maps[B * width + i] = q;
        maps[SQUARES * width + i] = p * p + q * q;
        maps[PRODUCT * width + i] = p * q;
    }
}

/* Sums up SSIM over a row of windows, from four local means of each window. are_whole marks the windows that count;
   null: all windows count. */
static double ssim_row(const double *means, size_t count, const uint8_t *are_whole)
{
    const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double a = means[A * count + i], b = means[B * count + i];
        double variances = means[SQUARES * count + i] - (a * a + b * b);
        double covariance = means[PRODUCT * count + i] - a * b;
        const double ssim = (2 * a * b + c1) * (2 * covariance + c2) / ((a * a + b * b + c1) * (variances + c2));
        sum += !are_whole || are_whole[i] ? ssim : 0;
    }
    return sum;
}

/* Sums up SSIM of a colour channel over all windows. `memory` has (WINDOW + 2) * MAPS * width doubles. Horizontally
   filtered rows are kept in a ring buffer. */
static double ssim_channel(const uint8_t *a, const uint8_t *b, const uint8_t *are_whole, size_t width, size_t height,
                           double *memory)
{
    double across[WINDOW], down[WINDOW], sum = 0;
    size_t taps_x = (size_t)window((int)width, across), taps_y = (size_t)window((int)height, down);
    size_t count = width - taps_x + 1, row = MAPS * count;
    double *maps = memory, *means = maps + MAPS * width, *filtered = means + MAPS * width;
    for (size_t y = 0; y < height; y++) {
        double *now = filtered + y % taps_y * row;
        fill_maps(a + 4 * width * y, b + 4 * width * y, width, maps);
        memset(now, 0, row * sizeof *now);
        for (size_t map = 0; map < MAPS; map++)
            for (size_t i = 0; i < taps_x; i++)
                add_scaled(now + map * count, maps + map * width + i, across[i], count);
        if (y + 1 < taps_y)
            continue;
        memset(means, 0, row * sizeof *means);
        for (size_t i = 0; i < taps_y; i++)
            add_scaled(means, filtered + (y + 1 + i) % taps_y * row, down[i], row);
        sum += ssim_row(means, count, are_whole ? are_whole + count * (y + 1 - taps_y) : NULL);
    }
    return sum;
}

static size_t find_whole_windows(const uint8_t *mask, size_t width, size_t height, size_t *below, uint8_t *are_whole)
{
    double weights[WINDOW];
    const size_t taps_x = (size_t)window((int)width, weights), taps_y = (size_t)window((int)height, weights);
    size_t found = 0;
    memset(below, 0, width * sizeof *below);
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0, beside = 0; x < width; x++) {
            below[x] = mask[y * width + x] ? below[x] + 1 : 0;   /* number of unmasked pixels upwards without a gap */
            beside = below[x] >= taps_y ? beside + 1 : 0;    /* number of columns to the left that fit a window */
            if (y + 1 >= taps_y && x + 1 >= taps_x)
                found += *are_whole++ = beside >= taps_x;
        }
    return found;
}

static int find_ssim(const uint8_t *a, const uint8_t *b, const uint8_t *mask, size_t width, size_t height, double *ssim)
{
    double weights[WINDOW], *memory = malloc((WINDOW + 2) * MAPS * width * sizeof *memory);
    uint8_t *are_whole = mask ? malloc(width * height) : NULL;
    size_t *below = mask ? malloc(width * sizeof *below) : NULL;
    size_t count = (width - (size_t)window((int)width, weights) + 1) *
                   (height - (size_t)window((int)height, weights) + 1);
    const int error = !memory || (mask && (!are_whole || !below)) ? -1 : 0;
    if (!error && mask)
        count = find_whole_windows(mask, width, height, below, are_whole);
    *ssim = count ? 0 : NAN;
    for (int channel = 0; channel < 3 && !error && count; channel++)
        *ssim += ssim_channel(a + channel, b + channel, are_whole, width, height, memory) / (double)count / 3;
    free(memory);
    free(are_whole);
    free(below);
    return error;
}

/* Computes all metrics but SSIM. Returns the sum of the squared differences. */
static uint64_t find_difference(const uint8_t *a, const uint8_t *b, const uint8_t *mask, size_t pixels,
                                struct fxs_metrics *out)
{
    uint64_t squares = 0;
    size_t counted = 0;
    out->largest = 0;
    for (size_t i = 0; i < pixels; i++) {
        if (mask && !mask[i])
            continue;
        counted++;
        for (size_t k = 4 * i; k < 4 * i + 3; k++) {
            const int difference = abs(a[k] - b[k]);
            squares += (uint64_t)(difference * difference);
            out->largest = difference > out->largest ? difference : out->largest;
        }
    }
    out->mse = squares ? (double)squares / (3.0 * (double)counted) : 0;
    out->psnr = squares ? 10 * log10(255.0 * 255.0 / out->mse) : INFINITY;
    out->ssim = counted ? 1 : NAN;
    return squares;
}

int fxs_metrics_compare_masked(const uint8_t *a, const uint8_t *b, const uint8_t *mask, int width, int height,
                               struct fxs_metrics *out)
{
    const uint64_t squares = find_difference(a, b, mask, (size_t)width * (size_t)height, out);
    return squares ? find_ssim(a, b, mask, (size_t)width, (size_t)height, &out->ssim) : 0;
}

int fxs_metrics_compare(const uint8_t *a, const uint8_t *b, int width, int height, struct fxs_metrics *out)
{
    return fxs_metrics_compare_masked(a, b, NULL, width, height, out);
}

void fxs_metrics_without_ssim(const uint8_t *a, const uint8_t *b, int width, int height, struct fxs_metrics *out)
{
    find_difference(a, b, NULL, (size_t)width * (size_t)height, out);
    out->ssim = NAN;
}

enum { TERMS = 4, COLUMNS = TERMS + 3 };   /* columns: terms 1, red, green and blue, then the target colours */

/* Sums up products of colours for a least-squares fit. The sums are exact, as integers below 2^53. */
static void add_products(const uint8_t *from, const uint8_t *to, const uint8_t *mask, size_t pixels,
                         double sums[TERMS][COLUMNS])
{
    uint64_t whole[TERMS][COLUMNS] = {{0}};
    for (size_t i = 0; i < pixels; i++, from += 4, to += 4) {
        if (mask && !mask[i])
            continue;
        const uint32_t numbers[COLUMNS] = {1, from[0], from[1], from[2], to[0], to[1], to[2]};
        for (int k = 0; k < TERMS; k++)
            for (int c = 0; c < COLUMNS; c++)
                whole[k][c] += numbers[k] * numbers[c];
    }
    for (int k = 0; k < TERMS; k++)
        for (int c = 0; c < COLUMNS; c++)
            sums[k][c] = (double)whole[k][c];
}

/* Solves the normal equations of an affine colour map by Gaussian elimination. A linearly dependent term, as in a grey
   picture, gets the factor 0. */
static void solve_map(double sums[TERMS][COLUMNS], double map[TERMS][3])
{
    double whole[TERMS];
    for (int k = 0; k < TERMS; k++)
        whole[k] = sums[k][k];
    for (int k = 0; k < TERMS; k++)
        for (int i = 0; i < TERMS && sums[k][k] > 1e-9 * whole[k]; i++) {
            const double factor = i == k ? 0 : sums[i][k] / sums[k][k];
            for (int c = 0; c < COLUMNS; c++)
                sums[i][c] -= factor * sums[k][c];
        }
    for (int k = 0; k < TERMS; k++)
        for (int c = 0; c < 3; c++)
            map[k][c] = sums[k][k] > 1e-9 * whole[k] ? sums[k][TERMS + c] / sums[k][k] : 0;
}

double fxs_metrics_affine_psnr(const uint8_t *drawn, const uint8_t *photograph, const uint8_t *mask, int width,
                               int height)
{
    const size_t pixels = (size_t)width * (size_t)height;
    double sums[TERMS][COLUMNS], map[TERMS][3], squares = 0;
    add_products(drawn, photograph, mask, pixels, sums);
    const double counted = sums[0][0];
    solve_map(sums, map);
    for (size_t i = 0; i < 4 * pixels; i += 4)
        for (int c = 0; c < 3 && (!mask || mask[i / 4]); c++) {
            const uint8_t *at = drawn + i;
            const double mapped = map[0][c] + map[1][c] * at[0] + map[2][c] * at[1] + map[3][c] * at[2];
            const double difference = fmin(fmax(mapped, 0), 255) - photograph[i + (size_t)c];
            squares += difference * difference;
        }
    return squares > 1e-9 * counted ? 10 * log10(255.0 * 255.0 * 3 * counted / squares) : INFINITY;
}
