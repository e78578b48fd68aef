/* Stops frames at every call of the stop callback. A stopped frame must return FXS_ERR_STOPPED without other damage.
   --threads runs only the test of several threads, for ThreadSanitizer. */
#include <fixsplat/board.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/declarations.h>
#include "check.h"
#include "one_scene.h"
#include "random_scene.h"

enum { SIDE = 100, THREADS = 4 };

typedef struct asked {
    int times, at;
} asked;

static int stop_at(void *argument)
{
    asked *a = argument;
    return ++a->times == a->at;
}

typedef struct bench {
    packed_scene packed;
    fxs_object object;
    fxs_camera cameras[2];
    fxs_context context;
    fxs_options options;
    void *memory;
    size_t bytes;
    unsigned char pixels[2][SIDE * SIDE * 4], expected[2][SIDE * SIDE * 4];
    uint32_t depths[SIDE * SIDE];
} bench;

typedef int draw_fn(bench *b);

static fxs_targets targets_of(bench *b, int eye)
{
    return one_target(FXS_FORMAT_RGBA8, b->pixels[eye], SIDE * 4);
}

static int draw_colour(bench *b)
{
    const fxs_targets targets = targets_of(b, 0);
    return render_frame(&b->context, &b->object, 1, b->cameras, &b->options, &targets, b->memory, b->bytes, 0);
}

static int draw_depth(bench *b)
{
    fxs_targets targets = targets_of(b, 0);
    targets.median_depth = (fxs_image){b->depths, SIDE * 4};
    return render_frame(&b->context, &b->object, 1, b->cameras, &b->options, &targets, b->memory, b->bytes, 0);
}

static int draw_eyes(bench *b)
{
    const fxs_targets targets[2] = {targets_of(b, 0), targets_of(b, 1)};
    return render_eyes(&b->context, &b->object, 1, b->cameras, &b->options, targets, b->memory, b->bytes, 0);
}

static int pick_middle(bench *b)
{
    fxs_pick_result result;
    const int found = pick_pixel(&b->context, &b->object, 1, b->cameras, &b->options, 0, SIDE / 2, SIDE / 2, b->memory,
                               b->bytes, &result);
    return found < 0 ? found : 0;
}

static int copy_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    memcpy((unsigned char *)argument + (size_t)first * SIDE * 4, strip->pixels, (size_t)rows * SIDE * 4);
    return 0;
}

static int draw_strips(bench *b)
{
    static unsigned char rows[16 * SIDE * 4];
    fxs_strip strip = {.pixels = rows, .stride = SIDE * 4, .rows = 16,
                       .rows_done = copy_rows, .argument = b->pixels[0]};
    fxs_context context = b->context;
    context.config.draw = fxs_strip_draw;
    context.config.draw_argument = &strip;
    context.config.draw_blended = 1;
    return render_frame(&context, &b->object, 1, b->cameras, &b->options, 0, b->memory, b->bytes, 0);
}

/* Makes a random scene to render. room: the memory is the minimum plus room / 16 of the difference to the memory
   of a whole frame. */
static void bench_init(bench *b, uint64_t seed, int room)
{
    fxs_frame_memory sizes;
    memset(b, 0, sizeof *b);
    fxs_context_init(&b->context, 0);
    fxs_options_init(&b->options);
    state = seed;
    b->packed = random_scene((enum fxs_profile)(seed % 3), 12000);
    fxs_object_init(&b->object, &b->packed.scene);
    random_camera(&b->cameras[0]);
    b->cameras[0].width = b->cameras[0].height = SIDE;
    b->cameras[0].cx_q12 = b->cameras[0].cy_q12 = SIDE * 2048;
    b->cameras[1] = b->cameras[0];
    b->cameras[1].position_q32[0] += 1 << 20;
    const size_t whole = fxs_frame_bytes(&b->context, &b->object, 1, SIDE, SIDE, &sizes);
    b->bytes = room < 16 ? sizes.least + (whole - sizes.least) / 16 * (size_t)room : whole;
    b->memory = check_aligned(b->bytes);
}

