/* Tests the cut: the nodes of the level-of-detail trees that a frame draws. The cut must be complete, within the
   budget, and nowhere coarser with a larger budget. The cut must be equal for all kernels, threads and memory sizes. */
#include <string.h>
#include <unistd.h>

#include <fixsplat/system.h>
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/parts.h>
#endif

#include "check.h"
#include "one_scene.h"
#include "src/core/frame.h"
#include "random_tree.h"
#include "src/core/mirror.h"
#include "tree_scene.h"
#include "fastest.h"

enum { WIDTH = TREE_WIDTH, HEIGHT = TREE_HEIGHT, PIXELS = WIDTH * HEIGHT * 4, COUNT = TREE_COUNT };

static fxs_packed_scene packed[3];
static fxs_scene scenes[3];

static void walk(const fxs_scene *scene, uint32_t chunk, const int32_t *drawn, uint32_t whole, uint8_t *to)
{
    whole += drawn[chunk] > 0 ? (uint32_t)drawn[chunk] : 0;
    if (chunk < scene->chunk_count) {
        to[chunk] = (uint8_t)(whole / 4);
        return;
    }
    fxs_node node;
    memcpy(&node, scene->nodes + (size_t)(chunk - scene->chunk_count) * sizeof node, sizeof node);
    fxs_node_turn(&node);
    for (int i = 0; i < 2; i++)
        walk(scene, node.children[i], drawn, whole, to);
}

/* Finds the chunks (256 Gaussians each) that a frame draws. Sets each chunk's share, its weight while levels of
   detail fade, or -1 if the chunk is not drawn. Returns the number of drawn chunks. */
static uint32_t cut_of(const fxs_scene *scene, fxs_camera camera, uint32_t budget, uint32_t detail_q8, int32_t *shares)
{
    unsigned char pixels[4];
    fxs_scene compensated = *scene;
    compensated.antialiased = 1;   /* with antialiasing, the shares of chunks do not depend on the distance */
    const fxs_object object = one_object(&compensated);
    fxs_request request = request_of(&object, 1, camera, budget, pixels);
    fxs_context context;
    fxs_frame f;
    request.options.detail_q8 = detail_q8;
    fxs_context_init(&context, 0);
    const size_t bytes = fxs_request_bytes(&context, &request, 0);
    void *memory = check_aligned(bytes);
    CHECK(!fxs_frame_init(&f, &context, &request, memory, bytes) && !fxs_frame_begin(&f) && f.drawn);
    for (uint32_t i = 0; i < fxs_scene_chunks(scene); i++)
        shares[i] = -1;
    for (uint32_t i = 0; i < f.chunk_count; i++) {
        CHECK(i == 0 || f.drawn[i].chunk > f.drawn[i - 1].chunk);
        shares[f.drawn[i].chunk] = (int32_t)f.drawn[i].share_q8;
    }
    free(memory);
    return f.chunk_count;
}

static int is_seen(const fxs_scene *scene, fxs_camera camera, uint32_t chunk)
{
    fxs_options options;
    fxs_stage_view view;
    fxs_chunk_view cv;
    fxs_options_init(&options);
    CHECK(!one_view_init(&view, scene, &camera, &options));
    return fxs_chunk_view_init(&cv, &view, scene, chunk);
}

static int32_t shares[2][2 * COUNT / FXS_CHUNK + 16];
static uint8_t marks[2][COUNT];

static void test_covered(void)
{
    const fxs_scene *scene = &scenes[0];
    const fxs_camera camera = camera_at(0.9, -3, -7);
    for (uint32_t budget = 1; budget < COUNT; budget += budget / 3 + 1) {
        const uint32_t drawn = cut_of(scene, camera, budget, 0, shares[0]);
        walk(scene, scene->chunk_count, shares[0], 0, marks[0]);
        CHECK(drawn <= (budget / FXS_CHUNK ? budget / FXS_CHUNK : 1));
        for (uint32_t leaf = 0; leaf < scene->chunk_count; leaf++)
            CHECK(marks[0][leaf] <= 64 && (marks[0][leaf] >= 60 || !is_seen(scene, camera, leaf)));
    }
}

static void mark_depths(const fxs_scene *scene, uint32_t chunk, uint8_t depth, uint8_t deepest, const int32_t *drawn,
                        uint8_t *to)
{
    deepest = drawn[chunk] >= 0 ? depth : deepest;
    if (chunk < scene->chunk_count) {
        to[chunk] = deepest;
        return;
    }
    fxs_node node;
    memcpy(&node, scene->nodes + (size_t)(chunk - scene->chunk_count) * sizeof node, sizeof node);
    fxs_node_turn(&node);
    for (int i = 0; i < 2; i++)
        mark_depths(scene, node.children[i], (uint8_t)(depth + 1), deepest, drawn, to);
}

