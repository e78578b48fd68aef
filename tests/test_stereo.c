/* A frame of a stereo pair must have the bytes and tile lists of two mono frames. This must hold on any number
   of threads, with every set of kernels, and in any memory. */
#include <inttypes.h>

#include <fixsplat/system.h>
#include "one_scene.h"
#include "random_scene.h"
#include "fastest.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

enum { GUARD = 0xa5, GUARD_BYTES = 256, CASES = 80 };
#define EXPECTED 0xfdd37d48b89663b7u

typedef struct pair {
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    enum fxs_format format;
    ptrdiff_t stride;              /* bytes from row to row; the pictures of both eyes are side by side */
    size_t bytes;
    fxs_stats stats;
} pair;

static pair pair_of(const fxs_scene *scene, const fxs_camera cameras[2], const fxs_options *options,
                    enum fxs_format format)
{
    pair p = {*scene, {cameras[0], cameras[1]}, *options, format, 0, 0, {0}};
    p.stride = 2 * (ptrdiff_t)cameras[0].width * fxs_pixel_bytes(format);
    p.bytes = (size_t)p.stride * (size_t)cameras[0].height;
    return p;
}

static int untouched(const unsigned char *bytes, size_t count)
{
    while (count > 0 && *bytes == GUARD)
        bytes++, count--;
    return count == 0;
}

static int render(pair *p, const fxs_context *context, size_t memory_bytes, unsigned char *pixels)
{
    unsigned char *memory = check_aligned(memory_bytes + GUARD_BYTES);
    void *const eyes[2] = {pixels, pixels + p->stride / 2};
    memset(memory, GUARD, memory_bytes + GUARD_BYTES);
    memset(pixels, GUARD, p->bytes);
    int error = one_render_stereo(context, &p->scene, p->cameras, &p->options, p->format, memory, memory_bytes, eyes,
                                  p->stride, &p->stats);
    CHECK(untouched(memory + memory_bytes, GUARD_BYTES));
    free(memory);
    return error;
}

static size_t bytes_of(const pair *p, const fxs_context *context, fxs_frame_memory *memory)
{
    return one_frame_bytes(context, &p->scene, p->cameras[0].width, p->cameras[0].height, memory);
}

/* Renders each eye as a mono frame. Returns the number of entries of all tile lists. */
static uint64_t render_alone(const pair *p, const fxs_context *context, unsigned char *pixels)
{
    size_t bytes = bytes_of(p, context, 0);
    void *memory = check_aligned(bytes);
    fxs_stats stats[2];
    for (int eye = 0; eye < 2; eye++)
        CHECK(!one_render(context, &p->scene, &p->cameras[eye], &p->options, p->format, memory, bytes,
                          pixels + eye * p->stride / 2, p->stride, &stats[eye]));
    free(memory);
    return stats[0].entries + stats[1].entries;
}

/* How the camera of the second eye is placed: in an unrelated direction, at one place, side by side (twice),
   apart in any direction. */
enum { ELSEWHERE, ONE_PLACE, APART = 4, KINDS };

static enum fxs_format random_pair(fxs_camera cameras[2], fxs_options *options, int which)
{
    random_camera(&cameras[0]);
    random_camera(&cameras[1]);
    cameras[1].width = cameras[0].width;
    cameras[1].height = cameras[0].height;
    if (which % KINDS != ELSEWHERE)
        cameras[1] = cameras[0];
    int32_t distance_q16 = between(1, 20000);
    for (int i = 0; i < 3 && which % KINDS > ONE_PLACE; i++)
        cameras[1].position_q32[i] += which % KINDS == APART ? (int64_t)between(-65536, 65536) * 4096
                                                             : (int64_t)cameras[0].rotation_q30[i] * distance_q16 >> 14;
    fxs_options_init(options);
    options->cutoff = (enum fxs_cutoff)(which / 3 % 2);
    options->sh_degree = which % 4;
    return (enum fxs_format)between(0, 2);
}

