/* Renders a photograph through a lens: resamples a perspective picture that shows all of it. The position of each pixel
   comes from the inverse of the lens, by Newton's method, started from a table of the radial part. */
#include "lens_warp.h"

#include <math.h>
#include <string.h>

#define FARTHEST 3.7320508075688772    /* tangent of 75 degrees, the largest angle between the axis and a point of the
                                          picture */
#define DIFFERENCE 1e-6
#define NEAR_ENOUGH 1e-8

enum { NEWTON_MOST = 12, SAMPLES = 64, LARGER_MOST = 4, MARGIN = 2, POSITION_BITS = 8 };

static void make_table(fxs_lens_warp *w)
{
    fxs_lens radial = w->lens;
    memset(radial.p, 0, sizeof radial.p);
    memset(radial.s, 0, sizeof radial.s);
    radial.skew = 0;
    w->step = FARTHEST / FXS_WARP_STEPS;
    w->reach[0] = 0;
    w->steps = 0;
    for (int i = 1; i <= FXS_WARP_STEPS; i++) {
        double bent[2];
        fxs_lens_bend(&radial, i * w->step, 0, bent);
        if (!(bent[0] > w->reach[i - 1]))
            return;
        w->reach[i] = bent[0];
        w->steps = i;
    }
}

/* Looks up in the table the distance from the axis that has a given radius in the photograph. */
static double look_up(const fxs_lens_warp *w, double reach)
{
    int low = 0, high = w->steps;
    if (reach >= w->reach[high])
        return high * w->step;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (w->reach[middle] <= reach)
            low = middle;
        else
            high = middle;
    }
    return (low + (reach - w->reach[low]) / (w->reach[high] - w->reach[low])) * w->step;
}

static double improve(const fxs_lens *lens, const double bent[2], double at[2])
{
    double here[2], right[2], below[2];
    fxs_lens_bend(lens, at[0], at[1], here);
    fxs_lens_bend(lens, at[0] + DIFFERENCE, at[1], right);
    fxs_lens_bend(lens, at[0], at[1] + DIFFERENCE, below);
    const double a = (right[0] - here[0]) / DIFFERENCE, b = (below[0] - here[0]) / DIFFERENCE;
    const double c = (right[1] - here[1]) / DIFFERENCE, d = (below[1] - here[1]) / DIFFERENCE;
    const double u = bent[0] - here[0], v = bent[1] - here[1], determinant = a * d - b * c;
    at[0] += (d * u - b * v) / determinant;
    at[1] += (a * v - c * u) / determinant;
    return u * u + v * v;
}

int fxs_lens_warp_straighten(const fxs_lens_warp *w, const double bent[2], double place[2])
{
    const double reach = sqrt(bent[0] * bent[0] + bent[1] * bent[1]);
    const double scale = reach > 0 ? look_up(w, reach) / reach : 1, most = w->steps * w->step;
    double left = 1;
    place[0] = scale * bent[0];
    place[1] = scale * bent[1];
    for (int i = 0; i < NEWTON_MOST && left > NEAR_ENOUGH * NEAR_ENOUGH; i++)
        left = improve(&w->lens, bent, place);
    return left <= NEAR_ENOUGH * NEAR_ENOUGH && place[0] * place[0] + place[1] * place[1] <= most * most;
}

typedef struct box {
    double low[2], high[2], farthest;
} box;

/* Extends the box of the perspective picture by a border point of the photograph. Where the lens sees nothing, it uses
   the farthest visible point. */
static void take_place(const fxs_lens_warp *w, double x, double y, box *b)
{
    const fxs_view *p = &w->photograph;
    const double bent[2] = {(x - p->cx) / p->fx, (y - p->cy) / p->fy};
    const double reach = sqrt(bent[0] * bent[0] + bent[1] * bent[1]), most = w->steps * w->step;
    double place[2];
    if (!fxs_lens_warp_straighten(w, bent, place))
        for (int i = 0; i < 2; i++)
            place[i] = bent[i] / reach * most;
    for (int i = 0; i < 2; i++) {
        b->low[i] = fmin(b->low[i], place[i]);
        b->high[i] = fmax(b->high[i], place[i]);
    }
    b->farthest = fmax(b->farthest, sqrt(place[0] * place[0] + place[1] * place[1]));
}

