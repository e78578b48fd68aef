/* A fit must give the same bytes for every compiler, processor and number of threads. A few hundred steps of each
   recipe on synthetic pictures are compared with constant hashes. Built with -DFXS_FIT_FEW, the test makes fewer steps,
   for an emulator. test_fit_steps --cuda fits on a GPU. */
#include <fixsplat/fit.h>
#include <fixsplat/system.h>
#include "fit_scene.h"
#include "src/fit/fit_internal.h"

/* The photographs are ray-traced pictures of spheres with a pattern of squares. Only + - * / and sqrt of doubles are
   used, which round equally everywhere. */
enum { WIDTH = 24, HEIGHT = 16, ORDINARY = 2, LARGER = 14, PHOTOS = 6, POINTS = 120, SPHERES = 4 };
static const uint8_t background[3] = {40, 80, 120};

typedef struct sphere {
    double centre[3], radius, colour[3];
} sphere;

static const sphere spheres[SPHERES] = {{{0, 0, 0}, 0.7, {0.9, 0.5, 0.2}}, {{0.9, -0.3, 0.4}, 0.4, {0.2, 0.8, 0.4}},
                                        {{-0.8, 0.2, 0.5}, 0.5, {0.3, 0.4, 0.9}},
                                        {{0.1, 0.5, -0.9}, 0.35, {0.9, 0.9, 0.3}}};

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void shade(const sphere *s, const double at[3], uint8_t colour[3])
{
    static const double light[3] = {0.48, -0.6, -0.64};
    double normal[3], bright;
    int squares = 0;
    for (int k = 0; k < 3; k++) {
        normal[k] = (at[k] - s->centre[k]) / s->radius;
        squares += (int)(normal[k] * 2.5 + 8);
    }
    bright = (0.35 + 0.6 * fmax(0, dot(normal, light))) * (squares % 2 ? 1 : 0.6);
    for (int k = 0; k < 3; k++)
        colour[k] = (uint8_t)(255 * s->colour[k] * bright);
}

static void trace(const double eye[3], const double ray[3], uint8_t colour[3])
{
    double nearest = INFINITY;
    memcpy(colour, background, 3);
    for (int i = 0; i < SPHERES; i++) {
        double from[3], at[3];
        for (int k = 0; k < 3; k++)
            from[k] = eye[k] - spheres[i].centre[k];
        const double a = dot(ray, ray), b = dot(ray, from), c = dot(from, from) - spheres[i].radius * spheres[i].radius;
        const double root_of = b * b - a * c;
        if (root_of < 0 || (-b - sqrt(root_of)) / a >= nearest)
            continue;
        nearest = (-b - sqrt(root_of)) / a;
        for (int k = 0; k < 3; k++)
            at[k] = eye[k] + nearest * ray[k];
        shade(&spheres[i], at, colour);
    }
}

static void look(fxs_view *v, int scale, const double eye[3])
{
    const double length = sqrt(dot(eye, eye)), across = sqrt(eye[0] * eye[0] + eye[2] * eye[2]);
    double *right = v->rotation, *down = right + 3, *forward = right + 6;
    memset(v, 0, sizeof *v);
    v->width = scale * WIDTH, v->height = scale * HEIGHT;
    v->fx = v->fy = scale * 30;
    v->cx = scale * WIDTH / 2.0, v->cy = scale * HEIGHT / 2.0;
    for (int k = 0; k < 3; k++) {
        v->position[k] = eye[k];
        forward[k] = -eye[k] / length;
    }
    right[0] = forward[2] * length / across, right[2] = -forward[0] * length / across;
    for (int k = 0; k < 3; k++)
        down[k] = forward[(k + 1) % 3] * right[(k + 2) % 3] - forward[(k + 2) % 3] * right[(k + 1) % 3];
}

static void take_photo(fxs_fit_photo *photo, uint8_t *pixels, int scale, const double eye[3])
{
    fxs_view *v = &photo->view;
    look(v, scale, eye);
    photo->pixels = pixels;
    photo->mask = NULL;
    for (int p = 0; p < v->width * v->height; p++) {
        double ray[3];
        for (int k = 0; k < 3; k++)
            ray[k] = (p % v->width + 0.5 - v->cx) / v->fx * v->rotation[k] +
                     (p / v->width + 0.5 - v->cy) / v->fy * v->rotation[3 + k] + v->rotation[6 + k];
        trace(eye, ray, pixels + 3 * p);
    }
}

