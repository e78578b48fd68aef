/* The tree of a .rad: each node stands for the Gaussians below it. */
#ifndef FXS_RAD_TREE_INTERNAL_H
#define FXS_RAD_TREE_INTERNAL_H

#include "scene_write_internal.h"

/* The nodes in the order of the file, the root first. */
typedef struct fxs_rad_tree {
    uint32_t count;
    uint32_t *order;               /* their numbers in the arrays of `held` */
    uint32_t *child_starts;        /* the place of the first child, which the others follow; 0: none */
    uint16_t *child_counts;
} fxs_rad_tree;

/* Makes the tree of the ordered Gaussians that are held, one or more. Its inner nodes are added to `held`, whose count
   stays; the opacity of an inner node may be above 1. Returns 1, or 0 where memory ran out or `progress` returned 0;
   fxs_rad_tree_free frees the tree in either case. */
int fxs_rad_tree_make(fxs_rad_tree *tree, fxs_held *held, int (*progress)(void *argument, double done), void *argument);
void fxs_rad_tree_free(fxs_rad_tree *tree);

/* D of Spark for an opacity A: sqrt(1 + e ln A), or 1 up to 1. */
double fxs_rad_dilation(double opacity);

#endif
