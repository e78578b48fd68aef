/* resolve: sums and transmittance of a tile, over the background, as pixels. */
#include "memory.h"
#include "stage.h"

static void store(unsigned char *pixel, enum fxs_format format, const int rgb[3], int transmittance_q15)
{
    if (format == FXS_FORMAT_RGB565) {
        uint16_t packed = fxs_little_16(fxs_rgb565(rgb[0], rgb[1], rgb[2]));
        memcpy(pixel, &packed, sizeof packed);
        return;
    }
    for (int c = 0; c < 3; c++)
        pixel[c] = (unsigned char)rgb[c];
    pixel[3] = format == FXS_FORMAT_RGBA8 ? 255 : (unsigned char)fxs_coverage_8bit(transmittance_q15);
}

void fxs_resolve_c(const fxs_options *options, const fxs_tile *tile, int32_t columns, int32_t rows,
                   unsigned char *pixels, ptrdiff_t stride)
{
    const int bytes = fxs_pixel_bytes(options);
    int background_q13[3], rgb[3];
    for (int c = 0; c < 3; c++)
        background_q13[c] = fxs_background_q13(options, c);
    for (int32_t y = 0; y < rows; y++)
        for (int32_t x = 0; x < columns; x++) {
            int i = y * FXS_TILE + x;
            for (int c = 0; c < 3; c++)
                rgb[c] = fxs_resolve_8bit(tile->sum_q13[c][i], tile->transmittance_q15[i], background_q13[c]);
            store(pixels + y * stride + x * bytes, options->format, rgb, tile->transmittance_q15[i]);
        }
}
