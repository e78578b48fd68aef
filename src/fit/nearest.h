/* Distances of points to their neighbours. */
#ifndef FXS_FIT_NEAREST_H
#define FXS_FIT_NEAREST_H

#include <fixsplat/fit.h>

/* Sets squares[i] to the mean square of the distances from point i to its three nearest points (to all others where
   there are fewer, 1 where there is none). Uses a tree of medians, which takes n log n for any points, even many in one
   place. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_nearest(const fxs_fit_point *points, size_t count, float *squares);

#endif
