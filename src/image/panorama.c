/* Resamples cube faces to an equirectangular panorama in fixed point. Faces overlap by a margin and are blended by
   the distance from their edge. */
#include "panorama.h"

#include <string.h>

#include "src/base/sine.h"

#define ONE_Q30 ((int64_t)1 << 30)
#define HALF_PI_Q30 1686629713

/* A square face of a cube around the camera: `side` pixels span 90 degrees, and `margin` pixels are added on all
   sides. */
typedef struct face {
    int side, margin, size;
} face;

/* Chooses the size of a cube face. Its side is even, so that focal length and middle are integers. A pixel of the
   panorama spans 1 to 2 pixels of a face. */
static face face_of(int width)
{
    const int side = (width / 2 + 3) / 4 * 4, margin = side / 16 + 2;
    return (face){side, margin, side + 2 * margin};
}

/* The axes right, down and forward of each cube face, as axes of the panorama's camera: 1 is its x, -3 its -z. */
static const signed char axes[FXS_PANORAMA_FACES][3] = {
    {1, 2, 3}, {-3, 2, 1}, {-1, 2, -3}, {3, 2, -1}, {1, 3, -2}, {1, -3, 2}
};

void fxs_panorama_face(const fxs_view *view, int number, int width, fxs_view *out)
{
    const face f = face_of(width);
    *out = *view;
    out->width = out->height = f.size;
    out->fx = out->fy = f.side / 2;
    out->cx = out->cy = f.size / 2;
    out->projection = FXS_PERSPECTIVE;
    for (int i = 0; i < 3; i++) {
        const int axis = axes[number][i], row = (axis < 0 ? -axis : axis) - 1;
        for (int k = 0; k < 3; k++)
            out->rotation[3 * i + k] = axis < 0 ? -view->rotation[3 * row + k] : view->rotation[3 * row + k];
    }
}

static int64_t times_q30(int64_t a, int64_t b)
{
    return (a * b) >> 30;
}

/* Computes the sine of 0 to a quarter turn by its series to x^13; error below 2^-28. */
static int64_t sin_of_quarter_q30(int64_t part_q30)
{
    static const int divisors[] = {156, 110, 72, 42, 20, 6};
    const int64_t x = times_q30(part_q30, HALF_PI_Q30), square = times_q30(x, x);
    int64_t sum = ONE_Q30;
    for (int i = 0; i < 6; i++)
        sum = ONE_Q30 - times_q30(square, sum) / divisors[i];
    return times_q30(x, sum);
}

static int64_t sin_q30(uint32_t turns_q32)
{
    const int64_t part = turns_q32 & 0x3fffffff;
    const int64_t s = sin_of_quarter_q30(turns_q32 >> 30 & 1 ? ONE_Q30 - part : part);
    return turns_q32 >> 31 ? -s : s;
}

static int64_t cos_q30(uint32_t turns_q32)
{
    return sin_q30(turns_q32 + 0x40000000u);
}

typedef struct samples {
    int64_t sums[4], weight;
} samples;

/* Adds the four pixels around a place in a cube face. */
static void add_sample(samples *s, const fxs_panorama_part *part, int64_t x_q8, int64_t y_q8, int64_t weight)
{
    const int64_t right = x_q8 & 255, below = y_q8 & 255;
    const uint8_t *a = part->rgba + 4 * (((y_q8 >> 8) - part->y) * part->width + (x_q8 >> 8) - part->x);
    const uint8_t *b = a + 4 * (ptrdiff_t)part->width;
    for (int c = 0; c < 4; c++)
        s->sums[c] += weight * ((256 - below) * ((256 - right) * a[c] + right * a[c + 4]) +
                                below * ((256 - right) * b[c] + right * b[c + 4]));
    s->weight += weight;
}

static int64_t component(const int64_t d[3], int axis)
{
    return axis < 0 ? -d[-axis - 1] : d[axis - 1];
}

/* Computes the place of a direction in a cube face, and returns its weight: the distance from the face's edge, so that
   no seam is visible; at most 0: outside. */