static void check_monotonic(const fxs_scene *scene, fxs_camera camera)
{
    memset(marks[0], 0, sizeof marks[0]);
    for (uint32_t budget = 1; budget < COUNT; budget += budget / 7 + 1) {
        cut_of(scene, camera, budget, 0, shares[0]);
        mark_depths(scene, scene->chunk_count, 0, 255, shares[0], marks[1]);
        for (uint32_t leaf = 0; leaf < scene->chunk_count; leaf++)
            CHECK(marks[1][leaf] >= marks[0][leaf]);
        memcpy(marks[0], marks[1], sizeof marks[0]);
    }
}

static void test_monotonic(void)
{
    check_monotonic(&scenes[0], camera_at(0.9, -3, -7));
    check_monotonic(&scenes[2], camera_at(0.2, -0.5, -1.5));
}

static uint32_t count_grown(const fxs_scene *scene, fxs_camera camera, uint32_t budget)
{
    unsigned char pixels[4];
    const fxs_object object = one_object(scene);
    const fxs_request request = request_of(&object, 1, camera, budget, pixels);
    fxs_context context;
    fxs_frame f;
    uint32_t grown = 0;
    fxs_context_init(&context, 0);
    const size_t bytes = fxs_request_bytes(&context, &request, 0);
    void *memory = check_aligned(bytes);
    CHECK(!fxs_frame_init(&f, &context, &request, memory, bytes) && !fxs_frame_begin(&f) && f.drawn);
    for (uint32_t i = 0; i < f.chunk_count; i++) {
        const fxs_drawn *d = &f.drawn[i];
        CHECK(d->grow_q8 <= 256 && d->share_q8 >= 1 && d->share_q8 <= 1024);
        CHECK(d->chunk >= scene->chunk_count || (!d->grow_q8 && d->share_q8 <= 256));
        grown += d->grow_q8 > 0;
    }
    free(memory);
    return grown;
}

static void test_growth(void)
{
    uint32_t before = 0;
    for (int far = 1; far <= 64; far *= 4) {
        for (uint32_t budget = COUNT / 16; budget < COUNT; budget += budget / 5)
            CHECK(far < 64 || count_grown(&scenes[0], camera_at(0.5 * far, -1.0 * far, -2.0 * far), budget) > 0);
        const uint32_t grown = count_grown(&scenes[0], camera_at(0.5 * far, -1.0 * far, -2.0 * far), COUNT / 4);
        CHECK(grown >= before);
        before = grown;
    }
    CHECK(before > 0);
}

/* A chunk that fades between levels of detail has a share. The share changes an opacity to 1 - (1 - opacity)^share.
   Share 256 (1.0 in Q8) keeps the opacity. */
static void test_shares(void)
{
    for (uint32_t law = 0; law < FXS_OPACITY_LAWS; law++)
        for (uint32_t code = 1; code < 256; code++) {
            const uint32_t offset_q11 = fxs_offset_of_code_q11[law][code];
            uint32_t before = FXS_FAINT_Q11 + 1;
            CHECK(fxs_share_of_q11(offset_q11, 256) == offset_q11);
            for (uint32_t share_q8 = 1; share_q8 <= 4096; share_q8 += share_q8 / 16 + 1) {
                const uint32_t of_share = fxs_share_of_q11(offset_q11, share_q8);
                CHECK(of_share <= before + 1);
                before = of_share;
            }
        }
}

static void test_detail(void)
{
    const fxs_scene *scene = &scenes[0];
    const fxs_camera camera = camera_at(0.9, -3, -7);
    uint32_t before = INT32_MAX;
    for (uint32_t detail_q8 = 8; detail_q8 < 256 << 8; detail_q8 *= 2) {
        const uint32_t drawn = cut_of(scene, camera, 0, detail_q8, shares[0]);
        const uint32_t both = cut_of(scene, camera, 20 * FXS_CHUNK, detail_q8, shares[1]);
        /* allows a quarter more, since a coarse chunk that fades is drawn together with its finer chunks */
        CHECK(drawn <= before + before / 4 && both <= 20);
        before = drawn;
    }
    CHECK(before < scene->chunk_count / 8);
}

static unsigned char pictures[3][PIXELS];