static fxs_fit_photo photos[PHOTOS];
static fxs_fit_point points[POINTS];

static void make_set(int scale)
{
    static const double eyes[PHOTOS][3] = {{0, -1, -4}, {3.2, 0.5, -2.4}, {3.2, -2, 2.4}, {0, 1, 4}, {-3.84, -1, 1.12},
                                           {-2.4, 0, -3.2}};
    static uint8_t pixels[PHOTOS][3 * LARGER * LARGER * WIDTH * HEIGHT];
    for (int i = 0; i < PHOTOS; i++)
        take_photo(&photos[i], pixels[i], scale, eyes[i]);
    fit_state = 1;
    for (int i = 0; i < POINTS; i++) {
        const sphere *s = &spheres[i % SPHERES];
        double to[3], at[3];
        for (int k = 0; k < 3; k++)
            to[k] = fit_uniform(-1, 1);
        for (int k = 0; k < 3; k++) {
            at[k] = s->centre[k] + s->radius * to[k] / sqrt(dot(to, to));
            points[i].position[k] = (float)at[k];
        }
        shade(s, at, points[i].colour);
    }
}

/* Adds a mask to each photograph that ignores a disc. The ignored pixels become noise from the seed. */
static void ignore_pixels(uint64_t seed)
{
    static uint8_t masks[PHOTOS][LARGER * LARGER * WIDTH * HEIGHT];
    fit_state = seed;
    for (int i = 0; i < PHOTOS; i++) {
        const int width = photos[i].view.width, height = photos[i].view.height;
        uint8_t *pixels = (uint8_t *)photos[i].pixels;
        for (int p = 0; p < width * height; p++) {
            const int x = 12 * (p % width) - (3 + i) * width, y = 12 * (p / width) - (7 - i) * height;
            const int is_ignored = x * x + y * y < 9 * height * height || p / width > height * 9 / 10;
            masks[i][p] = is_ignored ? 0 : (uint8_t)(1 + p % 255);
            for (int c = 0; c < 3 && !masks[i][p]; c++)
                pixels[3 * p + c] = (uint8_t)fit_random();
        }
        photos[i].mask = masks[i];
    }
}

static void ignore_nothing(void)
{
    static uint8_t mask[LARGER * LARGER * WIDTH * HEIGHT];
    memset(mask, 255, sizeof mask);
    for (int i = 0; i < PHOTOS; i++)
        photos[i].mask = mask;
}

static const int percent[PHOTOS][3] = {{60, 64, 66}, {160, 150, 140}, {85, 85, 85}, {130, 125, 136}, {72, 70, 64},
                                       {104, 110, 118}};

static void change_exposures(void)
{
    for (int i = 0; i < PHOTOS; i++) {
        uint8_t *pixels = (uint8_t *)photos[i].pixels;
        for (int k = 0; k < 3 * photos[i].view.width * photos[i].view.height; k++) {
            const int level = (pixels[k] * percent[i][k % 3] + 50) / 100;
            pixels[k] = (uint8_t)(level < 255 ? level : 255);
        }
    }
}

/* Sets the exposure of each photograph, known or unknown. The pixel values are proportional to light^(1 / 2.2). */
static void say_exposures(int are_known)
{
    static const double light[PHOTOS] = {0.0033, 0.0257, 0.007, 0.0165, 0.0046, 0.0117};
    for (int i = 0; i < PHOTOS; i++)
        photos[i].exposure = are_known ? light[i] : 0;
}

