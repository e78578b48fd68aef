/* Finds places inside a scene from which the scene may have been captured. */
#ifndef FXS_WITHIN_H
#define FXS_WITHIN_H

#include "sample.h"

#define FXS_WITHIN_MOST 3

/* The core of a scene: the region of most small Gaussians, which captured scenes have near their cameras. */
typedef struct fxs_core {
    double middle[3];
    double reach;                    /* median distance of the small Gaussians from the core's middle */
    double low[3], high[3];          /* box of the core, without the outer 2 % of the points on each side */
} fxs_core;

typedef struct fxs_within {
    double place[3];
    double clear;                    /* harmonic mean distance from the place to its surroundings */
    double merit;                    /* rating of the place; it grows with covered directions and free distance */
} fxs_within;

double fxs_distance(const double a[3], const double b[3]);

int fxs_core_find(fxs_core *core, const fxs_sample *s, fxs_message *message);

/* Returns the core's height along the axis, 1 or 2 (y or z), divided by its larger width. */
double fxs_core_height(const fxs_core *core, int axis);

/* Returns 1 or 2 if the scene's core stands tall along y or z, like a figure; else 0. */
int fxs_core_stands(const fxs_core *core);

/* Finds free places in the lower half of the scene's core, best first. Returns the number of places. */
int fxs_within_find(fxs_within found[FXS_WITHIN_MOST], const fxs_sample *sample, const fxs_core *core,
                    const double up[3]);

#endif
