/* Fits Gaussians to photographs: checks arguments, creates the Gaussians, and makes the steps. */
#include "fit_internal.h"
#include "src/base/options.h"
#include "src/base/try_internal.h"
#include "src/core/sized.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/fit_more.h>
#include "src/fit/stages/exposure.h"
#include "src/fit/stages/pose.h"
#include "src/base/random.h"
#include "recipe.h"
#include "sky.h"

void (fxs_fit_options_init)(fxs_fit_options *options, uint32_t size)
{
    const fxs_fit_options all = {.recipe = FXS_FIT_FAST, .steps = fxs_fit_recipe_steps(FXS_FIT_FAST), .sh_degree = 3,
                                 .max_gaussians = fxs_fit_recipe_gaussians(FXS_FIT_FAST), .cpu = ~0u};
    fxs_sized_fill(options, size, &all, sizeof all);
}

uint32_t fxs_fit_recipe_steps(enum fxs_fit_recipe recipe)
{
    return recipe == FXS_FIT_FAST ? 8000 : 30000;
}

size_t fxs_fit_recipe_gaussians(enum fxs_fit_recipe recipe)
{
    return recipe == FXS_FIT_FAST ? 250000 : recipe == FXS_FIT_MCMC ? 1000000 : 1u << 22;
}

void fxs_fit_set_camera(fxs_fit_camera *c, const fxs_view *view)
{
    memset(c, 0, sizeof *c);
    c->is_parallel = view->projection == FXS_ORTHOGRAPHIC;
    const int size[2] = {view->width, view->height};
    const double focal[2] = {view->fx, view->fy}, middle[2] = {view->cx, view->cy};
    for (int i = 0; i < 9; i++)
        c->rotation[i] = (float)view->rotation[i];
    for (int i = 0; i < 3; i++)
        c->eye[i] = (float)view->position[i];
    for (int i = 0; i < 2; i++) {
        c->focal[i] = (float)focal[i];
        c->middle[i] = (float)middle[i];
        c->slope_most[i] = c->is_parallel ? 0 : (float)(1.3 * size[i] / (2 * focal[i]));
    }
    c->near = view->near > 0 ? (float)view->near : 0.2f;
    c->width = view->width;
    c->height = view->height;
    c->tiles_x = (view->width + FXS_FIT_TILE - 1) / FXS_FIT_TILE;
    c->tiles_y = (view->height + FXS_FIT_TILE - 1) / FXS_FIT_TILE;
}

static int is_within(const double place[3])
{
    const double farthest = FXS_FIT_FARTHEST_PLACE;
    return fabs(place[0]) <= farthest && fabs(place[1]) <= farthest && fabs(place[2]) <= farthest;
}

static int is_before(const fxs_view *view, const double place[3])
{
    double depth = 0;
    for (int k = 0; k < 3; k++)
        depth += view->rotation[6 + k] * (place[k] - view->position[k]);
    return depth > 0;
}

int fxs_fit_check_points(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                         size_t point_count, fxs_message *message)
{
    int are_seen = 0;
    for (size_t i = 0; i < point_count; i++) {
        const float *p = points[i].position;
        const double place[3] = {(double)p[0], (double)p[1], (double)p[2]};
        if (!is_within(place))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "point %zu: a coordinate is not finite, or beyond 10^12", i);
        for (size_t k = 0; k < photo_count && !are_seen; k++)
            are_seen = is_before(&photos[k].view, place);
    }
    return are_seen ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, message, "all points are behind all cameras");
}

/* Checks that this thread computes in IEEE single precision with rounding to nearest and subnormal numbers, which
   reproducible results need. */
static int check_arithmetic(fxs_message *message)
{
    volatile float one = 1, half_unit = 0x1p-24f, tiny = 0x1p-140f;
    if (FLT_EVAL_METHOD == 0 && one + half_unit == 1 && one + 1.5f * half_unit > 1 && tiny * 0.5f > 0)
        return 0;
    return fxs_fail(message, "a fit needs IEEE single precision, rounded to the nearest: this %s",
                    FLT_EVAL_METHOD == 0 ? "thread is set otherwise" : "build computes with more digits");
}

