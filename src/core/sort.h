/* Sorts keys by depth in parallel. */
#ifndef FXS_SORT_H
#define FXS_SORT_H

#include "frame.h"

/* Sorts keys by depth, then by splat, in `parts` parallel jobs. The keys must arrive in the order of their splats.
   `spare` has room for `count` keys, `histograms` has one element per job. Returns `keys` or `spare`, whichever holds
   the result. */
fxs_key *fxs_sort(const fxs_config *config, fxs_key *keys, fxs_key *spare, uint32_t count,
                  uint32_t (*histograms)[FXS_SORT_BUCKETS], uint32_t parts);

#endif
