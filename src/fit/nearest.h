/* How far points are from their neighbours. */
#ifndef FXS_FIT_NEAREST_H
#define FXS_FIT_NEAREST_H

#include <fixsplat/fit.h>

/* squares[i] becomes the mean square of the distances of point i to its three nearest (to all others where there are
   fewer, 1 where there is none). A tree of medians: any points take n log n, many in one place too. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_fit_nearest(const fxs_fit_point *points, size_t count, float *squares);

#endif
