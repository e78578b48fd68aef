/* The stages of an instruction set, by its LANES: see stage.h. ISA is its name. */
#include "gaussian.h"
#include "loss.h"
#include "quantise.h"
#include "span.h"
#include "tile.h"

#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define STRING(a) #a
#define STRING_OF(a) STRING(a)

/* ---- project ----------------------------------------------------------------------------------------------------- */

static void set_tiles(const fxs_fit_camera *camera, fxs_fit_splat *s)
{
    const fxs_fit_span rows = fxs_fit_rows(camera, s);
    s->tiles = 0;
    for (int32_t row = rows.first; row < rows.end; row++) {
        const fxs_fit_span columns = fxs_fit_columns(camera, s, row);
        s->tiles += columns.end > columns.first ? (uint32_t)(columns.end - columns.first) : 0;
    }
}

static void project_lanes(const fxs_fit_camera *camera, int degree, const float *at, size_t stride,
                          fxs_fit_splat *splats)
{
    shape s;
    look l;
    float out[16][LANES];
    find_shape(&s, camera, at, stride);
    const real logit = load(at + FXS_FIT_OPACITY * (ptrdiff_t)stride);
    /* -2 ln o = 2 ln(1 + e^-x) */
    const real offset = 2.0f * ln(1.0f + exp_e(least(-logit, all(80))));
    const real limit = least(offset + FXS_FIT_CUT, all(FXS_FIT_FAINT)), radius2 = most(limit - offset, all(0));
    const real x = s.slope[0] * camera->focal[0] + camera->middle[0];
    const real y = s.slope[1] * camera->focal[1] + camera->middle[1];
    const real half_x = root(radius2 * s.a) * 1.001f + 0.01f, half_y = root(radius2 * s.c) * 1.001f + 0.01f;
    const whole seen = (s.in_camera[2] > camera->near) & (offset < limit) & (x + half_x > 0.0f) & (y + half_y > 0.0f) &
                       (x - half_x < (float)camera->width) & (y - half_y < (float)camera->height);
    if (!any(seen)) {
        for (int i = 0; i < LANES; i++)
            splats[i].depth = 0;
        return;
    }
    find_look(&l, &s, degree, at, stride);
    const real numbers[] = {x, y, s.ux, s.uy, s.vy, offset, limit,
                            most(l.colour[0], all(0)), most(l.colour[1], all(0)), most(l.colour[2], all(0)),
                            choose(seen, s.in_camera[2], all(0)), half_x, half_y};
    for (int i = 0; i < 13; i++)
        store(out[i], numbers[i]);
    for (int i = 0; i < LANES; i++) {
        float *to = splats[i].centre;
        for (int k = 0; k < 13; k++)
            to[k] = out[k][i];
        if (splats[i].depth > 0)
            set_tiles(camera, &splats[i]);
    }
}

static void NAMED(fxs_fit_project_, ISA)(const fxs_fit_camera *camera, int degree, const float *parameters,
                                         size_t stride, size_t first, size_t count, fxs_fit_splat *splats)
{
    for (size_t i = first; i < first + count; i += LANES)
        project_lanes(camera, degree, parameters + i, stride, splats + i);
}

/* ---- Tiles ------------------------------------------------------------------------------------------------------- */

static uint32_t NAMED(fxs_fit_blend_, ISA)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count,
                                           int32_t left, int32_t top, fxs_fit_tile *tile)
{
    return blend(splats, entries, count, left, top, tile);
}

static void NAMED(fxs_fit_back_, ISA)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count,
                                      int32_t left, int32_t top, const fxs_fit_tile_gradient *gradient,
                                      float (*sums)[FXS_FIT_SUMS])
{
    back_tile(splats, entries, count, left, top, gradient, sums);
}

/* ---- loss -------------------------------------------------------------------------------------------------------- */

static inline float *at_of(const fxs_fit_plane *plane, int32_t row)
{
    return plane->first + row * plane->stride;
}

