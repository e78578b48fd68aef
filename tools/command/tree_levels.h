/* The levels of detail of a packed scene, as printed by `fixsplat info`. */
#ifndef LEVELS_H
#define LEVELS_H

#include <fixsplat/fixsplat.h>

enum { LEVELS_MOST = 64 };

/* Chunks of a tree with about equal numbers of leaves: level 0 the leaves, level k the nodes with more than 2^(k-1)
   and up to 2^k leaves. */
typedef struct scene_level {
    uint32_t chunks;
    uint64_t gaussians;
    double error;                  /* sum over nodes: squared error that their children remove, colours^2 units^2 */
    double size;                   /* geometric mean of the sigma of the details left out, units */
} scene_level;

typedef struct scene_levels {
    scene_level levels[LEVELS_MOST];
    int count;                     /* 0: no tree */
    uint32_t chunk_bytes;          /* size of a chunk with its header; node_bytes: size of a node's record */
    uint32_t node_bytes;
} scene_levels;

/* Counts the levels of an open scene that has all its rows in memory. Returns 0, or prints that memory ran out and
   returns EXIT_FAILED. */
int levels_measure(scene_levels *levels, const fxs_scene *scene);

void levels_print_text(const scene_levels *levels);
void levels_print_json(const scene_levels *levels);     /* an array without a newline */

#endif