static void check_same(const fxs_request *first, int picture)
{
    fxs_request request = *first;
    fxs_context context;
    fxs_pool *pool = fxs_pool_create(3);
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run, .workers.pool = pool,
                               .workers.count = 3};
    fxs_frame_memory sizes;
    fxs_context_init(&context, 0);
    const size_t bytes = fxs_request_bytes(&context, first, &sizes);
    request.targets[0].colour.pixels = pictures[picture];
    draw(&context, first, bytes);
    for (size_t less = bytes / 2; less > sizes.least; less /= 2) {
        memset(pictures[picture], 1, PIXELS);
        draw(&context, &request, less);
        CHECK(!memcmp(pictures[0], pictures[picture], PIXELS));
    }
    fxs_context_init(&context, &config);
#ifdef FXS_WITH_KERNELS
    context.config.kernels = kernels_for(fxs_cpu_detect());
#endif
    memset(pictures[picture], 1, PIXELS);
    draw(&context, &request, 0);
    CHECK(!memcmp(pictures[0], pictures[picture], PIXELS));
    fxs_pool_destroy(pool);
}

static double mean_error(const unsigned char *a, const unsigned char *b)
{
    double sum = 0;
    for (int i = 0; i < PIXELS; i++)
        sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sum / PIXELS;
}

static void test_same_bytes(void)
{
    static unsigned char whole[PIXELS];
    fxs_context context;
    fxs_context_init(&context, 0);
    for (int profile = 0; profile < 3; profile++) {
        const fxs_object object = one_object(&scenes[profile]);
        fxs_request request = request_of(&object, 1, camera_at(0.9, -3, -7), 0, whole);
        double before = 1e9;
        draw(&context, &request, 0);
        request.targets[0].colour.pixels = pictures[0];
        for (uint32_t budget = COUNT / 16; budget < COUNT; budget *= 4) {
            request.options.budget = budget;
            check_same(&request, 1);
            const double error = mean_error(whole, pictures[0]);
            printf("  profile %d, budget %u: mean squared error %.1f\n", profile, budget, error);
            CHECK(error < before);
            before = error;
        }
        request.options.budget = COUNT;
        CHECK(draw(&context, &request, 0).drawn == scenes[profile].chunk_count * FXS_CHUNK);
        CHECK(!memcmp(whole, pictures[0], PIXELS));
        request.options.budget = UINT32_MAX;
        draw(&context, &request, 0);
        CHECK(!memcmp(whole, pictures[0], PIXELS));
    }
}

static void test_level_colours(void)
{
    const fxs_object object = one_object(&scenes[0]);
    fxs_request request = request_of(&object, 1, camera_at(0.9, -3, -7), COUNT / 8, pictures[0]);
    request.options.show_levels = 1;
    check_same(&request, 1);
    for (int whole = 0; whole < 2; whole++) {
        fxs_context context;
        int coloured = 0;
        fxs_context_init(&context, 0);
        request.options.budget = whole ? 0 : request.options.budget;
        draw(&context, &request, 0);
        for (int i = 0; i < PIXELS; i += 4)
            coloured += pictures[0][i] != pictures[0][i + 1] || pictures[0][i] != pictures[0][i + 2];
        CHECK(whole ? coloured == 0 : coloured > PIXELS / 4 / 16);
    }
}

static void test_window(void)
{
    const fxs_object object = one_object(&scenes[0]);
    fxs_context context;
    const fxs_camera whole = camera_at(0.3, -1, -3);
    fxs_request request = request_of(&object, 1, whole, COUNT / 5, pictures[0]);
    fxs_context_init(&context, 0);
    draw(&context, &request, 0);
    fxs_camera *c = &request.cameras[0];
    *c = (fxs_camera){.width = 96, .height = 64, .whole_width = WIDTH, .whole_height = HEIGHT, .whole_x = 112,
                      .whole_y = 64, .fx_q12 = whole.fx_q12, .fy_q12 = whole.fy_q12,
                      .cx_q12 = whole.cx_q12 - (112 << 12), .cy_q12 = whole.cy_q12 - (64 << 12),
                      .near_q32 = whole.near_q32};
    memcpy(c->rotation_q30, whole.rotation_q30, sizeof c->rotation_q30);
    memcpy(c->position_q32, whole.position_q32, sizeof c->position_q32);
    request.targets[0].colour = (fxs_image){pictures[1], 4 * 96};
    draw(&context, &request, 0);
    for (int row = 0; row < 64; row++)
        CHECK(!memcmp(pictures[1] + row * 4 * 96, pictures[0] + ((row + 64) * WIDTH + 112) * 4, 4 * 96));
}

