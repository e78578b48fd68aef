/* Converts the pixels of a tile to RGB565 on Cortex-M without vectors; the C version handles other formats. Pixels
 * without splats get the background, which is converted once. */
#include "src/core/memory.h"
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/pixel.h>
#include "kernels/simd/lanes/stages.h"

/* Scales a colour from 0..255 to 0..most: returns (most * c + 127) / 255. For n < 65535, n / 255 is computed as (n + 1
   + (n >> 8)) >> 8. */
static inline int of_255(int c, int most)
{
    const int n = most * c + 127;
    return (n + 1 + (n >> 8)) >> 8;
}

static inline uint16_t pixel_565(const int sum_q13[3], int transmittance_q15, const int background_q13[3])
{
    int c[3];
    for (int i = 0; i < 3; i++)
        c[i] = fxs_resolve_8bit(sum_q13[i], transmittance_q15, background_q13[i]);
    return (uint16_t)(of_255(c[0], 31) << 11 | of_255(c[1], 63) << 5 | of_255(c[2], 31));
}

FXS_RESOLVE(cortexm)
{
    const int none[3] = {0, 0, 0};
    int background_q13[3];
    if (format != FXS_FORMAT_RGB565) {
        fxs_resolve_c(options, format, tile, columns, rows, pixels, stride);
        return;
    }
    for (int i = 0; i < 3; i++)
        background_q13[i] = fxs_background_q13(options->background[i]);
    const uint16_t background = pixel_565(none, FXS_CLEAR_Q15, background_q13);
    for (int32_t y = 0; y < rows; y++, pixels += stride)
        for (int32_t x = 0; x < columns; x++) {
            const int16_t *at = tile->sum_q13[0] + y * FXS_TILE + x;
            const int sum_q13[3] = {at[0], at[FXS_TILE_PIXELS], at[2 * FXS_TILE_PIXELS]};
            const int t = tile->transmittance_q15[y * FXS_TILE + x];
            const int touched = t != FXS_CLEAR_Q15 || sum_q13[0] | sum_q13[1] | sum_q13[2];
            const uint16_t packed = fxs_little_16(touched ? pixel_565(sum_q13, t, background_q13) : background);
            memcpy(pixels + 2 * x, &packed, sizeof packed);
        }
}