static void disturb_poses(void)
{
    fit_state = 5;
    for (int i = 0; i < PHOTOS; i++) {
        fxs_view *v = &photos[i].view;
        const double distance = sqrt(dot(v->position, v->position));
        double turned[9];
        for (int k = 0; k < 3; k++) {
            double *const a = v->rotation + 3 * ((k + 1) % 3), *const b = v->rotation + 3 * ((k + 2) % 3);
            const double s = fit_uniform(-0.0175, 0.0175), c = sqrt(1 - s * s);
            for (int j = 0; j < 3; j++) {
                turned[j] = c * a[j] - s * b[j];
                b[j] = s * a[j] + c * b[j];
                a[j] = turned[j];
            }
            v->position[k] += fit_uniform(-0.01, 0.01) * distance;
        }
    }
}

typedef struct distances {
    double turn, shift;
} distances;

static distances pose_distances(const fxs_fit_photo *a, const fxs_fit_photo *b)
{
    distances sums = {0, 0};
    for (int i = 0; i < PHOTOS; i++) {
        double squares = 0, shift = 0;
        for (int k = 0; k < 9; k++)    /* angle between two rotation matrices: |R - R'|^2 = 8 sin^2(angle / 2) */
            squares += pow(a[i].view.rotation[k] - b[i].view.rotation[k], 2);
        for (int k = 0; k < 3; k++)
            shift += pow(a[i].view.position[k] - b[i].view.position[k], 2);
        sums.turn += 2 * asin(sqrt(squares / 8)) / PHOTOS;
        sums.shift += sqrt(shift) / PHOTOS;
    }
    return sums;
}

typedef struct result {
    uint64_t hash;
    size_t most;
    double first, last;   /* mean loss while the fit goes through all photographs once, at the start and at the end */
    int is_finite;
    fxs_fit_photo refined[PHOTOS];
    fxs_fit_gain gains[PHOTOS];
} result;

static void add_to_hash(uint64_t *hash, uint32_t word)
{
    *hash = (*hash ^ word) * 0x100000001b3u;
}

static void hash_gaussians(fxs_fit *fit, result *r)
{
    fxs_gaussian_source source;
    fxs_message message;
    CHECK(!fxs_fit_gaussians(fit, &source, &message));
    r->hash = 0xcbf29ce484222325u;
    for (uint64_t i = 0; i < source.count; i++) {
        fxs_gaussian g;
        uint32_t words[FXS_FIT_PARAMETERS];
        memset(&g, 0, sizeof g);
        CHECK(source.read(source.argument, i, &g, 1) == 1);
        memcpy(words, &g, sizeof words);
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++) {
            add_to_hash(&r->hash, words[k]);
            r->is_finite &= (words[k] >> 23 & 255) != 255;
        }
    }
}

/* True if the fit should report: in the first and last round through all photographs, and every 50 steps. */
static int wants_report(const fxs_fit_options *options, uint32_t step)
{
    return step <= PHOTOS || step > options->steps - PHOTOS || step % 50 == 0;
}

static result fit(const fxs_fit_options *options)
{
    result r = {.is_finite = 1};
    fxs_fit *f;
    fxs_message message;
    if (!CHECK(fxs_fit_create(&f, photos, PHOTOS, points, POINTS, options, &message) == 0))
        return r;
    while (fxs_fit_steps(f) < options->steps) {
        fxs_fit_report report;
        const int is_reported = wants_report(options, fxs_fit_steps(f) + 1);
        if (!CHECK(fxs_fit_step(f, is_reported ? &report : NULL, &message) == 0))
            break;
        if (!is_reported)
            continue;
        const double loss = 0.8 * report.absolute + 0.2 * report.dissimilar;
        r.first += fxs_fit_steps(f) <= PHOTOS ? loss / PHOTOS : 0;
        r.last += fxs_fit_steps(f) > options->steps - PHOTOS ? loss / PHOTOS : 0;
        r.most = report.gaussians > r.most ? report.gaussians : r.most;
    }
    hash_gaussians(f, &r);
    memcpy(r.gains, f->gains.of, sizeof r.gains);
    memcpy(r.refined, photos, sizeof photos);
    CHECK(!fxs_fit_pose_photos(f, r.refined, &message));
    fxs_fit_destroy(f);
    return r;
}

