/* Initial points of a sky: far away, in directions that photographs see and the reconstruction has no points for. */
#ifndef FXS_FIT_SKY_H
#define FXS_FIT_SKY_H

#include <fixsplat/fit.h>
#include "fit_stage.h"

typedef struct fxs_fit_sky {
    fxs_fit_point *points;
    size_t count;
    float sigma;                   /* sigma of a Gaussian that overlaps its neighbours, scene units */
    fxs_fit_far far;               /* about the mean of the cameras; its radius is the extent */
} fxs_fit_sky;

/* Spreads `directions` points evenly over a sphere about the mean of the cameras. Its radius is 1000 times the extent,
   or 1000 times the distance that contains 19 of 20 points if that is larger. A point is kept if it is free in more
   than half of the photographs that see it: its cell (1/48 of the picture's longer side) and the cells around it
   contain no projected point. Its colour is the mean over the photographs in which it is free. Returns 0, and points
   that the caller frees, or FXS_ERR_MEMORY and none. */
int fxs_fit_sky_find(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points, size_t point_count,
                     uint32_t directions, float extent, fxs_fit_sky *sky);

#endif
