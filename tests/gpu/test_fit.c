/* Compares the fit on CUDA with the fit on the processor: after each step, every buffer must be equal bit by bit.
 *   test_fit [--quick]
 * --quick: only a few small models. */
#include "src/fit/stepper.c"

#include <fixsplat/system.h>
#include "tests/fit_scene.h"
#include "peek_fit.h"

static int quick;
static fxs_pool *pool;

/* ---- Models and photographs -------------------------------------------------------------------------------------- */

typedef struct what {
    int32_t width, height, is_square;
    size_t count;
    int degree, batch;
    float by_opacity, noise, near_size;    /* near_size: natural logarithm of a typical sigma */
    uint32_t gains, poses;         /* number of exposures and number of camera poses that are fitted; 0: none */
    int is_affine;
    int is_antialiased;            /* 1: antialiased rendering */
    int has_far;                   /* 1: about half of the Gaussians have sizes as angles */
    int is_in_one_place;           /* 1: all Gaussians have equal depths */
    int has_masks;                 /* 1: all photographs except the second have masks */
    int surfaces;                  /* 0: none; 1: the last step turns Gaussians to surfaces; 2: it moves them */
} what;

enum { MOST_STEPS = 3, MOST_BATCH = 3, MOST_GAINS = 200, MASK_PIXELS = 160 * 120 };

static void fill_model(fxs_fit_model *m, const what *w)
{
    for (size_t i = 0; i < w->count; i++) {
        float *p = m->parameters + i;
        for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
            p[k * m->stride] = (float)fit_uniform(-0.3, 0.3);
        for (size_t k = 0; k < 3; k++) {
            p[(FXS_FIT_POSITION + k) * m->stride] = w->is_in_one_place ? 0.5f : (float)fit_uniform(-4, 4);
            p[(FXS_FIT_SCALE + k) * m->stride] = w->near_size + (float)fit_uniform(-2, 1);
        }
        for (size_t k = 0; k < 4; k++)
            p[(FXS_FIT_ROTATION + k) * m->stride] = (float)fit_uniform(-1, 1);
        p[FXS_FIT_OPACITY * m->stride] = (float)fit_uniform(-4, 6);
    }
}

/* Spoils some Gaussians of a model with zero rotations, NaN, infinity, and huge and tiny numbers. */
static void spoil_model(fxs_fit_model *m)
{
    static const float bad[] = {0, NAN, INFINITY, 1e30f, -1e30f, 1e-30f};
    for (size_t i = 0; i < m->count; i += 37)
        m->parameters[fit_random() % FXS_FIT_PARAMETERS * m->stride + i] = bad[fit_random() % 6];
    for (size_t i = 5; i < m->count; i += 91)
        for (size_t k = 0; k < 4; k++)
            m->parameters[(FXS_FIT_ROTATION + k) * m->stride + i] = 0;
}

static int copy_model(fxs_fit_model *to, const fxs_fit_model *from)
{
    const size_t bytes = FXS_FIT_PARAMETERS * from->stride * sizeof(float);
    if (fxs_fit_model_room(to, from->count))
        return 1;
    memcpy(to->parameters, from->parameters, bytes);
    return 0;
}

static void fill_gains(fxs_fit_gain gains[2][MOST_GAINS], int is_affine)
{
    for (int i = 0; i < MOST_GAINS; i++) {
        fxs_fit_gain *of = &gains[0][i];
        *of = (fxs_fit_gain){.square = (float)fit_uniform(0, 0.001), .of_one = {0.3f, 0.01f}};
        for (int k = 0; k < (is_affine ? FXS_FIT_GAIN : 3); k++) {
            of->at[k] = (float)(fit_uniform(-0.5, 0.5) + (is_affine && k < 9 && k % 4 == 0));
            of->mean[k] = (float)fit_uniform(-0.01, 0.01);
        }
        for (int k = 0; k < FXS_FIT_BASIS; k++)
            of->basis[k] = (float)fit_uniform(-0.2, 0.2);
    }
    memcpy(gains[1], gains[0], sizeof gains[1]);
}

