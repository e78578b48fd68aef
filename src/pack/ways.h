/* How the Gaussians of a moving scene's level-of-detail tree move, as they are merged. */
#ifndef FXS_WAYS_H
#define FXS_WAYS_H

#include "coarsen.h"
#include "lives.h"

/* A span of time in which a chunk of 256 Gaussians is alive, seconds. */
typedef struct fxs_lifespan {
    double from, to;
} fxs_lifespan;

/* Describes the way of a Gaussian of a chunk, whose span is `own`, in the span `set` of the chunks that are merged.
   Moves the Gaussian to the middle of that span. */
void fxs_way_of(fxs_way *way, fxs_gaussian *gaussian, const fxs_motion *motion, fxs_lifespan own, fxs_lifespan set);

/* Converts a way in the span `set` to a motion. Moves the Gaussian from the middle of the span to the time of its
   largest opacity. */
void fxs_way_motion(fxs_motion *motion, fxs_gaussian *gaussian, const fxs_way *way, fxs_lifespan set);

#endif
