/* Finds the ground of a scene from its flat Gaussians. */
#ifndef FXS_GROUND_H
#define FXS_GROUND_H

#include "sample.h"

typedef struct fxs_ground {
    double axis[3];                  /* unit normal of the ground, up or down */
    double spread;                   /* radius of 98 % of the Gaussians / radius of 50 % of the Gaussians */
    double sided;                    /* -1 to 1; positive: most of the scene lies on the axis's side */
} fxs_ground;

/* Finds a ground axis near -y or z. standing: 1 or 2 for a subject standing along y or z, else 0. Returns 0, or
   FXS_ERR_MEMORY and a message. */
int fxs_ground_find(fxs_ground *ground, const fxs_sample *sample, int standing, fxs_message *message);

#endif
