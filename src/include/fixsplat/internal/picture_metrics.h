/* Compares two images by mean squared error, PSNR and SSIM. */
#ifndef FXS_INTERNAL_PICTURE_METRICS_H
#define FXS_INTERNAL_PICTURE_METRICS_H

#include <stdint.h>

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

struct fxs_metrics {
    double mse;    /* mean squared error in colour levels of 0..255 */
    double psnr;   /* PSNR in dB; infinity for equal images */
    double ssim;   /* mean structural similarity; 1: equal images */
    int largest;   /* largest absolute difference in colour levels of 0..255 */
};

/* Compares the red, green and blue of RGBA images. SSIM follows Wang et al. 2004, with a Gaussian window of 11x11
   pixels, sigma 1.5, K1 0.01, K2 0.03. SSIM is the mean over channels and over windows inside the image. Returns 0;
   -1: out of memory. */
FXS_EXPERIMENTAL int fxs_metrics_compare(const uint8_t *a, const uint8_t *b, int width, int height,
                                         struct fxs_metrics *out);

/* Computes all metrics but SSIM, which takes most of the time of fxs_metrics_compare. ssim becomes NaN. */
FXS_EXPERIMENTAL void fxs_metrics_without_ssim(const uint8_t *a, const uint8_t *b, int width, int height,
                                               struct fxs_metrics *out);

/* Compares two images, but ignores the pixels that are 0 in `mask`. Null: no pixel is ignored. SSIM uses only windows
   without ignored pixels; it is NaN if there is no such window. */
FXS_EXPERIMENTAL int fxs_metrics_compare_masked(const uint8_t *a, const uint8_t *b, const uint8_t *mask, int width,
                                                int height, struct fxs_metrics *out);

/* Returns the PSNR in dB after the best affine map of the colours of `drawn` to those of `photograph`. The map is
   found by least squares over the pixels with a nonzero `mask`. Mapped colours are clamped to 0..255 and not
   rounded. Infinity: no difference. */
FXS_EXPERIMENTAL double fxs_metrics_affine_psnr(const uint8_t *drawn, const uint8_t *photograph, const uint8_t *mask,
                                                int width, int height);

#ifdef __cplusplus
}
#endif

#endif
