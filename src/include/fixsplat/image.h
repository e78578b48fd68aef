/* Images and films: reads and writes pictures, and sequences of pictures. */
#ifndef FXS_IMAGE_H
#define FXS_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Images ------------------------------------------------------------------------------------------------------ */

/* Image files hold 8-bit RGBA pixels here: rows from the top, no padding between rows. Several threads may read and
   write files at the same time. */

/* File formats of pictures. FXS_IMAGE_RAW has only the RGBA bytes. From FXS_IMAGE_Y4M on: frames of a film. */
enum fxs_image_format {
    FXS_IMAGE_UNKNOWN, FXS_IMAGE_PNG, FXS_IMAGE_PPM, FXS_IMAGE_RAW, FXS_IMAGE_JPG, FXS_IMAGE_WEBP, FXS_IMAGE_Y4M,
    FXS_IMAGE_RGBA, FXS_IMAGE_MP4, FXS_IMAGE_WEBM, FXS_IMAGE_GIF
};

/* Returns the image format for the ending of a file name: .png, .ppm, .raw, .jpg or .jpeg, .webp, .y4m, .rgba, .mp4,
   .webm, .gif; else FXS_IMAGE_UNKNOWN. */
FXS_API enum fxs_image_format fxs_image_format_of(const char *path);

/* A picture encoded as the bytes of an image file. All 0: none yet. */
typedef struct fxs_encoded {
    const uint8_t *bytes;    /* the encoded bytes: in `memory`, or the picture's own pixels */
    size_t size;
    void *memory;            /* memory block for the bytes: fxs_encoded_free frees it, and the next picture reuses it */
    size_t room;             /* size of the block `memory`, bytes */
} fxs_encoded;

/* Encodes a picture of `width` x `height` pixels, each of 4 bytes: .png (by zlib or libdeflate, fast rather than small;
   RGB if every alpha byte is 255), .ppm (P6, without alpha), .raw or .rgba, .jpg (by stb_image_write, without alpha,
   4:4:4 above a quality of 90), .webp (by libwebp), or a frame of a .y4m. `quality`: for .jpg 1 to 100, 0: 95; for
   .webp 1 to 100, 0: lossless. All formats except .jpg, lossy .webp and .y4m keep the exact pixels. Encoding is the
   same on every machine except for .jpg and lossy .webp, which use floats. Allocates up to 8 bytes a pixel for .png, 3
   for .ppm and .y4m.

   *encoded is all 0, or the result of an earlier call, whose memory is reused. Returns 0, or an error and a message;
   call fxs_encoded_free in any case. Errors: FXS_ERR_ARGUMENT if the size is out of range (for .webp 16383),
   FXS_ERR_UNSUPPORTED if this was built without the library (.png: zlib, .jpg: stb, .webp: libwebp), FXS_ERR_MEMORY. */
FXS_API int fxs_image_encode(enum fxs_image_format format, int quality, const uint8_t *rgba, int width, int height,
                             fxs_encoded *encoded, fxs_message *message);
FXS_API void fxs_encoded_free(fxs_encoded *encoded);

/* Writes an encoded picture to a temporary file next to `path` and renames it (system.h), so an existing file is
   unchanged after an error. Returns 0, or FXS_ERR_FILE or FXS_ERR_MEMORY and a message. */
FXS_API int fxs_encoded_write(const char *path, const fxs_encoded *encoded, fxs_message *message);

/* Encodes a picture with quality 0 (the default) in the format of the file name's ending, except .y4m and .rgba, and
   writes it. Returns 0, or an error of fxs_image_encode or fxs_encoded_write, or FXS_ERR_ARGUMENT for any other
   ending. */
FXS_API int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message);

/* Returns 1 if fxs_image_file_write knows the ending of the file name, else 0. */
FXS_API int fxs_image_file_known(const char *path);

/* Reads a .png (by libpng), .jpg (by libjpeg-turbo), .webp (by libwebp), .heic or other HEIF with HEVC (by libheif) or
   .ppm, of at most 2^26 pixels. The content determines the format. Of numbers with more than 8 bits the upper 8 are
   used; grey and palette pictures become RGBA. EXIF rotation is ignored, as in COLMAP, whose cameras refer to the
   stored pixels; HEIF rotation and cropping outside of EXIF are applied. Gamma and colour profiles are ignored.

   The pixels are the same on every machine. .png and .ppm store them exactly. The standard of .jpg leaves the last bit
   open; it is decoded in integers by a transform that libjpeg-turbo implements identically in C and for every
   instruction set. HEVC is exact; its Y, Cb and Cr become red, green and blue in integers, by the matrix (BT.601, 709
   or 2020) and the range that the file states (other matrices are refused), without interpolating the chroma of 2 x 2
   pixels.

   Truncated pictures are refused, and pictures that libpng or libjpeg-turbo find damaged, even if they would go on.
   Exceptions: pixels beyond the palette of a .png are black; damage inside the pixels of a .webp or HEIF is not
   reported by their libraries, and the affected pixels may differ each time. Also refused: a compressed file with more
   than 2^20 pixels and more than 512 pixels a byte, which is rare except for pictures of one colour (as a .ppm they are
   read); a .jpg with more than 100 scans, or in CMYK; a .webp with several pictures.

   Returns 0 with *rgba allocated by malloc, which the caller frees, or an error and a message, with *rgba null. Errors:
   FXS_ERR_FILE; FXS_ERR_UNSUPPORTED if this was built without the library (.png: libpng, .jpg: libjpeg-turbo, .webp:
   libwebp, HEIF: libheif) or if libheif is not installed; FXS_ERR_MEMORY. */
FXS_API int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message);

/* ---- Films ------------------------------------------------------------------------------------------------------- */

/* Writes films: a sequence of pictures of one size to a file, a FIFO or standard output.

   - .y4m (YUV4MPEG2, read by ffmpeg, mpv and encoders): 4:4:4, 8 bits, BT.709, limited range; the format cannot state
     the matrix.
   - .rgba: only the RGBA bytes of each frame.
   - .mp4 (H.264), .webm (VP9), .gif: encoded by the program ffmpeg, which is started for the film.
   - Any other image format: the image files of the frames, concatenated, as ffmpeg's image2pipe reads them. */

typedef struct fxs_film fxs_film;

/* Begins a film of `width` x `height` pixels and `rate` frames a second (each at least 1), in a file as system.h says;
   the path "-" is standard output. The format is a film's, on standard output FXS_IMAGE_Y4M, FXS_IMAGE_RGBA or an image
   format. Returns 0 and a film for fxs_film_close, or an error and a message, with *film null: FXS_ERR_ARGUMENT for
   another format, size or rate, FXS_ERR_UNSUPPORTED if ffmpeg is missing, FXS_ERR_FILE or FXS_ERR_MEMORY. */
FXS_API int fxs_film_open(fxs_film **film, const char *path, enum fxs_image_format format, int width, int height,
                          int rate, fxs_message *message);

/* Adds a frame to a film. The frame comes from fxs_image_encode, in the film's format. Returns 0, or an error and a
   message. */
FXS_API int fxs_film_write(fxs_film *film, const fxs_encoded *frame, fxs_message *message);

/* Ends a film and frees it; null is allowed. With `complete` 0 the film is discarded, and an existing file of its name
   is unchanged. Returns 0, or an error and a message. */
FXS_API int fxs_film_close(fxs_film *film, int complete, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
