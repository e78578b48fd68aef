/* Converts 2 * LANES pixels of a tile together to the output format. The 8-bit colour (255 c + 2^12) >> 13 is
 * computed as the rounded product (4 * 255 c + 2^14) >> 15. */
#include "src/core/memory.h"
#include "stages.h"

static inline vh colour_8bit(const int16_t *sum_q13, vh transmittance_q15, vh background_q13)
{
    return mul_h(mul_add_cut_h(transmittance_q15, background_q13, load_h(sum_q13)), all_h(4 * 255));
}

static inline void resolve_rgba8(unsigned char *to, const fxs_tile *tile, int i, const vh background_q13[3],
                                 int coverage)
{
    const vh t = load_h(tile->transmittance_q15 + i);
    const vh alpha = coverage ? mul_h(all_h(FXS_CLEAR_Q15) - t, all_h(255)) : all_h(255);
    store_pixels(to, colour_8bit(tile->sum_q13[0] + i, t, background_q13[0]),
                 colour_8bit(tile->sum_q13[1] + i, t, background_q13[1]),
                 colour_8bit(tile->sum_q13[2] + i, t, background_q13[2]), alpha);
}

/* Scales a colour from 0..255 to 0..most: returns (most * c + 127) / 255 with c clamped to 255. For n < 65535, n / 255
   is computed as (n + 1 + (n >> 8)) >> 8. */
static inline vh of_255(vh colour, int most)
{
    const vh n = least_h(colour, all_h(255)) * all_h(most) + all_h(127);
    return (n + 1 + (n >> 8)) >> 8;
}

static inline void resolve_rgb565(unsigned char *to, const fxs_tile *tile, int i, const vh background_q13[3])
{
    const vh t = load_h(tile->transmittance_q15 + i);
    const vh r = of_255(colour_8bit(tile->sum_q13[0] + i, t, background_q13[0]), 31);
    const vh g = of_255(colour_8bit(tile->sum_q13[1] + i, t, background_q13[1]), 63);
    const vh b = of_255(colour_8bit(tile->sum_q13[2] + i, t, background_q13[2]), 31);
    store(to, (vi)(r << 11 | g << 5 | b));
}

/* Converts colours from Q13 to 16 bits: returns min((65535 c + 2^12) >> 13, 65535), computed as 8 c + ((2^12 - c) >>
   13) modulo 2^16. */
static inline vh colour_16bit(const int16_t *sum_q13)
{
    const vh c = least_h(load_h(sum_q13), all_h(8192));
    return (c << 3) + ((4096 - c) >> 13);
}

static inline void resolve_rgba16(unsigned char *to, const fxs_tile *tile, int i)
{
    const vh taken = all_h(FXS_CLEAR_Q15) - load_h(tile->transmittance_q15 + i);
    /* equals the 16-bit alpha (65535 taken + 2^14) >> 15, where taken is 1 - transmittance, Q15 */
    const vh alpha = (taken << 1) + ((16384 - taken) >> 15);
    store_wide_pixels(to, colour_16bit(tile->sum_q13[0] + i), colour_16bit(tile->sum_q13[1] + i),
                      colour_16bit(tile->sum_q13[2] + i), alpha);
}

static inline void resolve_row(unsigned char *to, enum fxs_format format, const fxs_tile *tile, int first,
                               const vh background_q13[3])
{
    for (int x = 0; x < FXS_TILE; x += 2 * LANES)
        if (format == FXS_FORMAT_RGB565)
            resolve_rgb565(to + 2 * x, tile, first + x, background_q13);
        else if (format == FXS_FORMAT_RGBA16_COVERAGE)
            resolve_rgba16(to + 8 * x, tile, first + x);
        else
            resolve_rgba8(to + 4 * x, tile, first + x, background_q13, format == FXS_FORMAT_RGBA8_COVERAGE);
}

FXS_RESOLVE(ISA)
{
    vh background_q13[3];
    for (int c = 0; c < 3; c++)
        background_q13[c] = all_h(fxs_is_premultiplied(format) ? 0 : fxs_background_q13(options->background[c]));
    for (int32_t y = 0; y < rows; y++) {
        unsigned char row[8 * FXS_TILE], *to = columns == FXS_TILE ? pixels + y * stride : row;
        resolve_row(to, format, tile, y * FXS_TILE, background_q13);
        if (to == row)
            memcpy(pixels + y * stride, row, (size_t)columns * (size_t)fxs_pixel_bytes(format));
    }
}
