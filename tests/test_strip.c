/* Pictures rendered in strips of rows, and by the turntable of boards, must equal fxs_render byte for byte.
   test_strip SCENE.fxs WIDTH HEIGHT FRAMES [BUDGET] prints the hashes that a board's firmware should print.
   test_strip SCREEN.ppm prints the hash of a screen's picture. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/board.h>
#include "port/board/turntable.h"
#include <fixsplat/system.h>
#include <fixsplat/internal/stage.h>
#include "one_scene.h"
#include "check.h"
#include "random_scene.h"

#define WIDTH_MOST 330
#define HEIGHT_MOST 250

static fxs_options options = {.size = sizeof(fxs_options), .sh_degree = 3, .background = {0x11, 0x13, 0x1b}};

typedef struct collected {
    unsigned char *pixels;
    int32_t row_bytes, next, strips;
    void *other;   /* buffer that the callback gives for the next strip; null: all strips share a buffer */
    int error;                     /* error that the callback returns at the second strip; 0: none */
} collected;

static int collect(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    collected *c = argument;
    CHECK(first == c->next);
    c->next = first + rows;
    for (int32_t row = 0; row < rows; row++)
        memcpy(c->pixels + (size_t)(first + row) * (size_t)c->row_bytes,
               (unsigned char *)strip->pixels + row * strip->stride, (size_t)c->row_bytes);
    if (c->other) {
        void *last = strip->pixels;
        strip->pixels = c->other;
        c->other = last;
        memset(last, 0xee, (size_t)(strip->rows * strip->stride));
    }
    return c->strips++ ? c->error : 0;
}

typedef struct bench {
    fxs_context whole, strips;
    fxs_strip strip;
    fxs_config config;
    collected got;
    unsigned char *want;
} bench;

static void bench_init(bench *b, int32_t width, int32_t height, int32_t rows, enum fxs_format format)
{
    const int32_t bytes = fxs_pixel_bytes(format);
    memset(b, 0, sizeof *b);
    b->got = (collected){.pixels = check_aligned((size_t)(width * height * bytes)), .row_bytes = width * bytes};
    b->want = check_aligned((size_t)(width * height * bytes));
    b->strip = (fxs_strip){.stride = width * bytes + 16, .rows = rows, .format = format, .rows_done = collect,
                           .argument = &b->got};
    b->strip.pixels = check_aligned((size_t)((width * bytes + 16) * rows));
    b->config = (fxs_config){.size = sizeof(fxs_config), .draw = fxs_strip_draw, .draw_argument = &b->strip,
                             .draw_blended = 1};
    fxs_context_init(&b->whole, 0);
    fxs_context_init(&b->strips, &b->config);
}

static void bench_free(bench *b)
{
    free(b->got.pixels);
    free(b->got.other);
    free(b->want);
    free(b->strip.pixels);
}

/* Renders a frame whole and in strips. Returns the error code of rendering in strips. */
static int draw_both(bench *b, const fxs_object *object, const fxs_camera *camera, void *memory, size_t whole,
                     size_t bytes, fxs_stats *stats)
{
    fxs_targets targets;
    fxs_targets_init(&targets);
    targets.format = b->strip.format;
    targets.colour = (fxs_image){b->want, b->got.row_bytes};
    CHECK(!render_frame(&b->whole, object, 1, camera, &options, &targets, memory, whole, stats));
    b->got.next = b->got.strips = 0;
    return render_frame(&b->strips, object, 1, camera, &options, 0, memory, bytes, stats);
}

static int same(const bench *b, const fxs_camera *camera)
{
    return b->got.next == camera->height &&
           !memcmp(b->got.pixels, b->want, (size_t)(b->got.row_bytes * camera->height));
}

static void enlarge(packed_scene *scene, fxs_camera *camera)
{
    for (uint32_t c = 0; c < scene->scene.chunk_count; c++)
        scene->chunks[c].scale_q16 = (int32_t)fxs_little_32(3 << 16);
    camera->width = between(200, WIDTH_MOST);
    camera->height = between(60, HEIGHT_MOST);
    camera->cx_q12 = camera->width * 2048;
    camera->cy_q12 = camera->height * 2048;
}

