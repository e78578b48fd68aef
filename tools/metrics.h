/* How far two images are apart. */
#ifndef METRICS_H
#define METRICS_H

#include <fixsplat/message.h>

struct fxs_metrics {
    double mse;    /* mean squared error, levels of 255 */
    double psnr;   /* dB; infinity where the images are equal */
    double ssim;   /* mean structural similarity, 1 where the images are equal */
    int largest;   /* absolute difference, levels of 255 */
};

/* Compares the red, green and blue of two RGBA images. SSIM is that of Wang et al. 2004 (Gaussian window of 11 x 11
   pixels, sigma 1.5, K1 0.01, K2 0.03), the mean of the three channels over the windows that lie whole in the image;
   a side of fewer than 11 pixels cuts the window to it. Returns 0, or -1 when out of memory. */
int fxs_metrics_compare(const uint8_t *a, const uint8_t *b, int width, int height, struct fxs_metrics *out);

/* The same of the pixels that count, and SSIM over the windows all of whose pixels do: NaN where there is none. `mask`
   has a byte a pixel, 0 where it does not count; null: all do. Images without a pixel that counts are equal. */
int fxs_metrics_compare_masked(const uint8_t *a, const uint8_t *b, const uint8_t *mask, int width, int height,
                               struct fxs_metrics *out);

/* The PSNR, dB, that is left after the best affine map of the colours of `drawn` to those of `photograph`: three
   factors and a constant for each of red, green and blue, by least squares over all pixels that count, the result cut to
   0..255 and not rounded. Both are RGBA, and the mask is as above. Infinity where nothing is left. */
double fxs_metrics_affine_psnr(const uint8_t *drawn, const uint8_t *photograph, const uint8_t *mask, int width,
                               int height);

/* A PSNR as text, four decimals; `equal` where it is infinite. Returns text. */
const char *fxs_metrics_psnr(char text[32], double psnr, const char *equal);

/* An SSIM as text, six decimals; `none` where it is NaN. Returns text. */
const char *fxs_metrics_ssim(char text[32], double ssim, const char *none);

/* Writes 8 |a - b|, at most 255, with alpha 255, as a picture file. Returns 0, or an error and a message. */
int fxs_metrics_difference(const char *path, const uint8_t *a, const uint8_t *b, int width, int height,
                           fxs_message *message);

#endif
