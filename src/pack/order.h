/* Orders the Gaussians of a scene in chunks of 256 that look small from around the middle. */
#ifndef FXS_ORDER_H
#define FXS_ORDER_H

#include <fixsplat/pack.h>

#define FXS_NO_SLOT UINT32_MAX

typedef struct fxs_order_entry {
    float position[3];                          /* x is NaN for a Gaussian left out */
    uint32_t index;                             /* in the file; before, 1: to be ordered by themselves */
} fxs_order_entry;

/* Sorts entries whose positions are given in file order, and sets their indexes. Entries that are left out come last,
   before them those ordered by themselves, except that their first ones fill the last chunk of the others. Each stretch
   of FXS_CHUNK is a leaf of a tree, and each subtree a stretch of leaves; only the last leaf is shorter. Needs 100 KB
   while it runs. options->run is not null. Returns 0 or FXS_ERR_MEMORY. */
int fxs_order(fxs_order_entry *entries, uint32_t count, const fxs_pack_options *options);

#endif
