/* What a frame writes: checks, and the pixels of a tile in each target but depths and ids. */
#include "frame.h"
#include "memory.h"

#define IMAGES 7

void fxs_targets_init(fxs_targets *targets)
{
    memset(targets, 0, sizeof *targets);
}

/* ---- Checks ------------------------------------------------------------------------------------------------------ */

/* An image, its bytes a pixel and the alignment of its numbers. */
typedef struct part {
    const fxs_image *image;
    int bytes, alignment, written;
} part;

static int is_valid(const part *p, int32_t width, int32_t height)
{
    const ptrdiff_t row = (ptrdiff_t)width * p->bytes, stride = p->image->stride;
    return (uintptr_t)p->image->pixels % (unsigned)p->alignment == 0 && stride % p->alignment == 0 &&
           (height <= 1 || stride >= row || stride <= -row);
}

/* Whether two images share a byte. Rows of one stride may interlace, as those of two eyes side by side do. */
static int overlap(const part *a, const part *b, int32_t width, int32_t height)
{
    const part *parts[2] = {a, b};
    uintptr_t low[2], high[2];
    for (int i = 0; i < 2; i++) {
        const ptrdiff_t stride = parts[i]->image->stride, below = (height - 1) * stride;
        low[i] = (uintptr_t)parts[i]->image->pixels + (uintptr_t)(stride < 0 ? below : 0);
        high[i] = low[i] + (uintptr_t)(stride < 0 ? -below : below) + (uintptr_t)(width * (ptrdiff_t)parts[i]->bytes);
    }
    if (high[0] <= low[1] || high[1] <= low[0])
        return 0;
    const ptrdiff_t strides[2] = {a->image->stride, b->image->stride};
    const uintptr_t stride = (uintptr_t)(strides[0] < 0 ? -strides[0] : strides[0]);
    if ((strides[0] != strides[1] && strides[0] != -strides[1]) || !stride)
        return 1;
    const int first = low[1] < low[0];                 /* the one that starts lower */
    const uintptr_t ahead = (low[!first] - low[first]) % stride;
    return ahead < (uintptr_t)(width * (ptrdiff_t)parts[first]->bytes) ||
           ahead + (uintptr_t)(width * (ptrdiff_t)parts[!first]->bytes) > stride;
}

static int is_in_place(const fxs_targets *t)
{
    return t->backdrop.pixels == t->colour.pixels && t->backdrop.stride == t->colour.stride &&
           t->format == FXS_FORMAT_RGBA8;
}

int fxs_targets_check(const fxs_targets *t, int32_t width, int32_t height)
{
    if ((unsigned)t->format > FXS_FORMAT_RGBA16_COVERAGE || t->depth_bits < 0 || t->depth_bits > 28 ||
        (t->backdrop.pixels && fxs_is_premultiplied(t->format)))
        return FXS_ERR_TARGET;
    const part parts[IMAGES] = {
        {&t->colour, fxs_pixel_bytes(t->format), t->format == FXS_FORMAT_RGBA16_COVERAGE ? 2 : 1, 1},
        {&t->coverage, 1, 1, 1}, {&t->mean_depth, 4, 4, 1}, {&t->median_depth, 4, 4, 1}, {&t->id, 8, 4, 1},
        {&t->occluder, 4, 4, 0}, {&t->backdrop, 4, 1, 0}};
    for (int i = 0; i < IMAGES; i++) {
        if (!parts[i].image->pixels)
            continue;
        if (!is_valid(&parts[i], width, height))
            return FXS_ERR_TARGET;
        for (int k = 0; k < i; k++)
            if (parts[k].image->pixels && parts[k].written && overlap(&parts[k], &parts[i], width, height) &&
                !(parts[i].image == &t->backdrop && k == 0 && is_in_place(t)))
                return FXS_ERR_TARGET;
    }
    return 0;
}

int fxs_targets_missing(const fxs_context *context, const fxs_targets *t)
{
    return !context || context->config.draw ? 0
           : !t || !(t->colour.pixels || t->coverage.pixels || t->mean_depth.pixels || t->median_depth.pixels ||
                     t->id.pixels)
               ? FXS_ERR_TARGET : 0;
}

int fxs_targets_traced(const fxs_targets *t)
{
    return t && (t->mean_depth.pixels || t->median_depth.pixels || t->id.pixels || t->occluder.pixels);
}

/* ---- Pixels ------------------------------------------------------------------------------------------------------ */

static void resolve_coverage(const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels,
                             ptrdiff_t stride)
{
    for (int32_t y = 0; y < rows; y++)
        for (int32_t x = 0; x < columns; x++)
            pixels[y * stride + x] = (unsigned char)fxs_coverage_8bit(tile->transmittance_q15[y * FXS_TILE + x]);
}

#ifndef __CUDACC__                 /* the device has no table of kernels */
void fxs_resolve_targets(const fxs_frame *f, const fxs_tile *tile, int32_t x, int32_t y)
{
    const fxs_targets *t = f->eye->targets;
    const int32_t columns = fxs_min(FXS_TILE, f->eye->view.width - x);
    const int32_t rows = fxs_min(FXS_TILE, f->eye->view.height - y);
    unsigned char *colour = t->colour.pixels ? fxs_image_at(&t->colour, x, y, fxs_pixel_bytes(t->format)) : 0;
    if (colour && t->backdrop.pixels)
        fxs_resolve_over(t->format, tile, columns, rows, fxs_image_at(&t->backdrop, x, y, 4), t->backdrop.stride,
                         colour, t->colour.stride);
    else if (colour)
        f->context->kernels.resolve(f->options, t->format, tile, columns, rows, colour, t->colour.stride);
    if (t->coverage.pixels)
        resolve_coverage(tile, columns, rows, fxs_image_at(&t->coverage, x, y, 1), t->coverage.stride);
}
#endif