static void bench_free(bench *b)
{
    free(b->memory);
    free(b->packed.data);
}

/* Renders again and again, and stops at each call of the stop callback in turn. Returns the number of calls. */
static int stop_everywhere(bench *b, draw_fn *draw)
{
    asked a = {0, 0};
    CHECK(!draw(b));
    memcpy(b->expected, b->pixels, sizeof b->expected);
    b->options.stop.call = stop_at;
    b->options.stop.argument = &a;
    CHECK(!draw(b) && !memcmp(b->pixels, b->expected, sizeof b->expected));
    const int places = a.times;
    for (int at = 1; at <= places && !check_faults; at += 1 + places / 50) {
        a = (asked){0, at};
        CHECK(draw(b) == FXS_ERR_STOPPED);
    }
    b->options.stop.call = 0;
    CHECK(!draw(b) && !memcmp(b->pixels, b->expected, sizeof b->expected));
    return places;
}

static void test_stopped_at_each_place(void)
{
    static draw_fn *const draws[] = {draw_colour, draw_depth, draw_eyes, pick_middle, draw_strips};
    static bench b;
    for (uint64_t seed = 1; seed <= 6; seed++)
        for (int i = 0; i < 5; i++) {
            bench_init(&b, seed, 16);
            const int macros = draws[i] == draw_strips ? 0 : 16;
            CHECK(stop_everywhere(&b, draws[i]) > macros);
            bench_free(&b);
        }
}

static void test_stopped_by_a_byte(void)
{
    static bench b;
    unsigned char byte = 0;
    bench_init(&b, 1, 16);
    b.options.stop.call = fxs_stop_by_byte;
    b.options.stop.argument = &byte;
    CHECK(!draw_colour(&b));
    byte = 2;
    CHECK(draw_colour(&b) == FXS_ERR_STOPPED);
    bench_free(&b);
}

static void test_stopped_in_little_memory(void)
{
    static bench b;
    int most = 0;
    for (uint64_t seed = 1; seed <= 6; seed++)
        for (int room = 0; room < 16; room += 5) {
            bench_init(&b, seed, room);
            const int places = stop_everywhere(&b, draw_colour), strips = stop_everywhere(&b, draw_strips);
            most = places > most ? places : most;
            CHECK(places > 16 && strips > 1);
            bench_free(&b);
        }
    CHECK(most > 200);
}

/* A stop callback that stops at random, once in *argument calls. Each thread has its own random numbers. */
static int stop_by_chance(void *argument)
{
    static __thread uint32_t series;
    series = series * 1664525 + 1013904223;
    return (series >> 8) % *(const uint32_t *)argument == 0;
}

static void test_stopped_by_several_threads(void)
{
    static bench b;
    int stopped = 0;
    uint32_t every;
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run,
                               .workers.pool = fxs_pool_create(THREADS), .workers.count = THREADS};
    bench_init(&b, 5, 16);
    fxs_context_init(&b.context, &config);
    free(b.memory);
    b.bytes = fxs_frame_bytes(&b.context, &b.object, 1, SIDE, SIDE, 0);
    b.memory = check_aligned(b.bytes);
    CHECK(!draw_colour(&b));
    memcpy(b.expected, b.pixels, sizeof b.expected);
    b.options.stop.call = stop_by_chance;
    b.options.stop.argument = &every;
    for (every = 1; every <= 200 && !check_faults; every++) {
        memset(b.pixels, 0, sizeof b.pixels);
        const int error = draw_colour(&b);
        CHECK(error == FXS_ERR_STOPPED || (!error && !memcmp(b.pixels, b.expected, sizeof b.expected)));
        stopped += error != 0;
    }
    CHECK(stopped > 20 && stopped < 200);
    bench_free(&b);
    fxs_pool_destroy(config.workers.pool);
}

int main(int argc, char **argv)
{
    if (argc < 2 || strcmp(argv[1], "--threads")) {
        RUN(test_stopped_at_each_place);
        RUN(test_stopped_by_a_byte);
        RUN(test_stopped_in_little_memory);
    }
    RUN(test_stopped_by_several_threads);
    return check_report();
}
