/* Level-of-detail tree of a .rad file. An inner node is one Gaussian that replaces the Gaussians below it. */
#ifndef FXS_RAD_TREE_INTERNAL_H
#define FXS_RAD_TREE_INTERNAL_H

#include "scene_write_internal.h"

/* Nodes of a level-of-detail tree in file order, root first. */
typedef struct fxs_rad_tree {
    uint32_t count;
    uint32_t *order;               /* index of each node in the arrays of Gaussians given to fxs_rad_tree_make */
    /* for each node, place of its first child in file order, with siblings next; 0: no children */
    uint32_t *child_starts;
    uint16_t *child_counts;
} fxs_rad_tree;

/* Makes the level-of-detail tree of the ordered Gaussians that a writer has in memory (`held`). Appends the inner nodes
   to the arrays of `held` and leaves its count unchanged. An inner node's opacity may exceed 1. Returns 1, or 0 if
   memory ran out or `progress` returned 0. In either case, free the tree with fxs_rad_tree_free. */
int fxs_rad_tree_make(fxs_rad_tree *tree, fxs_held *held, int (*progress)(void *argument, double done), void *argument);
void fxs_rad_tree_free(fxs_rad_tree *tree);

/* Returns Spark's dilation of a tree node with opacity A: sqrt(1 + e ln A) for A > 1, else 1. */
double fxs_rad_dilation(double opacity);

#endif
