/* Procedural scenes, computed by formulas, for golden images, benchmarks and pictures. Gaussian i depends only on i,
   count and seed, so a scene of any size can be streamed. Results are identical to the last bit on every machine and
   compiler with IEEE 754 doubles, because only integer hashes, + - * / and sqrt are used. The build needs
   -ffp-contract=off.

   The y axis points down and the centre of a scene is near the origin. Gaussians shrink as count grows, so that the
   coverage stays the same. */
#ifndef FXS_PROCEDURAL_H
#define FXS_PROCEDURAL_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/scene.h>

typedef struct fxs_procedural_scene {
    const char *name;
    const char *description;   /* one line */
    int sh_degree;             /* 0 to 3 */
    uint64_t count;            /* default number of Gaussians */
    /* Writes Gaussian i, 0 <= i < count, of a scene with `count` Gaussians, at most 2^40. */
    void (*gaussian)(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out);
} fxs_procedural_scene;

/* Returns all scenes, a static array of *count. */
const fxs_procedural_scene *fxs_procedural_list(size_t *count);

/* Returns the scene of this name, or null. */
const fxs_procedural_scene *fxs_procedural_find(const char *name);

#endif