/* The photograph's row, 0 to 1, with zeros beside it. */
static void photograph_row(const fxs_fit_loss *loss, int32_t row, float *out)
{
    memset(out, 0, FXS_FIT_MARGIN * sizeof *out);
    for (int32_t x = 0; x < loss->width; x++)
        out[FXS_FIT_MARGIN + x] = (float)loss->photograph[row * loss->pitch + x * loss->step] / 255.0f;
    memset(out + FXS_FIT_MARGIN + loss->width, 0, 2 * FXS_FIT_MARGIN * sizeof *out);
}

static void NAMED(fxs_fit_loss_rows_, ISA)(const fxs_fit_loss *loss, int32_t row, float *scratch)
{
    const int32_t room = loss->width + 3 * FXS_FIT_MARGIN;
    float *b = scratch, *aa = b + room, *bb = aa + room, *ab = bb + room;
    const float *a = at_of(&loss->picture, row) - FXS_FIT_MARGIN;
    photograph_row(loss, row, b);
    for (int32_t x = 0; x < room - FXS_FIT_MARGIN; x += LANES) {
        const real p = load(a + x), q = load(b + x);
        store(aa + x, p * p);
        store(bb + x, q * q);
        store(ab + x, p * q);
    }
    const float *from[FXS_FIT_ROWS] = {a, b, aa, bb, ab};
    for (int i = 0; i < FXS_FIT_ROWS; i++) {
        float *to = at_of(&loss->rows[i], row);
        for (int32_t x = 0; x < loss->width; x += LANES)
            store(to + x, window_sum(from[i] + FXS_FIT_MARGIN + x, 1));
    }
}

/* Lanes beyond the picture's edge are 0. */
static inline real within(int32_t x, int32_t width, real value)
{
    return choose(column_numbers() + (float)x < (float)width, value, all(0));
}

static void NAMED(fxs_fit_loss_derivatives_, ISA)(const fxs_fit_loss *loss, int32_t row)
{
    for (int32_t x = 0; x < loss->width; x += LANES) {
        real sums[FXS_FIT_ROWS];
        for (int i = 0; i < FXS_FIT_ROWS; i++)
            sums[i] = window_sum(at_of(&loss->rows[i], row) + x, loss->rows[i].stride);
        const similarity s = similarity_of(sums[0], sums[1], sums[2], sums[3], sums[4]);
        const real out[FXS_FIT_DERIVATIVES] = {s.by_mean, s.by_square, s.by_product};
        for (int i = 0; i < FXS_FIT_DERIVATIVES; i++)
            store(at_of(&loss->derivatives[i], row) + x, within(x, loss->width, out[i]));
        store(at_of(&loss->values, row) + x, within(x, loss->width, s.value));
    }
}

static void NAMED(fxs_fit_loss_back_rows_, ISA)(const fxs_fit_loss *loss, int32_t row)
{
    for (int i = 0; i < FXS_FIT_DERIVATIVES; i++) {
        const float *from = at_of(&loss->derivatives[i], row);
        float *to = at_of(&loss->rows[i], row);
        for (int32_t x = 0; x < loss->width; x += LANES)
            store(to + x, window_sum(from + x, 1));
    }
}

/* 0.8 sign(a - b) - 0.2 (sum of by_mean + 2 a by_square + b by_product) */
static void NAMED(fxs_fit_loss_gradient_, ISA)(const fxs_fit_loss *loss, int32_t row, float *scratch)
{
    float *b = scratch + FXS_FIT_MARGIN;
    const float *a = at_of(&loss->picture, row);
    photograph_row(loss, row, scratch);
    for (int32_t x = 0; x < loss->width; x += LANES) {
        real sums[FXS_FIT_DERIVATIVES];
        for (int i = 0; i < FXS_FIT_DERIVATIVES; i++)
            sums[i] = window_sum(at_of(&loss->rows[i], row) + x, loss->rows[i].stride);
        const real p = load(a + x), q = load(b + x), similar = (sums[0] + 2.0f * p * sums[1]) + q * sums[2];
        const real sign = choose(p > q, all(0.8f), choose(p < q, all(-0.8f), all(0)));
        store(at_of(&loss->gradient, row) + x, within(x, loss->width, sign - 0.2f * similar));
    }
}

