/* Image files: 8-bit RGBA, rows from the top, no padding between rows. */
#ifndef FXS_IMAGE_FILE_H
#define FXS_IMAGE_FILE_H

#include <stdint.h>

#include "../files/message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes width * height * 4 bytes as .png (stb_image_write and zlib; RGB where every alpha byte is 255), .ppm (P6,
   alpha dropped) or .raw (the bytes as they are), told by the name's ending. Written to a temporary name beside `path`
   and renamed (output.h), so that a failure leaves an existing file whole. Allocates up to 10 bytes a pixel for .png, 3
   for .ppm. Returns 0, or -1 and a message, out of memory too. */
int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message);

/* 1 where the ending of the name is one that fxs_image_file_write knows. */
int fxs_image_file_known(const char *path);

/* Reads a .png or .ppm (stb_image), as RGBA, of at most 2^26 pixels. The data of a .png are inflated to at most twice
   the bytes that RGBA of its stated size and depth has, and 64 KiB; with more it is refused. Returns 0 with *rgba
   allocated by malloc and owned by the caller, or -1 and a message. */
int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