static void test_objects(void)
{
    fxs_object objects[3] = {one_object(&scenes[0]), one_object(&scenes[1]), one_object(&scenes[0])};
    fxs_scene plain = scenes[2];
    plain.nodes = plain.node_chunks = plain.node_rows = 0;
    objects[1].translation_q32[2] = 20 * FXS_ONE_Q32;
    objects[2].scene = &plain;
    objects[2].translation_q32[0] = 3 * FXS_ONE_Q32;
    fxs_request request = request_of(objects, 2, camera_at(0.9, -3, -7), COUNT / 4, pictures[0]);
    check_same(&request, 1);
    request.count = 3;
    check_same(&request, 1);
    fxs_context context;
    fxs_context_init(&context, 0);
    const fxs_stats stats = draw(&context, &request, 0);
    CHECK(stats.drawn >= plain.chunk_count * FXS_CHUNK && stats.drawn <= plain.chunk_count * FXS_CHUNK + 2 * FXS_CHUNK);
    objects[0].visible = 0;
    CHECK(draw(&context, &request, 0).drawn <= (plain.chunk_count + 1) * FXS_CHUNK);
}

/* Returns a camera that shows a part of a picture that is 64 pixels wider, from column x on. As a window, it draws the
   cut of the wider picture. */
static fxs_camera part_of_wider(int32_t x, int is_window)
{
    fxs_camera camera = camera_at(0.9, -3, -7);
    camera.cx_q12 += (32 - x) * 4096;
    if (is_window) {
        camera.whole_width = WIDTH + 64;
        camera.whole_height = HEIGHT;
        camera.whole_x = x;
    }
    return camera;
}

static void draw_eyes(fxs_request *request, fxs_camera left, fxs_camera right)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    request->eyes = 2;
    request->cameras[0] = left;
    request->cameras[1] = right;
    request->targets[1] = request->targets[0];
    request->targets[1].colour.pixels = pictures[1];
    draw(&context, request, 0);
}

/* Two eyes draw one cut. From one place, the eyes see the left and the right part of a wider picture, so the cut is
   that of the wider picture. */
static void test_eyes(void)
{
    static unsigned char swapped[PIXELS];
    const fxs_object object = one_object(&scenes[0]);
    const fxs_camera left = camera_at(0.9, -3, -7), right = camera_at(-2, -1, -1.5);
    fxs_context context;
    fxs_request request = request_of(&object, 1, left, COUNT / 5, pictures[0]);
    fxs_request one = request;
    fxs_context_init(&context, 0);
    one.targets[0].colour.pixels = pictures[2];
    draw_eyes(&request, part_of_wider(0, 0), part_of_wider(64, 0));
    for (int eye = 0; eye < 2; eye++) {
        one.cameras[0] = part_of_wider(64 * eye, 1);
        draw(&context, &one, 0);
        CHECK(!memcmp(pictures[2], pictures[eye], PIXELS));
    }
    draw_eyes(&request, left, right);
    memcpy(swapped, pictures[1], PIXELS);
    one.cameras[0] = left;
    draw(&context, &one, 0);
    CHECK(memcmp(pictures[2], pictures[0], PIXELS));
    draw_eyes(&request, right, left);
    CHECK(!memcmp(pictures[0], swapped, PIXELS));
    fxs_camera away = left;
    for (int i = 0; i < 9; i++)
        away.rotation_q30[i] *= i / 3 == 1 ? 1 : -1;
    draw_eyes(&request, left, away);
    CHECK(!memcmp(pictures[2], pictures[0], PIXELS));
}

static void test_eyes_covered(void)
{
    const fxs_scene *scene = &scenes[0];
    const fxs_camera cameras[] = {camera_at(0.9, -3, -7), camera_at(-2, -1, -1.5)};
    const fxs_object object = one_object(scene);
    fxs_options options;
    fxs_options_init(&options);
    for (options.budget = FXS_CHUNK; options.budget < COUNT; options.budget += options.budget / 3 + 1) {
        uint32_t count;
        fxs_drawn *drawn = find_cut(&object, 1, cameras, 2, &options, &count);
        CHECK(count <= options.budget / FXS_CHUNK);
        for (uint32_t i = 0; i < fxs_scene_chunks(scene); i++)
            shares[0][i] = -1;
        for (uint32_t i = 0; i < count; i++)
            shares[0][drawn[i].chunk] = 1;
        mark_depths(scene, scene->chunk_count, 0, 255, shares[0], marks[0]);
        for (uint32_t leaf = 0; leaf < scene->chunk_count; leaf++)
            CHECK(marks[0][leaf] != 255 || (!is_seen(scene, cameras[0], leaf) && !is_seen(scene, cameras[1], leaf)));
        free(drawn);
    }
}

