/* The recipe: which photograph, which rates, and when the Gaussians become more or fewer. */
#include "fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../kernels/kernels.h"
#include "../files/message.h"
#include "profile.h"
#include "random.h"

struct fxs_fit {
    fxs_fit_options options;
    fxs_fit_photograph *photographs;
    uint32_t *order;               /* of the photographs, for as many steps as there are */
    size_t count;
    fxs_fit_stepper *stepper;
    fxs_fit_model model;
    fxs_fit_profile profile;       /* the last tenth of the steps: see profile.h */
    float extent, position_rate, decay;
    uint32_t step;
};

void fxs_fit_options_init(fxs_fit_options *options)
{
    memset(options, 0, sizeof *options);
    options->steps = 30000;
    options->sh_degree = 3;
    options->max_gaussians = 1u << 22;
    options->cpu = ~0u;
}

/* ---- Beginning --------------------------------------------------------------------------------------------------- */

static void set_camera(fxs_fit_camera *c, const fxs_file_view *view)
{
    const int size[2] = {view->width, view->height};
    const double focal[2] = {view->fx, view->fy}, middle[2] = {view->cx, view->cy};
    for (int i = 0; i < 9; i++)
        c->rotation[i] = (float)view->rotation[i];
    for (int i = 0; i < 3; i++)
        c->eye[i] = (float)view->position[i];
    for (int i = 0; i < 2; i++) {
        c->focal[i] = (float)focal[i];
        c->middle[i] = (float)middle[i];
        c->slope_most[i] = (float)(1.3 * size[i] / (2 * focal[i]));
    }
    c->near = view->near > 0 ? (float)view->near : 0.2f;
    c->width = view->width;
    c->height = view->height;
    c->tiles_x = (view->width + FXS_FIT_TILE - 1) / FXS_FIT_TILE;
    c->tiles_y = (view->height + FXS_FIT_TILE - 1) / FXS_FIT_TILE;
}

/* 1.1 times the largest distance of a camera from their mean. */
static float extent_of(const fxs_fit_photo *photos, size_t count)
{
    double mean[3] = {0, 0, 0}, largest = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            mean[k] += photos[i].view.position[k] / (double)count;
    for (size_t i = 0; i < count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++)
            square += (photos[i].view.position[k] - mean[k]) * (photos[i].view.position[k] - mean[k]);
        largest = fmax(largest, sqrt(square));
    }
    return (float)(1.1 * (largest > 0 ? largest : 1));
}

int fxs_fit_create(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                   size_t point_count, const fxs_fit_options *options, fxs_message *message)
{
    *fit = NULL;
    if (!photo_count || !point_count)
        return fxs_fail(message, "a fit needs photographs, and points to begin with");
    fxs_fit *f = calloc(1, sizeof *f);
    if (f) {
        f->options = *options;
        f->count = photo_count;
        f->photographs = calloc(photo_count, sizeof *f->photographs);
        f->order = calloc(photo_count, sizeof *f->order);
        f->stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(options->cpu), options->run, options->pool,
                                            options->threads, options->clock);
    }
    if (!f || !f->photographs || !f->order || !f->stepper ||
        fxs_fit_model_begin(&f->model, points, point_count, 0.1f)) {
        fxs_fit_free(f);
        return fxs_fail_memory(message, "a fit", point_count * 4 * FXS_FIT_PARAMETERS * sizeof(float));
    }
    for (size_t i = 0; i < photo_count; i++) {
        f->photographs[i].pixels = photos[i].pixels;
        set_camera(&f->photographs[i].camera, &photos[i].view);
    }
    f->extent = extent_of(photos, photo_count);
    f->position_rate = 1.6e-4f;
    f->decay = 0.999846506f;       /* 100^(-1 / 30000) */
    *fit = f;
    return 0;
}

void fxs_fit_free(fxs_fit *f)
{
    if (!f)
        return;
    fxs_fit_profile_free(&f->profile);
    fxs_fit_model_free(&f->model);
    fxs_fit_stepper_free(f->stepper);
    free(f->photographs);
    free(f->order);
    free(f);
}

uint32_t fxs_fit_steps(const fxs_fit *f)
{
    return f->step;
}

/* ---- A step ------------------------------------------------------------------------------------------------------ */

/* A new permutation when all were seen (Fisher and Yates). */
static const fxs_fit_photograph *choose_photograph(fxs_fit *f)
{
    const uint32_t count = (uint32_t)f->count, turn = f->step % count;
    if (!turn) {
        for (uint32_t i = 0; i < count; i++)
            f->order[i] = i;
        for (uint32_t i = count - 1; i; i--) {
            const uint32_t j = (uint32_t)(fxs_fit_random(f->options.seed, f->step, i) % (i + 1)), swap = f->order[i];
            f->order[i] = f->order[j];
            f->order[j] = swap;
        }
    }
    return &f->photographs[f->order[turn]];
}

