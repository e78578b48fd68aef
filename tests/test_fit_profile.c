/* Tests the last steps of a fit, which optimise values quantised as in the packed file. The photographs are rendered
   from a scene with strong SH. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/internal/kernels.h>
#include "src/fit/model.h"
#include "src/fit/profile.h"
#include <fixsplat/system.h>
#include "check.h"
#include "decoded.h"
#include "one_scene.h"

enum { COUNT = 700, VIEWS = 12, WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT, SH_DEGREE = 3, STEPS = 320,
       CODED_EVERY = 10 };

static fxs_view views[VIEWS];
static fxs_fit_photograph photographs[VIEWS];
static uint8_t pixels[VIEWS][3 * PIXELS];
static fxs_message message;

static uint32_t seed;

static float uniform(double low, double high)
{
    seed = seed * 1664525u + 1013904223u;
    return (float)(low + (high - low) * (seed >> 8) / 16777216.0);
}

static void set_parameters(fxs_fit_model *m)
{
    seed = 1;
    for (size_t i = 0; i < COUNT; i++)
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
            m->parameters[(size_t)k * m->stride + i] = k < FXS_FIT_SCALE      ? uniform(-1, 1)
                                                       : k < FXS_FIT_ROTATION ? uniform(-3.5, -1.5)
                                                       : k < FXS_FIT_OPACITY  ? uniform(-1, 1)
                                                       : k < FXS_FIT_COLOUR   ? uniform(-2, 4)
                                                       : k < FXS_FIT_SH       ? uniform(-1, 1)
                                                                              : uniform(-0.1, 0.1);
}

static int make_model(fxs_fit_model *m)
{
    fxs_fit_point *points = calloc(COUNT, sizeof *points);
    const int error = points ? fxs_fit_model_begin(m, points, COUNT, 0.1f) : FXS_ERR_MEMORY;
    free(points);
    if (!error)
        set_parameters(m);
    return CHECK(!error);
}

static void set_view(int i)
{
    const double turn = 6.283185307179586 * i / VIEWS, c = cos(turn), s = sin(turn);
    const double rotation[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
    fxs_view *v = &views[i];
    fxs_fit_camera *camera = &photographs[i].camera;
    *v = (fxs_view){.width = WIDTH, .height = HEIGHT, .fx = 60, .fy = 60, .cx = WIDTH / 2.0, .cy = HEIGHT / 2.0,
                         .position = {-4 * s, 0, -4 * c}};
    memcpy(v->rotation, rotation, sizeof rotation);
    *camera = (fxs_fit_camera){.focal = {60, 60}, .middle = {WIDTH / 2.0f, HEIGHT / 2.0f}, .slope_most = {0.7f, 0.5f},
                               .near = 0.2f, .width = WIDTH, .height = HEIGHT, .tiles_x = WIDTH / FXS_FIT_TILE,
                               .tiles_y = HEIGHT / FXS_FIT_TILE};
    for (int k = 0; k < 9; k++)
        camera->rotation[k] = (float)rotation[k];
    for (int k = 0; k < 3; k++)
        camera->eye[k] = (float)v->position[k];
    photographs[i].pixels = pixels[i];
    photographs[i].width = camera->width;
    photographs[i].height = camera->height;
    photographs[i].divisor = 1;
}

static void take_photographs(fxs_fit_stepper *stepper, const fxs_fit_model *m)
{
    const fxs_fit_step_options options = {.sh_degree = SH_DEGREE};
    for (int i = 0; i < VIEWS; i++) {
        fxs_fit_plane planes[3];
        set_view(i);
        CHECK(fxs_fit_draw(stepper, m, &photographs[i].camera, &options, planes) == 0);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++)
                for (int c = 0; c < 3; c++) {
                    const double value = (double)planes[c].first[y * planes[c].stride + x] * 255 + 0.5;
                    pixels[i][3 * (y * WIDTH + x) + c] = (uint8_t)(value < 255 ? value : 255);
                }
    }
}

typedef struct fit {
    fxs_fit_stepper *stepper;
    fxs_fit_model model;
    fxs_fit_profile profile;
    fxs_pack_options options;
    uint32_t step;
} fit;

static void run_here(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

static int begin(fit *f, enum fxs_profile profile, fxs_pool *pool, uint32_t threads, unsigned cpu)
{
    memset(f, 0, sizeof *f);
    f->options = (fxs_pack_options){.size = sizeof(fxs_pack_options), .profile = profile, .workers.run = pool
                                    ? fxs_pool_run : run_here, .workers.pool = pool,
                                    .workers.count = threads};
    f->stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(cpu), f->options.workers.run, pool, threads, NULL);
    if (!CHECK(f->stepper) || !make_model(&f->model))
        return 0;
    take_photographs(f->stepper, &f->model);
    if (!CHECK(!fxs_fit_profile_begin(&f->profile, &f->model, SH_DEGREE, &f->options, &message)))
        return 0;
    fxs_fit_quantise(f->stepper, &f->model);
    return 1;
}

static void steps(fit *f, uint32_t count)
{
    fxs_fit_step_options options = {.sh_degree = SH_DEGREE};
    fxs_fit_report report;
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        options.rate[k] = k < FXS_FIT_SCALE      ? 2e-5f
                          : k < FXS_FIT_ROTATION ? 2e-4f
                          : k < FXS_FIT_OPACITY  ? 1e-4f
                          : k < FXS_FIT_COLOUR   ? 0.001f
                          : k < FXS_FIT_SH       ? 2.5e-4f
                                                 : 5e-4f;
    for (uint32_t end = f->step + count; f->step < end;) {
        if (f->step && f->step % CODED_EVERY == 0) {
            CHECK(!fxs_fit_profile_code(&f->profile, &f->model, &f->options, &message));
            fxs_fit_quantise(f->stepper, &f->model);
        }
        options.number = ++f->step;
        CHECK(!fxs_fit_stepper_step(f->stepper, &f->model, &photographs[f->step * 5 % VIEWS], 1, &options, &report));
    }
}

static void end(fit *f)
{
    fxs_fit_profile_free(&f->profile);
    fxs_fit_model_free(&f->model);
    fxs_fit_stepper_free(f->stepper);
}

static fxs_gaussian gaussian_at(const fxs_fit_model *m, const float *planes, size_t i)
{
    fxs_gaussian g;
    float values[FXS_FIT_PARAMETERS];
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        values[k] = planes[k * m->stride + i];
    memcpy(&g, values, sizeof g);
    return g;
}

static long read_gaussians(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const fxs_fit_model *m = argument;
    const size_t left = m->count - (size_t)first, count = left < capacity ? left : capacity;
    for (size_t i = 0; i < count; i++)
        out[i] = gaussian_at(m, m->parameters, (size_t)first + i);
    return (long)count;
}

static int pack(const fit *f, fxs_packed_scene *packed, fxs_scene *scene)
{
    const fxs_gaussian_source source = {.count = f->model.count, .sh_degree = SH_DEGREE, .read = read_gaussians,
                                        .argument = (void *)&f->model};
    fxs_pack_report report;
    return CHECK(!fxs_fit_profile_pack(&f->profile, &f->model, &source, packed, &report, &f->options, &message)) &&
           CHECK(!fxs_scene_open(scene, packed->data, packed->bytes));
}

static double psnr_of(const fit *f)
{
    enum { BYTES = 4 * PIXELS };
    static uint8_t picture[BYTES];
    double squares = 0;
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_context context;
    fxs_options options;
    fxs_context_init(&context, NULL);
    fxs_options_init(&options);
    if (!pack(f, &packed, &scene))
        return 0;
    const size_t bytes = one_frame_bytes(&context, &scene, WIDTH, HEIGHT, NULL);
    void *memory = check_aligned(bytes);
    for (int i = 0; i < VIEWS; i++) {
        fxs_camera camera;
        CHECK(!fxs_camera_from_view(&camera, &views[i], &message));
        CHECK(!one_render(&context, &scene, &camera, &options, FXS_FORMAT_RGBA8, memory, bytes, picture, 4 * WIDTH,
                          NULL));
        for (int p = 0; p < PIXELS; p++)
            for (int c = 0; c < 3; c++)
                squares += (picture[4 * p + c] - pixels[i][3 * p + c]) * (picture[4 * p + c] - pixels[i][3 * p + c]);
    }
    free(memory);
    fxs_packed_scene_free(&packed);
    return 10 * log10(255.0 * 255 * VIEWS * 3 * PIXELS / squares);
}

static double largest_of(const float *values, size_t count)
{
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs((double)values[i]));
    return most;
}

static void compare(const decoded *d, const fxs_gaussian *g)
{
    const double opacity = 1 / (1 + exp(-(double)g->opacity));
    for (int k = 0; k < 3; k++) {
        CHECK(fabs(d->position[k] - (double)g->position[k]) < 3e-7);
        CHECK(fabs(d->scale[k] - (double)g->scale[k]) < 1e-6);
        CHECK(fabs(d->dc[k] - (double)g->dc[k]) < 1e-6);
    }
    CHECK(angle_of_word(d->rotation, d->axis_bits, g->rotation, (const int[3]){0, 1, 2}) < 0.02);
    CHECK(fabs(d->opacity - opacity) < (opacity > 0.9989 ? 1.1e-3 : 3e-7));
    for (int k = 0; k < 45; k++)
        CHECK((float)d->sh[k] == g->sh[k]);
}

static void check_packed(const fit *f)
{
    fxs_packed_scene packed;
    fxs_scene scene;
    if (!pack(f, &packed, &scene) || !CHECK(scene.count == f->model.count))
        return;
    for (uint32_t i = 0; i < scene.count && !check_faults; i++) {
        const decoded d = decode(&scene, i);
        const fxs_gaussian g = gaussian_at(&f->model, f->model.parameters, i);
        const fxs_gaussian master = gaussian_at(&f->model, f->model.masters, i);
        double dot = 0;
        for (int k = 0; k < 4; k++)
            dot += (double)(g.rotation[k] * master.rotation[k]);
        CHECK(dot > 0);
        compare(&d, &g);
    }
    fxs_packed_scene_free(&packed);
}

static void test_what_is_fitted_is_packed(void)
{
    for (int profile = 0; profile < 3; profile++) {
        fit f;
        if (begin(&f, (enum fxs_profile)profile, NULL, 1, ~0u)) {
            check_packed(&f);
            steps(&f, 2 * CODED_EVERY + 3);
            check_packed(&f);
        }
        end(&f);
    }
}

/* In three steps most unquantised parameters must move, but fewer than half of their quantised copies may change. */
static void test_gradients_reach_the_masters(void)
{
    fit f;
    if (!begin(&f, FXS_PROFILE_SMALL, NULL, 1, ~0u))
        return;
    const size_t numbers = FXS_FIT_PARAMETERS * f.model.stride;
    float *before = malloc(numbers * sizeof *before), *copy = malloc(numbers * sizeof *copy);
    memcpy(before, f.model.masters, numbers * sizeof *before);
    memcpy(copy, f.model.parameters, numbers * sizeof *copy);
    steps(&f, 3);
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++) {
        size_t moved = 0, jumped = 0;
        for (size_t i = k * f.model.stride; i < k * f.model.stride + COUNT; i++) {
            moved += before[i] != f.model.masters[i];
            jumped += copy[i] != f.model.parameters[i];
        }
        if (!CHECK(moved > COUNT / 2 && jumped < COUNT / 2 && jumped < moved))
            printf("  parameter %zu: %zu masters moved, %zu copies\n", k, moved, jumped);
    }
    CHECK(largest_of(f.model.masters, numbers) < 100);
    free(before);
    free(copy);
    end(&f);
}

