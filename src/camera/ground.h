/* The ground of a scene, by the flat Gaussians that lie along it. */
#ifndef FXS_GROUND_H
#define FXS_GROUND_H

#include "sample.h"

typedef struct fxs_ground {
    double axis[3];                  /* across the ground, of length 1: up, or the opposite */
    double spread;                   /* the distance within which 98 % of the Gaussians lie, over that of half of them */
    double sided;                    /* more than 0: most of the scene lies on the axis's side of the ground; -1 to 1 */
} fxs_ground;

/* The axis is -y or z, or near one of them. `standing`: 1 or 2 if the scene is a thing standing along y or z, else 0.
   Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_ground_find(fxs_ground *ground, const fxs_sample *sample, int standing, fxs_message *message);

#endif
