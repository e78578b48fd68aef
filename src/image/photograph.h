/* Photographs as cameras and phones write them: the picture, and what EXIF says of how it was taken. */
#ifndef FXS_PHOTOGRAPH_H
#define FXS_PHOTOGRAPH_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/fixsplat.h>

enum fxs_photograph_kind { FXS_PHOTOGRAPH_NONE, FXS_PHOTOGRAPH, FXS_PHOTOGRAPH_HEIF };

/* By the ending of a name: .png, .jpg, .jpeg, .ppm and .webp; of HEIF .heic, .heif and .hif; also in capitals. */
enum fxs_photograph_kind fxs_photograph_kind_of(const char *name);

/* What a file does not say, or says out of its range, is not known. */
typedef struct fxs_exif {
    int orientation;               /* 1 to 8: how the stored picture is to be turned (EXIF, tag 274); not known: 1 */
    double exposure;               /* time * sensitivity / f-number^2, of seconds and ISO; not known: 0 */
    char lens[120];                /* maker, model and focal lengths, the same for photographs of one camera and zoom;
                                      not known: empty */
} fxs_exif;

/* Like fxs_image_file_read. *exif is of a .jpg or HEIF by libexif, else, or where that is not linked, not known. A HEIF
   states in its own way how it is turned, which is done, and so its orientation is 1. */
int fxs_photograph_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif *exif,
                        fxs_message *message);

/* Reads a photograph and writes it as a .jpg of quality 98 with its EXIF, but for an orientation, as its pixels are
   turned already. Returns 0, or an error of reading or writing, and FXS_ERR_FILE for one with transparent pixels. */
int fxs_photograph_to_jpg(const char *from, const char *to, fxs_message *message);

#endif
