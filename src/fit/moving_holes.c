/* Fills the holes of a moving scene. A hole is a place that a thing hid before it moved. A spare Gaussian fills a hole
 * at the depth of its neighbours in the picture, if the photographs agree on its colour. */
#include <stdlib.h>

#include "src/fit/stages/planes.h"
#include "moving_internal.h"

enum {
    AGREE_LEAST = 3,               /* fewest photographs that must agree on a hole's colour */
    CELL = 8,                      /* width of a cell of the depth grid, pixels */
    CELLS_AROUND = 4,              /* largest distance to a neighbour's cell, cells */
    HOLES_ACROSS = 100             /* number of pixels tested along a row */
};

#define HOLE_LEAST 0.3f            /* least transmittance of a hole */
#define HOLE_DIFFERENCE 0.01f      /* least squared difference to the background, summed over channels */
#define AGREE_DIFFERENCE 0.02f     /* largest squared difference between two photographs that agree */
#define AGREE_SHARE 0.6f           /* least share of photographs that must agree */

/* The holes of a view, a flag for each pixel, and a grid of depths: for each cell, the depth of its nearest still
   Gaussian, or 0. */
typedef struct look {
    const fxs_fit_photograph *photograph;
    uint8_t *holes;
    float *depths;
    int32_t across, down;          /* numbers of cells */
} look;

static void looks_free(look *looks, size_t count)
{
    for (size_t v = 0; v < count && looks; v++) {
        free(looks[v].holes);
        free(looks[v].depths);
    }
    free(looks);
}

/* Draws the Gaussians over one brightness. The planes of the result are valid until the next call. */
static int draw_over(fxs_fit *f, const fxs_fit_camera *camera, float background, fxs_fit_plane planes[3])
{
    const fxs_fit_step_options options = {.sh_degree = f->options.sh_degree,
                                          .background = {background, background, background}};
    return fxs_fit_draw(f->stepper, &f->model, camera, &options, planes);
}

/* Finds the holes of a view. A hole's transmittance follows from pictures over white and over black, and its photograph
   differs from the background. */
static int find_holes(fxs_fit *f, look *l)
{
    const fxs_fit_photograph *p = l->photograph;
    const fxs_fit_camera *c = &p->camera;
    const size_t pixels = (size_t)c->width * (size_t)c->height;
    fxs_fit_plane planes[3];
    float *white = malloc(pixels * sizeof *white);
    int error = white ? draw_over(f, c, 1, planes) : FXS_ERR_MEMORY;
    for (size_t i = 0; i < pixels && !error; i++)
        white[i] = planes[0].first[(ptrdiff_t)(i / (size_t)c->width) * planes[0].stride +
                                   (ptrdiff_t)(i % (size_t)c->width)];
    error = error ? error : draw_over(f, c, 0, planes);
    for (size_t i = 0; i < pixels && !error; i++) {
        const ptrdiff_t y = (ptrdiff_t)(i / (size_t)c->width), x = (ptrdiff_t)(i % (size_t)c->width);
        const float passes = white[i] - planes[0].first[y * planes[0].stride + x];
        float square = 0;
        for (int k = 0; k < 3; k++) {
            const float drawn = planes[k].first[y * planes[k].stride + x] +
                                passes * (float)f->options.background[k] / 255.0f;
            const float d = drawn - (float)p->pixels[3 * i + (size_t)k] / 255.0f;
            square += d * d;
        }
        l->holes[i] = passes >= HOLE_LEAST && square > HOLE_DIFFERENCE && (!p->mask || p->mask[i]);
    }
    free(white);
    return error;
}

/* Converts a place in the world to the camera's axes. */
static void to_camera(const fxs_fit_camera *c, const float place[3], float out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int i = 0; i < 3; i++)
            out[k] += c->rotation[3 * k + i] * (place[i] - c->eye[i]);
    }
}

static void find_depths(const fxs_fit *f, look *l)
{
    const struct fxs_fit_moving *m = f->moving;
    const fxs_fit_camera *c = &l->photograph->camera;
    for (size_t i = 0; i < m->made; i++) {
        float at[3], place[3];
        for (int k = 0; k < 3; k++)
            place[k] = plane(&f->model, FXS_FIT_POSITION + k)[i];
        to_camera(c, place, at);
        if (m->tried[i] != STAYS || at[2] <= c->near || opacity_at(&f->model, i) < HOLE_LEAST)
            continue;
        const float x = c->focal[0] * at[0] / at[2] + c->middle[0], y = c->focal[1] * at[1] / at[2] + c->middle[1];
        if (!(x >= 0 && y >= 0 && x < (float)c->width && y < (float)c->height))
            continue;
        float *depth = &l->depths[(int32_t)y / CELL * l->across + (int32_t)x / CELL];
        *depth = *depth > 0 && *depth < at[2] ? *depth : at[2];
    }
}

static int look_through(fxs_fit *f, size_t view, look *l)
{
    const fxs_fit_camera *c = &f->photographs[view].camera;
    *l = (look){&f->photographs[view], malloc((size_t)c->width * (size_t)c->height), NULL,
                (c->width + CELL - 1) / CELL, (c->height + CELL - 1) / CELL};
    l->depths = calloc((size_t)l->across * (size_t)l->down, sizeof *l->depths);
    if (!l->holes || !l->depths || find_holes(f, l))
        return FXS_ERR_MEMORY;
    find_depths(f, l);
    return 0;
}

