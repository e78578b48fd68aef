/* Procedural scenes for golden images, benchmarks and pictures. Gaussian i depends only on i, count and seed, so
   scenes of any size can be streamed. The code uses only integer hashes, + - * / and sqrt, so results are identical
   on every machine with IEEE 754 doubles. The y axis points down. */
#ifndef FXS_PROCEDURAL_H
#define FXS_PROCEDURAL_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/scene.h>

typedef struct fxs_procedural_scene {
    const char *name;
    const char *description;
    int sh_degree;             /* degree of the spherical harmonics, 0 to 3 */
    uint64_t count;
    /* Writes Gaussian i, 0 <= i < count, of a scene with `count` Gaussians, at most 2^40. */
    void (*gaussian)(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out);
} fxs_procedural_scene;

const fxs_procedural_scene *fxs_procedural_list(size_t *count);

const fxs_procedural_scene *fxs_procedural_find(const char *name);

#endif
