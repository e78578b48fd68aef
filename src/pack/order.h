/* The order of a scene's Gaussians: stretches of 256 that are small as seen from around the middle. */
#ifndef FXS_ORDER_H
#define FXS_ORDER_H

#include <fixsplat/pack.h>

#define FXS_NO_SLOT UINT32_MAX

typedef struct fxs_order_entry {
    float position[3];                          /* x is NaN for a Gaussian left out */
    uint32_t index;                             /* in the file; before, 1 for a Gaussian that is to be among its like */
} fxs_order_entry;

/* Sorts entries whose positions are given in file order, and sets their indexes; those left out come last, and before
   them those that are to be among their like, but for the first, which fill the last chunk of the others. Each stretch
   of FXS_CHUNK is a leaf of a tree and each subtree a stretch of leaves; only the last leaf is shorter. Needs 100 KB
   while it runs. options->run is not null. Returns 0 or FXS_ERR_MEMORY. */
int fxs_order(fxs_order_entry *entries, uint32_t count, const fxs_pack_options *options);

#endif