static uint64_t hash_of(const unsigned char *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/* Renders a stereo pair in various amounts of memory and compares it with the mono frames. With one byte less
   than the minimum nothing may be written. */
static void check_pair(pair *p, const fxs_context *context, const unsigned char *alone, uint64_t entries)
{
    unsigned char *pixels = malloc(p->bytes);
    fxs_frame_memory memory;
    const size_t bytes = bytes_of(p, context, &memory);
    CHECK(render(p, context, memory.least - 1, pixels) == FXS_ERR_MEMORY && p->stats.memory.least == memory.least);
    CHECK(untouched(pixels, p->bytes));
    CHECK(!render(p, context, bytes, pixels) && !memcmp(pixels, alone, p->bytes));
    CHECK(p->stats.entries == entries && p->stats.bands == 2);
    CHECK(!render(p, context, memory.least, pixels) && !memcmp(pixels, alone, p->bytes));
    CHECK(!render(p, context, 2 * bytes, pixels) && !memcmp(pixels, alone, p->bytes));
    free(pixels);
}

static uint64_t check_case(int which)
{
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_context context;
    state = (uint64_t)which * 0x7654321u;
    const packed_scene packed = random_scene((enum fxs_profile)(which % 3), which % 10 ? 3000 : 20000);
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    const enum fxs_format format = random_pair(cameras, &options, which);
    pair p = pair_of(&scene, cameras, &options, format);
    unsigned char *alone = malloc(p.bytes);
    fxs_context_init(&context, 0);
    const uint64_t entries = render_alone(&p, &context, alone), hash = hash_of(alone, p.bytes);
    check_pair(&p, &context, alone, entries);
    for (uint32_t threads = 1; threads <= 4; threads *= 2) {
        fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run,
                             .workers.pool = fxs_pool_create(threads), .workers.count = threads};
        fxs_context_init(&context, &config);
        check_pair(&p, &context, alone, entries);
#ifdef FXS_WITH_KERNELS
        context.config.kernels = kernels_for(fxs_cpu_detect());
        check_pair(&p, &context, alone, entries);
#endif
        fxs_pool_destroy(config.workers.pool);
    }
    free(alone);
    free(packed.data);
    return hash;
}

static void test_random_pairs(void)
{
    uint64_t sum = 0;
    for (int i = 0; i < CASES && !check_faults; i++)
        sum = sum * 3 + check_case(i);
    printf("  %d random pairs: %016" PRIx64 "\n", CASES, sum);
    CHECK(sum == EXPECTED);
}

static void test_eye_turned_to_any_side(void)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    for (int i = 0; i < 32; i++) {
        const int axis = i & 1, a = (axis + 1) % 3, b = (axis + 2) % 3, turned = i >> 1 & 1;
        const int32_t c = (int32_t)((1 << 30) / 25 * 24), s = (i & 4 ? 1 : -1) * ((1 << 30) / 25 * 7);
        fxs_scene scene;
        fxs_camera cameras[2];
        fxs_options options;
        state = (uint64_t)i;
        const packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        const enum fxs_format format = random_pair(cameras, &options, ONE_PLACE);
        for (int eye = 0; eye < 2; eye++) {
            int32_t *r = cameras[eye].rotation_q30;
            for (int k = 0; k < 9; k++)
                r[k] = k % 4 ? 0 : 1 << 30;
            if (eye == turned) {
                r[4 * a] = r[4 * b] = c;
                r[3 * a + b] = -s;
                r[3 * b + a] = s;
            }
        }
        pair p = pair_of(&scene, cameras, &options, format);
        unsigned char *pixels = malloc(p.bytes), *alone = malloc(p.bytes);
        render_alone(&p, &context, alone);
        CHECK(!render(&p, &context, bytes_of(&p, &context, 0), pixels) && !memcmp(pixels, alone, p.bytes));
        free(pixels);
        free(alone);
        free(packed.data);
    }
}

static void test_eyes_with_other_principal_points(void)
{
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_context context;
    fxs_context_init(&context, 0);
    for (int which = 0; which < 20; which++) {
        state = (uint64_t)which * 0x3456781u;
        const packed_scene packed = random_scene((enum fxs_profile)(which % 3), 3000);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        const enum fxs_format format = random_pair(cameras, &options, ONE_PLACE);
        cameras[1].cx_q12 += between(-200000, 200000);
        cameras[1].cy_q12 += between(-200000, 200000);
        cameras[1].fx_q12 += between(0, 40000);
        pair p = pair_of(&scene, cameras, &options, format);
        unsigned char *alone = malloc(p.bytes);
        const uint64_t entries = render_alone(&p, &context, alone);
        check_pair(&p, &context, alone, entries);
        free(alone);
        free(packed.data);
    }
}

static void test_near_planes(void)
{
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_context context;
    fxs_context_init(&context, 0);
    for (int which = 0; which < 20; which++) {
        state = (uint64_t)which * 0x2345671u;
        const packed_scene packed = random_scene((enum fxs_profile)(which % 3), 3000);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        const enum fxs_format format = random_pair(cameras, &options, ONE_PLACE);
        random_near(&cameras[0]);
        cameras[1].near_q32 = which % 2 ? 3 * cameras[0].near_q32 : cameras[0].near_q32;
        pair p = pair_of(&scene, cameras, &options, format);
        unsigned char *alone = malloc(p.bytes);
        const uint64_t entries = render_alone(&p, &context, alone);
        check_pair(&p, &context, alone, entries);
        free(alone);
        free(packed.data);
    }
}

