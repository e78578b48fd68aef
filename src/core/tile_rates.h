/* Rates: how many pixels a sample covers. A macro tile of 32x32 pixels with rate 2 or 4 shows, in each block of 2x2 or
 * 4x4 pixels, the Gaussians at one pixel of the block. */
#ifndef FXS_TILE_RATES_H
#define FXS_TILE_RATES_H

#include "frame.h"

#define FXS_RATE_PIXELS (FXS_MACRO * FXS_TILE)

/* Returns 0, or FXS_ERR_TARGET if a rate is not 1, 2 or 4, or if the view has the square cut-off, for which pixels of a
   macro tile have different splats. */
int fxs_rates_check(const fxs_image *rates, const fxs_stage_view *view);

/* Returns log2 of the rate of the macro tile with pixel (x, y). In the last column and row of macro tiles, the rate is
   halved while it does not divide the picture's width and height. So blocks never cross the picture's edge. */
int fxs_rate_shift(const fxs_image *rates, int32_t width, int32_t height, int32_t x, int32_t y);

/* Column and row, in a block of pixels with rate 2^shift, of the pixel that the block shows. */
static inline int32_t fxs_rate_pixel(int shift)
{
    return 1 << shift >> 1;
}

/* Writes the colours and coverage of the tile at pixel (x, y) with rate 2^shift. The first block of pixels shows sample
   number `first`, and the samples of adjacent blocks are `step` samples apart. */
void fxs_rate_resolve(const fxs_frame *f, const fxs_tile *samples, int shift, int first, int step, int32_t x,
                      int32_t y);

#endif
