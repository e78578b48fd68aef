#include "lens.h"

#include <math.h>
#include <string.h>

enum { STEPS = 24, SAMPLES = 64, RINGS = 16 };

int fxs_lens_is_pinhole(const fxs_lens *lens)
{
    for (int i = 0; i < 6; i++)
        if (lens->k[i] != 0)
            return 0;
    return !lens->fisheye && !lens->is_unknown && lens->p[0] == 0 && lens->p[1] == 0;
}

/* atan(x) = 2 atan(x / (1 + sqrt(1 + x^2))), four times, then the series: below 0.1, where ten terms are enough. */
static double arc_tangent(double x)
{
    double sum = 0;
    for (int i = 0; i < 4; i++)
        x = x / (1 + sqrt(1 + x * x));
    for (int i = 19; i > 0; i -= 2)
        sum = 1.0 / i - x * x * sum;
    return 16 * x * sum;
}

void fxs_lens_bend(const fxs_lens *lens, double x, double y, double bent[2])
{
    const double *k = lens->k, *p = lens->p, square = x * x + y * y;
    if (lens->fisheye) {
        const double radius = sqrt(square), angle = arc_tangent(radius), t = angle * angle;
        const double bend = radius > 0 ? angle * (1 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3])))) / radius : 1;
        bent[0] = bend * x;
        bent[1] = bend * y;
        return;
    }
    const double bend = (1 + square * (k[0] + square * (k[1] + square * k[2]))) /
                        (1 + square * (k[3] + square * (k[4] + square * k[5])));
    bent[0] = bend * x + 2 * p[0] * x * y + p[1] * (square + 2 * x * x);
    bent[1] = bend * y + p[0] * (square + 2 * y * y) + 2 * p[1] * x * y;
}

/* 1 where the lens puts the line from the principal point to a border pixel of the pinhole picture inside the
   photograph, without folding it. */
static int filled_along(const fxs_lens *lens, const fxs_file_view *photograph, double x, double y)
{
    double bent[2], last = 0;
    for (int ring = 1; ring <= RINGS; ring++) {
        fxs_lens_bend(lens, x * ring / RINGS, y * ring / RINGS, bent);
        const double square = bent[0] * bent[0] + bent[1] * bent[1];
        if (!(square > last))
            return 0;
        last = square;
    }
    const double at[2] = {photograph->fx * bent[0] + photograph->cx, photograph->fy * bent[1] + photograph->cy};
    return at[0] >= 0 && at[0] <= photograph->width && at[1] >= 0 && at[1] <= photograph->height;
}

static int filled(const fxs_lens *lens, const fxs_file_view *photograph, double scale)
{
    const double w = photograph->width, h = photograph->height, fx = scale * photograph->fx,
                 fy = scale * photograph->fy;
    for (int i = 0; i <= SAMPLES; i++) {
        const double x = (w * i / SAMPLES - photograph->cx) / fx, y = (h * i / SAMPLES - photograph->cy) / fy;
        const double left = -photograph->cx / fx, right = (w - photograph->cx) / fx;
        const double top = -photograph->cy / fy, bottom = (h - photograph->cy) / fy;
        if (!filled_along(lens, photograph, x, top) || !filled_along(lens, photograph, x, bottom) ||
            !filled_along(lens, photograph, left, y) || !filled_along(lens, photograph, right, y))
            return 0;
    }
    return 1;
}

int fxs_lens_fill(const fxs_lens *lens, const fxs_file_view *photograph, fxs_file_view *pinhole)
{
    double low = 0.5, high = 2;
    if (!filled(lens, photograph, high))
        return 0;
    for (int step = 0; step < STEPS; step++) {
        const double middle = (low + high) / 2;
        if (filled(lens, photograph, middle))
            high = middle;
        else
            low = middle;
    }
    *pinhole = *photograph;
    pinhole->fx = high * photograph->fx;
    pinhole->fy = high * photograph->fy;
    return 1;
}
