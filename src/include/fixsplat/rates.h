/* Maps of rates for fxs_targets.rates. */
#ifndef FXS_RATES_H
#define FXS_RATES_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fills in a map of rates for a picture of width x height pixels: 1 for macro tiles with a pixel within radius_1 pixels
   of pixel (x, y), the gaze, else 2 within radius_2, else 4. */
FXS_EXPERIMENTAL void fxs_rates_around(fxs_image *rates, int32_t width, int32_t height, int32_t x, int32_t y,
                                       uint32_t radius_1, uint32_t radius_2);

#ifdef __cplusplus
}
#endif

#endif