/* Compares a fit of quantised values with rounding after a fit. A small scene gets a small SH palette, so rounding
   costs much quality. */
static void test_fitted_is_better_than_rounded(void)
{
    fit f;
    if (begin(&f, FXS_PROFILE_SMALL, NULL, 1, ~0u)) {
        const double rounded = psnr_of(&f);
        steps(&f, STEPS);
        const double fitted = psnr_of(&f);
        printf("  rounded %.2f dB, fitted %.2f dB\n", rounded, fitted);
        CHECK(fitted > rounded + 1.5);
    }
    end(&f);
}

static int same(const fit *a, const fit *b)
{
    fxs_packed_scene p, q;
    fxs_scene scene;
    if (!pack(a, &p, &scene) || !pack(b, &q, &scene))
        return 0;
    int is_same = p.bytes == q.bytes && !memcmp(p.data, q.data, p.bytes) && a->model.stride == b->model.stride;
    for (size_t k = 0; is_same && k < FXS_FIT_PARAMETERS; k++) {
        const size_t at = k * a->model.stride, bytes = a->model.count * sizeof(float);
        is_same = !memcmp(a->model.masters + at, b->model.masters + at, bytes) &&
                  !memcmp(a->model.parameters + at, b->model.parameters + at, bytes);
    }
    fxs_packed_scene_free(&p);
    fxs_packed_scene_free(&q);
    return is_same;
}

