/* The levels of detail of a packed scene, as `fixsplat info` prints them. */
#ifndef LEVELS_H
#define LEVELS_H

#include <fixsplat/fixsplat.h>

enum { LEVELS_MOST = 64 };

/* Chunks of a tree that stand for about as much: level 0 are its leaves, level k the nodes of at most 2^k leaves and of
   more than half as many. */
typedef struct scene_level {
    uint32_t chunks;
    uint64_t gaussians;
    double error;                  /* squared, colours^2 units^2: what their children remove, of all together */
    double size;                   /* units: sigma of what they leave out, the geometric mean */
} scene_level;

typedef struct scene_levels {
    scene_level levels[LEVELS_MOST];
    int count;                     /* 0: the scene has no tree */
    uint32_t chunk_bytes;          /* of each, with its header, and of a node its place in the tree */
    uint32_t node_bytes;
} scene_levels;

/* Counts the levels of an open scene that has all its rows. Returns 0, or prints that memory is missing and returns
   EXIT_FAILED. */
int levels_measure(scene_levels *levels, const fxs_scene *scene);

void levels_print_text(const scene_levels *levels);
void levels_print_json(const scene_levels *levels);     /* an array, without a newline */

#endif
