/* Tests the refinement of levels of detail against photographs. Pictures within a budget must come closer to the
   full picture. Damaged options and trees are refused. */
#include <stdlib.h>

#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/view_more.h>
#include "src/core/chunk.h"
#include "scene_bytes.h"
#include "fastest.h"

enum { COUNT = 3000, ODD = 700, WIDTH = 72, HEIGHT = 48, VIEWS = 6, STEPS = 80 };

static fxs_gaussian made[COUNT];
static fxs_view views[VIEWS];

static long read_made(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const uint64_t count = *(const uint64_t *)argument;
    const size_t some = count - first < capacity ? (size_t)(count - first) : capacity;
    memcpy(out, made + first, some * sizeof *out);
    return (long)some;
}

static float number(uint32_t *state)
{
    return (float)((*state = *state * 1664525 + 1013904223) >> 8) / 8388608 - 1;
}

/* Makes a ball of Gaussians with a pattern of squares in two colours, and as many hidden Gaussians inside. */
static void make(void)
{
    uint32_t state = 3;
    memset(made, 0, sizeof made);
    for (int i = 0; i < COUNT; i++) {
        fxs_gaussian *g = &made[i];
        float square = 0;
        int squares = 0;
        for (int k = 0; k < 3; k++) {
            g->position[k] = number(&state);
            square += g->position[k] * g->position[k];
        }
        for (int k = 0; k < 3; k++) {
            g->position[k] /= sqrtf(square + 1e-6f);
            squares += (int)(g->position[k] * 2 + 9);
            g->scale[k] = -2.5f + 0.3f * number(&state);
            g->position[k] *= i % 2 ? 1 : 0.5f;
        }
        for (int k = 0; k < 4; k++)
            g->rotation[k] = number(&state) + (k == 0);
        g->opacity = 4 + number(&state);
        for (int k = 0; k < 3; k++)
            g->dc[k] = (squares % 2 ? 1.2f : -1.2f) * (k == 1 ? -1.0f : 1.0f) + (i % 2 ? 0.1f : 2.0f) * number(&state);
        for (int k = 0; k < 9; k++)
            g->sh[k] = 0.05f * number(&state);
    }
}

static int pack(fxs_packed_scene *packed, uint64_t count, const fxs_pack_options *options, int antialiased)
{
    const fxs_gaussian_source source = {count, 1, antialiased, read_made, &count, {0}};
    fxs_scene_file *file;
    fxs_pack_report report;
    if (!CHECK(!fxs_scene_file_open_gaussians("made", &source, NULL, &file, &info, &message)))
        return 0;
    const int error = fxs_pack(file, &info, packed, &report, options, &message);
    fxs_scene_file_close(file);
    return CHECK(!error);
}

static void make_views(void)
{
    static const double target[3] = {0, 0, 0}, up[3] = {0, -1, 0};
    for (int i = 0; i < VIEWS; i++) {
        const double angle = 6.283185307179586 * i / VIEWS, eye[3] = {3 * sin(angle), -0.8, -3 * cos(angle)};
        CHECK(!fxs_view_look_at(&views[i], eye, target, up, &(fxs_picture){50, WIDTH, HEIGHT}, &message));
    }
}

static int refine_with(const fxs_packed_scene *packed, uint32_t steps, uint32_t threads, unsigned cpu,
                       size_t view_count)
{
    fxs_pool *pool = fxs_pool_create(threads);
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run, .workers.pool = pool,
                               .workers.count = threads};
    fxs_context context;
    const fxs_refine_options options = {.size = sizeof(fxs_refine_options), .context = &context, .steps = steps,
                                        .views = view_count ? views : NULL,
                                        .view_count = view_count, .cpu = cpu};
    fxs_context_init(&context, &config);
    context.config.kernels = kernels_for(cpu);
    const int error = fxs_refine(packed->data, packed->bytes, &options, &message);
    fxs_pool_destroy(pool);
    return error;
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

static void draw(const fxs_packed_scene *packed, const fxs_view *view, uint32_t budget, uint8_t *rgba)
{
    fxs_context context;
    fxs_object object;
    fxs_request request;
    fxs_scene scene;
    void *memory;
    fxs_context_init(&context, NULL);
    CHECK(!fxs_scene_open(&scene, packed->data, packed->bytes));
    fxs_object_init(&object, &scene);
    fxs_request_init(&request, &object, 1);
    request.options.budget = budget;
    request.targets[0].colour = (fxs_image){rgba, 4 * WIDTH};
    CHECK(!fxs_camera_from_view(&request.cameras[0], view, &message));
    const size_t room = fxs_request_bytes(&context, &request, NULL);
    if (!CHECK(room && !posix_memalign(&memory, 64, room)))
        return;
    CHECK(!fxs_render(&context, &request, memory, room, NULL));
    free(memory);
}