static void fill_poses(fxs_fit_pose poses[2][MOST_GAINS])
{
    for (int i = 0; i < MOST_GAINS; i++) {
        fxs_fit_pose *of = &poses[0][i];
        *of = (fxs_fit_pose){.square = {(float)fit_uniform(0, 0.001), (float)fit_uniform(0, 0.001)},
                             .of_one = {0.3f, 0.01f}, .depth = (float)fit_uniform(0.5, 5)};
        for (int k = 0; k < FXS_FIT_POSE; k++) {
            of->at[k] = (float)fit_uniform(-0.1, 0.1);
            of->mean[k] = (float)fit_uniform(-0.01, 0.01);
        }
    }
    memcpy(poses[1], poses[0], sizeof poses[1]);
}

static void fill_mask(uint8_t *out, int32_t width, int32_t height)
{
    for (int32_t i = 0; i < width * height; i++) {
        const int32_t x = i % width % 40 - 20, y = i / width % 30 - 15;
        out[i] = x * x + y * y < 100 || fit_random() % 9 == 0 ? 0 : (uint8_t)(1 + fit_random() % 255);
    }
}

static void fill_photographs(fxs_fit_photograph *photographs, const what *w, uint8_t *pixels)
{
    static uint8_t masks[MOST_BATCH][MASK_PIXELS];
    const size_t bytes = 3 * (size_t)w->width * (size_t)w->height;
    for (size_t i = 0; i < bytes * MOST_BATCH; i++)
        pixels[i] = (uint8_t)(fit_random() % 5 ? fit_random() % 256 : 255);    /* a fifth of the bytes is 255 */
    for (int i = 0; i < MOST_BATCH; i++) {
        fxs_fit_photograph *p = &photographs[i];
        memset(p, 0, sizeof *p);
        p->pixels = pixels + (size_t)i * bytes;
        p->camera = fit_camera(w->width, w->height, (float)w->width);
        p->camera.eye[2] -= 3 + (float)i;
        p->camera.is_square = w->is_square;
        p->camera.is_antialiased = w->is_antialiased;
        p->width = w->width;
        p->height = w->height;
        p->divisor = 1;
        p->number = w->gains + w->poses ? (uint32_t)(2 * i + 1) % (w->gains ? w->gains : w->poses) : 0;
        if (w->has_masks && i != 1) {
            fill_mask(masks[i], w->width, w->height);
            p->mask = masks[i];
        }
    }
}

static void set_options(fxs_fit_step_options *o, const what *w, uint32_t number)
{
    memset(o, 0, sizeof *o);
    o->sh_degree = w->degree;
    o->number = number;
    o->by_opacity = o->by_scale = w->by_opacity;
    o->gain_rate = 0.05f;
    o->gain_decay = 0.02f;
    o->pose_rate = 0.01f;
    o->smooths = (int)number % 3;
    o->by_flat = w->surfaces ? 0.5f : 0;
    o->by_surface = w->surfaces ? 0.7f : 0;
    o->is_depth = w->surfaces && (MOST_STEPS - (int)number) % 2 != w->surfaces - 1;
    if (w->has_far)
        o->far = (fxs_fit_far){{0.3f, -0.2f, 0.1f}, 0.25f};
    o->noise = (fxs_fit_noise){w->noise, {12345 + number, 67890}, o->far};
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        o->rate[k] = 0.01f;
    for (int c = 0; c < 3; c++)
        o->background[c] = 0.2f * (float)c;
}

/* ---- Comparisons ------------------------------------------------------------------------------------------------- */

static int same(const float *a, const float *b, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (memcmp(&a[i], &b[i], sizeof *a) && !(a[i] != a[i] && b[i] != b[i]))
            return 0;
    return 1;
}

