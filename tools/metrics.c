#include "metrics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image_file.h>

#define WINDOW 11
#define SIGMA 1.5

/* The maps whose local means SSIM needs. */
enum { A, B, SQUARES, PRODUCT, MAPS };

/* A Gaussian of unit sum over at most WINDOW pixels of a side; returns their number. */
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

/* One channel of a row as the four maps, each of `width`. */
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

/* The sum of SSIM over a row of windows, given the four local means. */
static double ssim_row(const double *means, size_t count)
{
    const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double a = means[A * count + i], b = means[B * count + i];
        double variances = means[SQUARES * count + i] - (a * a + b * b);
        double covariance = means[PRODUCT * count + i] - a * b;
        sum += (2 * a * b + c1) * (2 * covariance + c2) / ((a * a + b * b + c1) * (variances + c2));
    }
    return sum;
}

/* The mean SSIM of one channel; memory: (WINDOW + 2) * MAPS * width doubles. Rows are filtered across as they come and
   kept for as long as a window reaches. */
static double ssim_channel(const uint8_t *a, const uint8_t *b, size_t width, size_t height, double *memory)
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
        sum += ssim_row(means, count);
    }
    return sum / (double)(count * (height - taps_y + 1));
}

int fxs_metrics_compare(const uint8_t *a, const uint8_t *b, int width, int height, struct fxs_metrics *out)
{
    size_t w = (size_t)width, h = (size_t)height;
    double *memory = malloc((WINDOW + 2) * MAPS * w * sizeof *memory);
    if (!memory)
        return -1;
    uint64_t squares = 0;
    out->largest = 0;
    for (size_t i = 0; i < 4 * w * h; i++) {
        int difference = i % 4 == 3 ? 0 : abs(a[i] - b[i]);
        squares += (uint64_t)(difference * difference);
        if (difference > out->largest)
            out->largest = difference;
    }
    out->mse = (double)squares / (3.0 * (double)(w * h));
    out->psnr = squares ? 10 * log10(255.0 * 255.0 / out->mse) : INFINITY;
    out->ssim = 0;
    if (!squares)
        out->ssim = 1;
    for (int channel = 0; channel < 3 && squares; channel++)
        out->ssim += ssim_channel(a + channel, b + channel, w, h, memory) / 3;
    free(memory);
    return 0;
}

const char *fxs_metrics_psnr(char text[32], double psnr, const char *equal)
{
    if (isinf(psnr))
        snprintf(text, 32, "%s", equal);
    else
        snprintf(text, 32, "%.4f", psnr);
    return text;
}

int fxs_metrics_difference(const char *path, const uint8_t *a, const uint8_t *b, int width, int height,
                           fxs_message *message)
{
    const size_t bytes = 4 * (size_t)width * (size_t)height;
    uint8_t *rgba = malloc(bytes);
    if (!rgba)
        return fxs_fail_memory(message, path, bytes);
    for (size_t i = 0; i < bytes; i++) {
        const int difference = 8 * abs(a[i] - b[i]);
        rgba[i] = i % 4 == 3 || difference > 255 ? 255 : (uint8_t)difference;
    }
    const int error = fxs_image_file_write(path, rgba, width, height, message);
    free(rgba);
    return error;
}
