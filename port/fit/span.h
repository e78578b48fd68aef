/* The tiles that a splat's ellipse touches, row by row. */
#ifndef FXS_FIT_SPAN_H
#define FXS_FIT_SPAN_H

#include <math.h>

#include "stage.h"

typedef struct fxs_fit_span {
    int32_t first, end;            /* columns of tiles */
} fxs_fit_span;

static inline int32_t fxs_fit_cut(float x, int32_t most)
{
    return x > 0 ? (x < (float)most ? (int32_t)x : most) : 0;
}

/* The tiles that centre - reach .. centre + reach touches. */
static inline fxs_fit_span fxs_fit_reach(float centre, float reach, int32_t tiles)
{
    return (fxs_fit_span){fxs_fit_cut((centre - reach) / 16, tiles), fxs_fit_cut((centre + reach) / 16 + 1, tiles)};
}

/* Rows of tiles. */
static inline fxs_fit_span fxs_fit_rows(const fxs_fit_camera *camera, const fxs_fit_splat *s)
{
    return fxs_fit_reach(s->centre[1], s->square > 0 ? s->square : s->half[1], camera->tiles_y);
}

/* Of a row of tiles: u = r cos, v = r sin, x = (u - uy y) / ux, y = v / vy. x is largest where tan = -uy / vy, or as
   near to there as the row's pixels are. With a margin of a hundredth, and of a hundredth of a pixel. */
static inline fxs_fit_span fxs_fit_columns(const fxs_fit_camera *camera, const fxs_fit_splat *s, int32_t row)
{
    if (s->square > 0)
        return fxs_fit_reach(s->centre[0], s->square, camera->tiles_x);
    const float top = (float)(row * FXS_FIT_TILE) + 0.5f - s->centre[1], bottom = top + (FXS_FIT_TILE - 1);
    const float r2 = (s->limit - s->offset) * 1.01f, slope = s->uy / s->vy;
    const float tip = -(sqrtf(r2) / s->vy) * slope / sqrtf(1 + slope * slope);
    const float y[2] = {fminf(fmaxf(-tip, top), bottom), fminf(fmaxf(tip, top), bottom)};
    float reach[2];
    for (int i = 0; i < 2; i++) {
        const float left = r2 - (s->vy * y[i]) * (s->vy * y[i]);
        reach[i] = (sqrtf(left > 0 ? left : 0) + (i ? -s->uy * y[i] : s->uy * y[i])) / s->ux + 0.01f;
    }
    const fxs_fit_span all = {fxs_fit_cut((s->centre[0] - reach[0]) / 16, camera->tiles_x),
                              fxs_fit_cut((s->centre[0] + reach[1]) / 16 + 1, camera->tiles_x)};
    return all;
}

#endif
