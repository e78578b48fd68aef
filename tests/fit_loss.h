/* Computes the loss of the fit in doubles. SSIM follows Wang et al. 2004: windows of 11x11 pixels, sigma 1.5, zeros
   outside the picture. */
#ifndef FIT_LOSS_H
#define FIT_LOSS_H

#include <math.h>
#include <stdint.h>

enum { FIT_WINDOW = 11, FIT_LOSS_PIXELS = 2048 };

static inline void fit_window(double window[FIT_WINDOW])
{
    double sum = 0;
    for (int i = 0; i < FIT_WINDOW; i++)
        sum += window[i] = exp(-(i - 5) * (i - 5) / (2 * 1.5 * 1.5));
    for (int i = 0; i < FIT_WINDOW; i++)
        window[i] /= sum;
}

/* Returns the SSIM of two pictures a and b from the means of a, b, a^2, b^2 and ab over a window. */
static inline double fit_similarity(const double m[5])
{
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    const double variances = m[2] - m[0] * m[0] + m[3] - m[1] * m[1], covariance = m[4] - m[0] * m[1];
    return (2 * m[0] * m[1] + c1) * (2 * covariance + c2) / ((m[0] * m[0] + m[1] * m[1] + c1) * (variances + c2));
}

/* Applies a Gaussian filter along one axis to five numbers of each pixel. Neighbouring pixels are `step` apart. A
   line has `size` pixels. */
static inline void fit_window_sums(const double (*from)[5], double (*to)[5], int pixels, int step, int size,
                                   const double *window)
{
    for (int p = 0; p < pixels; p++) {
        const int at = p / step % size, first = at < 5 ? -at : -5, last = at + 5 < size ? 5 : size - 1 - at;
        for (int k = 0; k < 5; k++)
            to[p][k] = 0;
        for (int i = first; i <= last; i++)
            for (int k = 0; k < 5; k++)
                to[p][k] += window[i + 5] * from[p + i * step][k];
    }
}

/* Sums 0.8 |a - b| + 0.2 (1 - SSIM) over one channel of the picture a and the photograph b. The photograph's samples
   are three bytes apart. Pixels with mask 0 count as outside of the picture; mask may be null. is_cut: 1 gives no loss
   where the photograph is white and the picture is brighter. */
static inline double fit_loss(const double *picture, const uint8_t *photograph, const uint8_t *mask, int is_cut,
                              int width, int height)
{
    static double products[FIT_LOSS_PIXELS][5], rows[FIT_LOSS_PIXELS][5], sums[FIT_LOSS_PIXELS][5];
    double window[FIT_WINDOW], loss = 0;
    fit_window(window);
    for (int p = 0; p < width * height; p++) {
        const int counts = !mask || mask[p];
        const double b = counts ? photograph[3 * p] / 255.0 : 0;
        const double a = !counts ? 0 : is_cut && b == 1 ? fmin(picture[p], 1) : picture[p];
        products[p][0] = a, products[p][1] = b, products[p][2] = a * a, products[p][3] = b * b, products[p][4] = a * b;
        loss += 0.8 * fabs(a - b);
    }
    fit_window_sums((const double(*)[5])products, rows, width * height, 1, width, window);
    fit_window_sums((const double(*)[5])rows, sums, width * height, width, height, window);
    for (int p = 0; p < width * height; p++)
        loss += !mask || mask[p] ? 0.2 * (1 - fit_similarity(sums[p])) : 0;
    return loss;
}

#endif
