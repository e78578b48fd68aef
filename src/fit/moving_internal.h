/* The state of a fit that follows the moments of a moving scene (moving.h). */
#ifndef FXS_FIT_MOVING_INTERNAL_H
#define FXS_FIT_MOVING_INTERNAL_H

#include "fit_internal.h"

enum {
    STAYS, ASKED, ADDED            /* whether a Gaussian is tried: from the first step of a moment on, or later */
};

struct fxs_fit_moving {
    float *before;                 /* what steps change, in the last moment; planes of stride floats */
    float *last, *rest;            /* poses in the moment before that, and in the first */
    float *fitted;                 /* mean squared difference of each Gaussian when it was last fitted */
    float *errors, *weights, *some_errors, *some_weights;
    float *asking, *showing;       /* numbers of the photographs that ask a Gaussian to move, and that show it */
    uint32_t *order;               /* Gaussians in the order of the steps: those tried first */
    uint32_t *near;                /* NEAR neighbours of each Gaussian in the first moment */
    uint32_t *place;               /* place of each Gaussian in `order` */
    uint32_t *thing;               /* for each place in `order` that is tried, the first place of its thing */
    size_t made;                   /* number of Gaussians that are in use; the others are spare, and cannot be seen */
    uint8_t *tried, *moves, *doubtful, *carried;
    float *moved_errors;           /* mean squared differences at the new places */
    size_t count, stride, tried_count;
    int is_under_way;              /* 1: Gaussians have moved before */
};

/* Puts spare Gaussians where light passes through the scene and the photographs show something else than the
   background. Raises moving->made. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_fill_holes(fxs_fit *fit);

#endif
