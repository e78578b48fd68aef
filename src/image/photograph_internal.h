/* What the readers of pictures share. */
#ifndef FXS_PHOTOGRAPH_INTERNAL_H
#define FXS_PHOTOGRAPH_INTERNAL_H

#include <stdio.h>

#include "photograph.h"

/* The bytes of an APP1 segment: "Exif\0\0" and a TIFF file. `bytes`, from malloc, null where there are none. */
typedef struct fxs_exif_bytes {
    uint8_t *bytes;
    size_t size;
    int is_upright;                /* 1: the orientation that they name does not count */
} fxs_exif_bytes;

/* Two faults that are not the file's. fxs_no_heif: neither linked nor installed. */
extern const char fxs_no_memory[], fxs_no_heif[];

/* The fault of a compressed picture of this size in a file of so many bytes, or NULL. */
const char *fxs_image_refusal(int width, int height, uint64_t bytes);

/* Reads a HEIF, where FXS_WITH_HEIF is defined. Returns NULL or the fault. `exif` may be null. */
const char *fxs_heif_read(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif);

/* Keeps a copy, unless there is one already or memory is out. */
void fxs_exif_keep(fxs_exif_bytes *exif, const void *bytes, size_t size);

/* What they say. */
void fxs_exif_parse(const fxs_exif_bytes *bytes, fxs_exif *exif);

/* Makes them say that the picture is not to be turned, without a thumbnail; frees them where that cannot be said. */
void fxs_exif_set_upright(fxs_exif_bytes *bytes);

/* Like fxs_photograph_read, but gives the bytes, which the caller frees. */
int fxs_photograph_read_bytes(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif,
                              fxs_message *message);

#endif
