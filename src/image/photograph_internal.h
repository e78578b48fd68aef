/* Shared by the picture readers. */
#ifndef FXS_PHOTOGRAPH_INTERNAL_H
#define FXS_PHOTOGRAPH_INTERNAL_H

#include <stdio.h>

#include "photograph.h"

/* An APP1 segment: "Exif\0\0" and a TIFF file. `bytes` is from malloc; null: none. */
typedef struct fxs_exif_bytes {
    uint8_t *bytes;
    size_t size;
    int is_upright;                /* 1: ignore the EXIF orientation */
} fxs_exif_bytes;

/* Faults of the system. fxs_no_heif: libheif is not linked or not installed. */
extern const char fxs_no_memory[], fxs_no_heif[];

/* The reason to refuse a compressed picture of this size in a file of `bytes` bytes, or NULL. */
const char *fxs_image_refusal(int width, int height, uint64_t bytes);

/* Reads a HEIF. Needs FXS_WITH_HEIF. Returns NULL or the fault. `exif` may be null. */
const char *fxs_heif_read(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif);

/* Keeps a copy of the first EXIF. Does nothing if it has one already or is out of memory. */
void fxs_exif_keep(fxs_exif_bytes *exif, const void *bytes, size_t size);

/* Extracts the fields of fxs_exif. */
void fxs_exif_parse(const fxs_exif_bytes *bytes, fxs_exif *exif);

/* Sets the orientation to 1 and drops the thumbnail. On failure, frees the bytes. */
void fxs_exif_set_upright(fxs_exif_bytes *bytes);

/* As fxs_photograph_read, but returns the EXIF bytes, which the caller frees. */
int fxs_photograph_read_bytes(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif,
                              fxs_message *message);

#endif
