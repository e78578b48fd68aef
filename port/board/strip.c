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

#define WHITE (255 * 255 / 4)      /* light of a white pixel */

/* luma = 255 (0.2126 r + 0.7152 g + 0.0722 b); light = luma^2 / 4, a gamma of 2 */
static int32_t light_of(const unsigned char *pixel)
{
    const int32_t red = pixel[0] >> 3, green = (pixel[0] & 7) << 3 | pixel[1] >> 5, blue = pixel[1] & 31;
    const int32_t luma = (red * 1791 + green * 2965 + blue * 608) >> 10; /* 0 to 255 */
    return luma * luma / 4;                                             /* 0 to WHITE */
}

/* Floyd and Steinberg's error diffusion, even rows to the right, odd rows to the left: 7/16 of an error go to the next
   pixel, and 3/16, 5/16 and 1/16 to the row below. `errors` has the row's errors, and gets those of the row below. */
static void diffuse(const unsigned char *row, int32_t width, int32_t y, int16_t *errors, uint8_t *page)
{
    const int32_t step = y % 2 ? -1 : 1;
    int32_t ahead = 0, below = 0;  /* for the next pixel, and for the one below it */
    for (int32_t i = 0, x = y % 2 ? width - 1 : 0; i < width; i++, x += step) {
        const int32_t light = light_of(row + 2 * x) + errors[x] + ahead;
        const int32_t white = light > WHITE / 2, error = light - white * WHITE; /* -WHITE / 2 to WHITE / 2 */
        page[x] = (uint8_t)(page[x] | white << y % 8);
        if (i)
            errors[x - step] = (int16_t)(errors[x - step] + error * 3 / 16);
        ahead = error * 7 / 16;
        errors[x] = (int16_t)(below + error - ahead - error * 3 / 16 - error / 16);
        below = error / 16;
    }
}

void fxs_strip_bits(const fxs_strip *strip, int32_t width, int32_t first, int32_t rows, int16_t *errors, uint8_t *pages)
{
    for (int32_t i = 0; i < width && !first; i++)
        errors[i] = 0;
    for (int32_t i = 0; i < (rows + 7) / 8 * width; i++)
        pages[i] = 0;
    for (int32_t y = 0; y < rows; y++)
        diffuse((const unsigned char *)strip->pixels + y * strip->stride, width, y, errors, pages + y / 8 * width);
}
