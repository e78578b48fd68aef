/* The result of a fit: the scene's file, and how far its pictures are from the photographs. */
#ifndef FIT_RESULT_H
#define FIT_RESULT_H

#include <fixsplat/blocks.h>
#include "quality.h"

/* Whether the name has an ending that result_write knows, and can be written. Returns 0, or prints why not and returns
   the exit status. */
int result_check(const char *out);

/* Whether it can be written, whatever its ending. Returns as above. */
int result_check_place(const char *out);

/* A fit's Gaussians, packed. */
typedef struct fit_result {
    fxs_packed_scene packed;
    fxs_pack_report report;
    size_t bytes;                           /* of it */
    quality quality;                        /* of the photographs that were held out; of all where none were */
} fit_result;

/* Packs the fit and writes it: as .fxs the packed scene with a start view, as .ply its Gaussians in floats, as .fit the
   saved fit. Of a block (or null) the .ply has the Gaussians with their centre in it alone, the packed scene has all.
   Returns 0, or prints why not and returns EXIT_FAILED; result_free frees what *result holds in either case. */
int result_write(fit_result *result, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
                 const char *out);

/* Writes the Gaussians of a coarse fit outside of all blocks, as a .ply. Returns as above. */
int result_write_outside(const fxs_fit_block *block, const char *out);

/* Writes the cameras of all photographs, a cameras.json. Returns as above. */
int result_write_cameras(const char *path, const fxs_photos *photos);

/* Makes *fitted the photographs that were fitted with the poses that the fit has found. The caller frees it in either
   case; it is null where there is no memory. Returns as above. */
int result_pose(fxs_fit *fit, const fxs_photos *photos, fxs_fit_photo **fitted);

/* Tells files_write the names of the pictures that result_measure will write. */
void result_tell_pictures(const fxs_photos *photos, const char *compare);

/* Renders the scene from where photographs were taken, and measures how far it is from them: quality_free frees what
   *q, all 0 before, holds in either case. `compare`: a folder for pictures of each photograph, left, beside the
   rendered one; or null. Returns as above. */
int result_measure(quality *q, world *scene, const fxs_photos *photos, const frame_options *frame, const char *compare);

/* The mean PSNR, dB, of as many photographs that were fitted as were held out, evenly spaced; 0 where none was held
   out. Returns as above. */
int result_measure_fitted(double *psnr, world *scene, const fxs_photos *photos, const frame_options *frame);

void result_free(fit_result *result);

#endif