static int check_options(const fxs_fit_options *o, fxs_message *message)
{
    const char *wrong = (unsigned)o->recipe > FXS_FIT_FAST                         ? "recipe"
                        : !o->steps                                                ? "number of steps"
                        : o->sh_degree < 0 || o->sh_degree > 3                     ? "SH degree"
                        : !o->max_gaussians || o->max_gaussians > FXS_MAX_COUNT    ? "number of Gaussians"
                        : (unsigned)o->cutoff > FXS_CUTOFF_SQUARE                  ? "cut-off"
                        : (unsigned)o->profile > FXS_PROFILE_SMALL                 ? "profile"
                        : o->workers.count > 64                                    ? "number of threads"
                        : o->device_count > (o->vulkan ? 1 : FXS_FIT_BATCH)        ? "number of devices"
                        : o->batch > FXS_FIT_BATCH                                 ? "number of photographs of a step"
                        : (unsigned)o->exposure > FXS_FIT_EXPOSURE_AFFINE          ? "exposure"
                        : (unsigned)o->refine_poses > 1                            ? "refinement of poses"
                        : (unsigned)o->antialiased > 1                             ? "antialiasing"
                        : (unsigned)o->surfaces > 1                                ? "fit of surfaces"
                        : (unsigned)o->vulkan > 1                                  ? "interface of devices"
                        : o->sky > FXS_FIT_SKY_MOST                                ? "number of directions of a sky"
                                                                                   : NULL;
    if (wrong)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a fit: there is no such %s", wrong);
    if (o->device_count && o->batch % o->device_count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a batch of %u photographs is not to be shared out among %u "
                           "devices", (unsigned)o->batch, (unsigned)o->device_count);
    return 0;
}

int fxs_fit_check_photographs(const fxs_fit_photo *photos, size_t count, fxs_message *message)
{
    fxs_camera camera;
    fxs_message why;
    if (!count || count > UINT32_MAX)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a fit needs photographs");
    for (size_t i = 0; i < count; i++) {
        const fxs_view *view = &photos[i].view;
        if (fxs_camera_from_view(&camera, view, &why))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "photograph %zu: %s", i, why.text);
        if (view->projection != FXS_PERSPECTIVE)
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "photograph %zu: a fit takes perspective cameras", i);
    }
    return 0;
}

/* Creates a Gaussian at each initial point. Of more than max_gaussians points, takes evenly spaced ones. */
static int begin_with(fxs_fit *f, const fxs_fit_point *points, size_t count, const fxs_fit_sky *sky)
{
    const size_t all = count + sky->count, most = all < f->options.max_gaussians ? all : f->options.max_gaussians;
    fxs_fit_point *chosen = malloc(most * sizeof *chosen);
    if (!chosen)
        return FXS_ERR_MEMORY;
    for (size_t i = 0; i < most; i++) {
        const size_t from = (size_t)((uint64_t)i * all / most);
        chosen[i] = from < count ? points[from] : sky->points[from - count];
        f->sky_count += from >= count;
    }
    const int error = fxs_fit_model_begin(&f->model, chosen, most, fxs_fit_first_opacity(f->options.recipe));
    if (!error) {
        fxs_fit_model_widen(&f->model, fxs_fit_first_scale(f->options.recipe));
        fxs_fit_model_set_sigma(&f->model, most - f->sky_count, sky->sigma);
    }
    free(chosen);
    return error;
}

static int begin_model(fxs_fit *f, const fxs_fit_photo *photos, const fxs_fit_point *points, size_t count)
{
    fxs_fit_sky sky = {0};
    if (f->options.sky && fxs_fit_sky_find(photos, f->count, points, count, f->options.sky, f->extent, &sky))
        return FXS_ERR_MEMORY;
    f->far = sky.far;
    const int error = begin_with(f, points, count, &sky);
    free(sky.points);
    return error;
}

/* Returns the harmonic mean of the depths of points in a camera's picture, from at most 4096 points. 0: no point is in
   the picture. */