/* ---- update ------------------------------------------------------------------------------------------------------ */

static void update_lanes(const fxs_fit_camera *camera, int degree, const fxs_fit_adam *adam, const float *at,
                         float *masters, float *means, float *squares, size_t stride, const float *of_sums,
                         float *by_centre)
{
    real sums[FXS_FIT_SUMS], gradient[FXS_FIT_PARAMETERS], centre[2];
    whole touched = bits_of(all(0));
    for (int i = 0; i < FXS_FIT_SUMS; i++) {
        sums[i] = load(of_sums + i * (ptrdiff_t)stride);
        touched |= sums[i] != 0.0f;
    }
    if (any(touched)) {
        find_gradient(camera, degree, at, stride, sums, gradient, centre);
        for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
            gradient[i] = choose(touched, gradient[i], all(0));
        const real x = centre[0] * (0.5f * (float)camera->width), y = centre[1] * (0.5f * (float)camera->height);
        store(by_centre, load(by_centre) + choose(touched, root(x * x + y * y), all(0)));
    } else
        for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
            gradient[i] = all(0);
    for (int i = 0; i < FXS_FIT_PARAMETERS; i++) {
        const ptrdiff_t plane = i * (ptrdiff_t)stride;
        const real g = gradient[i];
        const real mean = load(means + plane) * 0.9f + g * 0.1f;
        const real square = load(squares + plane) * 0.999f + g * g * 0.001f;
        store(means + plane, mean);
        store(squares + plane, square);
        store(masters + plane,
              load(masters + plane) - adam->rate[i] * mean / (root(square * adam->correction) + adam->epsilon));
    }
}

static void NAMED(fxs_fit_update_, ISA)(const fxs_fit_camera *camera, int degree, const fxs_fit_adam *adam,
                                        const float *parameters, float *masters, float *means, float *squares,
                                        size_t stride, size_t first, size_t count, const float *sums,
                                        float *by_centre)
{
    for (size_t i = first; i < first + count; i += LANES)
        update_lanes(camera, degree, adam, parameters + i, masters + i, means + i, squares + i, stride, sums + i,
                     by_centre + i);
}

static void NAMED(fxs_fit_quantise_, ISA)(const fxs_fit_grid *grid, const float *masters, float *parameters,
                                          size_t stride, size_t first, size_t count)
{
    whole codes[FXS_FIT_SH];
    for (size_t i = first; i < first + count; i += LANES) {
        const fxs_fit_chunk *chunk = &grid->chunks[i / FXS_FIT_CHUNK];
        quantise_shape(grid, chunk, masters + i, parameters + i, (ptrdiff_t)stride, codes);
        for (int degree = 1; degree <= grid->sh_degree; degree++)
            for (int k = 3 * SH_COUNT(degree - 1); k < 3 * SH_COUNT(degree); k++) {
                const size_t at = (size_t)(FXS_FIT_SH + k) * stride + i;
                store(parameters + at, quantise_band(chunk, degree, load(masters + at), codes));
            }
    }
}

const fxs_fit_stages NAMED(fxs_fit_stages_, ISA) = {
    STRING_OF(ISA), NAMED(fxs_fit_project_, ISA), NAMED(fxs_fit_blend_, ISA), NAMED(fxs_fit_back_, ISA),
    NAMED(fxs_fit_loss_rows_, ISA), NAMED(fxs_fit_loss_derivatives_, ISA), NAMED(fxs_fit_loss_back_rows_, ISA),
    NAMED(fxs_fit_loss_gradient_, ISA), NAMED(fxs_fit_update_, ISA),
    NAMED(fxs_fit_quantise_, ISA)};