static int planes_same(const float *a, size_t a_stride, const float *b, size_t b_stride, size_t count, size_t planes)
{
    for (size_t k = 0; k < planes; k++)
        if (!same(a + k * a_stride, b + k * b_stride, count))
            return 0;
    return 1;
}

static int models_same(const fxs_fit_model *a, const fxs_fit_model *b)
{
    const size_t n = a->count;
    return CHECK(b->count == n) &&
           CHECK(planes_same(a->parameters, a->stride, b->parameters, b->stride, n, FXS_FIT_PARAMETERS)) &&
           CHECK(planes_same(a->means, a->stride, b->means, b->stride, n, FXS_FIT_PARAMETERS)) &&
           CHECK(planes_same(a->squares, a->stride, b->squares, b->stride, n, FXS_FIT_PARAMETERS)) &&
           CHECK(same(a->by_centre, b->by_centre, n)) && CHECK(same(a->views, b->views, n));
}

static int splats_same(const fxs_fit_stepper *s, const peeked_fit *p, size_t count)
{
    const fxs_fit_splat *splats = s->splats.memory;
    for (size_t i = 0; i < count; i++)
        if (splats[i].depth > 0 ? !same(splats[i].centre, p->splats[i].centre, 15) : p->splats[i].depth > 0)
            return 0;
    return 1;
}

static int lists_same(const fxs_fit_stepper *s, const peeked_fit *p)
{
    const uint32_t *starts = s->counts.memory;
    const fxs_fit_entry *entries = s->entries.memory;
    if (!CHECK(p->entries == s->entry_count) ||
        !CHECK(!memcmp(starts, p->starts, (s->tile_count + 1) * sizeof *starts)))
        return 0;
    for (size_t e = 0; e < s->entry_count; e++)
        if (!CHECK(p->slots[e] < p->entries) || !CHECK(entries[e].splat == p->gaussians[e]) ||
            !CHECK(entries[e].splat == p->splat_of[p->slots[e]])) {
            printf("  entry %zu of %zu: splat %u, not %u\n", e, s->entry_count, (unsigned)p->gaussians[e],
                   (unsigned)entries[e].splat);
            return 0;
        }
    return 1;
}

/* Compares the gradient sums of splats, from number `from_sum` on. */
static int sums_same(const fxs_fit_stepper *s, const peeked_fit *p, int from_sum)
{
    const uint32_t *starts = s->counts.memory, *needed = starts + s->tile_count + 1;
    const fxs_fit_entry *entries = s->entries.memory;
    const float (*sums)[FXS_FIT_SUMS] = s->sums.memory;
    if (!CHECK(!memcmp(needed, p->needed, s->tile_count * sizeof *needed)))
        return 0;
    for (uint32_t tile = 0; tile < s->tile_count; tile++)
        for (uint32_t e = starts[tile]; e < starts[tile] + needed[tile]; e++)
            if (!CHECK(entries[e].blocks == p->blocks[e]) ||
                !CHECK(same(sums[entries[e].slot] + from_sum, p->sums[p->slots[e]] + from_sum,
                            (size_t)(FXS_FIT_SUMS - from_sum))))
                return 0;
    return 1;
}

/* Compares the pixels of a step. After a step with surfaces, these are its depth map and the gradient from it; the
   engines keep the depth map in different planes. */
