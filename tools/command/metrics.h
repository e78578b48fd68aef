/* Differences of two images. */
#ifndef METRICS_H
#define METRICS_H

#include <fixsplat/internal/message.h>

struct fxs_metrics {
    double mse;    /* mean squared error, in levels of 0..255 */
    double psnr;   /* dB; infinity for equal images */
    double ssim;   /* mean structural similarity; 1 for equal images */
    int largest;   /* largest absolute difference, levels of 0..255 */
};

/* Compares the red, green and blue of two RGBA images. SSIM follows Wang et al. 2004 (Gaussian window of 11 x 11
   pixels, sigma 1.5, K1 0.01, K2 0.03): the mean over three channels and over all windows inside the image. A side
   shorter than 11 pixels shortens the window. Returns 0, or -1 if memory runs out. */
int fxs_metrics_compare(const uint8_t *a, const uint8_t *b, int width, int height, struct fxs_metrics *out);

/* The same for the pixels that count. SSIM uses the windows without ignored pixels; NaN if none exists. `mask`: one
   byte a pixel, 0: ignored; null: all count. Images without a counting pixel are equal. */
int fxs_metrics_compare_masked(const uint8_t *a, const uint8_t *b, const uint8_t *mask, int width, int height,
                               struct fxs_metrics *out);

/* PSNR in dB after the best affine map of the colours of `drawn` to the colours of `photograph`: for each of red,
   green and blue three factors and a constant, by least squares over the pixels that count; the result is clamped to
   0..255 and not rounded. Both images are RGBA; mask as above. Infinity if no difference is left. */
double fxs_metrics_affine_psnr(const uint8_t *drawn, const uint8_t *photograph, const uint8_t *mask, int width,
                               int height);

/* PSNR as text with four decimals; `equal` if infinite. Returns text. */
const char *fxs_metrics_psnr(char text[32], double psnr, const char *equal);

/* SSIM as text with six decimals; `none` if NaN. Returns text. */
const char *fxs_metrics_ssim(char text[32], double ssim, const char *none);

/* Writes min(8 |a - b|, 255) with alpha 255 as a picture file. Returns 0, or an error and a message. */
int fxs_metrics_difference(const char *path, const uint8_t *a, const uint8_t *b, int width, int height,
                           fxs_message *message);

#endif