typedef struct recorded {
    const char *name;
    enum fxs_fit_recipe recipe;
    enum fxs_cutoff cutoff;
    enum fxs_profile profile;
    int scale;
    uint32_t steps;
    size_t most;
    uint32_t batch;
    enum fxs_fit_exposure exposure;
    double left;
    uint64_t hash;
} recorded;

enum { FEW, FEW_MCMC, FEW_EXPOSURE, REFERENCE, MCMC, LONGER, FAST, HALF_THE_SIZE, BATCH, EXPOSURE, MASKS, HALF_MASKS,
       POSES, ANTIALIASED, FEW_SKY, SKY, SURFACES, SURFACES_POSES, FITS };
static const recorded fits[FITS] = {
    {"few", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, 1, 680, 150, 1,
     FXS_FIT_EXPOSURE_NONE, 0.6, 0xdc82ca3bb1388e32},
    {"few by mcmc", FXS_FIT_MCMC, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_SMALL, 1, 680, 130, 1,
     FXS_FIT_EXPOSURE_NONE, 0.6, 0x5819bcbd0cfec3ad},
    {"few, exposures known", FXS_FIT_FAST, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, 1, 60, 150, 2,
     FXS_FIT_EXPOSURE_GAIN, 0.9, 0xb12809268617518b},
    {"reference", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 700, 250, 1,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0xf74b4c5249fd77ea},
    {"mcmc", FXS_FIT_MCMC, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_SMALL, ORDINARY, 700, 150, 1,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0xed9874ad1d6c450e},
    {"reference, longer", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 3200, 200, 1,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0x8577c65af221e857},
    {"fast, square", FXS_FIT_FAST, FXS_CUTOFF_SQUARE, FXS_PROFILE_COMPACT, ORDINARY, 1100, 250, 1,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0x905fd213127515d7},
    {"fast, larger", FXS_FIT_FAST, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, LARGER, 24, 250, 1,
     FXS_FIT_EXPOSURE_NONE, 0.9, 0x46abefeec90bd301},
    {"batches of four", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 700, 250, 4,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0x08c91fc44aad54e7},
    {"exposures, batches of four", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 700, 250,
     4,
     FXS_FIT_EXPOSURE_GAIN, 0.5, 0x38ff4d78aa80bb24},
    {"masks, affine, batches of four", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 700,
     250, 4, FXS_FIT_EXPOSURE_AFFINE, 0.5, 0xca83d8795c7718ef},
    {"masks, fast, larger", FXS_FIT_FAST, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, LARGER, 120, 250, 1,
     FXS_FIT_EXPOSURE_NONE, 0.9, 0x0fb87d537f2a9140},
    {"poses, batches of four", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 1100, 250, 4,
     FXS_FIT_EXPOSURE_GAIN, 0.5, 0x96a7599227daf5d0},
    {"antialiased, batches of two", FXS_FIT_FAST, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_SMALL, ORDINARY, 700, 200, 2,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0x02b69dc77b4770f3},
    {"few, a sky", FXS_FIT_MCMC, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, 1, 60, 250, 1,
     FXS_FIT_EXPOSURE_NONE, 0.9, 0xcf59ac40c3d4af21},
    {"a sky", FXS_FIT_REFERENCE, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 700, 350, 2,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0xb8d36b9cb21bb093},
    {"surfaces", FXS_FIT_FAST, FXS_CUTOFF_MAHALANOBIS, FXS_PROFILE_DEFAULT, ORDINARY, 900, 200, 1,
     FXS_FIT_EXPOSURE_NONE, 0.5, 0x09369a88c46f45fa},
    {"surfaces, poses, batches of two", FXS_FIT_REFERENCE, FXS_CUTOFF_SQUARE, FXS_PROFILE_SMALL, ORDINARY, 700, 250, 2,
     FXS_FIT_EXPOSURE_GAIN, 0.5, 0x26eab3ce5438f0b9}};

static int devices;                /* 0: the fit runs on the CPU, 1: on the first GPU */
static int through_vulkan;

