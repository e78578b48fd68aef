/* Places within a scene that a capture may have been made from. */
#ifndef FXS_WITHIN_H
#define FXS_WITHIN_H

#include "sample.h"

#define FXS_WITHIN_MOST 3            /* places */

/* Where most of the small Gaussians lie: a capture has them where its cameras were near. */
typedef struct fxs_core {
    double middle[3];
    double reach;                    /* the distance from the middle within which half of them lie */
    double low[3], high[3];          /* the box of all but 2 % of them at each end of an axis */
} fxs_core;

/* A place with free space about it. */
typedef struct fxs_within {
    double place[3];
    double clear;                    /* harmonic mean distance of the surroundings, over directions */
    double merit;                    /* grows with the share of directions that show something, and with `clear` */
} fxs_within;

double fxs_distance(const double a[3], const double b[3]);

/* Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_core_find(fxs_core *core, const fxs_sample *s, fxs_message *message);

/* 1 or 2 where the core is much higher along y or z than it is wide, as a figure that stands; else 0. */
int fxs_core_stands(const fxs_core *core);

/* Finds up to FXS_WITHIN_MOST places in the lower half of the core's box, the best first. Returns how many. */
int fxs_within_find(fxs_within found[FXS_WITHIN_MOST], const fxs_sample *sample, const fxs_core *core,
                    const double up[3]);

#endif
