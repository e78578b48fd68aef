/* resolve, 2 * LANES pixels at a time: (255 c + 2^12) >> 13 is the rounding product with 4 * 255. */
#include "../../src/memory.h"
#include "stages.h"

static inline vh colour_8bit(const int16_t *sum_q13, vh transmittance_q15, vh background_q13)
{
    return mul_h(mul_add_cut_h(transmittance_q15, background_q13, load_h(sum_q13)), all_h(4 * 255));
}

static inline void resolve_pixels(unsigned char *to, const fxs_tile *tile, int i, const vh background_q13[3],
                                  int coverage)
{
    const vh t = load_h(tile->transmittance_q15 + i);
    const vh alpha = coverage ? mul_h(all_h(FXS_CLEAR_Q15) - t, all_h(255)) : all_h(255);
    store_pixels(to, colour_8bit(tile->sum_q13[0] + i, t, background_q13[0]),
                 colour_8bit(tile->sum_q13[1] + i, t, background_q13[1]),
                 colour_8bit(tile->sum_q13[2] + i, t, background_q13[2]), alpha);
}

FXS_RESOLVE(ISA)
{
    const int coverage = format == FXS_FORMAT_RGBA8_COVERAGE;
    vh background_q13[3];
    if (format != FXS_FORMAT_RGBA8 && !coverage) {
        fxs_resolve_c(options, format, tile, columns, rows, pixels, stride);
        return;
    }
    for (int c = 0; c < 3; c++)
        background_q13[c] = all_h(coverage ? 0 : fxs_background_q13(options->background[c]));
    for (int32_t y = 0; y < rows; y++) {
        unsigned char row[4 * FXS_TILE], *to = columns == FXS_TILE ? pixels + y * stride : row;
        for (int x = 0; x < FXS_TILE; x += 2 * LANES)
            resolve_pixels(to + 4 * x, tile, y * FXS_TILE + x, background_q13, coverage);
        if (to == row)
            memcpy(pixels + y * stride, row, (size_t)columns * 4);
    }
}
