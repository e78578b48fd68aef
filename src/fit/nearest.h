/* Finds the nearest neighbours of points. */
#ifndef FXS_FIT_NEAREST_H
#define FXS_FIT_NEAREST_H

#include <fixsplat/fit.h>

/* Sets squares[i] to the mean squared distance from point i to its three nearest points, or to 1 for a single point.
   Takes O(n log n) time. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_nearest(const fxs_fit_point *points, size_t count, float *squares);

#define FXS_FIT_NEAR 8

/* Sets near[FXS_FIT_NEAR i ...] to the numbers of the points nearest to point i, from near to far. The coordinates are
   in three planes. Of fewer points, the last numbers are i itself. Takes O(n log n) time. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_fit_neighbours(const float *const planes[3], size_t count, uint32_t *near);

#endif
