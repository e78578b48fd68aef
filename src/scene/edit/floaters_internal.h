/* Finds floaters: isolated Gaussians, which have few neighbours. */
#ifndef FXS_FLOATERS_INTERNAL_H
#define FXS_FLOATERS_INTERNAL_H

#include <fixsplat/scene.h>

typedef struct fxs_floater {
    float position[3];
    float end[3];                 /* vector from the Gaussian's centre along its longest axis, one sigma long */
    int16_t level;
    uint8_t opaque, floats;
} fxs_floater;

typedef struct fxs_floaters {
    fxs_floater *items;
    uint32_t count, next, room;
    int strength, found;
} fxs_floaters;

/* Prepares a search for floaters among `count` Gaussians. strength: strictness of the search, 1 to
   FXS_FLOATER_STRENGTHS. Returns 0, or an error and a message. */
int fxs_floaters_init(fxs_floaters *floaters, int strength, uint64_t count, const fxs_allocator *allocator,
                      fxs_message *message);

/* Adds a Gaussian to the search for floaters and returns 0. After fxs_floaters_find, takes the same Gaussians again,
   and returns 1 for a floater, else 0. */
int fxs_floaters_take(fxs_floaters *floaters, const fxs_gaussian *gaussian);

/* Finds the floaters among all Gaussians that were added. Set the field `next` to 0 before each further pass over the
   Gaussians. Returns 0, or an error and a message. */
int fxs_floaters_find(fxs_floaters *floaters, const fxs_allocator *allocator, fxs_message *message);

void fxs_floaters_free(fxs_floaters *floaters, const fxs_allocator *allocator);

#endif
