/* Finds one thing in a scene without cameras, such as a statue on the ground. */
#ifndef FXS_THING_INTERNAL_H
#define FXS_THING_INTERNAL_H

#include <fixsplat/scene.h>

typedef struct fxs_thing_grid fxs_thing_grid;

typedef struct fxs_thing {
    enum {FXS_THING_SAMPLE, FXS_THING_FILL, FXS_THING_FILL_LEVEL, FXS_THING_KEEP} pass;
    double frame[3][3];           /* directions of the grid's axes in the scene: sideways, down, to the front */
    double middle[3], cell;       /* middle of the grid; width of a cell, scene units */
    uint64_t step, next;          /* every step-th Gaussian is in the sample */
    fxs_thing_grid *grid;
} fxs_thing;

/* Prepares a search for the thing among `count` Gaussians. up: about the scene's up direction; 0: -y. Returns 0, or an
   error and a message. */
int fxs_thing_init(fxs_thing *thing, uint64_t count, const double up[3], const fxs_allocator *allocator,
                   fxs_message *message);

/* Takes all Gaussians once in each pass. Returns 1 in the last pass for a Gaussian outside the thing, else 0. */
int fxs_thing_take(fxs_thing *thing, const fxs_gaussian *gaussian);

/* Ends a pass, except the last one. Returns 0, or FXS_ERR_ARGUMENT and a message if no thing stands out. */
int fxs_thing_next(fxs_thing *thing, fxs_message *message);

void fxs_thing_free(fxs_thing *thing, const fxs_allocator *allocator);

#endif