static void set_options(const recorded *wanted, fxs_fit_options *o)
{
    fxs_fit_options_init(o);
    o->recipe = wanted->recipe;
    o->cutoff = wanted->cutoff;
    o->profile = wanted->profile;
    o->steps = wanted->steps;
    o->max_gaussians = wanted->most;
    o->seed = 7;
    memcpy(o->background, background, sizeof background);
    o->batch = wanted->batch;
    o->exposure = wanted->exposure;
    o->refine_poses = wanted == &fits[POSES] || wanted == &fits[SURFACES_POSES];
    o->surfaces = wanted == &fits[SURFACES] || wanted == &fits[SURFACES_POSES];
    o->antialiased = wanted == &fits[ANTIALIASED];
    o->sky = wanted == &fits[FEW_SKY] || wanted == &fits[SKY] ? 300 : 0;
    o->device_count = (uint32_t)devices;
    o->vulkan = through_vulkan;
}

static void check_fit(const recorded *wanted, unsigned cpu, uint32_t threads)
{
    fxs_fit_options options;
    fxs_pool *pool = threads > 1 ? fxs_pool_create(threads) : NULL;
    set_options(wanted, &options);
    options.cpu = cpu;
    options.workers.run = pool ? fxs_pool_run : NULL;
    options.workers.pool = pool;
    options.workers.count = threads;
    const result r = fit(&options);
    const char *version = fxs_fit_stages_choose(cpu)->name;
    if (!CHECK(r.hash == wanted->hash))
        printf("  %s, %s, %u threads: 0x%016llx\n", wanted->name, version, (unsigned)threads,
               (unsigned long long)r.hash);
    if (!CHECK(r.is_finite && r.last < wanted->left * r.first))
        printf("  %s: loss %g at first, %g at last\n", wanted->name, r.first, r.last);
    if (wanted->steps > 600 && !CHECK(r.most > POINTS && r.most <= wanted->most))
        printf("  %s: %zu Gaussians\n", wanted->name, r.most);
    fxs_pool_destroy(pool);
}

static int is_refused(uint32_t batch, uint32_t device_count)
{
    fxs_fit *f;
    fxs_message message;
    fxs_fit_options options;
    fxs_fit_options_init(&options);
    options.batch = batch;
    options.device_count = device_count;
    const int error = fxs_fit_create(&f, photos, PHOTOS, points, POINTS, &options, &message);
    fxs_fit_destroy(f);
    return error == FXS_ERR_ARGUMENT;
}

static void test_batches_that_cannot_be(void)
{
    make_set(1);
    CHECK(is_refused(9, 0) && is_refused(0, 9) && is_refused(3, 2));
    CHECK(!is_refused(8, 0) && !is_refused(4, 2));
}

static void test_few(void)
{
    make_set(1);
    check_fit(&fits[FEW], ~0u, 1);
    check_fit(&fits[FEW_MCMC], ~0u, 1);
    check_fit(&fits[FEW_SKY], ~0u, 1);
    change_exposures();
    say_exposures(1);
    check_fit(&fits[FEW_EXPOSURE], ~0u, 1);
    say_exposures(0);
}

#ifndef FXS_FIT_FEW
static void check_everywhere_of_set(const recorded *wanted)
{
    if (!devices)
        check_fit(wanted, 0, 1);
    check_fit(wanted, ~0u, 5);
}

static void check_instruction_sets(const recorded *wanted)
{
    make_set(wanted->scale);
    for (int i = 1; i < FIT_VERSIONS && !devices; i++)
        if (fxs_fit_stages_choose(fit_cpus[i]) != fxs_fit_stages_choose(0))
            check_fit(wanted, fit_cpus[i], 1);
    check_fit(wanted, ~0u, 2);
    check_everywhere_of_set(wanted);
}

static void check_everywhere(const recorded *wanted)
{
    make_set(wanted->scale);
    check_everywhere_of_set(wanted);
}

static void test_reference(void)
{
    check_everywhere(&fits[REFERENCE]);
}

static void test_mcmc(void)
{
    check_instruction_sets(&fits[MCMC]);
}

static void test_reference_for_longer(void)
{
    make_set(ORDINARY);
    check_fit(&fits[LONGER], 0, 1);
    check_fit(&fits[LONGER], ~0u, 3);
}

static void test_fast(void)
{
    check_everywhere(&fits[FAST]);
}

