/* A picture in strips, for a display that takes a few rows at a time: whoever has no room for a picture gives room for
 * 16 rows of it or more. Tiles are blended by the kernels of the context, row after row of the picture, and each strip
 * is handed over when it is complete. The bytes are those that fxs_render writes.
 *
 *     static fxs_strip strip = {.pixels = rows, .stride = 320 * 2, .rows = 16, .format = FXS_FORMAT_RGB565,
 *                               .rows_done = send_to_display, .argument = &display};
 *     const fxs_config config = {.draw = fxs_strip_draw, .draw_argument = &strip, .draw_blended = 1};
 *     fxs_init(&context, &config);
 *     strip.kernels = &context.kernels;
 *     fxs_request_init(&request, &object, 1);        and its camera
 *     fxs_render(&context, &request, memory, sizeof memory, 0);
 *
 * It allocates nothing. One frame at a time. */
#ifndef FXS_STRIP_H
#define FXS_STRIP_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Rows `first` to first + rows - 1 of the picture lie in strip->pixels. They stay until this returns: a display that
   takes them by itself meanwhile (DMA) wants another strip->pixels for the next ones, set here. Returns 0, or an
   FXS_ERR_* that ends the frame and is returned by fxs_render. */
struct fxs_strip;
typedef int fxs_rows_done_fn(void *argument, struct fxs_strip *strip, int32_t first, int32_t rows);

typedef struct fxs_strip {
    void *pixels;                  /* `rows` rows of as many pixels as the picture is wide */
    ptrdiff_t stride;              /* bytes from row to row, at least those of a row */
    int32_t rows;                  /* a multiple of 16, 16 at least; the last strip of a picture may have fewer */
    enum fxs_format format;
    const fxs_kernels *kernels;    /* that blend and resolve; not null */
    fxs_rows_done_fn *rows_done;   /* not null */
    void *argument;                /* its first one */
    int16_t tile[4 * 256];         /* the strip's own: what is blended */
} fxs_strip;

/* An fxs_draw_fn, for fxs_config.draw; `argument` is an fxs_strip. FXS_ERR_TARGET where the strip is not as it says
   above. The targets of the request are not written. */
struct fxs_tile_run;
FXS_API int fxs_strip_draw(void *argument, const struct fxs_tile_run *run);

#ifdef __cplusplus
}
#endif

#endif
