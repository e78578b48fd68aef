/* Writes films: a sequence of pictures of one size to a file, a FIFO or standard output.
 *
 * - .y4m (YUV4MPEG2, read by ffmpeg, mpv and encoders): 4:4:4, 8 bits, BT.709, limited range; the format cannot state
 *   the matrix.
 * - .rgba: only the RGBA bytes of each frame.
 * - Any other image format: the image files of the frames, concatenated, as ffmpeg's image2pipe reads them.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_FILM_FILE_H
#define FXS_FILM_FILE_H

#include "image_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_film fxs_film;

/* Begins a film of `width` x `height` pixels and `rate` frames a second (each at least 1), in a file as output.h says;
   the path "-" is standard output. The format is FXS_IMAGE_Y4M or FXS_IMAGE_RGBA, or on standard output any image
   format. Returns 0 and a film for fxs_film_close, or an error and a message, with *film null: FXS_ERR_ARGUMENT for
   another format, size or rate, FXS_ERR_FILE or FXS_ERR_MEMORY. */
FXS_API int fxs_film_open(fxs_film **film, const char *path, enum fxs_image_format format, int width, int height,
                          int rate, fxs_message *message);

/* Adds a frame from fxs_image_encode, in the film's format. Returns 0, or an error and a message. */
FXS_API int fxs_film_write(fxs_film *film, const fxs_encoded *frame, fxs_message *message);

/* Ends a film and frees it; null is allowed. With `complete` 0 the film is discarded, and an existing file of its name
   is unchanged. Returns 0, or an error and a message. */
FXS_API int fxs_film_close(fxs_film *film, int complete, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
