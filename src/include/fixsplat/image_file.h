/* Image files: 8-bit RGBA, rows from the top, no padding between rows.
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

/* FXS_IMAGE_RAW: the bytes as they are. FXS_IMAGE_Y4M and FXS_IMAGE_RGBA are frames of a film (film_file.h). */
enum fxs_image_format {
    FXS_IMAGE_UNKNOWN, FXS_IMAGE_PNG, FXS_IMAGE_PPM, FXS_IMAGE_RAW, FXS_IMAGE_JPG, FXS_IMAGE_WEBP, FXS_IMAGE_Y4M,
    FXS_IMAGE_RGBA
};

/* The format that the ending of a name tells: .png, .ppm, .raw, .jpg or .jpeg, .webp, .y4m, .rgba; else
   FXS_IMAGE_UNKNOWN. */
FXS_API enum fxs_image_format fxs_image_format_of(const char *path);

/* A picture as the bytes of a file. All 0: none yet. */
typedef struct fxs_encoded {
    const uint8_t *bytes;    /* in `memory`, or the picture's own */
    size_t size;
    void *memory;            /* for fxs_encoded_free, and for the next picture */
    size_t room;             /* bytes of that */
} fxs_encoded;

/* Encodes a picture of `width` x `height` pixels, each of 4 bytes: .png (by zlib or libdeflate, fast rather than small;
   RGB where every alpha byte is 255), .ppm (P6, without alpha), .raw or .rgba, .jpg (by stb_image_write, without alpha,
   4:4:4 above a quality of 90), .webp (by libwebp), or a frame of a .y4m. `quality`: of .jpg, 1 to 100, 0: 95; of .webp
   the same, 0: without loss. But for .jpg and a .webp with loss, which are encoded in floats, the file has these
   pixels, and a .y4m, the same bytes on every machine. Allocates up to 8 bytes a pixel for .png, 3 for .ppm and .y4m.

   *encoded is all 0, or what an earlier call left there, whose memory is used again. Returns 0, or an error and a
   message; fxs_encoded_free frees in any case. Errors: FXS_ERR_ARGUMENT where the size is out of range (of .webp
   16383), FXS_ERR_UNSUPPORTED where this was built without the library (.png: zlib, .jpg: stb, .webp: libwebp),
   FXS_ERR_MEMORY. */
FXS_API int fxs_image_encode(enum fxs_image_format format, int quality, const uint8_t *rgba, int width, int height,
                             fxs_encoded *encoded, fxs_message *message);
FXS_API void fxs_encoded_free(fxs_encoded *encoded);

/* Writes the bytes to a temporary name beside `path`, which is renamed (output.h), so that a failure leaves an existing
   file whole. Returns 0, or FXS_ERR_FILE or FXS_ERR_MEMORY and a message. */
FXS_API int fxs_encoded_write(const char *path, const fxs_encoded *encoded, fxs_message *message);

/* Both: encodes a picture, of the quality 0, in the format that the ending of the name tells, .y4m and .rgba left out,
   and writes it. Returns 0, or an error as they do, FXS_ERR_ARGUMENT for any other ending. */
FXS_API int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message);

/* 1 where the ending of the name is one that fxs_image_file_write knows, else 0. */
FXS_API int fxs_image_file_known(const char *path);

/* Reads a .png (by libpng), .jpg (by libjpeg-turbo), .webp (by libwebp), .heic or another HEIF of HEVC (by libheif) or
   .ppm, of at most 2^26 pixels; its content tells which it is. Of more than 8 bits the upper 8 are taken, grey and
   palettes become RGBA, and how EXIF would turn a picture is not looked at (nor does COLMAP, whose cameras are for the
   pixels as they are stored); a HEIF is turned and cut as it states outside of EXIF. The pixels are the same on every
   machine: .png and .ppm say what they are, and a .jpg, whose standard leaves the last bit open, is decoded in integers
   by a transform that libjpeg-turbo has alike in C and for every instruction set. HEVC leaves nothing open; its Y, Cb
   and Cr become red, green and blue in integers, by the matrix of BT.601, 709 or 2020 and the levels that the file
   states (others are refused), with the chroma of 2 x 2 pixels taken as it is.

   A picture that is cut short is refused, and so is one that libpng or libjpeg-turbo finds damaged, even where they
   would go on; but pixels whose number lies beyond the palette of a .png are black, and of damage inside of the pixels
   of a .webp or HEIF their libraries do not tell, and what they make up there may be something else each time. Refused
   too is a compressed file of more than 2^20 pixels and of more than 512 a byte of the file, which few pictures have
   that are not all of one colour (as a .ppm they are read), a .jpg of more than 100 scans, or of CMYK, and a .webp with
   several pictures. Gamma and colour profiles are not looked at.

   Returns 0 with *rgba allocated by malloc, which the caller frees, or an error and a message, with *rgba null. Errors:
   FXS_ERR_FILE, FXS_ERR_UNSUPPORTED for .png where this was built without libpng, for .jpg without libjpeg-turbo, for
   .webp without libwebp, and for HEIF where it was built without libheif or libheif is not installed, FXS_ERR_MEMORY. */
FXS_API int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
