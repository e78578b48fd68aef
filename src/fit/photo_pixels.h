/* Prepares a photograph for a fit: turns it, removes distortion, puts it on the background, reduces it by averaging; and
   its mask likewise. */
#ifndef FXS_FIT_PHOTO_PIXELS_H
#define FXS_FIT_PHOTO_PIXELS_H

#include "photo_masks.h"

typedef struct fxs_photo_pixels {
    fxs_file_view view;            /* pinhole camera of these pixels */
    uint8_t *pixels;               /* RGB; the caller frees them */
    uint8_t *mask;                 /* a byte a pixel, 0 where it is ignored, which the caller frees; null: all count */
    double exposure;               /* of fxs_fit_photo */
} fxs_photo_pixels;

/* `resolution`: the largest width or height. Where the camera has the size of the photograph as EXIF would turn it, and
   not of the one that is stored, the photograph is turned; its mask is one of it as it is turned. Returns 0, or an error
   and a message, with null pixels and mask. */
int fxs_photo_read(const char *path, const fxs_listed_view *listed, int resolution, const uint8_t background[3],
                   const fxs_photo_masking *masking, fxs_photo_pixels *photo, fxs_message *message);

/* The view of the pinhole picture in the size that its file of cameras states, of a photograph that is not read. The
   file must state one, or at least the angle: FXS_SIZE_STATED or FXS_SIZE_OF_WIDTH, which is taken for square. */
void fxs_photo_view(const fxs_listed_view *listed, fxs_file_view *view);

#endif