static void test_sky(void)
{
    check_everywhere(&fits[SKY]);
}

/* Tests the recipe "fast" with photographs so large that the fit starts at half their size. */
static void test_fast_from_half_the_size(void)
{
    check_instruction_sets(&fits[HALF_THE_SIZE]);
}

static void test_batches(void)
{
    check_everywhere(&fits[BATCH]);
}

static void test_exposures(void)
{
    make_set(ORDINARY);
    change_exposures();
    check_everywhere_of_set(&fits[EXPOSURE]);
    check_fit(&fits[EXPOSURE], ~0u, 7);
}

static void test_masks(void)
{
    make_set(ORDINARY);
    ignore_pixels(1);
    check_everywhere_of_set(&fits[MASKS]);
    ignore_pixels(2);
    check_fit(&fits[MASKS], ~0u, 7);
}

static void test_masks_from_half_the_size(void)
{
    make_set(LARGER);
    ignore_pixels(1);
    check_everywhere_of_set(&fits[HALF_MASKS]);
    ignore_pixels(2);
    check_fit(&fits[HALF_MASKS], ~0u, 7);
}

static void test_masks_that_ignore_nothing(void)
{
    make_set(ORDINARY);
    ignore_nothing();
    check_fit(&fits[FAST], ~0u, 2);
    make_set(LARGER);
    ignore_nothing();
    check_fit(&fits[HALF_THE_SIZE], ~0u, 2);
}

/* Checks that the fitted factors are those by which the photographs were multiplied, but for a common tint. */
static void check_factors(const fxs_fit_gain gains[PHOTOS])
{
    double most = 0;
    for (int c = 0; c < 3; c++) {
        double off[PHOTOS], mean = 0;
        for (int i = 0; i < PHOTOS; i++) {
            const float *at = gains[i].at;
            const double fitted = (double)(c == 0 ? at[0] + at[1] : c == 1 ? at[0] - at[1] - at[2] : at[0] + at[2]);
            off[i] = fitted - log2(percent[i][c] / 100.0);
            mean += off[i] / PHOTOS;
        }
        for (int i = 0; i < PHOTOS; i++)
            most = fmax(most, fabs(off[i] - mean));
    }
    if (!CHECK(most < 0.1))
        printf("  a factor is off by %g, log2\n", most);
}

static void test_exposures_are_found(void)
{
    enum { SHORT, SHORT_CHANGED, LONG, FOUND, KNOWN, CASES };
    double left[CASES], first[CASES];
    for (int i = 0; i < CASES; i++) {
        fxs_fit_options options;
        make_set(ORDINARY);
        if (i != SHORT && i != LONG)
            change_exposures();
        set_options(&fits[EXPOSURE], &options);
        options.exposure = i > LONG ? FXS_FIT_EXPOSURE_GAIN : FXS_FIT_EXPOSURE_NONE;
        options.steps = i < LONG ? 700 : 1400;
        say_exposures(i == KNOWN);
        const result r = fit(&options);
        left[i] = r.last;
        first[i] = r.first;
        if (i == FOUND)
            check_factors(r.gains);
    }
    say_exposures(0);
    if (!CHECK(first[KNOWN] < 0.9 * first[FOUND] && left[KNOWN] < 1.1 * left[LONG]))
        printf("  loss at first %g, with exposures known %g, at last %g\n", first[FOUND], first[KNOWN], left[KNOWN]);
    if (!CHECK(left[SHORT_CHANGED] > 1.6 * left[SHORT] && left[FOUND] < 1.1 * left[LONG]))
        printf("  loss %g, changed %g; later %g, with exposures %g\n", left[SHORT], left[SHORT_CHANGED], left[LONG],
               left[FOUND]);
}

/* Returns the smallest sigma at a place that any photograph resolves: sqrt(0.2) pixels. Returns 0 if no photograph
   sees the place. */
