/* Finds the nearest neighbours of points. */
#ifndef FXS_NEAREST_H
#define FXS_NEAREST_H

#include <stddef.h>
#include <stdint.h>

/* Sets squares[i] to the mean squared distance from point i to its three nearest points, or to 1 for a single point.
   Coordinate k of point i is planes[k][i * step]. Takes O(n log n) time. Returns 0 or FXS_ERR_MEMORY. */
int fxs_nearest_squares(const float *const planes[3], size_t step, size_t count, float *squares);

#define FXS_NEAR 8

/* Sets near[FXS_NEAR i ...] to the numbers of the points nearest to point i, from near to far. The coordinates are
   in three planes. Of fewer points, the last numbers are i itself. Takes O(n log n) time. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_neighbours(const float *const planes[3], size_t count, uint32_t *near);

#endif
