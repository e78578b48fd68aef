/* Compares two images by mean squared error, PSNR and SSIM. */
#ifndef METRICS_H
#define METRICS_H

#include <fixsplat/internal/message.h>

struct fxs_metrics {
    double mse;    /* mean squared error in colour levels of 0..255 */
    double psnr;   /* PSNR in dB; infinity for equal images */
    double ssim;   /* mean structural similarity; 1: equal images */
    int largest;   /* largest absolute difference in colour levels of 0..255 */
};

/* Compares the red, green and blue of RGBA images. SSIM follows Wang et al. 2004, with a Gaussian window of 11x11
   pixels, sigma 1.5, K1 0.01, K2 0.03. SSIM is the mean over channels and over windows inside the image. Returns 0;
   -1: out of memory. */
int fxs_metrics_compare(const uint8_t *a, const uint8_t *b, int width, int height, struct fxs_metrics *out);

/* Compares two images, but ignores the pixels that are 0 in `mask`. Null: no pixel is ignored. SSIM uses only windows
   without ignored pixels; it is NaN if there is no such window. */
int fxs_metrics_compare_masked(const uint8_t *a, const uint8_t *b, const uint8_t *mask, int width, int height,
                               struct fxs_metrics *out);

/* Returns the PSNR in dB after the best affine map of the colours of `drawn` to those of `photograph`. The map is
   found by least squares over the pixels with a nonzero `mask`. Mapped colours are clamped to 0..255 and not
   rounded. Infinity: no difference. */
double fxs_metrics_affine_psnr(const uint8_t *drawn, const uint8_t *photograph, const uint8_t *mask, int width,
                               int height);

/* Formats a PSNR with four decimals, or as `equal` if infinite. Returns `text`. */
const char *fxs_metrics_psnr(char text[32], double psnr, const char *equal);

/* Formats an SSIM with six decimals, or as `none` if NaN. Returns `text`. */
const char *fxs_metrics_ssim(char text[32], double ssim, const char *none);

/* Writes a picture of the differences of two images: min(8 |a - b|, 255) in each channel, with alpha 255. Returns 0, or
   an error code and a message. */
int fxs_metrics_difference(const char *path, const uint8_t *a, const uint8_t *b, int width, int height,
                           fxs_message *message);

#endif