static void test_same_bytes(void)
{
    fxs_pool *pool = fxs_pool_create(3);
    for (int profile = 0; profile < 3; profile++) {
        fit one, other, plain;
        const int begun = begin(&one, (enum fxs_profile)profile, NULL, 1, ~0u) &
                          begin(&other, (enum fxs_profile)profile, pool, 3, ~0u) &
                          begin(&plain, (enum fxs_profile)profile, NULL, 1, 0);
        if (begun) {
            steps(&one, CODED_EVERY + 2);
            steps(&other, CODED_EVERY + 2);
            steps(&plain, CODED_EVERY + 2);
            CHECK(same(&one, &other));
            CHECK(same(&one, &plain));
        }
        end(&one);
        end(&other);
        end(&plain);
    }
    fxs_pool_destroy(pool);
}

typedef struct store {
    unsigned char *bytes;
    size_t count;
} store;

static int write_block(void *argument, void *block, size_t bytes)
{
    store *s = argument;
    s->bytes = realloc(s->bytes, s->count + bytes);
    memcpy(s->bytes + s->count, block, bytes);
    s->count += bytes;
    return 0;
}

static int read_block(void *argument, void *block, size_t bytes)
{
    store *s = argument;
    memcpy(block, s->bytes + s->count, bytes);
    s->count += bytes;
    return 0;
}