static void set_rates(const fxs_fit *f, float rate[FXS_FIT_PARAMETERS])
{
    for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
        rate[i] = i < FXS_FIT_SCALE      ? f->position_rate * f->extent
                  : i < FXS_FIT_ROTATION ? 0.005f
                  : i < FXS_FIT_OPACITY  ? 0.001f
                  : i < FXS_FIT_COLOUR   ? 0.025f
                  : i < FXS_FIT_SH       ? 0.0025f
                                         : 0.000125f;
}

/* Every 100 steps; the mean gradient is that of the mean over pixels and channels. */
static int densify(fxs_fit *f, const fxs_fit_camera *camera)
{
    const fxs_fit_densify d = {0.0002f * 3 * (float)camera->width * (float)camera->height, 0.01f * f->extent,
                               f->step > 3000 ? 0.1f * f->extent : INFINITY, 0.005f, f->options.max_gaussians,
                               f->options.seed, f->step};
    int error = fxs_fit_model_densify(&f->model, &d);
    if (!error && f->step % 1000 == 0)
        error = fxs_fit_model_order(&f->model);
    return error;
}

static void run_here(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

static fxs_pack_options pack_options(const fxs_fit *f)
{
    fxs_pack_options options = {.profile = f->options.profile, .run = f->options.run, .pool = f->options.pool,
                                .threads = f->options.threads};
    options.run = options.run ? options.run : run_here;
    return options;
}

/* Steps that are left when the packed profile is taken in. */
static uint32_t profile_steps(const fxs_fit *f)
{
    return f->options.steps / 10;
}

/* Before a step: the last tenth passes through the packed profile, whose steps and palette are found 16 times. Where a
   fit that was in its last tenth is to have more steps, it leaves it. */
static int fit_profile(fxs_fit *f)
{
    const uint32_t steps = profile_steps(f), first = f->options.steps - steps, every = (steps + 15) / 16;
    const fxs_pack_options options = pack_options(f);
    fxs_message message;
    if (f->step < first || f->step >= f->options.steps) {
        if (f->profile.chunks && f->step < first)
            fxs_fit_profile_end(&f->profile, &f->model);
        return 0;
    }
    if (!f->profile.chunks)
        return fxs_fit_profile_begin(&f->profile, &f->model, f->stepper, f->options.sh_degree, &options, &message);
    return (f->step - first) % every ? 0 : fxs_fit_profile_code(&f->profile, &f->model, f->stepper, &options, &message);
}

int fxs_fit_step(fxs_fit *f, fxs_fit_report *report)
{
    const fxs_fit_photograph *photograph = choose_photograph(f);
    fxs_fit_step_options options = {0};
    const uint32_t degree = f->step / 1000;
    options.sh_degree = (int)degree < f->options.sh_degree ? (int)degree : f->options.sh_degree;
    options.number = f->step + 1;
    for (int c = 0; c < 3; c++)
        options.background[c] = (float)f->options.background[c] / 255.0f;
    f->position_rate *= f->decay;
    set_rates(f, options.rate);
    int error = fit_profile(f);
    f->step++;
    if (!error)
        error = fxs_fit_stepper_step(f->stepper, &f->model, photograph, &options, report);
    const int is_open = f->step < 15000 && f->step < f->options.steps - profile_steps(f);
    if (!error && f->step > 500 && is_open && f->step % 100 == 0)
        error = densify(f, &photograph->camera);
    if (!error && is_open && f->step % 3000 == 0)
        fxs_fit_model_reset_opacity(&f->model, 0.01f);
    report->gaussians = f->model.count;
    return error;
}

static long read_gaussians(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const fxs_fit_model *m = argument;
    size_t count = m->count - (size_t)first < capacity ? m->count - (size_t)first : capacity;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
            memcpy((char *)&out[i] + k * sizeof(float), &m->parameters[k * m->stride + (size_t)first + i],
                   sizeof(float));
    return (long)count;
}

void fxs_fit_gaussians(const fxs_fit *f, fxs_gaussian_source *gaussians)
{
    memset(gaussians, 0, sizeof *gaussians);
    gaussians->count = f->model.count;
    gaussians->sh_degree = f->options.sh_degree;
    gaussians->read = read_gaussians;
    gaussians->argument = (void *)&f->model;
}

int fxs_fit_pack(const fxs_fit *f, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message)
{
    const fxs_pack_options options = pack_options(f);
    fxs_gaussian_source gaussians;
    fxs_fit_gaussians(f, &gaussians);
    return fxs_fit_profile_pack(&f->profile, &f->model, &gaussians, scene, report, &options, message);
}