typedef struct partial {
    fxs_scene scene;
    const fxs_scene *whole;
    uint32_t *places;
    unsigned char *rows;
    uint32_t held, room, wanted, known;
    uint32_t asked[64];
} partial;

static void note_wanted(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    partial *p = argument;
    CHECK(scene == &p->scene && chunk < fxs_scene_chunks(scene) && there == (p->places[chunk] != FXS_NOTHING));
    if (!there && p->wanted < 64)
        p->asked[p->wanted] = chunk;
    p->wanted += !there;
    p->known += there != 0;
}

static partial partial_of(const fxs_scene *whole, uint32_t room)
{
    partial p = {.scene = *whole, .whole = whole, .room = room};
    p.places = malloc(fxs_scene_chunks(whole) * sizeof *p.places);
    p.rows = check_aligned((size_t)room * whole->chunk_bytes);
    memset(p.places, 0xff, fxs_scene_chunks(whole) * sizeof *p.places);
    p.scene.places = p.places;
    p.scene.rows = p.rows;
    return p;
}

static void fetch(partial *p, uint32_t chunk)
{
    if (p->held == p->room)
        return;
    memcpy(p->rows + (size_t)p->held * p->scene.chunk_bytes, fxs_rows(p->whole, chunk), p->scene.chunk_bytes);
    p->places[chunk] = p->held++;
}

static void test_in_part(void)
{
    static unsigned char wanted[PIXELS];
    const fxs_object whole = one_object(&scenes[0]);
    fxs_context context;
    fxs_request request = request_of(&whole, 1, camera_at(0.9, -3, -7), COUNT / 4, wanted);
    fxs_context_init(&context, 0);
    const fxs_stats all = draw(&context, &request, 0);
    partial p = partial_of(&scenes[0], 2 * all.drawn / FXS_CHUNK + 2);
    const fxs_object object = one_object(&p.scene);
    double first = 0, last = 0;
    int frames = 0;
    request = request_of(&object, 1, camera_at(0.9, -3, -7), COUNT / 4, pictures[0]);
    request.options.want.call = note_wanted;
    request.options.want.argument = &p;
    fxs_stats stats;
    do {
        p.wanted = p.known = 0;
        stats = draw(&context, &request, 0);
        CHECK(stats.missing == p.wanted && (frames || stats.drawn == 0));
        last = mean_error(wanted, pictures[0]);
        first = frames == 1 ? last : first;
        for (uint32_t i = 0; i < p.wanted && i < 8; i++)
            fetch(&p, p.asked[i]);
        if (!frames)
            fetch(&p, p.scene.chunk_count);
    } while (stats.missing && ++frames < 1000);
    printf("  %d frames, error %.1f after the root, %.1f at the end\n", frames, first, last);
    CHECK(frames > 10 && frames < 1000 && last == 0 && first > 100);
    request.cameras[1] = request.cameras[0];
    request.targets[1] = request.targets[0];
    for (request.eyes = 1; request.eyes <= 2; request.eyes++) {
        p.wanted = p.known = 0;
        const size_t bytes = fxs_request_bytes(&context, &request, 0);
        void *memory = check_aligned(bytes);
        CHECK(!fxs_foresee(&context, &request, memory, bytes) && !p.wanted && p.known == stats.drawn / FXS_CHUNK);
        free(memory);
    }
    free(p.places);
    free(p.rows);
}

