/* Functions shared by the picture readers. */
#ifndef FXS_PHOTOGRAPH_INTERNAL_H
#define FXS_PHOTOGRAPH_INTERNAL_H

#include <stdio.h>

#include "photograph.h"

/* An EXIF block of a photograph: "Exif\0\0" and TIFF data, allocated by malloc; null: no EXIF. */
typedef struct fxs_exif_bytes {
    uint8_t *bytes;
    size_t size;
    int is_upright;                /* 1: the pixels are upright, so the EXIF orientation is ignored */
} fxs_exif_bytes;

/* Error messages. fxs_no_heif means that libheif is not linked or not installed. */
extern const char fxs_no_memory[], fxs_no_heif[];

const char *fxs_image_refusal(int width, int height, uint64_t bytes);

/* Reads a HEIF picture in builds with FXS_WITH_HEIF. Returns NULL, or the fault as text. `exif` may be null. */
const char *fxs_heif_read(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif);

/* Keeps a copy of a picture's first EXIF block. Does nothing if memory runs out. */
void fxs_exif_keep(fxs_exif_bytes *exif, const void *bytes, size_t size);

void fxs_exif_parse(const fxs_exif_bytes *bytes, fxs_exif *exif);

/* Sets the orientation in EXIF bytes to 1 (upright) and drops the thumbnail. Frees the bytes on failure. */
void fxs_exif_set_upright(fxs_exif_bytes *bytes);

/* Reads a photograph and returns its EXIF bytes, which the caller frees. */
int fxs_photograph_read_bytes(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif,
                              fxs_message *message);

#endif
