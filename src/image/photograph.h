/* Reads photographs of cameras and phones, with EXIF. */
#ifndef FXS_PHOTOGRAPH_H
#define FXS_PHOTOGRAPH_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/fixsplat.h>

enum fxs_photograph_kind { FXS_PHOTOGRAPH_NONE, FXS_PHOTOGRAPH, FXS_PHOTOGRAPH_HEIF };

/* Kind by the ending of a name. FXS_PHOTOGRAPH: .png, .jpg, .jpeg, .ppm, .webp. FXS_PHOTOGRAPH_HEIF: .heic, .heif,
   .hif. */
enum fxs_photograph_kind fxs_photograph_kind_of(const char *name);

typedef struct fxs_exif {
    int orientation;               /* 1 to 8: rotation and mirroring to apply (EXIF tag 274); unknown: 1 */
    double exposure;               /* time * sensitivity / f-number^2, in seconds and ISO; unknown: 0 */
    char lens[120];                /* equal for photographs of one camera and zoom */
} fxs_exif;

/* EXIF is supported for .jpg and HEIF, in builds with libexif. A HEIF is already upright, with orientation 1. */
int fxs_photograph_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif *exif,
                        fxs_message *message);

/* Converts a photograph to an upright .jpg of quality 98 with its EXIF. Returns 0, or an error of reading or
   writing; FXS_ERR_FILE for transparent pixels. */
int fxs_photograph_to_jpg(const char *from, const char *to, fxs_message *message);

#endif
