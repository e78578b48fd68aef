/* Converts a tile's colour sums and transmittance to pixels, over the background colour. */
#include "memory.h"
#include "targets.h"

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

/* Stores a pixel of 16 bits per channel: a colour c becomes min(65535, round(65535 c)). */
static void store_wide(unsigned char *pixel, const int sum_q13[3], int transmittance_q15)
{
    uint16_t rgba[4];
    for (int c = 0; c < 3; c++)
        /* the product is below 2^31, because a colour sum is at most 32767 */
        rgba[c] = (uint16_t)fxs_min((sum_q13[c] * 65535 + 4096) >> 13, 65535);
    rgba[3] = (uint16_t)(((FXS_CLEAR_Q15 - transmittance_q15) * 65535 + 16384) >> 15);
    memcpy(pixel, rgba, sizeof rgba);
}

static void resolve_pixel(unsigned char *pixel, enum fxs_format format, const int sum_q13[3], int transmittance_q15,
                          const int background_q13[3])
{
    int rgb[3];
    if (format == FXS_FORMAT_RGBA16_COVERAGE) {
        store_wide(pixel, sum_q13, transmittance_q15);
        return;
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = fxs_resolve_8bit(sum_q13[c], transmittance_q15, background_q13[c]);
    store(pixel, format, rgb, transmittance_q15);
}

static void resolve_tile_pixel(unsigned char *pixel, enum fxs_format format, const fxs_tile *tile, int i,
                               const int background_q13[3])
{
    const int sum_q13[3] = {tile->sum_q13[0][i], tile->sum_q13[1][i], tile->sum_q13[2][i]};
    resolve_pixel(pixel, format, sum_q13, tile->transmittance_q15[i], background_q13);
}

void fxs_resolve_c(const fxs_options *options, enum fxs_format format, const fxs_tile *tile, int32_t columns,
                   int32_t rows, unsigned char *pixels, ptrdiff_t stride)
{
    const int bytes = fxs_pixel_bytes(format), clear = fxs_is_premultiplied(format);
    int background_q13[3];
    for (int c = 0; c < 3; c++)
        background_q13[c] = clear ? 0 : fxs_background_q13(options->background[c]);
    for (int32_t y = 0; y < rows; y++)
        for (int32_t x = 0; x < columns; x++)
            resolve_tile_pixel(pixels + y * stride + x * bytes, format, tile, y * FXS_TILE + x, background_q13);
}

void fxs_resolve_over(enum fxs_format format, const fxs_tile *tile, int32_t columns, int32_t rows,
                      const unsigned char *backdrop, ptrdiff_t backdrop_stride, unsigned char *pixels,
                      ptrdiff_t stride)
{
    const int bytes = fxs_pixel_bytes(format);
    for (int32_t y = 0; y < rows; y++)
        for (int32_t x = 0; x < columns; x++) {
            int background_q13[3];
            for (int c = 0; c < 3; c++)
                background_q13[c] = fxs_background_q13(backdrop[y * backdrop_stride + 4 * x + c]);
            resolve_tile_pixel(pixels + y * stride + x * bytes, format, tile, y * FXS_TILE + x, background_q13);
        }
}
