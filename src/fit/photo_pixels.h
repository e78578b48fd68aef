/* Prepares a photograph for a fit: rotates it by EXIF, removes lens distortion, composes it over the background, and
   averages it down. Its mask is treated likewise. */
#ifndef FXS_FIT_PHOTO_PIXELS_H
#define FXS_FIT_PHOTO_PIXELS_H

#include "photo_masks.h"

typedef struct fxs_photo_pixels {
    fxs_file_view view;            /* pinhole camera of `pixels` */
    uint8_t *pixels;               /* RGB; freed by the caller */
    uint8_t *mask;                 /* one byte per pixel, 0: ignored; freed by the caller; null: all count */
    double exposure;               /* as in fxs_fit_photo */
} fxs_photo_pixels;

/* Reads a photograph. `resolution`: limit of the longer side. If the camera's size matches the EXIF-rotated photograph
   and not the stored one, the photograph is rotated; the mask must match the rotated one. Returns 0, or an error and a
   message, with null pixels and mask. */
int fxs_photo_read(const char *path, const fxs_listed_view *listed, int resolution, const uint8_t background[3],
                   const fxs_photo_masking *masking, fxs_photo_pixels *photo, fxs_message *message);

/* The pinhole view at the size stated in the camera file, without reading the photograph. A file that states only the
   field of view (FXS_SIZE_OF_WIDTH) gets a square size; the file must state one of the two. */
void fxs_photo_view(const fxs_listed_view *listed, fxs_file_view *view);

#endif