/* Moves over a scene with a small pool on a device, which is simulated in memory, and then stands still. */
static void test_mirror(void)
{
    enum { ROOM = 130, UPLOADS = 5, FLIGHT = 60, FRAMES = 200 };
    static unsigned char wanted[PIXELS];
    fxs_context context;
    fxs_mirror m;
    fxs_stats stats = {0};
    partial p = partial_of(&scenes[0], fxs_scene_chunks(&scenes[0]));
    const uint64_t each = fxs_mirror_place_bytes(&p.scene);
    unsigned char *rows = check_aligned(ROOM * (size_t)p.scene.chunk_bytes);
    void *memory = malloc((size_t)fxs_mirror_bytes(&p.scene, ROOM));
    fxs_context_init(&context, 0);
    CHECK(!fxs_places_room(&p.scene, 16 * each - 1, each) && fxs_places_room(&p.scene, ROOM * each, each) == ROOM);
    fetch(&p, p.scene.chunk_count);
    fxs_mirror_init(&m, &p.scene, ROOM, memory);
    m.scene.rows = rows;
    const fxs_object whole = one_object(&scenes[0]), object = one_object(&m.scene);
    for (uint32_t frame = 1; frame <= FRAMES; frame++) {
        const uint32_t way = frame < FLIGHT ? frame : FLIGHT, *places;
        fxs_request request = request_of(&object, 1, camera_at(0.2 * way - 6, -3, -7), COUNT / 4, pictures[0]);
        request.options.want.call = fxs_mirror_want;
        p.wanted = 0;
        fxs_mirror_begin(&m, frame, frame - 1, &(fxs_want){note_wanted, &p});
        stats = draw(&context, &request, 0);
        const uint32_t count = fxs_mirror_step(&m, UPLOADS * each, &places);
        CHECK(count <= UPLOADS);
        for (uint32_t i = 0; i < count; i++)
            memcpy(rows + (size_t)places[i] * p.scene.chunk_bytes, fxs_rows(&p.scene, fxs_mirror_chunk(&m, places[i])),
                   p.scene.chunk_bytes);
        for (uint32_t i = 0; i < p.wanted && i < 8; i++)
            fetch(&p, p.asked[i]);
        request.objects = &whole;
        request.targets[0].colour.pixels = wanted;
        request.options.want.call = 0;
        if (!stats.missing)
            draw(&context, &request, 0);
        CHECK(stats.missing || !memcmp(wanted, pictures[0], PIXELS));
    }
    CHECK(!stats.missing && m.pool.there == ROOM && m.scene.places[p.scene.chunk_count] != FXS_NOTHING);
    free(memory);
    free(rows);
    free(p.places);
    free(p.rows);
}

static void test_damage(void)
{
    const size_t bytes = packed[2].bytes;
    unsigned char *data = check_aligned(bytes);
    fxs_scene scene;
    fxs_context context;
    uint32_t random = 1, refused = 0, drawn = 0;
    fxs_context_init(&context, 0);
    for (int round = 0; round < 300; round++) {
        memcpy(data, packed[2].data, bytes);
        CHECK(!fxs_scene_open(&scene, data, bytes));
        const size_t nodes = (size_t)(scene.nodes - data), node_bytes = (scene.chunk_count - 1) * sizeof(fxs_node);
        for (int i = 0; i < 1 + round % 40; i++) {
            random = random * 1664525 + 1013904223;
            size_t at = nodes + random % (round % 2 ? 16 * sizeof(fxs_node) : node_bytes);
            at += round % 4 == 0 && (at - nodes) % 16 < 8 ? 8 : 0;
            random = random * 1664525 + 1013904223;
            data[at] = round % 3 && round % 4 ? (unsigned char)(random >> 24)
                                              : data[at] ^ (unsigned char)(1u << (random >> 29) >> (round % 4 ? 0 : 2));
        }
        const fxs_object object = one_object(&scene);
        fxs_request request = request_of(&object, 1, camera_at(0.9, -3, -7), COUNT / 3, pictures[0]);
        const size_t room = fxs_request_bytes(&context, &request, 0);
        void *memory = check_aligned(room);
        const int error = fxs_render(&context, &request, memory, room, 0);
        CHECK(!error || error == FXS_ERR_SCENE);
        refused += error != 0;
        drawn += error == 0;
        free(memory);
    }
    printf("  %u refused, %u drawn\n", refused, drawn);
    CHECK(refused > 50 && drawn > 10);
    free(data);
}

int main(void)
{
    for (int profile = 0; profile < 3; profile++)
        if (!pack_tree("knot", (enum fxs_profile)profile, &packed[profile], &scenes[profile]))
            return puts("FAIL cannot make the scenes"), 1;
    RUN(test_covered);
    RUN(test_monotonic);
    RUN(test_growth);
    RUN(test_shares);
    RUN(test_detail);
    RUN(test_same_bytes);
    RUN(test_level_colours);
    RUN(test_window);
    RUN(test_objects);
    RUN(test_eyes);
    RUN(test_eyes_covered);
    RUN(test_in_part);
    RUN(test_mirror);
    RUN(test_damage);
    for (int profile = 0; profile < 3; profile++)
        fxs_packed_scene_free(&packed[profile]);
    return check_report();
}