static float depth_of(const fxs_fit_camera *c, const fxs_fit_point *points, size_t count)
{
    const size_t some = count < 4096 ? count : 4096;
    double sum = 0;
    size_t seen = 0;
    for (size_t i = 0; i < some; i++) {
        const float *p = points[(size_t)((uint64_t)i * count / some)].position;
        double at[3] = {0, 0, 0};
        for (int k = 0; k < 9; k++)
            at[k / 3] += (double)c->rotation[k] * ((double)p[k % 3] - (double)c->eye[k % 3]);
        const double x = (double)c->focal[0] * at[0] / at[2] + (double)c->middle[0];
        const double y = (double)c->focal[1] * at[1] / at[2] + (double)c->middle[1];
        if (at[2] > (double)c->near && x >= 0 && y >= 0 && x <= c->width && y <= c->height) {
            sum += 1 / at[2];
            seen++;
        }
    }
    return seen ? (float)((double)seen / sum) : 0;
}

void fxs_fit_begin_poses(fxs_fit *f, size_t first, const fxs_fit_point *points, size_t count)
{
    for (size_t i = first; i < f->count; i++) {
        const float depth = depth_of(&f->photographs[i].camera, points, count);
        f->poses.of[i] = (fxs_fit_pose){0};
        f->poses.of[i].depth = depth > 0 && depth < FXS_FIT_FARTHEST_PLACE ? depth : f->extent;
    }
}

void fxs_fit_set_photograph(fxs_fit *f, size_t i, const fxs_fit_photo *photo)
{
    fxs_fit_photograph *p = &f->photographs[i];
    *p = (fxs_fit_photograph){.pixels = photo->pixels, .width = photo->view.width, .height = photo->view.height,
                              .divisor = 1, .number = (uint32_t)i, .mask = photo->mask};
    fxs_fit_set_camera(&p->camera, &photo->view);
    p->camera.is_square = f->options.cutoff == FXS_CUTOFF_SQUARE;
    p->camera.is_antialiased = f->options.antialiased;
    f->cameras.of[i] = p->camera;
    f->gains.of[i] = (fxs_fit_gain){0};
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        f->gains.of[i].at[k] = gain_neutral(f->gains.is_affine, k);
}

int fxs_fit_begin(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_options *options,
                  fxs_message *message)
{
    *fit = NULL;
    if (check_arithmetic(message) || check_options(options, message) ||
        fxs_fit_check_photographs(photos, photo_count, message))
        return FXS_ERR_ARGUMENT;
    fxs_fit *f = calloc(1, sizeof *f);
    if (f) {
        f->options = *options;
        if (!f->options.batch)
            f->options.batch = options->device_count ? options->device_count : 1;
        f->count = photo_count;
        f->photographs = calloc(photo_count, sizeof *f->photographs);
        f->order = calloc(photo_count, sizeof *f->order);
        f->gains.of = calloc(photo_count, sizeof *f->gains.of);
        f->gains.count = (uint32_t)photo_count;
        f->gains.is_affine = options->exposure == FXS_FIT_EXPOSURE_AFFINE;
        f->poses.of = calloc(photo_count, sizeof *f->poses.of);
        f->poses.count = (uint32_t)photo_count;
        f->cameras.of = calloc(photo_count, sizeof *f->cameras.of);
        f->cameras.count = (uint32_t)photo_count;
        f->stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(options->cpu), options->workers.run,
                                            options->workers.pool, options->workers.count, options->clock);
    }
    if (!f || !f->photographs || !f->order || !f->gains.of || !f->poses.of || !f->cameras.of ||
        !f->stepper) {
        fxs_fit_destroy(f);
        return fxs_fail_memory(message, "a fit", 0);
    }
    for (size_t i = 0; i < photo_count; i++)
        fxs_fit_set_photograph(f, i, &photos[i]);
    const int error = fxs_fit_choose_engine(f, message);
    if (error)
        fxs_fit_destroy(f);
    else
        *fit = f;
    return error;
}

/* Sets the orthonormal basis of the functions that exposures keep out of, by Gram and Schmidt: constants, and from
   LINEAR_FROM photographs on the components of the cameras' viewing directions. Leaves out a component that varies by
   less than 0.1 beside those before it. */
