/* The stages of a fitting step (fit_stage.h), compiled for the instruction set ISA with LANES floats per vector. */
#include <fixsplat/fixsplat.h>
#include "adam.h"
#include "loss.h"
#include "noise.h"
#include "fit_project.h"
#include "src/fit/quantise.h"
#include "smooth.h"
#include "fit_surface.h"
#include "tile.h"

#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define STRING(a) #a
#define STRING_OF(a) STRING(a)

static void put_splats(const real *numbers, int count, fxs_fit_splat *splats)
{
    float out[16][LANES];
    for (int i = 0; i < count; i++)
        store(out[i], numbers[i]);
    for (int i = 0; i < LANES; i++) {
        float *to = splats[i].centre;
        for (int k = 0; k < count; k++)
            to[k] = out[k][i];
    }
}

static void project_lanes(const fxs_fit_camera *camera, int degree, const float *at, size_t stride,
                          fxs_fit_splat *splats)
{
    real numbers[SPLAT_NUMBERS];
    if (any(find_splat(camera, at, stride, numbers))) {
        find_colours(camera, degree, at, stride, &numbers[SPLAT_LIMIT], &numbers[SPLAT_COLOUR]);
        put_splats(numbers, SPLAT_NUMBERS, splats);
        return;
    }
    for (int i = 0; i < LANES; i++)
        splats[i].depth = 0;
}

static void NAMED(fxs_fit_project_, ISA)(const fxs_fit_camera *camera, int degree, const float *parameters,
                                         size_t stride, size_t first, size_t count, fxs_fit_splat *splats)
{
    for (size_t i = first; i < first + count; i += LANES)
        project_lanes(camera, degree, parameters + i, stride, splats + i);
}

static void cover_lanes(const fxs_fit_camera *camera, const fxs_fit_splat *splats, uint32_t *tiles)
{
    float numbers[16][LANES], depths[LANES];
    uint32_t *out[LANES];
    ellipses e;
    for (int i = 0; i < LANES; i++)
        depths[i] = splats[i].depth;
    const mask seen = below(all(0), load(depths));
    if (!any(seen))                /* Returns early if no splat of the vector is visible; hidden splats have no valid
                                      field except the depth. */
        return;
    for (int i = 0; i < LANES; i++) {
        const float *from = splats[i].centre;
        for (int k = 0; k < 14; k++)
            numbers[k][i] = from[k];
        out[i] = depths[i] > 0 ? tiles + splats[i].slot : tiles;
    }
    e.x = load(numbers[0]);
    e.y = load(numbers[1]);
    e.ux = load(numbers[2]);
    e.uy = load(numbers[3]);
    e.vy = load(numbers[4]);
    e.radius2 = load(numbers[11]);
    e.half_y = load(numbers[12]);
    e.tip = load(numbers[13]);
    find_rows(camera, seen, &e);
    put_tiles(camera, &e, out);
}

static void NAMED(fxs_fit_cover_, ISA)(const fxs_fit_camera *camera, const fxs_fit_splat *splats, size_t first,
                                       size_t count, uint32_t *tiles)
{
    for (size_t i = first; i < first + count; i += LANES)
        cover_lanes(camera, splats + i, tiles);
}

static uint32_t NAMED(fxs_fit_blend_, ISA)(const fxs_fit_splat *splats, fxs_fit_entry *entries, uint32_t count,
                                           int32_t left, int32_t top, float light, fxs_fit_tile *tile)
{
    return blend(splats, entries, count, left, top, light, tile);
}

static void NAMED(fxs_fit_backward_, ISA)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count,
                                          int32_t left, int32_t top, const fxs_fit_tile_gradient *gradient,
                                          float (*sums)[FXS_FIT_SUMS])
{
    backward(splats, entries, count, left, top, gradient, sums);
}

static inline float *at_of(const fxs_fit_plane *plane, int32_t row)
{
    return plane->first + row * plane->stride;
}

enum { STRIP = 256 };

