/* Image files: 8-bit RGBA, rows from the top, no padding between rows.
 *
 * Several threads may read and write files at the same time. */
#ifndef FXS_IMAGE_FILE_H
#define FXS_IMAGE_FILE_H

#include <stdint.h>

#include "../../src/fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a picture of `width` x `height` pixels, each of 4 bytes. The ending of the name tells the format: .png (by
   stb_image_write and zlib; RGB where every alpha byte is 255), .ppm (P6, without alpha) or .raw (the bytes as they
   are). It is written to a temporary name beside `path` and renamed (output.h), so that a failure leaves an existing
   file whole. Allocates up to 10 bytes a pixel for .png and 3 for .ppm.

   Returns 0, or an error and a message. Errors: FXS_ERR_ARGUMENT where the ending is none of these or the size is out
   of range, FXS_ERR_UNSUPPORTED for .png where this was built without stb or zlib, FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message);

/* 1 where the ending of the name is one that fxs_image_file_write knows, else 0. */
int fxs_image_file_known(const char *path);

/* Reads a .png or .jpg (by stb_image) or .ppm, of at most 2^26 pixels; its content tells which it is. Of 16 bits the
   upper 8 are taken, grey and palettes become RGBA, and how EXIF would turn a picture is not looked at (nor does COLMAP,
   whose cameras are for the pixels as they are stored). The pixels are the same on every machine: .png and .ppm say
   what they are, and a .jpg, whose standard leaves the last bit open, is decoded by stb_image's text in integers, with
   its SIMD left out.

   The data of a .png are inflated to at most twice the bytes that RGBA of its stated size and depth has, and 64 KiB; one
   with more is refused, as is a .jpg of more than 512 pixels a byte. A picture that is cut short is refused.

   Returns 0 with *rgba allocated by malloc, which the caller frees, or an error and a message, with *rgba null. Errors:
   FXS_ERR_FILE, FXS_ERR_UNSUPPORTED for all but .ppm where this was built without stb, FXS_ERR_MEMORY. */
int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