static double finest_sigma(const float place[3])
{
    double finest = INFINITY;
    for (int i = 0; i < PHOTOS; i++) {
        const fxs_view *v = &photos[i].view;
        double at[3] = {0, 0, 0};
        for (int k = 0; k < 9; k++)
            at[k / 3] += v->rotation[k] * ((double)place[k % 3] - v->position[k % 3]);
        const double x = (v->fx * at[0] / at[2] + v->cx) / v->width, y = (v->fy * at[1] / at[2] + v->cy) / v->height;
        const double beyond = fmax(fmax(-x, x - 1), fmax(-y, y - 1));
        if (at[2] > 0.2 && fabs(beyond - 0.15) < 1e-4)
            return 0;
        if (at[2] > 0.2 && beyond < 0.15)
            finest = fmin(finest, at[2] / v->fx);
    }
    return finest < INFINITY ? sqrt(0.2) * finest : 0;
}

static void test_antialiased(void)
{
    check_everywhere(&fits[ANTIALIASED]);
    for (int i = 0; i < 2; i++) {
        fxs_fit_options options;
        fxs_gaussian_source source;
        fxs_message message;
        fxs_fit *f;
        size_t bound = 0, finer = 0;
        set_options(&fits[ANTIALIASED], &options);
        options.antialiased = !i;
        options.steps = 9;         /* few steps, since longer fits quantise scales in their last tenth */
        if (!CHECK(fxs_fit_create(&f, photos, PHOTOS, points, POINTS, &options, &message) == 0))
            return;
        while (fxs_fit_steps(f) < options.steps)
            CHECK(fxs_fit_step(f, NULL, &message) == 0);
        CHECK(!fxs_fit_gaussians(f, &source, &message) && source.antialiased == !i);
        for (uint64_t n = 0; n < source.count; n++) {
            fxs_gaussian g;
            CHECK(source.read(source.argument, n, &g, 1) == 1);
            const double sigma = finest_sigma(g.position);
            for (int k = 0; k < 3 && sigma > 0; k++) {
                const double ratio = exp((double)g.scale[k]) / sigma;
                finer += ratio < 1 - 1e-5;
                bound += fabs(ratio - 1) < 1e-5;
            }
        }
        if (!CHECK(i ? finer > 100 && !bound : bound > 15 && !finer))
            printf("  antialiased %d: %zu scales at the bound, %zu finer\n", !i, bound, finer);
        fxs_fit_destroy(f);
    }
}

/* Returns the mean angle between the shortest axes of Gaussians and the spheres' normals, and the mean of the shortest
   scale divided by the next one. */
static distances surface_distances(const fxs_fit_options *options)
{
    distances sums = {0, 0};
    fxs_gaussian_source source;
    fxs_message message;
    fxs_fit *f;
    double weights = 0;
    if (!CHECK(fxs_fit_create(&f, photos, PHOTOS, points, POINTS, options, &message) == 0))
        return sums;
    while (fxs_fit_steps(f) < options->steps)
        CHECK(fxs_fit_step(f, NULL, &message) == 0);
    CHECK(!fxs_fit_gaussians(f, &source, &message));
    for (uint64_t n = 0; n < source.count; n++) {
        fxs_gaussian g;
        double nearest = INFINITY, normal[3] = {0}, scale[3], axis[3];
        CHECK(source.read(source.argument, n, &g, 1) == 1);
        for (int i = 0; i < SPHERES; i++) {
            double from[3];
            for (int k = 0; k < 3; k++)
                from[k] = (double)g.position[k] - spheres[i].centre[k];
            const double away = fabs(sqrt(dot(from, from)) - spheres[i].radius);
            for (int k = 0; k < 3 && away < nearest; k++)
                normal[k] = from[k] / sqrt(dot(from, from));
            nearest = fmin(nearest, away);
        }
        const double w = g.rotation[0], x = g.rotation[1], y = g.rotation[2], z = g.rotation[3];
        const double q = w * w + x * x + y * y + z * z;
        const double axes[3][3] = {{1 - 2 * (y * y + z * z) / q, 2 * (x * y + w * z) / q, 2 * (x * z - w * y) / q},
                                   {2 * (x * y - w * z) / q, 1 - 2 * (x * x + z * z) / q, 2 * (y * z + w * x) / q},
                                   {2 * (x * z + w * y) / q, 2 * (y * z - w * x) / q, 1 - 2 * (x * x + y * y) / q}};
        int shortest = 0;
        for (int k = 0; k < 3; k++) {
            scale[k] = exp((double)g.scale[k]);
            shortest = scale[k] < scale[shortest] ? k : shortest;
        }
        memcpy(axis, axes[shortest], sizeof axis);
        const double a = scale[(shortest + 1) % 3], b = scale[(shortest + 2) % 3];
        const double weight = nearest < 0.1 ? a * b / (1 + exp(-(double)g.opacity)) : 0;
        sums.turn += weight * acos(fmin(1, fabs(dot(axis, normal))));
        sums.shift += weight * scale[shortest] / fmin(a, b);
        weights += weight;
    }
    fxs_fit_destroy(f);
    return (distances){sums.turn / weights, sums.shift / weights};
}

