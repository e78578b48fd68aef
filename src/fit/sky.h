/* Points to begin a sky with: far out, where photographs look and the reconstruction has no points. */
#ifndef FXS_FIT_SKY_H
#define FXS_FIT_SKY_H

#include <fixsplat/fit.h>
#include "fit_stage.h"

typedef struct fxs_fit_sky {
    fxs_fit_point *points;
    size_t count;
    float sigma;                   /* of a Gaussian that overlaps with its neighbours, scene units */
    fxs_fit_far far;               /* about the mean of the cameras; its radius is the extent */
} fxs_fit_sky;

/* Spreads `directions` points evenly over a sphere about the mean of the cameras, 1000 times as large as their extent,
   or as the distance within which 19 of 20 points lie where that is more. Those stay that a photograph sees, and of
   most photographs that see it has a place there without points: none of a 48th of the longer side of the picture, nor
   in the cells of that size around. The colour is the mean of those photographs. Returns 0, with points that the caller
   frees, or FXS_ERR_MEMORY and none. */
int fxs_fit_sky_find(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points, size_t point_count,
                     uint32_t directions, float extent, fxs_fit_sky *sky);

#endif