static double largest_scale(const fxs_lens_warp *w, double farthest)
{
    double scale = 0;
    for (int i = 0; i < w->steps && i * w->step <= farthest; i++)
        scale = fmax(scale, (w->reach[i + 1] - w->reach[i]) / w->step);
    return scale > 0 ? scale : 1;
}

static double most_pixels(double side)
{
    return fmin(FXS_MAX_SIZE - 2 * MARGIN, LARGER_MOST * side);
}

static int pixels(double wanted, double side)
{
    const double most = most_pixels(side);
    return 2 * MARGIN + (wanted > 0 ? (int)ceil(wanted < most ? wanted : most) : 0);
}

void fxs_lens_warp_make(fxs_lens_warp *w, const fxs_lens *lens, const fxs_view *photograph)
{
    const double size[2] = {photograph->width, photograph->height};
    box b = {{0, 0}, {0, 0}, 0};
    w->lens = *lens;
    w->photograph = w->cover = *photograph;
    make_table(w);
    for (int i = 0; i <= SAMPLES; i++) {
        take_place(w, size[0] * i / SAMPLES, 0, &b);
        take_place(w, size[0] * i / SAMPLES, size[1], &b);
        take_place(w, 0, size[1] * i / SAMPLES, &b);
        take_place(w, size[0], size[1] * i / SAMPLES, &b);
    }
    double scale = largest_scale(w, b.farthest);
    const double focal[2] = {photograph->fx, photograph->fy};
    for (int i = 0; i < 2; i++) {
        scale = fmin(scale, most_pixels(size[i]) / fmax((b.high[i] - b.low[i]) * focal[i], 1));
    }
    w->cover.fx = scale * focal[0];
    w->cover.fy = scale * focal[1];
    w->cover.cx = MARGIN - b.low[0] * w->cover.fx;
    w->cover.cy = MARGIN - b.low[1] * w->cover.fy;
    w->cover.width = pixels((b.high[0] - b.low[0]) * w->cover.fx, size[0]);
    w->cover.height = pixels((b.high[1] - b.low[1]) * w->cover.fy, size[1]);
}

static int between(double at, int size, uint32_t *part)
{
    const double most = (double)(size - 1) * (1 << POSITION_BITS);
    const double place = floor((at - 0.5) * (1 << POSITION_BITS) + 0.5);
    const int fixed = (int)(place > 0 ? place < most ? place : most : 0);
    *part = (uint32_t)fixed & ((1 << POSITION_BITS) - 1);
    return fixed >> POSITION_BITS;
}

static void sample(const fxs_view *view, const uint8_t *rgba, const double at[2], uint8_t out[4])
{
    uint32_t part[2];
    const int x = between(at[0], view->width, &part[0]), y = between(at[1], view->height, &part[1]);
    const uint8_t *p = rgba + 4 * ((size_t)y * (size_t)view->width + (size_t)x);
    const size_t right = x + 1 < view->width ? 4 : 0, below = y + 1 < view->height ? 4 * (size_t)view->width : 0;
    for (size_t c = 0; c < 4; c++) {
        const uint32_t upper = p[c] * (256 - part[0]) + p[c + right] * part[0];
        const uint32_t lower = p[c + below] * (256 - part[0]) + p[c + below + right] * part[0];
        out[c] = (uint8_t)((upper * (256 - part[1]) + lower * part[1] + 32768) >> 16);
    }
}

void fxs_lens_warp_rows(const fxs_lens_warp *w, const uint8_t *cover, const uint8_t outside[4], uint8_t *rgba,
                        int first, int end)
{
    const fxs_view *p = &w->photograph, *c = &w->cover;
    for (int y = first; y < end; y++) {
        uint8_t *out = rgba + 4 * (size_t)y * (size_t)p->width;
        for (int x = 0; x < p->width; x++, out += 4) {
            const double bent[2] = {(x + 0.5 - p->cx) / p->fx, (y + 0.5 - p->cy) / p->fy};
            double place[2];
            if (!fxs_lens_warp_straighten(w, bent, place)) {
                memcpy(out, outside, 4);
                continue;
            }
            const double at[2] = {c->fx * place[0] + c->cx, c->fy * place[1] + c->cy};
            sample(c, cover, at, out);
        }
    }
}