static void test_state(void)
{
    for (int profile = 0; profile < 3; profile++) {
        fit f, again;
        store s = {NULL, 0};
        if (begin(&f, (enum fxs_profile)profile, NULL, 1, ~0u)) {
            steps(&f, CODED_EVERY / 2);
            again = f;
            CHECK(!fxs_fit_profile_walk(&f.profile, &f.model, write_block, write_block, &s));
            memset(&again.profile, 0, sizeof again.profile);
            again.stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(~0u), NULL, NULL, 1, NULL);
            make_model(&again.model);
            const size_t bytes = FXS_FIT_PARAMETERS * f.model.stride * sizeof(float);
            memcpy(again.model.parameters, f.model.parameters, bytes);
            memcpy(again.model.means, f.model.means, bytes);
            memcpy(again.model.squares, f.model.squares, bytes);
            CHECK(!fxs_fit_profile_allocate(&again.profile, &again.model, (enum fxs_profile)profile, SH_DEGREE));
            s.count = 0;
            CHECK(!fxs_fit_profile_walk(&again.profile, &again.model, read_block, read_block, &s));
            CHECK(!fxs_fit_profile_restore(&again.profile, &again.model));
            steps(&f, CODED_EVERY);
            steps(&again, CODED_EVERY);
            CHECK(same(&f, &again));
            again.profile.chunks[1].opacity_law = 4;
            CHECK(fxs_fit_profile_restore(&again.profile, &again.model) != 0);
            end(&again);
        }
        free(s.bytes);
        end(&f);
    }
}

int main(void)
{
    RUN(test_what_is_fitted_is_packed);
    RUN(test_gradients_reach_the_masters);
    RUN(test_fitted_is_better_than_rounded);
    RUN(test_same_bytes);
    RUN(test_state);
    return check_report();
}
