/* Prints image metrics, and writes pictures of differences. */
#include "metrics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <fixsplat/image.h>

const char *fxs_metrics_psnr(char text[32], double psnr, const char *equal)
{
    if (isinf(psnr))
        snprintf(text, 32, "%s", equal);
    else
        snprintf(text, 32, "%.4f", psnr);
    return text;
}

const char *fxs_metrics_ssim(char text[32], double ssim, const char *none)
{
    if (isnan(ssim))
        snprintf(text, 32, "%s", none);
    else
        snprintf(text, 32, "%.6f", ssim);
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