static void test_surfaces(void)
{
    fxs_fit_options options;
    distances found[2];
    check_instruction_sets(&fits[SURFACES]);
    make_set(ORDINARY);
    disturb_poses();
    check_everywhere_of_set(&fits[SURFACES_POSES]);
    make_set(8);
    set_options(&fits[SURFACES], &options);
    options.max_gaussians = 1000;
    options.steps = 3000;
    options.workers.pool = fxs_pool_create(2);
    options.workers.run = options.workers.pool ? fxs_pool_run : NULL;
    options.workers.count = 2;
    for (int i = 0; i < 2; i++) {
        options.surfaces = i;
        found[i] = surface_distances(&options);
    }
    fxs_pool_destroy(options.workers.pool);
    if (!CHECK(found[1].turn < 0.97 * found[0].turn && found[1].shift < 0.9 * found[0].shift))
        printf("  normals off by %g and %g rad, thickness %g and %g\n", found[0].turn, found[1].turn, found[0].shift,
               found[1].shift);
}

static void test_poses(void)
{
    make_set(ORDINARY);
    disturb_poses();
    check_everywhere_of_set(&fits[POSES]);
    check_fit(&fits[POSES], ~0u, 7);
}

static void test_poses_are_found(void)
{
    fxs_fit_photo right[PHOTOS];
    distances before = {0, 0}, after = {0, 0};
    double left[3];
    for (int i = 0; i < 3; i++) {
        fxs_fit_options options;
        make_set(ORDINARY);
        memcpy(right, photos, sizeof photos);
        if (i)
            disturb_poses();
        set_options(&fits[POSES], &options);
        options.exposure = FXS_FIT_EXPOSURE_NONE;
        options.refine_poses = i == 2;
        const result r = fit(&options);
        left[i] = r.last;
        before = pose_distances(photos, right);
        after = pose_distances(r.refined, right);
        CHECK(i == 2 || !memcmp(r.refined, photos, sizeof photos));
    }
    if (!CHECK(left[1] > 1.3 * left[0] && left[2] < 1.12 * left[0]) ||
        !CHECK(after.turn < 0.7 * before.turn && after.shift < 0.8 * before.shift))
        printf("  loss %g, disturbed %g, refined %g; poses %g rad and %g, refined %g and %g\n", left[0], left[1],
               left[2], before.turn, before.shift, after.turn, after.shift);
}
#endif

int main(int argc, char **argv)
{
    through_vulkan = argc > 1 && !strcmp(argv[1], "--vulkan");
    devices = through_vulkan || (argc > 1 && !strcmp(argv[1], "--cuda"));
    RUN(test_batches_that_cannot_be);
    RUN(test_few);
#ifndef FXS_FIT_FEW
    RUN(test_reference);
    RUN(test_mcmc);
    RUN(test_reference_for_longer);
    RUN(test_fast);
    RUN(test_sky);
    RUN(test_fast_from_half_the_size);
    RUN(test_batches);
    RUN(test_exposures);
    RUN(test_exposures_are_found);
    RUN(test_masks);
    RUN(test_masks_from_half_the_size);
    RUN(test_masks_that_ignore_nothing);
    RUN(test_antialiased);
    RUN(test_surfaces);
    RUN(test_poses);
    RUN(test_poses_are_found);
#endif
    return check_report();
}
