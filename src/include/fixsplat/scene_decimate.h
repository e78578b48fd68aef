/* Decimates a stream of Gaussians: merges neighbours until the target number is left.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_SCENE_DECIMATE_H
#define FXS_SCENE_DECIMATE_H

#include <stdint.h>

#include "fixsplat.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads an open file from its start and merges Gaussians until `target` are left, 1 or more. fxs_drawable must accept
   every Gaussian of the file. From then on, fxs_scene_file_read returns the merged Gaussians, and info->count is their
   number. A scene of at most `target` Gaussians is unchanged.

   The two Gaussians of a pair are weighted by opacity times area. The merged position and covariance are the mean and
   the covariance of the pair as one distribution; dc and SH are weighted means. The merged opacity keeps the sum of
   opacity times area, but is at most 0.99, or the larger opacity of the two if that is higher. Each round pairs every
   Gaussian with the neighbour of least loss, among the nearest 16 in its chunk of 256 (fxs_order). Then it merges the
   quarter of the pairs with the least loss, skipping a pair that shares a Gaussian with an earlier pair. The loss is
   Runnalls' bound (2007, "Kullback-Leibler approach to Gaussian mixture reduction") and the difference of the colours.
   The result is the same on every machine.

   Memory: 340 bytes a Gaussian, and 236 for each remaining Gaussian until the file is closed. `progress` is called with
   `argument`, and may be null. Returns 0, or an error and a message; the caller must then close the file. Errors: as
   fxs_scene_file_read, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (the target), FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_decimate(fxs_scene_file *file, uint64_t target, fxs_scene_file_info *info,
                                    fxs_progress_fn *progress, void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
