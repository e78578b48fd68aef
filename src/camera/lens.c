/* Evaluates lens models, and finds the largest pinhole view that a photograph fills. */
#include "lens.h"

#include <math.h>
#include <string.h>

enum { STEPS = 24, SAMPLES = 64, RINGS = 16 };

#define WIDEST 1.7320508075688772   /* tangent of 60 degrees, the largest angle between the axis and a side of the
                                       pinhole view */
#define WIDEST_FOV 3.14

double *fxs_lens_coefficient(fxs_lens *lens, char letter)
{
    return letter >= 's' ? &lens->s[letter - 's'] : letter >= 'p' ? &lens->p[letter - 'p'] :
           letter >= 'a' ? &lens->d[letter - 'a'] : &lens->k[letter - '0'];
}

int fxs_lens_complete(fxs_lens *lens)
{
    for (const char *c = "012345abcpqstuv"; *c; c++)
        if (!isfinite(*fxs_lens_coefficient(lens, *c)))
            return 0;
    if (lens->kind == FXS_LENS_FOV) {
        lens->k[0] = fabs(lens->k[0]);
        lens->kind = lens->k[0] > 0 ? FXS_LENS_FOV : FXS_LENS_BROWN;
        lens->k[1] = 2 * fxs_tangent(fmin(lens->k[0], WIDEST_FOV) / 2);
    }
    return isfinite(lens->skew) && !(lens->kind == FXS_LENS_FOV && lens->k[0] > WIDEST_FOV) &&
           !(lens->kind == FXS_LENS_EUCM && (lens->k[0] < 0 || lens->k[0] > 1 || lens->k[1] <= 0));
}

int fxs_lens_is_pinhole(const fxs_lens *lens)
{
    fxs_lens copy = *lens;
    for (const char *c = "012345abcpqstuv"; *c; c++)
        if (*fxs_lens_coefficient(&copy, *c) != 0)
            return 0;
    return lens->kind != FXS_LENS_FISHEYE && lens->kind != FXS_LENS_FISHEYE_AFTER && lens->skew == 0;
}

/* Computes a tangent by Lambert's continued fraction for angle / 8, then three doublings of the angle. */
double fxs_tangent(double angle)
{
    const double z = angle / 8, square = z * z;
    double t = 15;
    for (int i = 13; i > 0; i -= 2)
        t = i - square / t;
    t = z / t;
    for (int i = 0; i < 3; i++)
        t = 2 * t / (1 - t * t);
    return t;
}

/* Computes an arc tangent: atan(x) = 2 atan(x / (1 + sqrt(1 + x^2))), applied four times, then ten terms of the
   series. */
static double arc_tangent(double x)
{
    double sum = 0;
    for (int i = 0; i < 4; i++)
        x = x / (1 + sqrt(1 + x * x));
    for (int i = 19; i > 0; i -= 2)
        sum = 1.0 / i - x * x * sum;
    return 16 * x * sum;
}

static void bend_brown(const fxs_lens *lens, double x, double y, double bent[2])
{
    const double *k = lens->k, *d = lens->d, *p = lens->p, square = x * x + y * y;
    const double bend = (1 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3])))) /
                        (1 + square * (d[0] + square * (d[1] + square * d[2])));
    bent[0] = bend * x + 2 * p[0] * x * y + p[1] * (square + 2 * x * x);
    bent[1] = bend * y + p[0] * (square + 2 * y * y) + 2 * p[1] * x * y;
}

static void bend_fisheye(const fxs_lens *lens, double x, double y, double bent[2])
{
    const double *k = lens->k, *p = lens->p, *s = lens->s;
    const double radius = sqrt(x * x + y * y), angle = arc_tangent(radius), t = angle * angle;
    const double series = 1 + t * (k[0] + t * (k[1] + t * (k[2] + t * (k[3] + t * (k[4] + t * k[5])))));
    const double bend = radius > 0 ? angle * series / radius : 1, plain = radius > 0 ? angle / radius : 1;
    bent[0] = bend * x;
    bent[1] = bend * y;
    const double u = lens->kind == FXS_LENS_FISHEYE ? plain * x : bent[0];
    const double v = lens->kind == FXS_LENS_FISHEYE ? plain * y : bent[1], square = u * u + v * v;
    bent[0] += 2 * p[0] * u * v + p[1] * (square + 2 * u * u) + square * (s[0] + square * s[1]);
    bent[1] += p[0] * (square + 2 * v * v) + 2 * p[1] * u * v + square * (s[2] + square * s[3]);
}

static double bend_by(const fxs_lens *lens, double square)
{
    const double radius = sqrt(square), *k = lens->k;
    if (lens->kind == FXS_LENS_DIVISION)
        return 2 / (1 + sqrt(1 - 4 * k[0] * square));
    if (lens->kind == FXS_LENS_EUCM)
        return 1 / (k[0] * sqrt(k[1] * square + 1) + (1 - k[0]));
    return (radius > 0 ? arc_tangent(radius * k[1]) / radius : k[1]) / k[0];
}

void fxs_lens_bend(const fxs_lens *lens, double x, double y, double bent[2])
{
    if (lens->kind == FXS_LENS_BROWN) {
        bend_brown(lens, x, y, bent);
    } else if (lens->kind == FXS_LENS_FISHEYE || lens->kind == FXS_LENS_FISHEYE_AFTER) {
        bend_fisheye(lens, x, y, bent);
    } else {
        const double bend = bend_by(lens, x * x + y * y);
        bent[0] = bend * x;
        bent[1] = bend * y;
    }
    bent[0] += lens->skew * bent[1];
}

/* Returns 1 if the lens maps the line from the principal point to a border pixel of the pinhole picture into the
   photograph, with growing radius. */
static int filled_along(const fxs_lens *lens, const fxs_view *photograph, double x, double y)
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

static int filled(const fxs_lens *lens, const fxs_view *photograph, double scale)
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

static double scale_of_widest(const fxs_view *p)
{
    const double x = fmax(p->cx, p->width - p->cx) / p->fx, y = fmax(p->cy, p->height - p->cy) / p->fy;
    return fmax(x, y) / WIDEST;
}

int fxs_lens_fill(const fxs_lens *lens, const fxs_view *photograph, fxs_view *pinhole)
{
    const double least = lens->kind == FXS_LENS_BROWN ? 0 : scale_of_widest(photograph);
    double low = 0.5, high = fmax(2, least);
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
    pinhole->fx = fmax(high, least) * photograph->fx;
    pinhole->fy = fmax(high, least) * photograph->fy;
    return 1;
}
