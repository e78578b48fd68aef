/* Prepares a photograph for a fit, row by row. Composes it over the background, resamples it bilinearly to undo lens
 * distortion, and adds it to weighted sums for the smaller picture (box filter). Colours are integers. */
#include "photo_pixels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"
#include "src/image/photograph.h"

/* Colours between the steps of preparing a photograph are 0 to 255 * 255. */
#define POSITION_BITS 8            /* number of fractional bits of a position between two pixels */

typedef struct picture {
    const uint8_t *rgba;
    int width, height;
    const uint8_t *background;
    const uint8_t *counts;         /* mask of the picture: a byte per pixel, 0: ignored; null: all pixels count */
} picture;

static int same_proportion(const fxs_view *view, int width, int height)
{
    const double by_width = (double)view->width * height, by_height = (double)view->height * width;
    return fabs(by_width - by_height) <= fmax(fmax(view->width, width), fmax(view->height, height));
}

static void scale(fxs_view *view, int width, int height)
{
    const double x = (double)width / view->width, y = (double)height / view->height;
    view->fx *= x;
    view->cx *= x;
    view->fy *= y;
    view->cy *= y;
    view->width = width;
    view->height = height;
}

static int fit_camera(const char *path, const fxs_listed_view *listed, const picture *p, fxs_view *view,
                      fxs_message *message)
{
    *view = listed->view;
    if (listed->sizeless)
        fxs_view_set_size(listed, view, p->width, p->height);
    else if (!same_proportion(view, p->width, p->height))
        return fxs_fail(message, "%s: %d x %d pixels, its camera has %d x %d, of another proportion", path, p->width,
                        p->height, view->width, view->height);
    else
        scale(view, p->width, p->height);
    return 0;
}

static int is_turned(const fxs_listed_view *listed, int width, int height, int orientation)
{
    return orientation > 4 && !listed->sizeless && !same_proportion(&listed->view, width, height) &&
           same_proportion(&listed->view, height, width);
}

/* Turns a photograph upright, for EXIF orientations 5 to 8. Returns null if memory runs out. */
static uint8_t *turned(const uint8_t *rgba, int width, int height, int orientation)
{
    uint8_t *out = malloc(4 * (size_t)width * (size_t)height), *to = out;
    for (int y = 0; y < width && out; y++)
        for (int x = 0; x < height; x++, to += 4) {
            const int column = orientation > 6 ? width - 1 - y : y;
            const int row = orientation == 6 || orientation == 7 ? height - 1 - x : x;
            memcpy(to, rgba + 4 * ((size_t)row * (size_t)width + (size_t)column), 4);
        }
    return out;
}

static int read_picture(const char *path, const fxs_listed_view *listed, picture *p, uint8_t **rgba, double *exposure,
                        fxs_message *message)
{
    fxs_exif exif;
    FXS_TRY(fxs_photograph_read(path, rgba, &p->width, &p->height, &exif, message));
    *exposure = exif.exposure;
    if (!is_turned(listed, p->width, p->height, exif.orientation))
        return 0;
    uint8_t *upright = turned(*rgba, p->width, p->height, exif.orientation);
    const int width = p->width;
    free(*rgba);
    *rgba = upright;
    p->width = p->height;
    p->height = width;
    return upright ? 0 : fxs_fail_memory(message, path, 4 * (size_t)p->width * (size_t)p->height);
}

static uint32_t on_background(const picture *p, const uint8_t *rgba, int c)
{
    return (uint32_t)(rgba[c] * rgba[3] + p->background[c] * (255 - rgba[3]));
}

static void plain_row(const picture *p, int y, uint16_t *row)
{
    const uint8_t *rgba = p->rgba + 4 * (size_t)y * (size_t)p->width;
    for (int x = 0; x < p->width; x++, rgba += 4, row += 3)
        for (int c = 0; c < 3; c++)
            row[c] = (uint16_t)on_background(p, rgba, c);
}

/* Returns the first of the two pixels around a coordinate, for interpolation. *part is the distance from this pixel's
   centre, in 1/256 pixels. */
static int between(double at, int size, uint32_t *part)
{
    const double most = (double)(size - 1) * (1 << POSITION_BITS);
    const double place = floor((at - 0.5) * (1 << POSITION_BITS) + 0.5);
    const int fixed = (int)(place > 0 ? place < most ? place : most : 0);
    *part = (uint32_t)fixed & ((1 << POSITION_BITS) - 1);
    return fixed >> POSITION_BITS;
}

