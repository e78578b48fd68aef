/* The order of a scene's Gaussians: a Morton curve. */
#ifndef FXS_ORDER_H
#define FXS_ORDER_H

#include "pack.h"

#define FXS_NO_SLOT UINT32_MAX

/* A Gaussian's position, then in the same place its key. */
typedef union fxs_order_entry {
    float position[3];                          /* x is NaN for a Gaussian left out */
    struct {
        uint32_t low, high;                     /* Morton code; all ones for a Gaussian left out */
        uint32_t index;                         /* in the file */
    } key;
} fxs_order_entry;

/* Sorts entries, given in file order, along the curve, those left out last: `inner_low` and `inner_high` of the report
   say where its cells are small. Needs 12 bytes a Gaussian while it runs. options->run is not null. Returns 0, or -1
   where there is no memory. */
int fxs_order(fxs_order_entry *entries, uint32_t count, const fxs_pack_report *report,
              const fxs_pack_options *options);

#endif