static int pixels_same(const fxs_fit_stepper *s, const peeked_fit *p, int has_surfaces)
{
    const size_t width = (size_t)s->camera->width, height = (size_t)s->camera->height, size = width * height;
    int found = 1;
    for (size_t c = 0; c < 3; c++)
        for (size_t y = 0; y < height && found; y++) {
            const fxs_fit_loss *l = &s->loss[c];
            const ptrdiff_t row = (ptrdiff_t)y * l->picture.stride;
            const float *const picture = has_surfaces ? p->derivatives : p->picture;
            found = CHECK(same(l->picture.first + row, picture + c * size + y * width, width));
            if (has_surfaces)
                found = found && CHECK(same(s->loss[0].derivatives[0].first + row,
                                            p->derivatives + 3 * size + y * width, width));
            for (size_t k = 0; k < FXS_FIT_DERIVATIVES && found && !has_surfaces; k++)
                found = CHECK(same(l->derivatives[k].first + row,
                                   p->derivatives + (3 * c + k) * size + y * width, width));
            found = found && CHECK(same(l->gradient.first + row, p->gradient + c * size + y * width, width));
        }
    return found;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* Compares every buffer of the last fit step on CUDA with the processor's. `narrow`: initial capacity of the tile
 * lists; 0: default. */
static void compare(const what *w, int is_spoiled, uint32_t narrow, uint32_t steps)
{
    static uint8_t pixels[MOST_BATCH * 3 * 1200 * 900];
    fxs_fit_photograph photographs[MOST_BATCH];
    static fxs_fit_gain gains_of[2][MOST_GAINS];
    static fxs_fit_pose poses_of[2][MOST_GAINS];
    fxs_fit_gains gains[2] = {{gains_of[0], w->gains, w->is_affine}, {gains_of[1], w->gains, w->is_affine}};
    fxs_fit_poses poses[2] = {{poses_of[0], w->poses}, {poses_of[1], w->poses}};
    fxs_fit_camera cameras_of[MOST_BATCH];
    const fxs_fit_cameras cameras = {cameras_of, MOST_BATCH};
    fxs_fit_model here, there;
    fxs_fit_options options;
    const fxs_fit_engine *engine;
    fxs_fit_report of_here, of_there;
    fxs_message why;
    peeked_fit p;
    void *self;
    if (!CHECK(!fxs_fit_model_room(&here, w->count)))
        return;
    fill_model(&here, w);
    if (is_spoiled)
        spoil_model(&here);
    fill_photographs(photographs, w, pixels);
    fxs_fit_options_init(&options);
    options.device_count = 1;
    if (!CHECK(!copy_model(&there, &here)) || !CHECK(!fxs_cuda_fit_engine(&engine, &self, &there, &options, &why)))
        return;
    fxs_fit_stepper *s = fxs_fit_stepper_create(fxs_fit_stages_choose(~0u), fxs_pool_run, pool, 8, NULL);
    fill_gains(gains_of, w->is_affine);
    here.gains = w->gains ? &gains[0] : NULL;
    there.gains = w->gains ? &gains[1] : NULL;
    fill_poses(poses_of);
    here.poses = w->poses ? &poses[0] : NULL;
    there.poses = w->poses ? &poses[1] : NULL;
    for (int i = 0; i < MOST_BATCH; i++)
        cameras_of[i] = photographs[i].camera;
    here.cameras = there.cameras = w->is_antialiased ? &cameras : NULL;
    CHECK(!engine->give(self, &why));
    if (narrow)
        CHECK(!peek_fit_narrow(self, narrow));
    int is_same = 1;
    for (uint32_t i = 1; i <= steps && is_same; i++) {
        fxs_fit_step_options o;
        const uint32_t batch = (uint32_t)w->batch;
        set_options(&o, w, i);
        CHECK(!fxs_fit_stepper_step(s, &here, photographs, batch, &o, &of_here));
        CHECK(!engine->step(self, photographs, batch, &o, i == steps ? &of_there : NULL, &why));
    }
    CHECK(!engine->fetch(self, &why));
    CHECK(of_here.entries == of_there.entries && of_here.visible == of_there.visible);
    CHECK(of_here.absolute == of_there.absolute && of_here.dissimilar == of_there.dissimilar);
    if (CHECK(!peek_fit(self, &photographs[w->batch - 1].camera, &p)))
        is_same = CHECK(splats_same(s, &p, w->count)) && CHECK(lists_same(s, &p)) &&
                  pixels_same(s, &p, w->surfaces) && sums_same(s, &p, w->surfaces ? FXS_FIT_RED : 0) &&
                  models_same(&here, &there) &&
                  CHECK(!memcmp(gains_of[0], gains_of[1], sizeof gains_of[0])) &&
                  CHECK(!memcmp(poses_of[0], poses_of[1], sizeof poses_of[0]));
    if (!CHECK(is_same))
        printf("  %d x %d, square %d, antialiased %d, %zu Gaussians, degree %d, batch %d, %u exposures, affine %d, "
               "%u poses, surfaces %d, spoiled %d\n", (int)w->width, (int)w->height, (int)w->is_square,
               w->is_antialiased, w->count, w->degree, w->batch, (unsigned)w->gains, w->is_affine, (unsigned)w->poses,
               w->surfaces, is_spoiled);
    peek_fit_free(&p);
    fxs_fit_stepper_free(s);
    engine->free(self);
    fxs_fit_model_free(&here);
    fxs_fit_model_free(&there);
}

static void test_steps(void)
{
    static const int32_t sizes[][2] = {{1, 1}, {16, 16}, {37, 27}, {160, 120}, {333, 211}, {640, 480}};
    static const size_t counts[] = {1, 16, 700, 5000, 60000};
    for (int i = 0; i < (quick ? 4 : 40); i++) {
        const int size = quick ? i % 3 : i % 6;
        const what w = {.width = sizes[size][0], .height = sizes[size][1], .is_square = i % 3 == 2,
                        .count = counts[quick ? i % 3 : i % 5], .degree = i % 4, .batch = 1,
                        .by_opacity = i % 4 ? 0 : 0.01f, .noise = i % 3 ? 0 : 50.0f, .near_size = i % 2 ? -3.0f : -1.5f,
                        .has_far = i % 8 < 4};
        compare(&w, i % 4 == 3, 0, MOST_STEPS);
    }
}

static void test_one_depth(void)
{
    const what w = {.width = 37, .height = 27, .count = quick ? 2500 : 20000, .degree = 1, .batch = 1,
                    .near_size = -1.5f, .is_in_one_place = 1};
    compare(&w, 0, 0, 1);
}

static void test_large(void)
{
    for (int i = 0; i < (quick ? 0 : 2); i++) {
        const what w = {.width = 1200, .height = 900, .is_square = i == 1, .count = 200000, .degree = 3, .batch = 1,
                        .near_size = -3.5f};
        compare(&w, 0, 0, 1);
    }
}

static void test_batches(void)
{
    for (int i = 0; i < (quick ? 2 : 8); i++) {
        const what w = {.width = 90, .height = 70, .count = quick ? 200 : 3000, .degree = i % 4, .batch = 2 + i % 2,
                        .by_opacity = i % 2 ? 0 : 0.01f, .near_size = -2.5f};
        compare(&w, i % 4 == 3, 0, MOST_STEPS);
    }
}

static void test_exposures(void)
{
    static const uint32_t gains[] = {MOST_GAINS, 5, 1};
    for (int i = 0; i < (quick ? 4 : 24); i++) {
        const what w = {.width = i % 2 ? 37 : 160, .height = i % 2 ? 27 : 120, .count = quick ? 200 : 3000,
                        .degree = i % 4, .batch = 1 + i % MOST_BATCH, .near_size = -2.5f, .gains = gains[i / 2 % 3],
                        .is_affine = i / (quick ? 2 : 12)};
        compare(&w, i % 4 == 3, 0, MOST_STEPS);
    }
}

static void test_masks(void)
{
    for (int i = 0; i < (quick ? 3 : 12); i++) {
        const what w = {.width = i % 2 ? 37 : 160, .height = i % 2 ? 27 : 120, .count = quick ? 200 : 3000,
                        .degree = i % 4, .batch = 1 + i % MOST_BATCH, .near_size = -2.5f, .gains = i % 3 ? 0 : 7,
                        .is_affine = i % 2, .has_masks = 1};
        compare(&w, i % 4 == 3, 0, MOST_STEPS);
    }
}

static void test_poses(void)
{
    static const size_t counts[] = {200, 3000, 20000};
    for (int i = 0; i < (quick ? 3 : 24); i++) {
        const uint32_t poses = i % 4 ? 5 : 1;
        const what w = {.width = i % 2 ? 37 : 160, .height = i % 2 ? 27 : 120, .count = counts[quick ? 0 : i % 3],
                        .degree = i % 4, .batch = 1 + i % MOST_BATCH, .near_size = -2.5f, .poses = poses,
                        .gains = i % 5 < 2 ? poses : 0};
        compare(&w, i % 4 == 3, 0, MOST_STEPS);
    }
}

static void test_antialiased(void)
{
    static const size_t counts[] = {200, 3000, 20000};
    for (int i = 0; i < (quick ? 3 : 18); i++) {
        const what w = {.width = i % 2 ? 37 : 160, .height = i % 2 ? 27 : 120, .is_square = i % 5 == 3,
                        .count = counts[quick ? 0 : i % 3], .degree = i % 4, .batch = 1 + i % MOST_BATCH,
                        .noise = i % 3 ? 0 : 50.0f, .near_size = i % 4 < 2 ? -4.5f : -2.5f,
                        .poses = i % 6 < 2 ? 5 : 0, .is_antialiased = 1};
        compare(&w, i % 4 == 3, 0, MOST_STEPS);
    }
}

static void test_surfaces(void)
{
    static const size_t counts[] = {200, 3000, 20000};
    for (int i = 0; i < (quick ? 4 : 24); i++) {
        const int size = i / 2 % 3;
        const what w = {.width = size ? size > 1 ? 160 : 37 : 1, .height = size ? size > 1 ? 120 : 27 : 1,
                        .is_square = i % 5 == 3, .count = counts[quick ? 0 : i % 3], .degree = i % 4,
                        .batch = 1 + i % MOST_BATCH, .by_opacity = i % 4 ? 0 : 0.01f, .near_size = -1.5f,
                        .gains = i % 6 < 2 ? 5 : 0, .poses = i % 6 < 3 ? 5 : 0, .has_far = i % 2,
                        .has_masks = i % 3 == 1, .surfaces = 1 + i % 2};
        compare(&w, i % 8 == 7, 0, MOST_STEPS);
    }
}

static void test_no_room(void)
{
    const what w = {.width = 160, .height = 120, .count = quick ? 300 : 5000, .degree = 2, .batch = 1, .near_size = -2};
    const what batch = {.width = 90, .height = 70, .count = 500, .degree = 2, .batch = 2, .near_size = -2, .gains = 7,
                        .poses = 7};
    compare(&w, 0, 64, MOST_STEPS);
    compare(&batch, 0, 64, MOST_STEPS);
    const what surfaces = {.width = 90, .height = 70, .count = 500, .degree = 2, .batch = 2, .near_size = -2,
                           .surfaces = 1};
    compare(&surfaces, 0, 64, MOST_STEPS);
}

static void test_odds(void)
{
    CHECK(peek_fit_odds() == 0);
}

/* ---- Failures ---------------------------------------------------------------------------------------------------- */

static const what ordinary = {.width = 160, .height = 120, .count = 5000, .degree = 3, .batch = 2, .near_size = -2.5f};

static uint64_t hash_of(const fxs_fit_model *m)
{
    uint64_t hash = 14695981039346656037u;
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        for (size_t i = 0; i < m->count; i++) {
            uint32_t bits;
            memcpy(&bits, &m->parameters[k * m->stride + i], sizeof bits);
            hash = (hash ^ bits) * 1099511628211u;
        }
    return hash;
}

static int fit_within(uint64_t max_memory, uint64_t *hash, fxs_message *why)
{
    static uint8_t pixels[MOST_BATCH * 3 * 160 * 120];
    fxs_fit_photograph photographs[MOST_BATCH];
    const fxs_fit_engine *engine;
    fxs_fit_options options;
    fxs_fit_model model;
    void *self;
    if (fxs_fit_model_room(&model, ordinary.count))
        return 1;
    fit_state = 99;
    fill_model(&model, &ordinary);
    fill_photographs(photographs, &ordinary, pixels);
    fxs_fit_options_init(&options);
    options.device_count = 1;
    options.max_memory = max_memory;
    int error = fxs_cuda_fit_engine(&engine, &self, &model, &options, why);
    for (uint32_t i = 0; i <= MOST_STEPS && !error; i++) {
        fxs_fit_step_options o;
        set_options(&o, &ordinary, i);
        error = i ? engine->step(self, photographs, 2, &o, NULL, why) : engine->give(self, why);
    }
    error = error ? error : engine->fetch(self, why);
    if (!error)
        CHECK(!max_memory || peek_fit_bytes(self) <= max_memory);
    *hash = error ? 0 : hash_of(&model);
    if (self)
        engine->free(self);
    fxs_fit_model_free(&model);
    return error;
}

/* A fit with too little memory fails, and succeeds with the memory that its messages ask for. */
static void test_too_little_memory(void)
{
    uint64_t wanted, hash, most = 1000;
    fxs_message why;
    int error = FXS_ERR_MEMORY;
    CHECK(!fit_within(0, &wanted, &why));
    for (int i = 0; i < 40 && error; i++) {
        error = fit_within(most, &hash, &why);
        if (error && (!CHECK(error == FXS_ERR_MEMORY) || !CHECK(why.text[0]) || !CHECK(why.bytes_needed > most)))
            return;
        most = error ? why.bytes_needed : most;
    }
    CHECK(!error && hash == wanted);
}

/* Tests a lost device. This test runs last, because CUDA is unusable in the process afterwards. */
static void test_lost_device(void)
{
    static uint8_t pixels[MOST_BATCH * 3 * 160 * 120];
    fxs_fit_photograph photographs[MOST_BATCH];
    const fxs_fit_engine *engine;
    fxs_fit_step_options o;
    fxs_fit_options options;
    fxs_fit_model model;
    fxs_fit_report report;
    fxs_message why;
    void *self;
    if (!CHECK(!fxs_fit_model_room(&model, ordinary.count)))
        return;
    fill_model(&model, &ordinary);
    fill_photographs(photographs, &ordinary, pixels);
    set_options(&o, &ordinary, 1);
    fxs_fit_options_init(&options);
    options.device_count = 1;
    if (!CHECK(!fxs_cuda_fit_engine(&engine, &self, &model, &options, &why)) || !CHECK(!engine->give(self, &why)))
        return;
    CHECK(!engine->step(self, photographs, 2, &o, NULL, &why));
    peek_fit_lose(self);
    why.text[0] = 0;
    CHECK(engine->step(self, photographs, 2, &o, &report, &why) == FXS_ERR_DEVICE && why.text[0]);
    CHECK(engine->fetch(self, &why) == FXS_ERR_DEVICE);
    engine->free(self);
    CHECK(fxs_cuda_fit_engine(&engine, &self, &model, &options, &why) == FXS_ERR_DEVICE && !self);
    fxs_fit_model_free(&model);
}

int main(int argc, char **argv)
{
    quick = argc > 1 && !strcmp(argv[1], "--quick");
    pool = fxs_pool_create(8);
    RUN(test_odds);
    RUN(test_steps);
    RUN(test_one_depth);
    RUN(test_large);
    RUN(test_batches);
    RUN(test_exposures);
    RUN(test_masks);
    RUN(test_poses);
    RUN(test_antialiased);
    RUN(test_surfaces);
    RUN(test_no_room);
    RUN(test_too_little_memory);
    if (!quick)
        RUN(test_lost_device);
    fxs_pool_destroy(pool);
    return check_report();
}