static void test_arguments(void)
{
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_context context;
    state = 1;
    const packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 500);
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    const enum fxs_format format = random_pair(cameras, &options, 2);
    fxs_context_init(&context, 0);
    pair p = pair_of(&scene, cameras, &options, format), other = p;
    unsigned char *pixels = check_aligned(p.bytes);
    const size_t bytes = bytes_of(&p, &context, 0);
    for (int eye = 0; eye < 2; eye++) {
        other = p;
        other.cameras[eye].height++;
        CHECK(render(&other, &context, 2 * bytes, pixels) == FXS_ERR_SIZE && untouched(pixels, p.bytes));
        other = p;
        other.cameras[eye].fx_q12 = 0;
        CHECK(render(&other, &context, bytes, pixels) == FXS_ERR_CAMERA && untouched(pixels, p.bytes));
        void *eyes[2] = {pixels, pixels};
        eyes[eye] = 0;
        CHECK(one_render_stereo(&context, &scene, cameras, &options, format, pixels, bytes, eyes, p.stride, 0) ==
              FXS_ERR_TARGET);
        other = p;
        other.stride = cameras[0].width * fxs_pixel_bytes(format) - 1;
        CHECK(render(&other, &context, bytes, pixels) == FXS_ERR_TARGET && untouched(pixels, p.bytes));
    }
    free(pixels);
    free(packed.data);
}

typedef struct looked {
    uint64_t calls, first, last;
} looked;

static uint64_t look_at_clock(void *argument)
{
    looked *l = argument;
    l->calls++;
    l->last = 5000000000000 + 1000 * l->calls * l->calls;
    l->first = l->calls == 1 ? l->last : l->first;
    return l->last;
}

static void test_time(void)
{
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_context context;
    state = 1;
    const packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 500);
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    const enum fxs_format format = random_pair(cameras, &options, ONE_PLACE);
    pair p = pair_of(&scene, cameras, &options, format);
    unsigned char *pixels = check_aligned(p.bytes);
    looked l = {0, 0, 0};
    const fxs_config config = {.size = sizeof(fxs_config), .clock = look_at_clock, .clock_argument = &l};
    uint64_t stages = 0;
    fxs_context_init(&context, &config);
    CHECK(!render(&p, &context, bytes_of(&p, &context, 0), pixels));
    for (int i = 0; i < FXS_STAGES; i++)
        stages += p.stats.nanoseconds[i];
    CHECK(l.calls > 2 && p.stats.frame_nanoseconds == l.last - l.first);
    CHECK(stages > p.stats.frame_nanoseconds / 2 && stages < p.stats.frame_nanoseconds);
    free(pixels);
    free(packed.data);
}

/* Renders a stereo pair whose eyes see more splats (projected Gaussians) than the renderer can hold for one part
   of the picture. */
static void test_too_many_slots(void)
{
    static fxs_object objects[FXS_MAX_OBJECTS];
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_context context;
    fxs_frame_memory memory;
    fxs_stats stats;
    fxs_targets targets[2];
    state = 3;
    const packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 4200);
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    random_pair(cameras, &options, 2);
    fxs_context_init(&context, 0);
    for (uint32_t i = 0; i < FXS_MAX_OBJECTS; i++)
        objects[i] = one_object(&scene);
    unsigned char *pixels = check_aligned(2 * 256 * 256 * 4);
    for (int eye = 0; eye < 2; eye++) {
        cameras[eye].width = cameras[eye].height = 256;
        targets[eye] = one_target(FXS_FORMAT_RGBA8, pixels + eye * 256 * 256 * 4, 256 * 4);
    }
    CHECK(fxs_frame_bytes(&context, objects, FXS_MAX_OBJECTS, 256, 256, &memory) > 0 && memory.least < memory.total);
    CHECK(render_frame(&context, objects, FXS_MAX_OBJECTS, cameras, &options, targets, pixels, 4096, &stats) ==
          FXS_ERR_MEMORY && stats.memory.least < memory.total);
    CHECK(render_eyes(&context, objects, FXS_MAX_OBJECTS, cameras, &options, targets, pixels, 4096, &stats) ==
          FXS_ERR_MEMORY && stats.memory.least == memory.least);
    free(pixels);
    free(packed.data);
}

int main(void)
{
    RUN(test_random_pairs);
    RUN(test_eye_turned_to_any_side);
    RUN(test_eyes_with_other_principal_points);
    RUN(test_near_planes);
    RUN(test_arguments);
    RUN(test_time);
    RUN(test_too_many_slots);
    return check_report();
}
