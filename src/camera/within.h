/* Finds places within a scene from which it may have been captured. */
#ifndef FXS_WITHIN_H
#define FXS_WITHIN_H

#include "sample.h"

#define FXS_WITHIN_MOST 3            /* places */

/* The region of most small Gaussians. Captures have small Gaussians near their cameras. */
typedef struct fxs_core {
    double middle[3];
    double reach;                    /* median distance from the middle */
    double low[3], high[3];          /* box without 2 % of the points at each end of each axis */
} fxs_core;

/* A place with free space around it. */
typedef struct fxs_within {
    double place[3];
    double clear;                    /* harmonic mean distance of the surroundings over directions */
    double merit;                    /* grows with the share of covered directions and with `clear` */
} fxs_within;

double fxs_distance(const double a[3], const double b[3]);

/* Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_core_find(fxs_core *core, const fxs_sample *s, fxs_message *message);

/* 1 or 2 if the core is much taller along y or z than wide, like a standing figure; else 0. */
int fxs_core_stands(const fxs_core *core);

/* Finds up to FXS_WITHIN_MOST places in the lower half of the core, best first. Returns their number. */
int fxs_within_find(fxs_within found[FXS_WITHIN_MOST], const fxs_sample *sample, const fxs_core *core,
                    const double up[3]);

#endif
