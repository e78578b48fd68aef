/* Prints image metrics, and writes pictures of differences. */
#ifndef METRICS_H
#define METRICS_H

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/picture_metrics.h>

/* Formats a PSNR with four decimals, or as `equal` if infinite. Returns `text`. */
const char *fxs_metrics_psnr(char text[32], double psnr, const char *equal);

/* Formats an SSIM with six decimals, or as `none` if NaN. Returns `text`. */
const char *fxs_metrics_ssim(char text[32], double ssim, const char *none);

/* Writes a picture of the differences of two images: min(8 |a - b|, 255) in each channel, with alpha 255. Returns 0, or
   an error code and a message. */
int fxs_metrics_difference(const char *path, const uint8_t *a, const uint8_t *b, int width, int height,
                           fxs_message *message);

#endif