/* Converts a row of the photograph from bytes to 0..1. Columns outside the photograph become 0. */
static void photograph_strip(const fxs_fit_loss *loss, int32_t row, int32_t first, int32_t count, float *out)
{
    for (int32_t i = 0; i < count; i++) {
        const int32_t x = first + i;
        out[i] = x >= 0 && x < loss->width ? (float)loss->photograph[row * loss->pitch + x * loss->step] / 255.0f : 0;
    }
}

static void drop_ignored(const fxs_fit_loss *loss, int32_t row, int32_t first, int32_t count, float *numbers)
{
    const uint8_t *counts = loss->mask + (ptrdiff_t)row * loss->width;
    for (int32_t i = 0; i < count; i++) {
        const int32_t x = first + i;
        if (x >= 0 && x < loss->width && !counts[x])
            numbers[i] = 0;
    }
}

static void cut_white(const float *a, const float *b, int32_t count, float *out)
{
    for (int32_t x = 0; x < count; x += LANES)
        store(out + x, recorded(load(a + x), load(b + x)));
}

static void loss_strip(const fxs_fit_loss *loss, int32_t row, int32_t first)
{
    float b[STRIP + 2 * FXS_FIT_MARGIN], products[3][STRIP + 2 * FXS_FIT_MARGIN], kept[STRIP + 2 * FXS_FIT_MARGIN];
    const float *a = at_of(&loss->picture, row) + first - FXS_FIT_MARGIN;
    const int32_t left = (loss->width - first + 15) & ~15, count = left < STRIP ? left : STRIP;
    const int32_t with_margins = count + 2 * FXS_FIT_MARGIN;
    photograph_strip(loss, row, first - FXS_FIT_MARGIN, with_margins, b);
    if (loss->has_exposure) {
        cut_white(a, b, with_margins, kept);
        a = kept;
    }
    if (loss->mask) {
        memmove(kept, a, (size_t)with_margins * sizeof *kept);
        drop_ignored(loss, row, first - FXS_FIT_MARGIN, with_margins, kept);
        drop_ignored(loss, row, first - FXS_FIT_MARGIN, with_margins, b);
        a = kept;
    }
    for (int32_t x = 0; x < with_margins; x += LANES) {
        const real p = load(a + x), q = load(b + x);
        store(products[0] + x, p * p);
        store(products[1] + x, q * q);
        store(products[2] + x, p * q);
    }
    const float *from[FXS_FIT_ROWS] = {a, b, products[0], products[1], products[2]};
    for (int i = 0; i < FXS_FIT_ROWS; i++) {
        float *to = at_of(&loss->rows[i], row) + first;
        for (int32_t x = 0; x < count; x += LANES)
            store(to + x, window_sum(from[i] + FXS_FIT_MARGIN + x, 1));
    }
}

static void NAMED(fxs_fit_loss_rows_, ISA)(const fxs_fit_loss *loss, int32_t row)
{
    for (int32_t first = 0; first < loss->width; first += STRIP)
        loss_strip(loss, row, first);
}

static inline mask counting(const fxs_fit_loss *loss, int32_t row, int32_t x)
{
    const mask inside = below(numbers_from(0) + (float)x, all((float)loss->width));
    float counts[LANES];
    if (!loss->mask)
        return inside;
    for (int32_t i = 0; i < LANES; i++)
        counts[i] = x + i < loss->width ? (float)loss->mask[(ptrdiff_t)row * loss->width + x + i] : 0;
    return both(inside, below(all(0), load(counts)));
}

/* Adds numbers of a row to 16 partial sums: the number in column x to sum x % 16. sum_of then adds these as a binary
   tree. */
static inline void add_to(float sums[16], int32_t x, real value)
{
    store(sums + x % 16, load(sums + x % 16) + value);
}

static float sum_of(float sums[16])
{
    for (int half = 8; half; half /= 2)
        for (int i = 0; i < half; i++)
            sums[i] += sums[i + half];
    return sums[0];
}