static double error_of(const fxs_packed_scene *packed, uint32_t budget)
{
    static uint8_t whole[4 * WIDTH * HEIGHT], some[sizeof whole];
    static const double middle[3] = {0, 0, 0}, up[3] = {0, -1, 0};
    double sum = 0;
    for (int i = 0; i < VIEWS; i++) {
        fxs_view view = views[i];
        fxs_view_orbit(&view, middle, up, 0.5);
        draw(packed, &view, 0, whole);
        draw(packed, &view, budget, some);
        for (size_t p = 0; p < sizeof whole; p++)
            sum += (whole[p] - some[p]) * (whole[p] - some[p]);
    }
    return sum / (VIEWS * sizeof whole);
}

static void check_better(enum fxs_profile profile, int antialiased)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = profile, .tree = 1};
    fxs_packed_scene packed, measured;
    if (!pack(&packed, COUNT, &options, antialiased) || !pack(&measured, COUNT, &options, antialiased))
        return;
    const double before[2] = {error_of(&packed, COUNT / 2), error_of(&packed, COUNT / 8)};
    CHECK(!refine_with(&packed, STEPS, 1, 0, VIEWS) && !refine_with(&measured, 0, 1, 0, VIEWS));
    const double after[2] = {error_of(&packed, COUNT / 2), error_of(&packed, COUNT / 8)};
    const double by_gains[2] = {error_of(&measured, COUNT / 2), error_of(&measured, COUNT / 8)};
    printf("  profile %d, antialiased %d: %.2f %.2f, measured %.2f %.2f, refined %.2f %.2f\n", (int)profile,
           antialiased, before[0], before[1], by_gains[0], by_gains[1], after[0], after[1]);
    CHECK(by_gains[0] < 0.8 * before[0] && after[0] < 0.7 * before[0]);
    CHECK(after[1] < 380 && after[1] < 0.75 * before[1]);
    fxs_packed_scene_free(&packed);
    fxs_packed_scene_free(&measured);
}

static void check_same(size_t view_count, uint64_t count)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .tree = 1};
    fxs_packed_scene first, other;
    if (!pack(&first, count, &options, 0))
        return;
    CHECK(!refine_with(&first, 3, 1, 0, view_count));
    for (uint32_t threads = 2; threads <= (view_count ? 3u : 2u); threads++)
        if (pack(&other, count, &options, 0)) {
            CHECK(!refine_with(&other, 3, threads, ~0u, view_count));
            CHECK(first.bytes == other.bytes && !memcmp(first.data, other.data, first.bytes));
            fxs_packed_scene_free(&other);
        }
    fxs_packed_scene_free(&first);
}

static void check_kept(void)
{
    const fxs_pack_options with = {.size = sizeof(fxs_pack_options), .tree = 1};
    fxs_packed_scene packed, plain;
    fxs_scene scene;
    if (!pack(&packed, COUNT, &with, 0) || !pack(&plain, COUNT, NULL, 0))
        return;
    CHECK(!refine_with(&packed, STEPS, 2, ~0u, VIEWS) && !fxs_scene_open(&scene, packed.data, packed.bytes));
    CHECK(!memcmp((char *)packed.data + 8, (char *)plain.data + 8, plain.bytes - 8));
    for (uint32_t i = 0; i + 1 < scene.chunk_count; i++) {
        fxs_node node;
        fxs_chunk own, below;
        CHECK(!fxs_node_read(&node, &scene, i) && !fxs_chunk_read(&own, &scene, scene.chunk_count + i));
        for (int side = 0; side < 2; side++) {
            CHECK(!fxs_chunk_read(&below, &scene, node.children[side]));
            CHECK(below.scale_q16 <= own.scale_q16 + 1);
            for (int k = 0; k < 3; k++) {
                const int64_t reach = (int64_t)own.step_q32[k] * 65535 << own.step_shift;
                const int64_t reach_below = (int64_t)below.step_q32[k] * 65535 << below.step_shift;
                CHECK(below.origin_q32[k] >= own.origin_q32[k] - reach / 1000);
                CHECK(below.origin_q32[k] + reach_below <= own.origin_q32[k] + reach + reach / 1000);
            }
        }
    }
    CHECK(!fxs_file_seal(packed.data, packed.bytes));
    fxs_packed_scene_free(&packed);
    fxs_packed_scene_free(&plain);
}

static int stop(void *calls, double done)
{
    CHECK(done >= 0 && done <= 1);
    return ++*(int *)calls == 5;
}