static void set_basis(fxs_fit *f)
{
    enum { LINEAR_FROM = 30 };
    fxs_fit_gain *const of = f->gains.of;
    for (int j = 0; j < (f->count < LINEAR_FROM ? 1 : FXS_FIT_BASIS); j++) {
        double square = 0;
        for (size_t i = 0; i < f->count; i++)
            of[i].basis[j] = j ? f->photographs[i].camera.rotation[5 + j] : 1.0f;
        for (int before = 0; before < j; before++) {
            double common = 0;
            for (size_t i = 0; i < f->count; i++)
                common += (double)of[i].basis[before] * (double)of[i].basis[j];
            for (size_t i = 0; i < f->count; i++)
                of[i].basis[j] -= (float)common * of[i].basis[before];
        }
        for (size_t i = 0; i < f->count; i++)
            square += (double)of[i].basis[j] * (double)of[i].basis[j];
        const double scale = square > 0.01 * (double)f->count ? 1 / sqrt(square) : 0;
        for (size_t i = 0; i < f->count; i++)
            of[i].basis[j] *= (float)scale;
    }
}

/* Sets the exposures' basis and the initial exposures. If the exposures of all photographs are known, starts with log2
   gains of log2(exposure) / 2.2, minus their mean. */
static void begin_gains(fxs_fit *f, const fxs_fit_photo *photos)
{
    fxs_fit_gain *const gains = f->gains.of;
    set_basis(f);
    for (size_t i = 0; i < f->count; i++)
        if (!(photos[i].exposure >= 1e-30 && photos[i].exposure <= 1e30))
            return;
    for (size_t i = 0; i < f->count; i++) {
        const float at = (1.44269504f / 2.2f) * ln((float)photos[i].exposure);
        gains[i].at[0] = least(most(at, -FXS_FIT_GAIN_MOST), FXS_FIT_GAIN_MOST);
    }
    const float mean = gain_mean(&f->gains, 0);
    for (size_t i = 0; i < f->count; i++)
        gains[i].at[0] -= mean;
    if (!f->gains.is_affine)
        return;
    for (size_t i = 0; i < f->count; i++)
        gains[i].at[0] = least(exp_2_minus(-gains[i].at[0]), FXS_FIT_GAIN_MOST);
    const float mean_factor = gain_mean(&f->gains, 0);
    for (size_t i = 0; i < f->count; i++)
        gains[i].at[0] = gains[i].at[4] = gains[i].at[8] = least(gains[i].at[0] / mean_factor, FXS_FIT_GAIN_MOST);
}

int fxs_fit_hand_over(fxs_fit *f, fxs_message *message)
{
    f->model.gains = f->options.exposure ? &f->gains : NULL;
    f->model.poses = f->options.refine_poses ? &f->poses : NULL;
    f->model.cameras = f->options.antialiased ? &f->cameras : NULL;
    return f->engine->give(f->self, message);
}

int fxs_fit_create(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                   size_t point_count, const fxs_fit_options *given, fxs_message *message)
{
    fxs_fit_options all;
    const fxs_fit_options *const options = &all;
    *fit = NULL;
    fxs_fit_options_init(&all);
    FXS_TRY(FXS_OPTIONS_READ(fxs_fit_options, &all, given, message));
    int error = fxs_fit_begin(fit, photos, photo_count, options, message);
    if (!error && options->exposure && options->blocks)
        error = fxs_fail_as(FXS_ERR_ARGUMENT, message, "exposures of a block are those of its coarse fit");
    if (!error && options->refine_poses && options->blocks)
        error = fxs_fail_as(FXS_ERR_ARGUMENT, message, "refined poses of a block are those of its coarse fit");
    if (!error && options->sky && options->blocks)
        error = fxs_fail_as(FXS_ERR_ARGUMENT, message, "the sky of a block is that of its coarse fit");
    if (!error)
        error = point_count ? fxs_fit_check_points(photos, photo_count, points, point_count, message)
                            : fxs_fail_as(FXS_ERR_ARGUMENT, message, "a fit needs points to begin with");
    if (!error)
        (*fit)->extent = options->extent > 0 ? options->extent
                                             : fxs_fit_extent(photos, photo_count, points, point_count);
    if (!error && begin_model(*fit, photos, points, point_count))
        error = fxs_fail_memory(message, "a fit", point_count * 4 * FXS_FIT_PARAMETERS * sizeof(float));
    if (!error && options->exposure)
        begin_gains(*fit, photos);
    if (!error) {
        if (options->refine_poses)
            fxs_fit_begin_poses(*fit, 0, points, point_count);
        error = fxs_fit_hand_over(*fit, message);
    }
    if (error) {
        fxs_fit_destroy(*fit);
        *fit = NULL;
    }
    return error;
}

