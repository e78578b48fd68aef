/* Points to begin a sky with: far out, where photographs look and the reconstruction has no points. */
#ifndef FXS_FIT_SKY_H
#define FXS_FIT_SKY_H

#include <fixsplat/fit.h>
#include "fit_stage.h"

typedef struct fxs_fit_sky {
    fxs_fit_point *points;
    size_t count;
    float sigma;                   /* of a Gaussian that overlaps with its neighbours, scene units */
    fxs_fit_far far;               /* about the mean of the cameras */
} fxs_fit_sky;

/* The radius of sky->far is the extent of the cameras, or the distance from their mean within which 19 of 20 points lie
   where that is more. Spreads `directions` points evenly over a sphere 1000 times as large. A point stays where more than
   half of the photographs that see it have no point of the reconstruction near it: in a cell of a 48th of the longer side
   of the picture, and those around it. Its colour is the mean of these photographs. Returns 0, with points that the
   caller frees, or FXS_ERR_MEMORY and none. */
int fxs_fit_sky_find(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points, size_t point_count,
                     uint32_t directions, float extent, fxs_fit_sky *sky);

#endif
