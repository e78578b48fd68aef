/* Makes a scene of fewer Gaussians, whoever reads it, by merging neighbours. */
#ifndef FXS_SCENE_DECIMATE_H
#define FXS_SCENE_DECIMATE_H

#include <stdint.h>

#include "fixsplat.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads an open file from its start and merges Gaussians, which fxs_drawable has accepted, until `target` are left, 1
   or more. From then on fxs_scene_file_read gives these, and info->count is their number. Where there are no more than
   `target`, they stay as they are.

   Two that become one are weighted by opacity times area. Position and covariance are the mean and the covariance of
   both together, dc and SH the mean; the opacity keeps opacity times area, up to 0.99 or what the larger of both had.
   It goes in rounds: each finds for every Gaussian the neighbour that is the least loss, among the nearest in its chunk
   of 256 (fxs_order), and merges pairs that share no Gaussian, those of the least loss first, up to a quarter of all.
   The loss is Runnalls' bound (2007, "Kullback-Leibler approach to Gaussian mixture reduction") and the difference of
   the colours. The same Gaussians give the same result on every machine.

   This takes 340 bytes a Gaussian, and 236 for each that is left until the file is closed. `progress` is called with
   `argument`, and may be null. Returns 0, or an error and a message; the file is to be closed then. Errors: those of
   fxs_scene_file_read, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (the target), FXS_ERR_MEMORY. */
int fxs_scene_file_decimate(fxs_scene_file *file, uint64_t target, fxs_scene_file_info *info, fxs_progress_fn *progress,
                            void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
