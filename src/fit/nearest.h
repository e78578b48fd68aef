/* Computes the distances from points to their nearest neighbours. */
#ifndef FXS_FIT_NEAREST_H
#define FXS_FIT_NEAREST_H

#include <fixsplat/fit.h>

/* Sets squares[i] to the mean squared distance from point i to its three nearest points, or to 1 for a single point.
   Takes O(n log n) time. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_nearest(const fxs_fit_point *points, size_t count, float *squares);

#endif