void fxs_fit_destroy(fxs_fit *f)
{
    if (!f)
        return;
    if (f->engine)
        f->engine->free(f->self);
    fxs_fit_moving_free(f->moving);
    fxs_fit_profile_free(&f->profile);
    fxs_fit_model_free(&f->model);
    fxs_fit_stepper_free(f->stepper);
    free(f->photographs);
    free(f->order);
    free(f->gains.of);
    free(f->poses.of);
    free(f->cameras.of);
    free(f);
}

uint32_t fxs_fit_steps(const fxs_fit *f)
{
    return f->step;
}

const fxs_fit_options *fxs_fit_options_of(const fxs_fit *f)
{
    return &f->options;
}

size_t fxs_fit_sky_count(const fxs_fit *f)
{
    return f->sky_count;
}

/* Shuffles the photographs for a pass over all of them (Fisher and Yates). The seed is the number of the pass's first
   photograph. */
void fxs_fit_set_order(fxs_fit *f, uint64_t number)
{
    const uint32_t count = (uint32_t)f->count;
    const uint64_t first = number - number % count;
    for (uint32_t i = 0; i < count; i++)
        f->order[i] = i;
    for (uint32_t i = count - 1; i; i--) {
        const uint32_t j = (uint32_t)(fxs_random(f->options.seed, first, i) % (i + 1)), swap = f->order[i];
        f->order[i] = f->order[j];
        f->order[j] = swap;
    }
}

static const fxs_fit_photograph *choose_photograph(fxs_fit *f, uint64_t number)
{
    if (number % f->count == 0)
        fxs_fit_set_order(f, number);
    return &f->photographs[f->order[number % f->count]];
}

static void reduce(fxs_fit_photograph *p, int divisor)
{
    fxs_fit_camera *c = &p->camera;
    p->divisor = divisor;
    for (int i = 0; i < 2; i++) {
        c->focal[i] /= (float)divisor;
        c->middle[i] /= (float)divisor;
    }
    c->width /= divisor;
    c->height /= divisor;
    c->tiles_x = (c->width + FXS_FIT_TILE - 1) / FXS_FIT_TILE;
    c->tiles_y = (c->height + FXS_FIT_TILE - 1) / FXS_FIT_TILE;
}

/* Returns the learning rate of camera poses in radians: `way` (their total movement) divided by the steps per
   photograph, at most 0.002. */
static float pose_rate(const fxs_fit *f, float way)
{
    return least(way * (float)f->count / ((float)f->options.steps * (float)f->options.batch), 0.002f);
}

/* Returns the learning rate of affine exposures: 4 divided by the steps per photograph, clamped to 0.05..0.2, times
   `part`. */
static float affine_rate(const fxs_fit *f, float part)
{
    const float share = 4 * (float)f->count / ((float)f->options.steps * (float)f->options.batch);
    return part * least(most(share, 0.05f), 0.2f);
}

static void set_step(const fxs_fit *f, const fxs_fit_plan *plan, fxs_fit_step_options *options)
{
    const uint64_t key = fxs_random(f->options.seed, f->step, UINT64_MAX);
    memset(options, 0, sizeof *options);
    options->sh_degree = plan->sh_degree;
    options->number = f->step;
    options->by_opacity = plan->by_opacity;
    options->by_scale = plan->by_scale;
    options->by_flat = plan->by_flat / f->extent;
    options->by_surface = plan->by_surface;
    options->is_depth = plan->is_depth;
    options->gain_rate = f->gains.is_affine ? affine_rate(f, plan->gain_part) : 0.5f * plan->gain_part;
    options->gain_decay = f->gains.is_affine ? options->gain_rate : 0;
    options->pose_rate = pose_rate(f, plan->pose_way);
    options->smooths = plan->smooths;
    options->far = f->far;
    options->noise = (fxs_fit_noise){plan->noise, {(uint32_t)key, (uint32_t)(key >> 32)}, f->far};
    memcpy(options->rate, plan->rate, sizeof options->rate);
    for (int c = 0; c < 3; c++)
        options->background[c] = (float)f->options.background[c] / 255.0f;
}