static int64_t find_place(const int64_t d_q30[3], const face *f, int number, int64_t place_q8[2])
{
    const int64_t reach_q16 = 65536 + 131072 * (int64_t)(f->margin - 1) / f->side;
    const int64_t middle_q8 = (int64_t)f->size * 128 - 128, focal_q8 = (int64_t)f->side * 128;
    const int64_t most_q8 = (int64_t)(f->size - 1) * 256 - 1, ahead = component(d_q30, axes[number][2]);
    int64_t outer = 0;
    for (int i = 0; i < 2; i++) {
        const int64_t x = component(d_q30, axes[number][i]), across = x < 0 ? -x : x;
        outer = across > outer ? across : outer;
        if (ahead <= 0 || across >= 2 * ahead)
            return 0;
        const int64_t at_q8 = middle_q8 + x * focal_q8 / ahead;
        place_q8[i] = at_q8 < 0 ? 0 : at_q8 > most_q8 ? most_q8 : at_q8;
    }
    return reach_q16 - outer * 65536 / ahead;
}

static void sample(uint8_t *rgba, const int64_t d_q30[3], const face *f, const fxs_panorama_part *parts)
{
    int64_t place_q8[2];
    samples s;
    memset(&s, 0, sizeof s);
    for (int i = 0; i < FXS_PANORAMA_FACES; i++) {
        const int64_t weight = find_place(d_q30, f, i, place_q8);
        if (weight > 0)
            add_sample(&s, &parts[i], place_q8[0], place_q8[1], weight);
    }
    for (int c = 0; c < 4; c++)
        rgba[c] = (uint8_t)((s.sums[c] + s.weight * 32768) / (s.weight * 65536));
}

/* Computes the direction of a pixel, in the axes of the panorama's camera. */
static void direction_of(int x, int y, int width, int height, int64_t d_q30[3])
{
    const uint32_t up_q32 = 0x40000000u - (uint32_t)((((uint64_t)y * 2 + 1) << 30) / (uint32_t)height);
    const uint32_t right_q32 = (uint32_t)((((uint64_t)x * 2 + 1) << 31) / (uint32_t)width) + 0x80000000u;
    const int64_t level_q30 = cos_q30(up_q32);
    d_q30[0] = times_q30(level_q30, sin_q30(right_q32));
    d_q30[1] = -sin_q30(up_q32);
    d_q30[2] = times_q30(level_q30, cos_q30(right_q32));
}

static int column_of(int strip, int strips, int width)
{
    return (int)((int64_t)strip * width / strips);
}

static void widen(int *first, int *length, int at)
{
    const int end = *length ? *first + *length : at, last = at + 2 > end ? at + 2 : end;
    *first = !*length || at < *first ? at : *first;
    *length = last - *first;
}

void fxs_panorama_parts(int width, int height, int strip, int strips,
                        fxs_panorama_part parts[FXS_PANORAMA_FACES])
{
    const face f = face_of(width);
    int64_t d_q30[3], place_q8[2];
    for (int i = 0; i < FXS_PANORAMA_FACES; i++)
        parts[i] = (fxs_panorama_part){0, 0, 0, strips == 1 ? f.size : 0, strips == 1 ? f.size : 0};
    for (int x = column_of(strip, strips, width); x < column_of(strip + 1, strips, width) && strips > 1; x++)
        for (int y = 0; y < height; y++) {
            direction_of(x, y, width, height, d_q30);
            for (int i = 0; i < FXS_PANORAMA_FACES; i++)
                if (find_place(d_q30, &f, i, place_q8) > 0) {
                    widen(&parts[i].x, &parts[i].width, (int)(place_q8[0] >> 8));
                    widen(&parts[i].y, &parts[i].height, (int)(place_q8[1] >> 8));
                }
        }
}

void fxs_panorama_aside(const fxs_view *view, int strip, int strips, double aside, fxs_view *out)
{
    const double turns = (strip + 0.5) / strips - 0.5, s = fxs_sine(turns), c = fxs_sine(turns + 0.25);
    *out = *view;
    for (int i = 0; i < 3; i++)
        out->position[i] += aside * (c * view->rotation[i] - s * view->rotation[6 + i]);
}

void fxs_panorama_rows(uint8_t *rgba, int width, int height, const fxs_panorama_part parts[FXS_PANORAMA_FACES],
                       int strip, int strips, int first, int end)
{
    const face f = face_of(width);
    int64_t d_q30[3];
    for (int y = first; y < end; y++)
        for (int x = column_of(strip, strips, width); x < column_of(strip + 1, strips, width); x++) {
            direction_of(x, y, width, height, d_q30);
            sample(rgba + 4 * ((size_t)y * (size_t)width + (size_t)x), d_q30, &f, parts);
        }
}
