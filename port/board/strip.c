/* Renders a picture in strips of rows. Blends tile by tile to the strip's pixels, and calls rows_done for each full
   strip. */
#include <fixsplat/board.h>

#include <fixsplat/internal/stage.h>

static int is_valid(const fxs_strip *s, const fxs_stage_view *view)
{
    const ptrdiff_t row = (ptrdiff_t)view->width * fxs_pixel_bytes(s->format);
    return s->pixels && s->rows >= FXS_TILE && s->rows % FXS_TILE == 0 && s->rows_done &&
           (unsigned)s->format <= FXS_FORMAT_RGB565_SWAPPED && s->stride >= row;
}

static void resolve(const fxs_strip *s, const fxs_tile_run *run, const fxs_tile *pixels, int32_t x, int32_t y)
{
    unsigned char *to = (unsigned char *)s->pixels + y % s->rows * s->stride +
                        (ptrdiff_t)x * fxs_pixel_bytes(s->format);
    fxs_resolve_colour(run->config->kernels, run->options, s->format, pixels, fxs_min(run->view->width - x, FXS_TILE),
                       fxs_min(run->view->height - y, FXS_TILE), to, s->stride);
}

static void blend(fxs_strip *s, const fxs_tile_run *run, uint32_t tile, int32_t x, int32_t y)
{
    fxs_tile *pixels = (fxs_tile *)(void *)s->tile;
    const uint32_t count = run->counts[tile];
    run->config->kernels->blend(run->view, x, y, run->splats, run->entries + run->ends[tile] - count, count, pixels);
    resolve(s, run, pixels, x, y);
}

int fxs_strip_draw(void *argument, const fxs_tile_run *run)
{
    fxs_strip *s = argument;
    const int32_t tiles_x = run->view->tiles_x, height = run->view->height;
    if (!is_valid(s, run->view))
        return FXS_ERR_TARGET;
    for (uint32_t tile = run->first_tile; tile <= run->last_tile; tile++) {
        const int32_t x = (int32_t)tile % tiles_x * FXS_TILE, y = (int32_t)tile / tiles_x * FXS_TILE;
        const int32_t end = fxs_min(y + FXS_TILE, height), first = y / s->rows * s->rows;
        if (run->blended)
            resolve(s, run, &run->blended[tile - run->first_tile], x, y);
        else
            blend(s, run, tile, x, y);
        if (x / FXS_TILE == tiles_x - 1 && (end % s->rows == 0 || end == height)) {
            const int error = s->rows_done(s->argument, s, first, end - first);
            if (error)
                return error;
        }
    }
    return 0;
}
