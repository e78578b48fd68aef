/* The result of a fit: the scene's file, and its pictures' difference from the photographs. */
#ifndef FIT_RESULT_H
#define FIT_RESULT_H

#include "src/fit/blocks.h"
#include "tools/command/quality.h"

/* Checks that result_write knows the name's ending and that the file can be written. Returns 0, or prints the reason
   and returns the exit status. */
int result_check(const char *out);

/* Checks only that the file can be written. Returns as above. */
int result_check_place(const char *out);

/* A fit's Gaussians, packed. */
typedef struct fit_result {
    fxs_packed_scene packed;
    fxs_pack_report report;
    size_t bytes;                           /* size of the file written */
    quality quality;                        /* against the held-out photographs, or all if none was held out */
} fit_result;

/* Packs the fit and writes it: .fxs the packed scene with a start view, .ply the Gaussians in floats, .fit the saved
   fit. With a block (or null), the .ply has only Gaussians with their centre inside it; the packed scene has all.
   Returns 0, or prints the reason and returns EXIT_FAILED. Call result_free in either case. */
int result_write(fit_result *result, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
                 const char *out);

/* Writes the Gaussians of a coarse fit outside of all blocks as a .ply. Returns as above. */
int result_write_outside(const fxs_fit_block *block, const char *out);

/* Writes the cameras of all photographs as a cameras.json. Returns as above. */
int result_write_cameras(const char *path, const fxs_photos *photos);

/* Allocates *fitted, a copy of the fitted photographs with the poses that the fit has refined. The caller frees it
   in either case; null if memory runs out. Returns as above. */
int result_pose(fxs_fit *fit, const fxs_photos *photos, fxs_fit_photo **fitted);

/* Registers the names of the pictures that result_measure will write with files_write. */
void result_tell_pictures(const fxs_photos *photos, const char *compare);

/* Renders the scene from the photographs' cameras and measures the difference. *q must be all 0 before; call
   quality_free in either case. `compare`: a folder for pictures with photograph (left) and rendering (right); or
   null. Returns as above. */
int result_measure(quality *q, world *scene, const fxs_photos *photos, const frame_options *frame, const char *compare);

/* Mean PSNR in dB of fitted photographs, evenly spaced, as many as were held out; 0 if none was. Returns as above. */
int result_measure_fitted(double *psnr, world *scene, const fxs_photos *photos, const frame_options *frame);

void result_free(fit_result *result);

#endif
