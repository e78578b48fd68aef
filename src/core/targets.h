/* Checks a request's images, called targets, and writes pixels to them. */
#ifndef FXS_TARGETS_H
#define FXS_TARGETS_H

#include "frame.h"

int fxs_targets_check(const fxs_targets *targets, int32_t width, int32_t height);

/* Returns true if the images of two eyes, width x height pixels each, overlap in memory and one of them is written. */
int fxs_targets_collide(const fxs_targets *a, const fxs_targets *b, int32_t width, int32_t height);

/* Returns FXS_ERR_TARGET if an eye has no image to write and no back end draws, otherwise 0. */
int fxs_targets_missing(const fxs_context *context, const fxs_request *request);

/* Returns true if tiles must be blended by the kernel `trace` instead of `blend`: for depths, ids or an occluder. */
int fxs_targets_traced(const fxs_targets *targets);

void fxs_resolve_targets(const fxs_frame *f, const fxs_tile *tile, int32_t x, int32_t y);

/* Converts a tile to pixels like fxs_resolve_c, but over the RGBA8 picture `backdrop` as the background. */
void fxs_resolve_over(enum fxs_format format, const fxs_tile *tile, int32_t columns, int32_t rows,
                      const unsigned char *backdrop, ptrdiff_t backdrop_stride, unsigned char *pixels,
                      ptrdiff_t stride);

static inline unsigned char *fxs_image_at(const fxs_image *image, int32_t x, int32_t y, int pixel_bytes)
{
    return (unsigned char *)image->pixels + y * image->stride + (ptrdiff_t)x * pixel_bytes;
}

static inline int fxs_depth_bits(const fxs_targets *targets)
{
    return targets->depth_bits ? targets->depth_bits : 16;
}

#endif