static void NAMED(fxs_fit_loss_derivatives_, ISA)(const fxs_fit_loss *loss, int32_t row)
{
    float dissimilar[16] = {0};
    for (int32_t x = 0; x < loss->width; x += LANES) {
        real sums[FXS_FIT_ROWS];
        for (int i = 0; i < FXS_FIT_ROWS; i++)
            sums[i] = window_sum(at_of(&loss->rows[i], row) + x, loss->rows[i].stride);
        const mask counted = counting(loss, row, x);
        const similarity s = similarity_of(sums[0], sums[1], sums[2], sums[3], sums[4]);
        const real out[FXS_FIT_DERIVATIVES] = {s.by_mean, s.by_square, s.by_product};
        for (int i = 0; i < FXS_FIT_DERIVATIVES; i++)
            store(at_of(&loss->derivatives[i], row) + x, keep(counted, out[i]));
        add_to(dissimilar, x, keep(counted, 1.0f - s.value));
    }
    loss->dissimilar[row] = sum_of(dissimilar);
}

static void NAMED(fxs_fit_loss_backward_rows_, ISA)(const fxs_fit_loss *loss, int32_t row)
{
    for (int i = 0; i < FXS_FIT_DERIVATIVES; i++) {
        const float *from = at_of(&loss->derivatives[i], row);
        float *to = at_of(&loss->rows[i], row);
        for (int32_t x = 0; x < loss->width; x += LANES)
            store(to + x, window_sum(from + x, 1));
    }
}

static void NAMED(fxs_fit_loss_gradient_, ISA)(const fxs_fit_loss *loss, int32_t row)
{
    float b[STRIP], differences[16] = {0};
    const float *a = at_of(&loss->picture, row);
    for (int32_t x = 0; x < loss->width; x += LANES) {
        real sums[FXS_FIT_DERIVATIVES];
        if (x % STRIP == 0)
            photograph_strip(loss, row, x, STRIP, b);
        for (int i = 0; i < FXS_FIT_DERIVATIVES; i++)
            sums[i] = window_sum(at_of(&loss->rows[i], row) + x, loss->rows[i].stride);
        const mask counted = counting(loss, row, x);
        const real p = load(a + x), q = load(b + x % STRIP), seen = loss->has_exposure ? recorded(p, q) : p;
        real gradient = keep(counted, gradient_of(p, q, sums[0], sums[1], sums[2]));
        if (loss->has_exposure)
            gradient = choose(is_beyond_white(p, q), all(0), gradient);
        store(at_of(&loss->gradient, row) + x, gradient);
        add_to(differences, x, keep(counted, absolute(seen - q)));
    }
    loss->absolute[row] = sum_of(differences);
}

typedef float part_planes[FXS_FIT_PARAMETERS][FXS_FIT_PART];

static inline void add_regularisers(const fxs_fit_adam *adam, const float *at, size_t stride, float *gradients)
{
    float *to = gradients + FXS_FIT_OPACITY * FXS_FIT_PART;
    store(to, opacity_regularised(adam, load(to), load(at + FXS_FIT_OPACITY * (ptrdiff_t)stride)));
    const real unit = unit_at(&adam->far, at, stride);
    for (int i = FXS_FIT_SCALE; i < FXS_FIT_SCALE + 3; i++) {
        to = gradients + i * FXS_FIT_PART;
        store(to, scale_regularised(adam, load(to), load(at + i * (ptrdiff_t)stride), unit));
    }
}

static inline mask load_sums(const float *of_sums, real sums[FXS_FIT_SUMS])
{
    mask has_any = below(all(1), all(0));
    for (int i = 0; i < FXS_FIT_SUMS; i++) {
        sums[i] = load(of_sums + i * FXS_FIT_PART);
        has_any = either(has_any, below(all(0), absolute(sums[i])));
    }
    return has_any;
}

