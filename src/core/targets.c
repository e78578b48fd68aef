/* Checks the images of a request, and writes the colours and coverage of a tile. */
#include "memory.h"
#include "targets.h"

#define IMAGES 8

typedef struct part {
    const fxs_image *image;
    int bytes, alignment, written;
    int32_t width, height;         /* size of the image in its own pixels */
} part;

static void parts_of(part parts[IMAGES], const fxs_targets *t, int32_t width, int32_t height)
{
    const int32_t w = width, h = height, side = FXS_MACRO * FXS_TILE;
    const part all[IMAGES] = {
        {&t->colour, fxs_pixel_bytes(t->format), t->format == FXS_FORMAT_RGBA16_COVERAGE ? 2 : 1, 1, w, h},
        {&t->coverage, 1, 1, 1, w, h}, {&t->mean_depth, 4, 4, 1, w, h}, {&t->median_depth, 4, 4, 1, w, h},
        {&t->id, 8, 4, 1, w, h}, {&t->occluder, 4, 4, 0, w, h}, {&t->backdrop, 4, 1, 0, w, h},
        {&t->rates, 1, 1, 0, (w + side - 1) / side, (h + side - 1) / side}};
    memcpy(parts, all, sizeof all);
}

typedef struct extent {
    uintptr_t low, high;
} extent;

static extent extent_of(const part *p)
{
    const ptrdiff_t below = (p->height - 1) * p->image->stride;
    const uintptr_t top = (uintptr_t)p->image->pixels, row = (uintptr_t)p->width * (unsigned)p->bytes;
    return (extent){top + (uintptr_t)(below < 0 ? below : 0), top + (uintptr_t)(below < 0 ? 0 : below) + row};
}

static int is_valid(const part *p)
{
    const ptrdiff_t row = (ptrdiff_t)p->width * p->bytes, stride = p->image->stride;
    const ptrdiff_t most = (PTRDIFF_MAX - row) / p->height;
    const uintptr_t top = (uintptr_t)p->image->pixels;
    if (top % (unsigned)p->alignment || stride % p->alignment || stride > most || stride < -most ||
        (p->height > 1 && stride < row && stride > -row))
        return 0;
    const extent e = extent_of(p);     /* an image with addresses that wrap around the address space has
                                                          high < low */
    return e.low <= top && top < e.high;
}

/* Returns true if two images share a byte. Rows with equal strides may interlace, as in a side-by-side stereo
   picture. */
static int overlap(const part *a, const part *b)
{
    const extent extents[2] = {extent_of(a), extent_of(b)};
    if (extents[0].high <= extents[1].low || extents[1].high <= extents[0].low)
        return 0;
    const ptrdiff_t strides[2] = {a->image->stride, b->image->stride};
    const uintptr_t stride = (uintptr_t)(strides[0] < 0 ? -strides[0] : strides[0]);
    if ((strides[0] != strides[1] && strides[0] != -strides[1]) || !stride)
        return 1;
    const part *parts[2] = {a, b};
    const int first = extents[1].low < extents[0].low;
    const uintptr_t ahead = (extents[!first].low - extents[first].low) % stride;
    return ahead < (uintptr_t)(parts[first]->width * (ptrdiff_t)parts[first]->bytes) ||
           ahead + (uintptr_t)(parts[!first]->width * (ptrdiff_t)parts[!first]->bytes) > stride;
}

static int collide(const part *a, const part *b)
{
    return a->image->pixels && b->image->pixels && (a->written || b->written) && overlap(a, b);
}

static int is_in_place(const fxs_targets *t)
{
    return t->backdrop.pixels == t->colour.pixels && t->backdrop.stride == t->colour.stride &&
           t->format == FXS_FORMAT_RGBA8;
}

int fxs_targets_check(const fxs_targets *t, int32_t width, int32_t height)
{
    if ((unsigned)t->format > FXS_FORMAT_RGB565_SWAPPED || t->depth_bits < 0 || t->depth_bits > 28 ||
        (t->backdrop.pixels && fxs_is_premultiplied(t->format)))
        return FXS_ERR_TARGET;
    part parts[IMAGES];
    parts_of(parts, t, width, height);
    for (int i = 0; i < IMAGES; i++) {
        if (parts[i].image->pixels && !is_valid(&parts[i]))
            return FXS_ERR_TARGET;
        for (int k = 0; k < i; k++)
            if (collide(&parts[k], &parts[i]) &&
                !(parts[i].image == &t->backdrop && k == 0 && is_in_place(t)))
                return FXS_ERR_TARGET;
    }
    return 0;
}

