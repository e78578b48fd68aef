/* Levels of detail of the Gaussians that a writer has in memory. Each level has about half the Gaussians of the
   previous level. */
#ifndef FXS_HELD_LEVELS_INTERNAL_H
#define FXS_HELD_LEVELS_INTERNAL_H

#include "scene_write_internal.h"

enum { FXS_LEVELS_MOST = 40, FXS_LEVEL_SET = 256 };

/* A level of detail. Level 0 has the written Gaussians in sets of FXS_LEVEL_SET neighbours. A set of a higher level
   merges two sets of the previous level. If the previous level is a single set, its Gaussians are merged to half their
   number. */
typedef struct fxs_level {
    fxs_held_gaussian *gaussians;  /* gaussians and sh are null for level 0, whose Gaussians are in fxs_levels.held */
    int16_t *sh;
    uint32_t *into;                /* index in this level of each Gaussian of the previous level */
    uint32_t *begins;              /* index of the first Gaussian of each set, then the number of Gaussians */
    double *errors;                /* merging error of each set, in squared colours times squared scene units */
    uint32_t count, sets;
} fxs_level;

typedef struct fxs_levels {
    const fxs_held *held;
    fxs_level levels[FXS_LEVELS_MOST];
    uint32_t count;
} fxs_levels;

/* Makes up to `most` further levels of detail, until a level has a single Gaussian. Returns 1, or 0 if memory ran out
   or `progress` returned 0. */
int fxs_levels_make(fxs_levels *levels, const fxs_held *held, uint32_t most,
                    int (*progress)(void *argument, double done), void *argument);
void fxs_levels_free(fxs_levels *levels);

const fxs_held_gaussian *fxs_level_gaussian(const fxs_levels *levels, uint32_t level, uint32_t i);
const int16_t *fxs_level_sh(const fxs_levels *levels, uint32_t level, uint32_t i);

/* Returns the index of the first Gaussian of a set, or the number of Gaussians for a set beyond the last. */
uint32_t fxs_level_begin(const fxs_levels *levels, uint32_t level, uint32_t set);

#endif
