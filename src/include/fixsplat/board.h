/* Renders a picture in strips, for a display that takes a few rows at a time, in a program without memory for a whole
 * picture: a buffer of 16 rows is enough. The context's kernels blend the tiles row by row, and each strip is handed
 * over when it is complete. The bytes are the same as fxs_render's.
 *
 *     static fxs_strip strip = {.pixels = rows, .stride = 320 * 2, .rows = 16, .format = FXS_FORMAT_RGB565,
 *                               .rows_done = send_to_display, .argument = &display};
 *     const fxs_config config = {.size = sizeof config, .draw = fxs_strip_draw, .draw_argument = &strip,
 *                                .draw_blended = 1};
 *     fxs_context_init(&context, &config);
 *     fxs_request_init(&request, &object, 1);        and its camera
 *     fxs_render(&context, &request, memory, sizeof memory, 0);
 *
 * It allocates nothing. One frame at a time. */
#ifndef FXS_BOARD_H
#define FXS_BOARD_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A callback of fxs_strip_draw. It gets the finished rows `first` to first + rows - 1 of the picture, in strip->pixels.
   They stay unchanged until the function returns. For a display that reads them asynchronously (DMA), set strip->pixels
   to another buffer here for the next rows. Returns 0, or an FXS_ERR_* that ends the frame and that fxs_render
   returns. */
struct fxs_strip;
typedef int fxs_rows_done_fn(void *argument, struct fxs_strip *strip, int32_t first, int32_t rows);

typedef struct fxs_strip {
    void *pixels;                  /* buffer for one strip: `rows` rows of the picture's width */
    ptrdiff_t stride;              /* bytes from one row of the buffer to the next, at least the size of a row */
    int32_t rows;                  /* height of a strip: a multiple of 16, at least 16; the last strip of a picture may
                                      be lower */
    enum fxs_format format;
    fxs_rows_done_fn *rows_done;   /* not null */
    void *argument;                /* first argument of the callback rows_done */
    int16_t tile[4 * 256];         /* for the library only: the tile of 16x16 pixels that is being blended */
} fxs_strip;

/* Draws a frame in strips. It is an fxs_draw_fn for fxs_config.draw, and its `argument` is an fxs_strip. Returns
   FXS_ERR_TARGET if a field of the strip is invalid. The request's own targets (output pictures) are not written. */
struct fxs_tile_run;
FXS_EXPERIMENTAL int fxs_strip_draw(void *argument, const struct fxs_tile_run *run);

/* Converts a strip of format RGB565_SWAPPED to 1 bit a pixel, by error diffusion in linear light. Call it for the
   strips of a picture in order, as in rows_done. `errors` has a number per column, and carries errors from strip to
   strip. `pages` gets the bits as an SSD1306 stores them: a byte per column of 8 rows, bit 0 on top, then the next 8
   rows. */
FXS_EXPERIMENTAL void fxs_strip_bits(const fxs_strip *strip, int32_t width, int32_t first, int32_t rows,
                                     int16_t *errors, uint8_t *pages);

#ifdef __cplusplus
}
#endif

#endif
