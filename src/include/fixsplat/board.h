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

/* Called with rows `first` to first + rows - 1 of the picture in strip->pixels. They stay unchanged until the function
   returns. For a display that reads them asynchronously (DMA), set strip->pixels to another buffer here for the next
   rows. Returns 0, or an FXS_ERR_* that ends the frame and that fxs_render returns. */
struct fxs_strip;
typedef int fxs_rows_done_fn(void *argument, struct fxs_strip *strip, int32_t first, int32_t rows);

typedef struct fxs_strip {
    void *pixels;                  /* `rows` rows of the picture's width */
    ptrdiff_t stride;              /* bytes from row to row, at least a row's size */
    int32_t rows;                  /* a multiple of 16, at least 16; the last strip of a picture may have fewer */
    enum fxs_format format;
    fxs_rows_done_fn *rows_done;   /* not null */
    void *argument;                /* first argument of rows_done */
    int16_t tile[4 * 256];         /* internal: the tile being blended */
} fxs_strip;

/* An fxs_draw_fn, for fxs_config.draw; `argument` is an fxs_strip. Returns FXS_ERR_TARGET if the strip's fields are
   invalid. The request's targets are not written. */
struct fxs_tile_run;
FXS_EXPERIMENTAL int fxs_strip_draw(void *argument, const struct fxs_tile_run *run);

#ifdef __cplusplus
}
#endif

#endif
