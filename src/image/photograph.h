/* Reads photographs of cameras and phones, with EXIF. */
#ifndef FXS_PHOTOGRAPH_H
#define FXS_PHOTOGRAPH_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/fixsplat.h>

enum fxs_photograph_kind { FXS_PHOTOGRAPH_NONE, FXS_PHOTOGRAPH, FXS_PHOTOGRAPH_HEIF };

/* Returns the kind of a photograph by the ending of its file name. FXS_PHOTOGRAPH: .png, .jpg, .jpeg, .ppm, .webp.
   FXS_PHOTOGRAPH_HEIF: .heic, .heif, .hif. */
enum fxs_photograph_kind fxs_photograph_kind_of(const char *name);

typedef struct fxs_exif {
    int orientation;               /* rotation and mirroring that make the photograph upright, 1 to 8 (EXIF tag 274);
                                      unknown: 1 */
    double exposure;               /* exposure of the photograph: time * sensitivity / f-number^2, in seconds and ISO;
                                      unknown: 0 */
    char lens[120];                /* camera and lens, as a text that is equal for photographs of one camera and zoom */
} fxs_exif;

/* Reads a photograph and its EXIF, which is supported for .jpg and HEIF in builds with libexif. Pixels of a HEIF
   are already upright, so the orientation is 1. */
int fxs_photograph_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif *exif,
                        fxs_message *message);

/* Converts a photograph to an upright .jpg of quality 98 with its EXIF. Returns 0, or an error and a message;
   FXS_ERR_FILE for transparent pixels. */
int fxs_photograph_to_jpg(const char *from, const char *to, fxs_message *message);

#endif
