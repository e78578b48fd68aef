/* The levels of detail of a scene's tree, as printed by `fixsplat info`. */
#ifndef LEVELS_H
#define LEVELS_H

#include <fixsplat/fixsplat.h>

enum { LEVELS_MOST = 64 };

/* A level of the tree. Level 0 has the leaves, level k the nodes above 2^(k-1) + 1 to 2^k leaves. */
typedef struct scene_level {
    uint32_t chunks;
    uint64_t gaussians;
    double error;                  /* squared error that drawing the children would remove, colours^2 units^2 */
    double size;                   /* geometric mean of the sigmas of omitted details, scene units */
} scene_level;

typedef struct scene_levels {
    scene_level levels[LEVELS_MOST];
    int count;                     /* number of levels; 0: no tree */
    uint32_t chunk_bytes;          /* bytes of a chunk of 256 Gaussians */
    uint32_t node_bytes;
} scene_levels;

/* Measures the levels of a scene that is wholly in memory. */
int levels_measure(scene_levels *levels, const fxs_scene *scene);

void levels_print_text(const scene_levels *levels);
void levels_print_json(const scene_levels *levels);

#endif
