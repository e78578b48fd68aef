/* Levels of detail of held Gaussians. Each level has about half the Gaussians of the previous level. */
#ifndef FXS_HELD_LEVELS_INTERNAL_H
#define FXS_HELD_LEVELS_INTERNAL_H

#include "scene_write_internal.h"

enum { FXS_LEVELS_MOST = 40, FXS_LEVEL_SET = 256 };

/* Level 0 has the held Gaussians in sets of FXS_LEVEL_SET. A set of a higher level merges two sets of the previous
   level. If the previous level is a single set, its Gaussians are merged to half their number. */
typedef struct fxs_level {
    fxs_held_gaussian *gaussians;  /* gaussians and sh are null for level 0 */
    int16_t *sh;
    uint32_t *into;                /* for each Gaussian of the previous level, the index after merging */
    uint32_t *begins;              /* start of each set of Gaussians, and the end */
    double *errors;                /* merging error of each set, colours^2 units^2 */
    uint32_t count, sets;
} fxs_level;

typedef struct fxs_levels {
    const fxs_held *held;
    fxs_level levels[FXS_LEVELS_MOST];
    uint32_t count;
} fxs_levels;

/* Adds up to `most` levels, until a level has a single Gaussian. Returns 1, or 0 if memory ran out or `progress`
   returned 0. */
int fxs_levels_make(fxs_levels *levels, const fxs_held *held, uint32_t most,
                    int (*progress)(void *argument, double done), void *argument);
void fxs_levels_free(fxs_levels *levels);

const fxs_held_gaussian *fxs_level_gaussian(const fxs_levels *levels, uint32_t level, uint32_t i);
const int16_t *fxs_level_sh(const fxs_levels *levels, uint32_t level, uint32_t i);

/* Returns the first Gaussian of a set, or the end beyond the last set. */
uint32_t fxs_level_begin(const fxs_levels *levels, uint32_t level, uint32_t set);

#endif