/* Interpolates a colour bilinearly between pixels of a photograph. Returns true if the mask allows all of these
   pixels. */
static int sample(const picture *p, const double at[2], uint16_t out[3])
{
    uint32_t part[2];
    const int x = between(at[0], p->width, &part[0]), y = between(at[1], p->height, &part[1]);
    const uint8_t *rgba = p->rgba + 4 * ((size_t)y * (size_t)p->width + (size_t)x);
    const size_t right = x + 1 < p->width ? 4 : 0, below = y + 1 < p->height ? 4 * (size_t)p->width : 0;
    for (int c = 0; c < 3; c++) {
        const uint32_t upper = on_background(p, rgba, c) * (256 - part[0]) +
                               on_background(p, rgba + right, c) * part[0];
        const uint32_t lower = on_background(p, rgba + below, c) * (256 - part[0]) +
                               on_background(p, rgba + below + right, c) * part[0];
        out[c] = (uint16_t)(((uint64_t)upper * (256 - part[1]) + (uint64_t)lower * part[1] + 32768) >> 16);
    }
    if (!p->counts)
        return 1;
    const uint8_t *counts = p->counts + (rgba - p->rgba) / 4;
    const size_t beside = part[0] ? right / 4 : 0, under = part[1] ? below / 4 : 0;
    return counts[0] && counts[beside] && counts[under] && counts[under + beside];
}

static void bent_row(const picture *p, const fxs_lens *lens, const fxs_view *photograph,
                     const fxs_view *pinhole, int y, uint16_t *row, uint8_t *counts)
{
    const double v = (y + 0.5 - pinhole->cy) / pinhole->fy;
    for (int x = 0; x < p->width; x++, row += 3) {
        double at[2];
        fxs_lens_bend(lens, (x + 0.5 - pinhole->cx) / pinhole->fx, v, at);
        at[0] = photograph->fx * at[0] + photograph->cx;
        at[1] = photograph->fy * at[1] + photograph->cy;
        counts[x] = (uint8_t)sample(p, at, row);
    }
}

/* Sums the pixels of a photograph's row for each column of the smaller picture, weighted by overlap. A pixel wholly in
   one column has weight `width`. */
static void add_columns(const uint16_t *row, int size, int width, uint64_t *sums)
{
    memset(sums, 0, 3 * (size_t)width * sizeof *sums);
    for (int x = 0, column = 0, room = size; x < size; x++, row += 3) {
        const int first = room < width ? room : width;
        for (int c = 0; c < 3; c++)
            sums[3 * column + c] += (uint64_t)row[c] * (uint64_t)first;
        room -= first;
        if (room)
            continue;
        column++;
        room = size;
        if (first == width)
            continue;
        for (int c = 0; c < 3; c++)
            sums[3 * column + c] += (uint64_t)row[c] * (uint64_t)(width - first);
        room -= width - first;
    }
}

static void add_row(uint64_t *sums, const uint64_t *columns, size_t values, int covered)
{
    for (size_t i = 0; i < values; i++)
        sums[i] += columns[i] * (uint64_t)covered;
}

/* Finishes a row of the smaller picture: divides sums of colours by the area, rounding half up. */
static void finish_row(uint64_t *sums, size_t values, uint64_t area, uint8_t *out)
{
    const uint64_t whole = area * 255;
    for (size_t i = 0; i < values; i++)
        out[i] = (uint8_t)((sums[i] + whole / 2) / whole);
    memset(sums, 0, values * sizeof *sums);
}

static void ignore_row(const picture *p, int y, const uint8_t *counts, int width, int height, uint8_t *mask)
{
    const int first = (int)((int64_t)y * height / p->height);
    const int last = (int)((((int64_t)y + 1) * height - 1) / p->height);
    for (int x = 0; x < p->width; x++)
        for (int row = first; row <= last && !counts[x]; row++)
            for (int64_t column = (int64_t)x * width / p->width; column * p->width < ((int64_t)x + 1) * width; column++)
                mask[(int64_t)row * width + column] = 0;
}

typedef struct work {
    uint16_t *row;
    uint8_t *counts;
    uint64_t *columns, *sums;
} work;

static int work_allocate(work *w, int width, int smaller)
{
    w->row = malloc(3 * (size_t)width * sizeof *w->row);
    w->counts = malloc((size_t)width);
    w->columns = malloc(3 * (size_t)smaller * sizeof *w->columns);
    w->sums = calloc(3 * (size_t)smaller, sizeof *w->sums);
    return w->row && w->counts && w->columns && w->sums;
}

