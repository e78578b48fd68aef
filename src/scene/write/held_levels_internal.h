/* Levels of detail of the Gaussians in an fxs_held. Each level has about half the Gaussians of the previous one. */
#ifndef FXS_HELD_LEVELS_INTERNAL_H
#define FXS_HELD_LEVELS_INTERNAL_H

#include "scene_write_internal.h"

enum { FXS_LEVELS_MOST = 40, FXS_LEVEL_SET = 256 };

/* Level 0: the held Gaussians in their order, in sets of FXS_LEVEL_SET. A set of a higher level merges two sets of the
   previous level. If the previous level has only one set, the Gaussians of this set are merged to half their number. */
typedef struct fxs_level {
    fxs_held_gaussian *gaussians;  /* gaussians and sh: null for level 0 */
    int16_t *sh;
    uint32_t *into;                /* for each Gaussian of the previous level: the Gaussian that contains it */
    uint32_t *begins;              /* start of each set, and the end; null for level 0 */
    double *errors;                /* for each set: error of all merging since level 0, colours^2 units^2; null for
                                      level 0 */
    uint32_t count, sets;
} fxs_level;

typedef struct fxs_levels {
    const fxs_held *held;          /* ordered */
    fxs_level levels[FXS_LEVELS_MOST];
    uint32_t count;
} fxs_levels;

/* Adds levels up to `most` (at most FXS_LEVELS_MOST), or until one has a single Gaussian. Returns 1, or 0 if memory ran
   out or `progress` returned 0. Free with fxs_levels_free in either case. */
int fxs_levels_make(fxs_levels *levels, const fxs_held *held, uint32_t most,
                    int (*progress)(void *argument, double done), void *argument);
void fxs_levels_free(fxs_levels *levels);

/* Return Gaussian `i` of a level, and its SH. */
const fxs_held_gaussian *fxs_level_gaussian(const fxs_levels *levels, uint32_t level, uint32_t i);
const int16_t *fxs_level_sh(const fxs_levels *levels, uint32_t level, uint32_t i);

/* Returns the first Gaussian of a set; beyond the last set, the end. */
uint32_t fxs_level_begin(const fxs_levels *levels, uint32_t level, uint32_t set);

#endif
