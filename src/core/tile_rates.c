/* Maps of rates, and tiles whose pixels share samples. */
#include <fixsplat/rates.h>

#include "memory.h"
#include "targets.h"
#include "tile_rates.h"

static int is_rate(unsigned rate)
{
    return rate == 1 || rate == 2 || rate == 4;
}

int fxs_rates_check(const fxs_image *rates, const fxs_stage_view *view)
{
    int fit = !rates->pixels || view->cutoff != FXS_CUTOFF_SQUARE;
    for (int32_t y = 0; rates->pixels && y * FXS_RATE_PIXELS < view->height; y++)
        for (int32_t x = 0; x * FXS_RATE_PIXELS < view->width; x++)
            fit &= is_rate(*fxs_image_at(rates, x, y, 1));
    return fit ? 0 : FXS_ERR_TARGET;
}

int fxs_rate_shift(const fxs_image *rates, int32_t width, int32_t height, int32_t x, int32_t y)
{
    const int32_t column = x / FXS_RATE_PIXELS, row = y / FXS_RATE_PIXELS;
    const unsigned rate = rates->pixels ? *fxs_image_at(rates, column, row, 1) : 1;
    const int32_t right = column == width / FXS_RATE_PIXELS ? width : 0;
    const int32_t lower = row == height / FXS_RATE_PIXELS ? height : 0;
    int shift = is_rate(rate) ? (int)rate / 2 : 0;     /* another program may change the map after the check */
    while ((right | lower) & ((1 << shift) - 1))
        shift--;
    return shift;
}

static void spread(int16_t to[FXS_TILE_PIXELS], const int16_t *from, int shift, int step)
{
    const size_t row_bytes = FXS_TILE * sizeof *to;
    for (int row = 0; row < FXS_TILE; row += 1 << shift, to += FXS_TILE << shift, from += step * FXS_TILE) {
        for (int i = 0; i < FXS_TILE; i++)
            to[i] = from[step * (i >> shift)];
        for (int below = 1; below < 1 << shift; below++)
            memcpy(to + below * FXS_TILE, to, row_bytes);
    }
}

void fxs_rate_resolve(const fxs_frame *f, const fxs_tile *samples, int shift, int first, int step, int32_t x,
                      int32_t y)
{
    fxs_tile pixels;
    spread(pixels.transmittance_q15, samples->transmittance_q15 + first, shift, step);
    for (int c = 0; c < 3; c++)
        spread(pixels.sum_q13[c], samples->sum_q13[c] + first, shift, step);
    fxs_resolve_targets(f, &pixels, x, y);
}

/* Distance along one axis from position c to the nearest pixel of a macro tile that starts at `first`. */
static int64_t distance(int64_t c, int32_t first)
{
    const int64_t last = (int64_t)first + FXS_RATE_PIXELS - 1;
    return c < first ? first - c : c > last ? c - last : 0;
}

void fxs_rates_around(fxs_image *rates, int32_t width, int32_t height, int32_t x, int32_t y, uint32_t radius_1,
                      uint32_t radius_2)
{
    for (int32_t top = 0; top < height; top += FXS_RATE_PIXELS)
        for (int32_t left = 0; left < width; left += FXS_RATE_PIXELS) {
            const uint64_t across = (uint64_t)distance(x, left), down = (uint64_t)distance(y, top);
            const uint64_t square = across * across + down * down;
            *fxs_image_at(rates, left / FXS_RATE_PIXELS, top / FXS_RATE_PIXELS, 1) =
                square <= (uint64_t)radius_1 * radius_1 ? 1 : square <= (uint64_t)radius_2 * radius_2 ? 2 : 4;
        }
}
