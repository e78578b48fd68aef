/* Chooses initial points of the sky: far away, in directions that photographs see but where the reconstruction has no
 * points. */
#ifndef FXS_FIT_SKY_H
#define FXS_FIT_SKY_H

#include <fixsplat/fit.h>
#include "src/fit/stages/fit_stage.h"

typedef struct fxs_fit_sky {
    fxs_fit_point *points;
    size_t count;
    float sigma;                   /* sigma of the sky's Gaussians in scene units, such that neighbours overlap */
    fxs_fit_far far;               /* sphere around the scene; middle: mean of the cameras; radius: extent of the
                                      scene */
} fxs_fit_sky;

/* Spreads `directions` points over a sphere about the mean of the cameras. Its radius is 1000 times the scene's extent,
   or 1000 times the distance that contains 19 of 20 points if larger. Keeps a point if more than half of the
   photographs that see it have no projected point near it. Returns 0 and points that the caller frees, or
   FXS_ERR_MEMORY. */
int fxs_fit_sky_find(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points, size_t point_count,
                     uint32_t directions, float extent, fxs_fit_sky *sky);

#endif
