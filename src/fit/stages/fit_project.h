/* Projects LANES Gaussians to splats (Gaussians in the picture). */
#ifndef FXS_FIT_PROJECT_H
#define FXS_FIT_PROJECT_H

#include "fit_gaussian.h"
#include "span.h"

enum { SPLAT_LIMIT = 6, SPLAT_COLOUR = 7, SPLAT_TILES = 14, SPLAT_NUMBERS };

/* Returns half the side of a splat's square cut-off, 3 sigma_max. The covariance in the picture is (A, B; B, C). With m
   = (A + C) / 2, sigma_max^2 = m + sqrt(((A - C) / 2)^2 + B^2). */
static inline real square_of(const shape *s)
{
    const real middle = 0.5f * (s->a + s->c), half = 0.5f * (s->a - s->c);
    return 3.0f * root(middle + root(half * half + s->b * s->b));
}

/* Projects LANES Gaussians to splats without colour (colours are 0). Returns the mask of visible splats; if none is
   visible, writes nothing. */
static inline mask find_splat(const fxs_fit_camera *camera, const float *at, size_t stride,
                              real numbers[SPLAT_NUMBERS])
{
    shape s;
    find_shape(&s, camera, at, stride);
    /* The offset of a splat's level is -log2 of its opacity o: log2(1 + e^-x), with the logit x. */
    real offset = 1.44269504f * ln(1.0f + exp_of_minus(load(at + FXS_FIT_OPACITY * (ptrdiff_t)stride)));
    if (camera->is_antialiased)    /* antialiasing divides the opacity by sqrt(share), the factor by which dilation
                                      enlarges the area of a splat */
        offset += 0.721347520f * ln(least(s.share, all(1e30f)));
    const real limit = camera->is_square ? all(FXS_FIT_FAINT) : least(offset + FXS_FIT_CUT, all(FXS_FIT_FAINT));
    const real radius = root(most(limit - offset, all(0)) * (FXS_FIT_WIDER / (FXS_FIT_UNIT * FXS_FIT_UNIT)));
    const real x = s.slope[0] * camera->focal[0] + camera->middle[0];
    const real y = s.slope[1] * camera->focal[1] + camera->middle[1];
    const real half_x = camera->is_square ? square_of(&s) : radius * root(s.a) + 0.01f;
    const real half_y = camera->is_square ? half_x : radius * root(s.c) + 0.01f;
    mask seen = both(below(all(camera->near), s.in_camera[2]), below(offset, limit));
    seen = both(seen, both(below(all(0), x + half_x), below(x - half_x, all((float)camera->width))));
    seen = both(seen, both(below(all(0), y + half_y), below(y - half_y, all((float)camera->height))));
    if (!any(seen))
        return seen;
    seen = both(seen, below(s.ux, all(1e6f)));     /* excludes splats with NaN or extreme values */
    ellipses e;
    e.x = x;
    e.y = y;
    e.ux = s.ux * FXS_FIT_UNIT;
    e.uy = s.uy * FXS_FIT_UNIT;
    e.vy = s.vy * FXS_FIT_UNIT;
    e.radius2 = camera->is_square ? all(-1) : radius * radius * (FXS_FIT_UNIT * FXS_FIT_UNIT);
    e.half_y = half_y;
    e.tip = -(radius * s.uy) / (s.vy * root(s.uy * s.uy + s.vy * s.vy));
    find_rows(camera, seen, &e);
    const real found[SPLAT_NUMBERS] = {x, y, e.ux, e.uy, e.vy, offset, limit, all(0), all(0), all(0),
                                       keep(seen, s.in_camera[2]), e.radius2, half_y, e.tip,
                                       count_tiles(camera, &e)};
    memcpy(numbers, found, sizeof found);
    return seen;
}

/* Computes the colours of LANES splats. A splat with a NaN or too large colour gets the cut-off level -1, so that it
   changes no pixel. */
static inline void find_colours(const fxs_fit_camera *camera, int degree, const float *at, size_t stride, real *limit,
                                real colour[3])
{
    look l;
    real offset[3];
    for (int i = 0; i < 3; i++)
        offset[i] = camera->is_parallel ? all(camera->rotation[6 + i])
                                        : load(at + (FXS_FIT_POSITION + i) * (ptrdiff_t)stride) - camera->eye[i];
    find_look(&l, offset, degree, at, stride);
    const mask is_colour = both(both(below(l.colour[0], all(1e6f)), below(l.colour[1], all(1e6f))),
                                below(l.colour[2], all(1e6f)));
    for (int c = 0; c < 3; c++)
        colour[c] = keep(is_colour, most(l.colour[c], all(0)));
    *limit = choose(is_colour, *limit, all(-1));
}

#endif