int fxs_targets_collide(const fxs_targets *a, const fxs_targets *b, int32_t width, int32_t height)
{
    part of_a[IMAGES], of_b[IMAGES];
    int any = 0;
    parts_of(of_a, a, width, height);
    parts_of(of_b, b, width, height);
    for (int i = 0; i < IMAGES; i++)
        for (int k = 0; k < IMAGES; k++)
            any |= collide(&of_a[i], &of_b[k]);
    return any;
}

static int is_written(const fxs_targets *t)
{
    return t->colour.pixels || t->coverage.pixels || t->mean_depth.pixels || t->median_depth.pixels || t->id.pixels;
}

int fxs_targets_missing(const fxs_context *context, const fxs_request *request)
{
    const int all = request && (request->eyes != 2 || is_written(&request->targets[1])) &&
                    is_written(&request->targets[0]);
    return !context || !request || context->config.draw || all ? 0 : FXS_ERR_TARGET;
}

int fxs_targets_traced(const fxs_targets *t)
{
    return t && (t->mean_depth.pixels || t->median_depth.pixels || t->id.pixels || t->occluder.pixels);
}

static void resolve_coverage(const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels,
                             ptrdiff_t stride)
{
    for (int32_t y = 0; y < rows; y++)
        for (int32_t x = 0; x < columns; x++)
            pixels[y * stride + x] = (unsigned char)fxs_coverage_8bit(tile->transmittance_q15[y * FXS_TILE + x]);
}

#ifndef __CUDACC__
static enum fxs_format resolved_format(enum fxs_format format)
{
    return format == FXS_FORMAT_BGRA8 ? FXS_FORMAT_RGBA8
           : format == FXS_FORMAT_RGB565_SWAPPED ? FXS_FORMAT_RGB565 : format;
}

static void swap_bytes(enum fxs_format format, int32_t columns, int32_t rows, unsigned char *pixels, ptrdiff_t stride)
{
    const int bytes = fxs_pixel_bytes(format), other = format == FXS_FORMAT_BGRA8 ? 2 : 1;
    for (int32_t y = 0; y < rows && format != resolved_format(format); y++)
        for (int32_t x = 0; x < columns; x++) {
            unsigned char *pixel = pixels + y * stride + x * bytes, first = pixel[0];
            pixel[0] = pixel[other];
            pixel[other] = first;
        }
}

void fxs_resolve_colour(const fxs_kernels *kernels, const fxs_options *options, enum fxs_format format,
                        const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels, ptrdiff_t stride)
{
    kernels->resolve(options, resolved_format(format), tile, columns, rows, pixels, stride);
    swap_bytes(format, columns, rows, pixels, stride);
}

static void resolve_over(const fxs_targets *t, const fxs_tile *tile, int32_t columns, int32_t rows, int32_t x,
                         int32_t y, unsigned char *colour)
{
    fxs_resolve_over(resolved_format(t->format), tile, columns, rows, fxs_image_at(&t->backdrop, x, y, 4),
                     t->backdrop.stride, colour, t->colour.stride);
    swap_bytes(t->format, columns, rows, colour, t->colour.stride);
}

void fxs_resolve_targets(const fxs_frame *f, const fxs_tile *tile, int32_t x, int32_t y)
{
    const fxs_targets *t = f->targets;
    const int32_t columns = fxs_min(FXS_TILE, f->view.width - x);
    const int32_t rows = fxs_min(FXS_TILE, f->view.height - y);
    unsigned char *colour = t->colour.pixels ? fxs_image_at(&t->colour, x, y, fxs_pixel_bytes(t->format)) : 0;
    if (colour && t->backdrop.pixels)
        resolve_over(t, tile, columns, rows, x, y, colour);
    else if (colour)
        fxs_resolve_colour(f->context->config.kernels, f->options, t->format, tile, columns, rows, colour,
                           t->colour.stride);
    if (t->coverage.pixels)
        resolve_coverage(tile, columns, rows, fxs_image_at(&t->coverage, x, y, 1), t->coverage.stride);
}
#endif
