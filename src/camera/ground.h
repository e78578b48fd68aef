/* Finds the ground of a scene from its flat Gaussians. */
#ifndef FXS_GROUND_H
#define FXS_GROUND_H

#include "sample.h"
#include "within.h"

typedef struct fxs_ground {
    double axis[3];                  /* unit normal of the ground, pointing up or down */
    double spread;                   /* spread of the scene: radius of 98 % of the Gaussians / radius of 50 % of the
                                        Gaussians */
    double sided;                    /* side of the ground with most of the scene, -1 to 1; positive: the axis points
                                        there */
} fxs_ground;

/* Finds the normal of the ground near -y or z. `standing` is 1 or 2 for a subject standing along y or z, else 0.
   Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_ground_find(fxs_ground *ground, const fxs_sample *sample, const fxs_core *core, int standing,
                    fxs_message *message);

#endif
