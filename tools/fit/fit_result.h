/* Writes the result of a fit, and compares rendered pictures of it with the photographs. */
#ifndef FIT_RESULT_H
#define FIT_RESULT_H

#include "src/fit/blocks.h"
#include "tools/command/quality.h"

/* Checks that the file ending of an output is known, and that the output can be written. */
int result_check(const char *out);

int result_check_place(const char *out);

typedef struct fit_result {
    fxs_packed_scene packed;
    fxs_pack_report report;
    size_t bytes;
    quality quality;    /* quality compared with the held-out (not fitted) photographs, or with all photographs */
} fit_result;

/* Packs a fitted scene and writes it. An .fxs file gets the packed scene, a .ply file the Gaussians as floats, a .fit
   file the saved fit. If `block` is not null, the .ply has only Gaussians with their centre in this part of the scene.
   Call result_free even after a failure. */
int result_write(fit_result *result, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
                 const char *out);

/* Writes a .ply file of those Gaussians of a coarse fit that lie outside of all blocks (parts of the scene). */
int result_write_outside(const fxs_fit_block *block, const char *out);

int result_write_cameras(const char *path, const fxs_photos *photos);

/* Allocates a copy of the fitted photographs, with the camera poses that the fit has refined. The caller frees
   *fitted, even after a failure. */
int result_pose(fxs_fit *fit, const fxs_photos *photos, fxs_fit_photo **fitted);

/* Registers the comparison pictures of result_measure as outputs of the command, so that they replace no input. */
void result_tell_pictures(const fxs_photos *photos, const char *compare);

/* Renders the scene from the photographs' cameras and measures the differences from the photographs. *q must be all 0;
   call quality_free even after a failure. `compare` (may be null) is a folder for comparison pictures. */
int result_measure(quality *q, world *scene, const fxs_photos *photos, const frame_options *frame, const char *compare);

/* Computes the mean PSNR in dB of fitted photographs, and that after an affine map of colours, for as many photographs
   as were held out; 0: none was held out. */
int result_measure_fitted(double psnr[2], world *scene, const fxs_photos *photos, const frame_options *frame);

void result_free(fit_result *result);

#endif
