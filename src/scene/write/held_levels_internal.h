/* Levels of detail of the Gaussians that a writer holds: each has about half of those of the level before. */
#ifndef FXS_HELD_LEVELS_INTERNAL_H
#define FXS_HELD_LEVELS_INTERNAL_H

#include "scene_write_internal.h"

enum { FXS_LEVELS_MOST = 40, FXS_LEVEL_SET = 256 };

/* Level 0 are the Gaussians that are held, in their order, in sets of FXS_LEVEL_SET. A set of any other level is what
   two sets of the level before were merged to; where that had one set, half of it. */
typedef struct fxs_level {
    fxs_held_gaussian *gaussians;  /* null for level 0, as `sh` */
    int16_t *sh;
    uint32_t *into;                /* of each Gaussian of the level before, the one that it was merged into */
    uint32_t *begins;              /* of each set, and behind the last; null for level 0 */
    double *errors;                /* of each set, what merging since level 0 changed, colours^2 units^2; null there */
    uint32_t count, sets;
} fxs_level;

typedef struct fxs_levels {
    const fxs_held *held;          /* ordered */
    fxs_level levels[FXS_LEVELS_MOST];
    uint32_t count;
} fxs_levels;

/* Adds levels until there are `most`, at most FXS_LEVELS_MOST, or one with a single Gaussian. Returns 1, or 0 where
   memory ran out or `progress` returned 0; fxs_levels_free frees them in either case. */
int fxs_levels_make(fxs_levels *levels, const fxs_held *held, uint32_t most,
                    int (*progress)(void *argument, double done), void *argument);
void fxs_levels_free(fxs_levels *levels);

/* Gaussian `i` of a level, and its SH. */
const fxs_held_gaussian *fxs_level_gaussian(const fxs_levels *levels, uint32_t level, uint32_t i);
const int16_t *fxs_level_sh(const fxs_levels *levels, uint32_t level, uint32_t i);

/* The first Gaussian of a set, or behind the last one. */
uint32_t fxs_level_begin(const fxs_levels *levels, uint32_t level, uint32_t set);

#endif
