/* Prepares a photograph and its mask for a fit: rotates them as EXIF says, removes lens distortion, and reduces them by
 * averaging. */
#ifndef FXS_FIT_PHOTO_PIXELS_H
#define FXS_FIT_PHOTO_PIXELS_H

#include "photo_masks.h"

typedef struct fxs_photo_pixels {
    fxs_view view;            /* pinhole camera of the prepared pixels */
    uint8_t *pixels;               /* the prepared photograph in RGB; freed by the caller */
    uint8_t *mask;                 /* mask of the photograph, a byte per pixel, 0: ignored; null: all pixels count;
                                      freed by the caller */
    double exposure;               /* relative exposure of the photograph; 0: unknown */
} fxs_photo_pixels;

/* Reads a photograph and its mask, and prepares them for a fit. resolution: limit of the longer side in pixels. Turns
   the photograph by EXIF if only then its proportions match the camera's. Returns 0, or an error and a message with
   null pixels and mask. */
int fxs_photo_read(const char *path, const fxs_listed_view *listed, int resolution, const uint8_t background[3],
                   const fxs_photo_masking *masking, fxs_photo_pixels *photo, fxs_message *message);

/* Sets the pinhole view of a photograph, with the size in the camera file. The file must state a size or a field of
   view. */
void fxs_photo_view(const fxs_listed_view *listed, fxs_view *view);

#endif
