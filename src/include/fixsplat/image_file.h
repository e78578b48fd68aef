/* Reads and writes image files. Pictures in memory are 8-bit RGBA, rows from the top, no padding between rows.
 *
 * Several threads may read and write files at the same time.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_IMAGE_FILE_H
#define FXS_IMAGE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* FXS_IMAGE_RAW: the bytes of the picture. FXS_IMAGE_Y4M and FXS_IMAGE_RGBA: frames of a film (film_file.h). */
enum fxs_image_format {
    FXS_IMAGE_UNKNOWN, FXS_IMAGE_PNG, FXS_IMAGE_PPM, FXS_IMAGE_RAW, FXS_IMAGE_JPG, FXS_IMAGE_WEBP, FXS_IMAGE_Y4M,
    FXS_IMAGE_RGBA
};

/* The format of a file name by its ending: .png, .ppm, .raw, .jpg or .jpeg, .webp, .y4m, .rgba; else
   FXS_IMAGE_UNKNOWN. */
enum fxs_image_format fxs_image_format_of(const char *path);

/* A picture encoded as the bytes of a file. All fields 0: no picture yet. */
typedef struct fxs_encoded {
    const uint8_t *bytes;    /* in `memory`, or the caller's picture itself */
    size_t size;
    void *memory;            /* used again for the next picture; fxs_encoded_free frees it */
    size_t room;             /* size of `memory` in bytes */
} fxs_encoded;

/* Encodes a picture of `width` x `height` pixels, each of 4 bytes: .png (by zlib or libdeflate, fast rather than small;
   RGB where every alpha byte is 255), .ppm (P6, without alpha), .raw or .rgba, .jpg (by stb_image_write, without alpha,
   4:4:4 above a quality of 90), .webp (by libwebp), or a frame of a .y4m. `quality` is 1 to 100; 0 means 95 for a .jpg
   and lossless for a .webp; other formats ignore it. Except for .jpg and lossy .webp, which are encoded in floats, a
   file decodes to the same pixels on every machine, and a .y4m has the same bytes there. Allocates up to 8 bytes a
   pixel for .png, 3 for .ppm and .y4m.

   encoded must be all 0, or the result of an earlier call, whose memory is used again. Returns 0, or an error and a
   message; fxs_encoded_free must be called in either case. Errors: FXS_ERR_ARGUMENT where the size or the quality is
   out of range (for .webp above 16383), FXS_ERR_UNSUPPORTED where fixsplat was built without the library (.png: zlib,
   .jpg: stb, .webp: libwebp), FXS_ERR_MEMORY. */
int fxs_image_encode(enum fxs_image_format format, int quality, const uint8_t *rgba, int width, int height,
                     fxs_encoded *encoded, fxs_message *message);
void fxs_encoded_free(fxs_encoded *encoded);

/* Writes the bytes to a temporary file beside `path` and renames it (output.h), so a failure leaves an existing file
   unchanged. Returns 0, or FXS_ERR_FILE or FXS_ERR_MEMORY and a message. */
int fxs_encoded_write(const char *path, const fxs_encoded *encoded, fxs_message *message);

/* Encodes a picture with quality 0 in the format of the name's ending, other than .y4m and .rgba, and writes it.
   Returns 0, or an error of the two functions above, or FXS_ERR_ARGUMENT for any other ending. */
int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message);

/* 1 where fxs_image_file_write knows the ending of the name, else 0. */
int fxs_image_file_known(const char *path);

/* Reads a .png or .jpg (by stb_image) or .ppm, of at most 2^26 pixels; its content tells the format. Of 16-bit channels
   the upper 8 bits are kept, grey and colour palettes become RGBA, and a rotation in EXIF is ignored (as in COLMAP,
   whose cameras are for the stored pixels). The pixels are the same on every machine: .png and .ppm define them, and a
   .jpg, whose standard leaves the last bit open, is decoded by stb_image's integer code without SIMD. Faults of a .jpg
   that stb_image 2.27 does not notice are checked first.

   The data of a .png may inflate to twice the bytes of RGBA in its stated size and depth plus 64 KiB; a larger one is
   refused, as are a .jpg of more than 512 pixels a byte and a picture that is cut short.

   Returns 0 with *rgba allocated by malloc, which the caller frees, or an error and a message, with *rgba null. Errors:
   FXS_ERR_FILE, FXS_ERR_UNSUPPORTED for .png and .jpg where fixsplat was built without stb, FXS_ERR_MEMORY. */
int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