static void test_strips_are_the_picture(void)
{
    int banded = 0, sliced = 0;
    state = 20;
    for (int i = 0; i < 40; i++) {
        packed_scene scene = random_scene((enum fxs_profile)(i % 3), 3000);
        fxs_camera camera;
        fxs_object object;
        fxs_stats stats;
        bench b;
        const int32_t rows = 16 * (1 + i % 3);
        random_camera(&camera);
        if (i % 2)
            enlarge(&scene, &camera);
        fxs_object_init(&object, &scene.scene);
        bench_init(&b, camera.width, camera.height, rows, (enum fxs_format)(i % 6));
        if (i % 5 == 0)
            b.got.other = check_aligned((size_t)(b.strip.stride * rows));
        fxs_frame_memory sizes;
        const size_t whole = fxs_frame_bytes(&b.whole, &object, 1, camera.width, camera.height, &sizes);
        void *memory = check_aligned(whole);
        CHECK(!draw_both(&b, &object, &camera, memory, whole, whole, &stats) && same(&b, &camera));
        CHECK(b.got.strips == (camera.height + rows - 1) / rows);
        for (size_t bytes = sizes.least; bytes < whole; bytes += (whole - sizes.least) / 3 + 1) {
            CHECK(!draw_both(&b, &object, &camera, memory, whole, bytes, &stats) && same(&b, &camera));
            banded += stats.bands > 1;
            sliced += stats.slices > 0;
        }
        CHECK(draw_both(&b, &object, &camera, memory, whole, sizes.least - 1, &stats) == FXS_ERR_MEMORY);
        free(memory);
        free(scene.data);
        bench_free(&b);
    }
    CHECK(banded > 10 && sliced > 5);
}

static void test_wrong_strips(void)
{
    packed_scene scene = random_scene(FXS_PROFILE_DEFAULT, 500);
    fxs_camera camera;
    fxs_object object;
    bench b;
    fxs_camera_init(&camera, 50, 70);
    fxs_object_init(&object, &scene.scene);
    bench_init(&b, 50, 70, 16, FXS_FORMAT_RGB565);
    const size_t whole = fxs_frame_bytes(&b.whole, &object, 1, 50, 70, 0);
    void *memory = check_aligned(whole);
    const fxs_strip good = b.strip;
    static const int32_t wrong_rows[] = {0, -16, 15, 24};
    for (size_t i = 0; i < sizeof wrong_rows / sizeof *wrong_rows; i++) {
        b.strip.rows = wrong_rows[i];
        CHECK(draw_both(&b, &object, &camera, memory, whole, whole, 0) == FXS_ERR_TARGET && !b.got.strips);
    }
    for (int i = 0; i < 5; i++) {
        b.strip = good;
        if (i == 0)
            b.strip.pixels = 0;
        if (i == 1)
            b.strip.stride = 99;
        if (i == 2)
            b.strip.rows = 17;
        if (i == 3)
            b.strip.rows_done = 0;
        if (i == 4)
            b.strip.format = (enum fxs_format)6;
        CHECK(render_frame(&b.strips, &object, 1, &camera, &options, 0, memory, whole, 0) == FXS_ERR_TARGET);
    }
    b.strip = good;
    b.got.error = FXS_ERR_DEVICE;
    CHECK(draw_both(&b, &object, &camera, memory, whole, whole, 0) == FXS_ERR_DEVICE && b.got.strips == 2);
    free(memory);
    free(scene.data);
    bench_free(&b);
}

static void test_turntable_turns(void)
{
    packed_scene scene = random_scene(FXS_PROFILE_SMALL, 500);
    fxs_turntable t;
    for (int i = 0; i < 3; i++) {
        scene.header->inner_low_q32[i] = (int64_t)fxs_little_64((uint64_t)(i + 1) << 32);
        scene.header->inner_high_q32[i] = (int64_t)fxs_little_64((uint64_t)(i + 3) << 32);
    }
    CHECK(!fxs_turntable_open(&t, scene.data, scene.bytes, 320, 240));
    CHECK(t.middle_q32[0] == INT64_C(2) << 32 && t.middle_q32[2] == INT64_C(4) << 32);
    fxs_object plain;
    fxs_object_init(&plain, &t.scene);
    for (uint32_t step = 0; step <= FXS_TURNTABLE_STEPS; step += FXS_TURNTABLE_STEPS) {
        fxs_turntable_turn(&t, step);
        CHECK(!memcmp(t.object.rotation_q30, plain.rotation_q30, sizeof plain.rotation_q30));
        CHECK(!memcmp(t.object.translation_q32, plain.translation_q32, sizeof plain.translation_q32));
    }
    fxs_turntable_turn(&t, FXS_TURNTABLE_STEPS / 4);
    CHECK(t.object.rotation_q30[2] == 1 << 30 && t.object.rotation_q30[6] == -(1 << 30) && !t.object.rotation_q30[0]);
    CHECK(t.object.translation_q32[0] == -(INT64_C(2) << 32) && t.object.translation_q32[2] == INT64_C(6) << 32);
    CHECK(fxs_turntable_open(&t, scene.data, scene.bytes, 0, 240) == FXS_ERR_SIZE);
    CHECK(fxs_turntable_open(&t, scene.data, scene.bytes, 320, FXS_MAX_SIZE + 1) == FXS_ERR_SIZE);
    CHECK(fxs_turntable_open(&t, scene.data, 100, 320, 240) == FXS_ERR_SCENE);
    scene.header->inner_low_q32[1] = (int64_t)fxs_little_64((uint64_t)9 << 32);
    CHECK(fxs_turntable_open(&t, scene.data, scene.bytes, 320, 240) == FXS_ERR_SCENE);
    free(scene.data);
}

