/* The motion of Gaussians that are merged for the level-of-detail tree of a moving scene. */
#ifndef FXS_WAYS_H
#define FXS_WAYS_H

#include "coarsen.h"
#include "lives.h"

/* The time of a chunk's life, seconds. */
typedef struct fxs_lifespan {
    double from, to;
} fxs_lifespan;

/* Describes the way of a Gaussian in the life `set` of the chunks that are merged. Its own chunk has the life `own`.
   Moves the Gaussian to the middle of `set`. */
void fxs_way_of(fxs_way *way, fxs_gaussian *gaussian, const fxs_motion *motion, fxs_lifespan own, fxs_lifespan set);

/* Converts a way in the life `set` to a motion. Moves the Gaussian from the middle of `set` to the time of its
   largest opacity. */
void fxs_way_motion(fxs_motion *motion, fxs_gaussian *gaussian, const fxs_way *way, fxs_lifespan set);

#endif
