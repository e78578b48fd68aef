/* Gaussians that have nearly nothing near them: scene_filter.h says which. */
#ifndef FXS_FLOATERS_INTERNAL_H
#define FXS_FLOATERS_INTERNAL_H

#include <fixsplat/scene_file.h>

typedef struct fxs_floater {
    float position[3];
    int16_t level;                /* of the cells, 2^level wide, that it is looked for in */
    uint8_t floats;
} fxs_floater;

typedef struct fxs_floaters {
    fxs_floater *items;
    uint32_t count, next, room;
    int found;
} fxs_floaters;

/* For up to `count` Gaussians. Returns 0, or an error and a message. */
int fxs_floaters_init(fxs_floaters *floaters, uint64_t count, const fxs_allocator *allocator, fxs_message *message);

/* Takes the next Gaussian. Once they are found, returns whether it floats; before, 0. */
int fxs_floaters_take(fxs_floaters *floaters, const fxs_gaussian *gaussian);

/* Finds those that float; `next` is to be set to 0 before they are taken again. Returns 0, or an error and a
   message. */
int fxs_floaters_find(fxs_floaters *floaters, const fxs_allocator *allocator, fxs_message *message);

void fxs_floaters_free(fxs_floaters *floaters, const fxs_allocator *allocator);

#endif