/* Returns the depth of the nearest filled cell around a pixel, or 0. */
static float depth_beside(const look *l, int32_t x, int32_t y)
{
    for (int32_t r = 0; r <= CELLS_AROUND; r++)
        for (int32_t j = y / CELL - r; j <= y / CELL + r; j++)
            for (int32_t i = x / CELL - r; i <= x / CELL + r; i++)
                if (i >= 0 && j >= 0 && i < l->across && j < l->down && l->depths[j * l->across + i] > 0)
                    return l->depths[j * l->across + i];
    return 0;
}

/* Projects a place to a pixel of a view. Returns 0 if the pixel is outside the picture. */
static int find_pixel(const look *l, const float place[3], int32_t *x, int32_t *y)
{
    const fxs_fit_camera *c = &l->photograph->camera;
    float at[3];
    to_camera(c, place, at);
    const float column = c->focal[0] * at[0] / at[2] + c->middle[0], row = c->focal[1] * at[1] / at[2] + c->middle[1];
    if (!(at[2] > c->near && column >= 0 && row >= 0 && column < (float)c->width && row < (float)c->height))
        return 0;
    *x = (int32_t)column;
    *y = (int32_t)row;
    return 1;
}

/* Returns 1 if most photographs with a hole at a place agree on its colour. */
static int photographs_agree(const look *looks, size_t count, const float place[3], const uint8_t colour[3])
{
    float holes = 0, agreeing = 0;
    for (size_t v = 0; v < count; v++) {
        const fxs_fit_photograph *p = looks[v].photograph;
        int32_t x, y;
        float square = 0;
        if (!find_pixel(&looks[v], place, &x, &y) || !looks[v].holes[y * p->camera.width + x])
            continue;
        for (int k = 0; k < 3; k++) {
            const float d = ((float)p->pixels[3 * (y * p->camera.width + x) + k] - (float)colour[k]) / 255.0f;
            square += d * d;
        }
        holes += 1;
        agreeing += square < AGREE_DIFFERENCE;
    }
    return agreeing >= AGREE_LEAST && agreeing >= AGREE_SHARE * holes;
}

/* Clears the hole flags around a place in all views, in a square of 2 reach + 1 pixels. */
static void close_hole(const look *looks, size_t count, const float place[3], int32_t reach)
{
    for (size_t v = 0; v < count; v++) {
        const fxs_fit_camera *c = &looks[v].photograph->camera;
        int32_t x, y;
        if (!find_pixel(&looks[v], place, &x, &y))
            continue;
        for (int32_t j = y > reach ? y - reach : 0; j <= y + reach && j < c->height; j++)
            for (int32_t i = x > reach ? x - reach : 0; i <= x + reach && i < c->width; i++)
                looks[v].holes[j * c->width + i] = 0;
    }
}

/* Puts a spare Gaussian at a place. */
static void put_spare(fxs_fit *f, const float place[3], float sigma, const uint8_t colour[3])
{
    const size_t i = f->moving->made++;
    for (int k = 0; k < 3; k++) {
        plane(&f->model, FXS_FIT_POSITION + k)[i] = place[k];
        plane(&f->model, FXS_FIT_SCALE + k)[i] = ln(sigma);
        plane(&f->model, FXS_FIT_COLOUR + k)[i] = ((float)colour[k] / 255.0f - 0.5f) / 0.282094792f;
    }
    for (int k = FXS_FIT_SH; k < FXS_FIT_PARAMETERS; k++)
        plane(&f->model, k)[i] = 0;
    for (int k = 0; k < 4; k++)
        plane(&f->model, FXS_FIT_ROTATION + k)[i] = k == 0;
    plane(&f->model, FXS_FIT_OPACITY)[i] = logit_of(0.8f);
}

/* Fills the hole at a pixel of a view, at the depth of its neighbours. `step` is the distance between tested pixels. */
static void fill_hole(fxs_fit *f, const look *looks, const look *l, int32_t x, int32_t y, int32_t step)
{
    const fxs_fit_camera *c = &l->photograph->camera;
    const float depth = depth_beside(l, x, y);
    const uint8_t *colour = l->photograph->pixels + 3 * (y * c->width + x);
    const float at[3] = {((float)x + 0.5f - c->middle[0]) / c->focal[0] * depth,
                         ((float)y + 0.5f - c->middle[1]) / c->focal[1] * depth, depth};
    float place[3];
    for (int k = 0; k < 3; k++)
        place[k] = c->eye[k] + c->rotation[k] * at[0] + c->rotation[3 + k] * at[1] + c->rotation[6 + k] * at[2];
    if (!(depth > 0) || !photographs_agree(looks, f->count, place, colour))
        return;
    put_spare(f, place, 0.6f * (float)step * depth / c->focal[0], colour);
    close_hole(looks, f->count, place, step / 2);
}

int fxs_fit_fill_holes(fxs_fit *f)
{
    look *looks = calloc(f->count, sizeof *looks);
    int error = looks ? 0 : FXS_ERR_MEMORY;
    for (size_t v = 0; v < f->count && !error; v++)
        error = look_through(f, v, &looks[v]);
    for (size_t v = 0; v < f->count && !error; v++) {
        const fxs_fit_camera *c = &f->photographs[v].camera;
        const int32_t step = c->width / HOLES_ACROSS > 2 ? c->width / HOLES_ACROSS : 2;
        for (int32_t y = step / 2; y < c->height; y += step)
            for (int32_t x = step / 2; x < c->width; x += step)
                if (f->moving->made < f->moving->count && looks[v].holes[y * c->width + x])
                    fill_hole(f, looks, &looks[v], x, y, step);
    }
    looks_free(looks, f->count);
    return error;
}