static int change_model(fxs_fit *f, const fxs_fit_plan *plan, fxs_message *message)
{
    const fxs_fit_densify densify = {0.0002f, 0.01f * f->extent, plan->large, 0.005f, f->options.max_gaussians,
                                     f->far};
    const int repeats = f->repeated && f->step - f->repeated <= f->reached && f->most < f->options.max_gaussians;
    const fxs_fit_relocate relocate = {0.005f, repeats ? f->most : f->options.max_gaussians, f->options.seed, f->step};
    int error = plan->densify ? f->engine->densify(f->self, &densify, message) : 0;
    if (!error && plan->relocate)
        error = f->engine->relocate(f->self, &relocate, message);
    if (!error && plan->order)
        error = f->engine->order(f->self, message);
    if (!error && plan->reset)
        error = f->engine->reset_opacity(f->self, 0.01f, message);
    return error;
}

void fxs_fit_take_photograph(fxs_fit *f, uint64_t number, int32_t divisor, fxs_fit_photograph *photograph)
{
    *photograph = *choose_photograph(f, number);
    if (divisor > 1)
        reduce(photograph, divisor);
}

static void choose_batch(fxs_fit *f, fxs_fit_photograph *batch, fxs_fit_plan *plan)
{
    for (uint32_t v = 0; v < f->options.batch; v++) {
        batch[v] = *choose_photograph(f, (uint64_t)f->step * f->options.batch + v);
        const fxs_fit_camera *c = &batch[v].camera;
        fxs_fit_plan_step(&f->options, f->extent, f->step - f->repeated + 1,
                          c->width < c->height ? c->width : c->height, plan);
        if (plan->divisor > 1)
            reduce(&batch[v], plan->divisor);
    }
}

int fxs_fit_step(fxs_fit *f, fxs_fit_report *report, fxs_message *message)
{
    fxs_fit_photograph batch[FXS_FIT_BATCH];
    fxs_fit_step_options options;
    fxs_fit_plan plan;
    int error = fxs_fit_pass_profile(f, message);
    if (error)
        return error;
    choose_batch(f, batch, &plan);
    f->step++;
    set_step(f, &plan, &options);
    error = f->engine->step(f->self, batch, f->options.batch, &options, report, message);
    if (!error && !f->profile.chunks)
        error = change_model(f, &plan, message);
    if (report)
        report->gaussians = f->model.count;
    return error;
}

static long read_gaussians(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const fxs_fit_model *m = argument;
    size_t count = m->count - (size_t)first < capacity ? m->count - (size_t)first : capacity;
    for (size_t i = 0; i < count; i++)
        fxs_fit_model_give(m, (size_t)first + i, &out[i]);
    return (long)count;
}

int fxs_fit_gaussians(fxs_fit *f, fxs_gaussian_source *gaussians, fxs_message *message)
{
    memset(gaussians, 0, sizeof *gaussians);
    const int error = f->engine->fetch(f->self, message);
    gaussians->count = f->model.count;
    gaussians->sh_degree = f->options.sh_degree;
    gaussians->antialiased = f->options.antialiased;
    gaussians->read = read_gaussians;
    gaussians->argument = &f->model;
    return error;
}

static void pose_view(fxs_view *view, const fxs_fit_pose *pose)
{
    fxs_fit_camera own = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    double given[9];
    memcpy(given, view->rotation, sizeof given);
    pose_camera(&own, pose);
    for (int k = 0; k < 9; k++) {
        const float *r = own.rotation + k / 3 * 3;
        view->rotation[k] = 0;
        for (int i = 0; i < 3; i++)
            view->rotation[k] += (double)r[i] * given[3 * i + k % 3];
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            view->position[k] += given[3 * i + k] * (double)own.eye[i];
}

int fxs_fit_pose_photos(fxs_fit *f, fxs_fit_photo *photos, fxs_message *message)
{
    const int error = f->model.poses ? f->engine->fetch(f->self, message) : 0;
    for (size_t i = 0; i < f->count && f->model.poses && !error; i++)
        pose_view(&photos[i].view, &f->poses.of[i]);
    return error;
}