static void work_free(work *w)
{
    free(w->row);
    free(w->counts);
    free(w->columns);
    free(w->sums);
}

/* Averages a photograph down to width * height pixels, and undoes lens distortion unless `pinhole` is null. If `mask`
   is null, all pixels count; else the mask must be 1 everywhere on entry. */
static void average(const picture *p, const fxs_lens *lens, const fxs_view *photograph,
                    const fxs_view *pinhole, int width, int height, work *w, uint8_t *out, uint8_t *mask)
{
    const size_t values = 3 * (size_t)width;
    const uint64_t area = (uint64_t)p->width * (uint64_t)p->height;
    int room = p->height;
    for (int y = 0; y < p->height; y++) {
        if (pinhole)
            bent_row(p, lens, photograph, pinhole, y, w->row, w->counts);
        else
            plain_row(p, y, w->row);
        if (mask)
            ignore_row(p, y, pinhole ? w->counts : p->counts + (size_t)y * (size_t)p->width, width, height, mask);
        add_columns(w->row, p->width, width, w->columns);
        const int first = room < height ? room : height;
        add_row(w->sums, w->columns, values, first);
        room -= first;
        if (room)
            continue;
        finish_row(w->sums, values, area, out);
        out += values;
        add_row(w->sums, w->columns, values, height - first);
        room = p->height - (height - first);
    }
}

static void smaller_size(const picture *p, int resolution, int size[2])
{
    const int longer = p->width > p->height ? p->width : p->height;
    const int full[2] = {p->width, p->height};
    for (int i = 0; i < 2; i++) {
        const int64_t side = longer > resolution ? ((int64_t)full[i] * resolution * 2 + longer) / (2 * (int64_t)longer)
                             : full[i];
        size[i] = side > 1 ? (int)side : 1;
    }
}

static int finish(const char *path, const fxs_listed_view *listed, const picture *p, int resolution,
                  fxs_photo_pixels *photo, fxs_message *message)
{
    fxs_view photograph, *const pinhole = &photo->view;
    const int bends = !fxs_lens_is_pinhole(&listed->lens);
    int size[2];
    FXS_TRY(fit_camera(path, listed, p, &photograph, message));
    *pinhole = photograph;
    if (bends && !fxs_lens_fill(&listed->lens, &photograph, pinhole))
        return fxs_fail(message, "%s: the distortion of its camera cannot be undone: part of the picture is folded or "
                        "missing", path);
    smaller_size(p, resolution, size);
    const size_t pixels = (size_t)size[0] * (size_t)size[1], bytes = 3 * pixels;
    work w;
    photo->pixels = malloc(bytes);
    photo->mask = p->counts ? malloc(pixels) : NULL;
    const int allocated = work_allocate(&w, p->width, size[0]) && photo->pixels && (photo->mask || !p->counts);
    if (allocated && photo->mask)
        memset(photo->mask, 1, pixels);
    if (allocated)
        average(p, &listed->lens, &photograph, bends ? pinhole : NULL, size[0], size[1], &w, photo->pixels,
                photo->mask);
    work_free(&w);
    scale(pinhole, size[0], size[1]);
    return allocated ? 0 : fxs_fail_memory(message, path, bytes);
}

void fxs_photo_view(const fxs_listed_view *listed, fxs_view *view)
{
    if (fxs_lens_is_pinhole(&listed->lens) || !fxs_lens_fill(&listed->lens, &listed->view, view))
        *view = listed->view;
}

int fxs_photo_read(const char *path, const fxs_listed_view *listed, int resolution, const uint8_t background[3],
                   const fxs_photo_masking *masking, fxs_photo_pixels *photo, fxs_message *message)
{
    picture p = {NULL, 0, 0, background, NULL};
    uint8_t *rgba, *counts;
    photo->pixels = photo->mask = NULL;
    FXS_TRY(read_picture(path, listed, &p, &rgba, &photo->exposure, message));
    int error = fxs_photo_mask_read(masking, path, rgba, p.width, p.height, &counts, message);
    p.rgba = rgba;
    p.counts = counts;
    if (!error)
        error = finish(path, listed, &p, resolution, photo, message);
    free(rgba);
    free(counts);
    if (error) {
        free(photo->pixels);
        free(photo->mask);
        photo->pixels = photo->mask = NULL;
    }
    return error;
}