static void test_turntable_frames(void)
{
    packed_scene scene = random_scene(FXS_PROFILE_SMALL, 500);
    static const int64_t halves[][3] = {{1, 1, 1}, {1000, 1, 1}, {1, 1000, 1}, {1, 1, 1000}, {0, 0, 0},
                                        {1 << 23, 1 << 23, 1 << 23}};
    for (size_t k = 0; k < sizeof halves / sizeof *halves; k++) {
        fxs_turntable t;
        fxs_stats stats;
        for (int i = 0; i < 3; i++) {
            scene.header->inner_low_q32[i] = (int64_t)fxs_little_64((uint64_t)(-halves[k][i] * (INT64_C(1) << 32)));
            scene.header->inner_high_q32[i] = (int64_t)fxs_little_64((uint64_t)(halves[k][i] * (INT64_C(1) << 32)));
        }
        CHECK(!fxs_turntable_open(&t, scene.data, scene.bytes, WIDTH_MOST, HEIGHT_MOST));
        bench b;
        bench_init(&b, WIDTH_MOST, HEIGHT_MOST, 16, FXS_FORMAT_RGBA8);
        const size_t whole = fxs_frame_bytes(&b.whole, &t.object, 1, WIDTH_MOST, HEIGHT_MOST, 0);
        void *memory = check_aligned(whole);
        for (uint32_t step = 0; step < FXS_TURNTABLE_STEPS; step += 9) {
            fxs_turntable_turn(&t, step);
            CHECK(!draw_both(&b, &t.object, &t.camera, memory, whole, whole, &stats) && same(&b, &t.camera));
        }
        free(memory);
        bench_free(&b);
    }
    free(scene.data);
}

/* ---- Output of a board ------------------------------------------------------------------------------------------- */

static uint64_t fnv1a64(const unsigned char *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

static int print_hashes(char **arguments)
{
    fxs_mapping file;
    fxs_message message;
    fxs_turntable t;
    const int32_t width = (int32_t)strtol(arguments[1], 0, 10), height = (int32_t)strtol(arguments[2], 0, 10);
    const uint32_t frames = (uint32_t)strtoul(arguments[3], 0, 10);
    options.budget = arguments[4] ? (uint32_t)strtoul(arguments[4], 0, 10) : 0;
    if (fxs_map_open(&file, arguments[0], &message))
        return puts(message.text), 1;
    int error = fxs_turntable_open(&t, file.data, file.bytes, width, height);
    for (uint32_t i = 0; i < frames && !error; i++) {
        bench b;
        const uint32_t step = i * FXS_TURNTABLE_STEPS / frames;
        bench_init(&b, width, height, 16, FXS_FORMAT_RGB565);
        fxs_turntable_turn(&t, step);
        const size_t whole = fxs_frame_bytes(&b.whole, &t.object, 1, width, height, 0);
        void *memory = check_aligned(whole);
        error = draw_both(&b, &t.object, &t.camera, memory, whole, whole, 0);
        printf("step %" PRIu32 " hash %016" PRIx64 "\n", step, fnv1a64(b.want, (size_t)(2 * width * height)));
        free(memory);
        bench_free(&b);
    }
    fxs_map_close(&file);
    if (error)
        printf("error: %s\n", fxs_strerror(error));
    return error != 0 || check_faults;
}

static int print_screen(const char *path)
{
    int width, height, most;
    FILE *file = fopen(path, "rb");
    if (!file || fscanf(file, "P6 %d %d %d", &width, &height, &most) != 3 || most != 255 || fgetc(file) == EOF)
        return printf("%s: not a picture\n", path), 1;
    uint64_t hash = 0xcbf29ce484222325u;
    for (int i = 0; i < width * height; i++) {
        unsigned char rgb[3];
        CHECK(fread(rgb, 1, 3, file) == 3);
        const int pixel = rgb[0] >> 3 << 11 | rgb[1] >> 2 << 5 | rgb[2] >> 3;
        hash = (hash ^ (unsigned)(pixel & 255)) * 0x100000001b3u;
        hash = (hash ^ (unsigned)(pixel >> 8)) * 0x100000001b3u;
    }
    fclose(file);
    printf("%dx%d hash %016" PRIx64 "\n", width, height, hash);
    return check_faults != 0;
}

int main(int argc, char **argv)
{
    if (argc == 2)
        return print_screen(argv[1]);
    if (argc == 5 || argc == 6)
        return print_hashes(argv + 1);
    RUN(test_strips_are_the_picture);
    RUN(test_wrong_strips);
    RUN(test_turntable_turns);
    RUN(test_turntable_frames);
    return check_report();
}