static void add_part(const fxs_fit_camera *camera, int degree, int used, const float *at, size_t stride,
                     const float *of_sums, float *by_centre, float *gradients)
{
    real sums[FXS_FIT_SUMS], gradient[FXS_FIT_PARAMETERS], centre[2];
    mask is_touched = load_sums(of_sums, sums);
    if (!any(is_touched))
        return;
    find_gradient(camera, degree, at, stride, sums, gradient, centre);
    for (int i = 0; i < used; i++)
        is_touched = both(is_touched, below(absolute(gradient[i]), all(FXS_FIT_FARTHEST_GRADIENT)));
    for (int i = 0; i < used; i++) {
        float *to = gradients + i * FXS_FIT_PART;
        store(to, load(to) + keep(is_touched, gradient[i]));
    }
    store(by_centre, load(by_centre) + keep(is_touched, centre_gradient(camera, centre)));
}

static void add_surface_part(const fxs_fit_adam *adam, uint32_t batch, const float *at, size_t stride,
                             const float *by_surface, float *gradients)
{
    real sums[3] = {all(0), all(0), all(0)}, gradient[FXS_FIT_SH];
    for (uint32_t k = 0; by_surface && k < 3 * batch; k++)
        sums[k % 3] += load(by_surface + k * stride);
    for (int k = 0; k < FXS_FIT_SH; k++)
        gradient[k] = load(gradients + k * FXS_FIT_PART);
    add_surface(adam, at, stride, sums, gradient);
    for (int k = 0; k < FXS_FIT_SH; k++)
        store(gradients + k * FXS_FIT_PART, gradient[k]);
}

static inline void adam_plane(const fxs_fit_adam *adam, float rate, const float *gradient, size_t count, float *at,
                              float *means, float *squares, size_t ahead)
{
    for (size_t i = 0; i < count; i += LANES) {
        __builtin_prefetch(at + ahead + i, 1);
        __builtin_prefetch(means + ahead + i, 1);
        __builtin_prefetch(squares + ahead + i, 1);
        real number = load(at + i), mean = load(means + i), square = load(squares + i);
        adam_step(adam, rate, load(gradient + i), &number, &mean, &square);
        store(means + i, mean);
        store(squares + i, square);
        store(at + i, number);
    }
}

static void keep_within(float *at, size_t count)
{
    for (size_t i = 0; i < count; i += LANES)
        store(at + i, least(most(load(at + i), all(-FXS_FIT_FARTHEST)), all(FXS_FIT_FARTHEST)));
}

static void NAMED(fxs_fit_update_, ISA)(const fxs_fit_camera *const *cameras, uint32_t batch, int degree,
                                        const fxs_fit_adam *adam, const float *parameters, float *masters,
                                        float *means, float *squares, size_t stride, size_t first, size_t count,
                                        const float *sums, const float *by_surface, float *by_centre)
{
    part_planes gradients;
    const int used = FXS_FIT_SH + 3 * SH_COUNT(degree);
    for (size_t i = 0; i < count; i += LANES) {
        for (int k = 0; k < used; k++)
            store(gradients[k] + i, all(0));
        for (uint32_t v = 0; v < batch; v++)
            add_part(cameras[v], degree, used, parameters + first + i, stride,
                     sums + (size_t)v * FXS_FIT_SUMS * FXS_FIT_PART + i, by_centre + first + i, gradients[0] + i);
        if (adam->by_opacity > 0)
            add_regularisers(adam, parameters + first + i, stride, gradients[0] + i);
        if (adam->by_flat > 0)
            add_surface_part(adam, batch, parameters + first + i, stride, by_surface ? by_surface + first + i : NULL,
                             gradients[0] + i);
    }
    for (int k = 0; k < used; k++) {
        const size_t at = (size_t)k * stride + first;
        adam_plane(adam, adam->rate[k], gradients[k], count, masters + at, means + at, squares + at,
                   k + 1 < used ? stride : 0);
        if ((k >= FXS_FIT_SCALE && k < FXS_FIT_ROTATION) || k == FXS_FIT_OPACITY)
            keep_within(masters + at, count);
    }
}

static void NAMED(fxs_fit_noise_, ISA)(const fxs_fit_noise *noise, float *parameters, size_t stride, size_t first,
                                       size_t count)
{
    for (size_t i = first; i < first + count; i += LANES)
        add_noise(noise, parameters + i, stride, (uint32_t)i);
}