static void check_refused(void)
{
    const fxs_pack_options with = {.size = sizeof(fxs_pack_options), .tree = 1};
    fxs_packed_scene packed, plain;
    fxs_context context;
    fxs_scene scene;
    int calls = 0;
    if (!pack(&packed, COUNT, &with, 0) || !pack(&plain, COUNT, NULL, 0))
        return;
    fxs_context_init(&context, NULL);
    fxs_refine_options options = {.size = sizeof(fxs_refine_options), .context = &context,
                                  .steps = FXS_REFINE_STEPS_MOST + 1, .views = views,
                                  .view_count = VIEWS};
    CHECK(fxs_refine(packed.data, packed.bytes, &options, &message) == FXS_ERR_ARGUMENT);
    options.steps = 2;
    options.context = NULL;
    CHECK(fxs_refine(packed.data, packed.bytes, &options, &message) == FXS_ERR_ARGUMENT);
    options.context = &context;
    CHECK(fxs_refine(packed.data, packed.bytes - 64, &options, &message) == FXS_ERR_SCENE);
    CHECK(fxs_refine(plain.data, plain.bytes, &options, &message) == 0);
    options.views = NULL;
    CHECK(fxs_refine(packed.data, packed.bytes, &options, &message) == FXS_ERR_ARGUMENT);
    options.views = views;
    options.progress = (fxs_progress){stop, &calls};
    CHECK(fxs_refine(packed.data, packed.bytes, &options, &message) == FXS_ERR_STOPPED && calls == 5);
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    fxs_packed_scene_free(&packed);
    fxs_packed_scene_free(&plain);
}

static void check_damaged(void)
{
    const fxs_pack_options with = {.size = sizeof(fxs_pack_options), .tree = 1};
    fxs_packed_scene packed;
    fxs_scene scene;
    uint32_t state = 1, refused = 0, refined = 0;
    if (!pack(&packed, 1000, &with, 0) || !CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes)))
        return;
    unsigned char *const whole = malloc(packed.bytes), *const data = packed.data;
    const size_t tree = (size_t)(scene.nodes - data), heads = (size_t)(scene.node_rows - scene.nodes);
    memcpy(whole, data, packed.bytes);
    for (uint32_t round = 0; round < 60; round++) {
        memcpy(data, whole, packed.bytes);
        for (uint32_t i = 0; i < 1 + round % 4; i++) {
            state = state * 1664525 + 1013904223;
            data[tree + (state >> 8) % heads] ^= (unsigned char)(1u << (state >> 29));
        }
        const int error = refine_with(&packed, round % 2, 1, ~0u, 1);
        CHECK(!error || error == FXS_ERR_SCENE);
        refused += error != 0;
        refined += error == 0;
    }
    printf("  %u refused, %u refined\n", (unsigned)refused, (unsigned)refined);
    CHECK(refused > 5 && refined > 5);
    free(whole);
    fxs_packed_scene_free(&packed);
}

static void check_shared(void)
{
    const fxs_pack_options with = {.size = sizeof(fxs_pack_options), .tree = 1};
    fxs_packed_scene packed;
    fxs_scene scene;
    uint32_t state = 7;
    if (!pack(&packed, COUNT, &with, 0) || !CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes)))
        return;
    const uint32_t leaves = scene.chunk_count;
    fxs_node *const nodes = (fxs_node *)(void *)((unsigned char *)packed.data + (scene.nodes - scene.chunks) +
                                                 sizeof(fxs_packed_header));
    for (int round = 0; round < 20; round++) {
        for (uint32_t i = 0; i + 1 < leaves; i++)
            for (uint32_t side = 0; side < 2; side++) {
                state = state * 1664525 + 1013904223;
                const uint32_t later = leaves - 2 - i, any = state >> 8;
                const uint32_t child = later > 1 && state >> 30 ? leaves + i + 1 + any % later : any % leaves;
                nodes[i].children[side] = fxs_little_32(child);
            }
        CHECK(refine_with(&packed, 0, 1, ~0u, 1) == FXS_ERR_SCENE);
    }
    fxs_packed_scene_free(&packed);
}

static void check_odd(void)
{
    const fxs_pack_options with = {.size = sizeof(fxs_pack_options), .tree = 1};
    fxs_packed_scene packed;
    for (int far = 0; far < 2; far++) {
        for (int i = 0; i < ODD; i++)
            for (int k = 0; k < 3; k++)
                made[i].position[k] = far ? (float)(i % (7 + k)) * 1e7f : 0.5f;
        if (pack(&packed, ODD, &with, 0)) {
            CHECK(!refine_with(&packed, 2, 2, ~0u, far ? VIEWS : 0));
            CHECK(!fxs_file_seal(packed.data, packed.bytes));
            fxs_packed_scene_free(&packed);
        }
    }
}

int main(void)
{
    make();
    make_views();
    RUN_AS("better", check_better(FXS_PROFILE_DEFAULT, 0));
    RUN_AS("better_antialiased", check_better(FXS_PROFILE_DEFAULT, 1));
    RUN_AS("better_compact", check_better(FXS_PROFILE_COMPACT, 0));
    RUN_AS("better_small", check_better(FXS_PROFILE_SMALL, 0));
    RUN_AS("kept", check_kept());
    RUN_AS("same_bytes", check_same(VIEWS, COUNT));
    RUN_AS("same_bytes_from_around", check_same(0, 300));
    RUN_AS("refused", check_refused());
    RUN_AS("damaged", check_damaged());
    RUN_AS("shared", check_shared());
    RUN_AS("odd", check_odd());
    return check_report();
}