static void NAMED(fxs_fit_smooth_, ISA)(const fxs_fit_cameras *cameras, int divisor, float *parameters, size_t stride,
                                        size_t first, size_t count)
{
    for (size_t i = first; i < first + count; i += LANES)
        smooth_scales(cameras, divisor, parameters + i, stride);
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

static void pose_lanes(const fxs_fit_camera *camera, int degree, const float *at, size_t stride, const float *of_sums,
                       float *out)
{
    real sums[FXS_FIT_SUMS], own[FXS_FIT_POSE];
    mask is_touched = load_sums(of_sums, sums);
    if (!any(is_touched))
        return;
    find_pose_gradient(camera, degree, at, stride, sums, own);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        is_touched = both(is_touched, below(absolute(own[k]), all(FXS_FIT_FARTHEST_GRADIENT)));
    for (int k = 0; k < FXS_FIT_POSE; k++)
        store(out + k * FXS_FIT_PART, keep(is_touched, own[k]));
}

static void NAMED(fxs_fit_pose_, ISA)(const fxs_fit_camera *camera, int degree, const float *parameters, size_t stride,
                                      size_t first, size_t count, const float *sums, float out[FXS_FIT_POSE])
{
    float numbers[FXS_FIT_POSE][FXS_FIT_PART] = {{0}};
    for (size_t i = 0; i < count; i += LANES)
        pose_lanes(camera, degree, parameters + first + i, stride, sums + i, numbers[0] + i);
    for (int k = 0; k < FXS_FIT_POSE; k++) {
        for (int half = FXS_FIT_PART / 2; half; half /= 2)
            for (int i = 0; i < half; i++)
                numbers[k][i] += numbers[k][i + half];
        out[k] = numbers[k][0];
    }
}

static void NAMED(fxs_fit_planes_, ISA)(const fxs_fit_camera *camera, const float *parameters, size_t stride,
                                        size_t first, size_t count, fxs_fit_splat *splats)
{
    for (size_t i = first; i < first + count; i += LANES) {
        real plane[3];
        float out[3][LANES];
        find_plane(camera, parameters + i, stride, plane);
        for (int c = 0; c < 3; c++)
            store(out[c], plane[c]);
        for (size_t k = 0; k < LANES; k++)
            for (int c = 0; c < 3 && splats[i + k].depth > 0; c++)
                splats[i + k].colour[c] = out[c][k];
    }
}

static void NAMED(fxs_fit_depths_, ISA)(const fxs_fit_camera *camera, const fxs_fit_plane planes[4], int32_t row,
                                         int is_depth, float weight, const fxs_fit_plane out[3])
{
    const depth_map d = {planes[0].first, planes[1].first, planes[2].first, planes[3].first, planes[0].stride};
    for (int32_t x = 0; x < camera->width; x += LANES) {
        real n[3];
        (is_depth ? depth_gradient : depth_normal)(camera, numbers_from(0) + (float)x, all((float)row), &d,
                                                   row * d.stride + x, weight, n);
        for (int c = 0; c < 3; c++)
            store(at_of(&out[c], row) + x, n[c]);
    }
}

const fxs_fit_stages NAMED(fxs_fit_stages_, ISA) = {
    STRING_OF(ISA), NAMED(fxs_fit_project_, ISA), NAMED(fxs_fit_cover_, ISA), NAMED(fxs_fit_blend_, ISA),
    NAMED(fxs_fit_backward_, ISA),
    NAMED(fxs_fit_loss_rows_, ISA), NAMED(fxs_fit_loss_derivatives_, ISA), NAMED(fxs_fit_loss_backward_rows_, ISA),
    NAMED(fxs_fit_loss_gradient_, ISA), NAMED(fxs_fit_update_, ISA), NAMED(fxs_fit_noise_, ISA),
    NAMED(fxs_fit_smooth_, ISA), NAMED(fxs_fit_quantise_, ISA), NAMED(fxs_fit_pose_, ISA),
    NAMED(fxs_fit_planes_, ISA), NAMED(fxs_fit_depths_, ISA)};
