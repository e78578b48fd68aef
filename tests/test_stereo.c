/* Stereo. Exact: the bytes of two mono frames. Shared: the same bytes on any number of threads and with every version
 * of the stages, the tile lists of two frames, and pictures close to theirs. */
#include <inttypes.h>
#include <math.h>
#include <unistd.h>

#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include <fixsplat/pool.h>
#include "tools/metrics.h"
#include "src/scene/make/procedural.h"
#include "scene_writer.h"
#include "one_scene.h"
#include "random_scene.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/kernels.h>
#endif

enum { GUARD = 0xa5, GUARD_BYTES = 256, CASES = 80 };
#define EXPECTED 0xeee255e0423145c2u
#define FLOOR 50.0

typedef struct pair {
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    enum fxs_format format;
    ptrdiff_t stride;              /* of the two pictures side by side */
    size_t bytes;                  /* of both pictures */
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

static int render(pair *p, const fxs_context *context, int exact, size_t memory_bytes, unsigned char *pixels)
{
    unsigned char *memory = check_aligned(memory_bytes + GUARD_BYTES);
    void *const eyes[2] = {pixels, pixels + p->stride / 2};
    memset(memory, GUARD, memory_bytes + GUARD_BYTES);
    memset(pixels, GUARD, p->bytes);
    int error = one_render_stereo(context, &p->scene, p->cameras, &p->options, p->format, exact, memory, memory_bytes,
                                  eyes, p->stride, &p->stats);
    CHECK(untouched(memory + memory_bytes, GUARD_BYTES));
    free(memory);
    return error;
}

static size_t bytes_of(const pair *p, const fxs_context *context)
{
    return one_stereo_bytes(context, &p->scene, p->cameras[0].width, p->cameras[0].height);
}

/* Two mono frames. Returns their list entries. */
static uint64_t render_alone(const pair *p, const fxs_context *context, unsigned char *pixels)
{
    size_t bytes = one_frame_bytes(context, &p->scene, p->cameras[0].width, p->cameras[0].height, 0);
    void *memory = check_aligned(bytes);
    fxs_stats stats[2];
    for (int eye = 0; eye < 2; eye++)
        CHECK(!one_render(context, &p->scene, &p->cameras[eye], &p->options, p->format, memory, bytes,
                          pixels + eye * p->stride / 2, p->stride, &stats[eye]));
    free(memory);
    return stats[0].entries + stats[1].entries;
}

/* ---- Random scenes ----------------------------------------------------------------------------------------------- */

/* Case by case: eyes with unrelated directions, at one place, side by side (twice), apart in any direction. */
enum { ELSEWHERE, ONE_PLACE, APART = 4, KINDS };

/* Returns the format. */
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

/* True if shared stereo equals two frames: order and colours are not shared, or are equal. */
static int is_exact(const pair *p, int which)
{
    int flat = !p->options.sh_degree || !p->scene.sh_degree;
    return which % KINDS == ONE_PLACE || (flat && (which % KINDS == ELSEWHERE || which % KINDS == APART));
}

static uint64_t hash_of(const unsigned char *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/* Renders in just enough memory; one byte less is refused and nothing is written. Returns the hash of the shared
   pictures. */
static uint64_t check_pair(pair *p, const fxs_context *context, const unsigned char *alone, uint64_t entries, int which)
{
    unsigned char *pixels = malloc(p->bytes);
    size_t bytes = bytes_of(p, context);
    for (int exact = 0; exact < 2; exact++) {
        CHECK(render(p, context, exact, bytes - 1, pixels) == FXS_ERR_MEMORY && p->stats.memory.least == bytes);
        CHECK(untouched(pixels, p->bytes));
    }
    CHECK(!render(p, context, 1, bytes, pixels) && !memcmp(pixels, alone, p->bytes));
    CHECK(p->stats.entries == entries && p->stats.bands == 2);
    CHECK(!render(p, context, 0, bytes, pixels));
    CHECK(p->stats.entries == entries && p->stats.bands == 1 && p->stats.memory.total == bytes);
    uint64_t hash = hash_of(pixels, p->bytes);
    if (is_exact(p, which))
        CHECK(!memcmp(pixels, alone, p->bytes));
    CHECK(!render(p, context, 0, 2 * bytes, pixels) && hash_of(pixels, p->bytes) == hash);
    free(pixels);
    return hash;
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
    fxs_init(&context, 0);
    uint64_t entries = render_alone(&p, &context, alone), hash = check_pair(&p, &context, alone, entries, which);
    for (uint32_t threads = 1; threads <= 4; threads *= 2) {
        fxs_config config = {.run = fxs_pool_run, .pool = fxs_pool_create(threads), .threads = threads};
        fxs_init(&context, &config);
        CHECK(check_pair(&p, &context, alone, entries, which) == hash);
#ifdef FXS_WITH_KERNELS
        fxs_kernels_choose(&context.kernels, fxs_cpu_detect());
        CHECK(check_pair(&p, &context, alone, entries, which) == hash);
#endif
        fxs_pool_destroy(config.pool);
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

/* ---- Splats outside one eye -------------------------------------------------------------------------------------- */

static struct {
    const fxs_bounds *bounds;
    const fxs_box *boxes;          /* of the last binned stretch, now complete */
    uint32_t count;
    uint32_t unseen, searched;     /* splats outside an eye; of these, the ones still searched for */
} binned;

static void look_at_boxes(void)
{
    for (uint32_t i = 0; i < binned.count; i++) {
        if (binned.bounds[i].cx_q14 != -FXS_CENTRE_LIMIT_Q14)
            continue;
        binned.unseen++;
        binned.searched += binned.boxes[i].bits != FXS_NOWHERE.bits;
    }
    binned.count = 0;
}

static void bin_and_look(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count,
                         fxs_box *boxes)
{
    look_at_boxes();
    fxs_bin_c(view, splats, bounds, count, boxes);
    binned.bounds = bounds;
    binned.boxes = boxes;
    binned.count = count;
}

static uint64_t look(void *ignored)
{
    (void)ignored;
    look_at_boxes();
    return 0;
}

/* An invisible splat's box marks it, and the lists skip it; otherwise each part of the keys and each run would
   search it in vain. */
static void test_unseen_splats_are_not_looked_for(void)
{
    const fxs_config config = {.clock = look};
    fxs_context context;
    fxs_camera cameras[2];
    fxs_options options;
    memset(&binned, 0, sizeof binned);
    fxs_init(&context, &config);
    context.kernels.bin = bin_and_look;
    for (int i = 0; i < 2 * KINDS; i++) {
        fxs_scene scene;
        state = (uint64_t)i;
        const packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        const enum fxs_format format = random_pair(cameras, &options, i);
        pair p = pair_of(&scene, cameras, &options, format);
        unsigned char *pixels = malloc(p.bytes);
        CHECK(!render(&p, &context, 0, bytes_of(&p, &context), pixels));
        CHECK(binned.count == 0);
        free(pixels);
        free(packed.data);
    }
    if (!CHECK(binned.unseen > 300) || !CHECK(binned.searched == 0))
        printf("  %u unseen, %u of them searched\n", binned.unseen, binned.searched);
}

/* One eye looks ahead, the other is turned about x or y: each has its own order. Without SH the pictures equal two
   frames. */
static void test_eye_turned_to_any_side(void)
{
    fxs_context context;
    fxs_init(&context, 0);
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
        options.sh_degree = 0;
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
        CHECK(!render(&p, &context, 0, bytes_of(&p, &context), pixels) && !memcmp(pixels, alone, p.bytes));
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
    fxs_init(&context, 0);
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
        check_pair(&p, &context, alone, entries, ONE_PLACE);
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
    fxs_init(&context, 0);
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
        check_pair(&p, &context, alone, entries, ONE_PLACE);
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
    fxs_init(&context, 0);
    pair p = pair_of(&scene, cameras, &options, format), other = p;
    unsigned char *pixels = check_aligned(p.bytes);
    size_t bytes = bytes_of(&p, &context);
    const size_t more = bytes - one_frame_bytes(&context, &scene, cameras[0].width, cameras[0].height, 0);
    CHECK(more > 68 * FXS_CHUNK * scene.chunk_count && more <= 68 * FXS_CHUNK * scene.chunk_count + 512);
    CHECK(!one_stereo_bytes(&context, &scene, 0, 1) && !one_stereo_bytes(&context, 0, 1, 1));
    for (int eye = 0; eye < 2; eye++)
        for (int exact = 0; exact < 2; exact++) {
            other = p;
            other.cameras[eye].height++;
            CHECK(render(&other, &context, exact, 2 * bytes, pixels) == FXS_ERR_SIZE && untouched(pixels, p.bytes));
            other = p;
            other.cameras[eye].fx_q12 = 0;
            CHECK(render(&other, &context, exact, bytes, pixels) == FXS_ERR_CAMERA && untouched(pixels, p.bytes));
            void *eyes[2] = {pixels, pixels};
            eyes[eye] = 0;
            CHECK(one_render_stereo(&context, &scene, cameras, &options, format, exact, pixels, bytes, eyes, p.stride,
                                    0) == FXS_ERR_TARGET);
            other = p;
            other.stride = cameras[0].width * fxs_pixel_bytes(format) - 1;
            CHECK(render(&other, &context, exact, bytes, pixels) == FXS_ERR_TARGET && untouched(pixels, p.bytes));
        }
    free(pixels);
    free(packed.data);
}

/* A clock that advances faster with each call. */
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

/* From the first clock call to the last, including all stages. */
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
    for (int exact = 0; exact < 2; exact++) {
        looked l = {0, 0, 0};
        const fxs_config config = {.clock = look_at_clock, .clock_argument = &l};
        uint64_t stages = 0;
        fxs_init(&context, &config);
        CHECK(!render(&p, &context, exact, bytes_of(&p, &context), pixels));
        for (int i = 0; i < FXS_STAGES; i++)
            stages += p.stats.nanoseconds[i];
        CHECK(l.calls > 2 && p.stats.frame_nanoseconds == l.last - l.first);
        CHECK(stages > p.stats.frame_nanoseconds / 2 && stages < p.stats.frame_nanoseconds);
    }
    free(pixels);
    free(packed.data);
}

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
    fxs_init(&context, 0);
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
    CHECK(render_eyes(&context, objects, FXS_MAX_OBJECTS, cameras, &options, targets, 0, pixels, 4096, 0) ==
          FXS_ERR_OBJECT);
    CHECK(render_eyes(&context, objects, FXS_MAX_OBJECTS - 4096, cameras, &options, targets, 0, pixels, 4096,
                            0) == FXS_ERR_MEMORY);
    free(pixels);
    free(packed.data);
}

/* ---- Difference to mono frames ----------------------------------------------------------------------------------- */

enum { WIDTH = 640, HEIGHT = 360 };
static const double up[3] = {0, -1, 0};

/* Eyes 2 % of the distance to the scene's middle apart. The left one is turned right by `turn` degrees, the right
   one left. */
static int eyes_of(fxs_camera cameras[2], const fxs_file_view *view, const fxs_pack_report *report, double turn)
{
    fxs_message m;
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += pow((report->inner_low[i] + report->inner_high[i]) / 2 - view->position[i], 2);
    for (int eye = 0; eye < 2; eye++) {
        fxs_file_view beside = *view;
        for (int i = 0; i < 3; i++)
            beside.position[i] += (eye ? 0.01 : -0.01) * sqrt(square) * view->rotation[i];
        fxs_view_orbit(&beside, beside.position, view->rotation + 3, (eye ? -1 : 1) * turn * 0.017453292519943295);
        if (fxs_camera_from_view(&cameras[eye], &beside, &m))
            return -1;
    }
    return 0;
}

static void copy_eye(uint8_t *eye, const pair *p, const unsigned char *pixels, int which)
{
    for (int y = 0; y < HEIGHT; y++)
        memcpy(eye + y * WIDTH * 4, pixels + y * p->stride + which * WIDTH * 4, WIDTH * 4);
}

static double worse_psnr(const fxs_scene *scene, const fxs_camera cameras[2])
{
    static uint8_t eyes[2][WIDTH * HEIGHT * 4];
    fxs_context context;
    fxs_options options;
    struct fxs_metrics metrics;
    double worse = INFINITY;
    fxs_init(&context, 0);
#ifdef FXS_WITH_KERNELS
    fxs_kernels_choose(&context.kernels, fxs_cpu_detect());
#endif
    fxs_options_init(&options);
    pair p = pair_of(scene, cameras, &options, FXS_FORMAT_RGBA8);
    unsigned char *shared = malloc(p.bytes), *alone = malloc(p.bytes);
    CHECK(!render(&p, &context, 0, bytes_of(&p, &context), shared));
    CHECK(!render(&p, &context, 1, bytes_of(&p, &context), alone));
    for (int eye = 0; eye < 2; eye++) {
        copy_eye(eyes[0], &p, shared, eye);
        copy_eye(eyes[1], &p, alone, eye);
        CHECK(!fxs_metrics_compare(eyes[0], eyes[1], WIDTH, HEIGHT, &metrics));
        worse = fmin(worse, metrics.psnr);
    }
    free(shared);
    free(alone);
    return worse;
}

static void check_headset(const fxs_scene *scene, const fxs_file_view *view, const fxs_pack_report *report)
{
    static const double tangents[][4] = {{-1.38, 1.19, 1.0, -1.2}, {-1.19, 1.38, 1.0, -1.2}};
    fxs_message m;
    fxs_camera cameras[2];
    for (int eye = 0; eye < 2; eye++) {
        fxs_file_view wide = *view;
        fxs_camera both[2];
        CHECK(!fxs_view_set_tangents(&wide, tangents[eye], &m) && !eyes_of(both, &wide, report, 0));
        cameras[eye] = both[eye];
    }
    CHECK(cameras[0].cx_q12 - cameras[1].cx_q12 > 40 << 12);
    const double psnr = worse_psnr(scene, cameras);
    printf("  %s, a headset: %.1f dB\n", view->name, psnr);
    CHECK(psnr >= FLOOR);
}

static void check_view(const fxs_packed_scene *packed, const fxs_pack_report *report, const fxs_file_view *view)
{
    static const double turns[] = {0, 1, -5};
    fxs_scene scene;
    fxs_camera cameras[2];
    CHECK(!fxs_scene_open(&scene, packed->data, packed->bytes));
    for (int i = 0; i < 3; i++) {
        if (!CHECK(!eyes_of(cameras, view, report, turns[i])))
            return;
        double psnr = worse_psnr(&scene, cameras);
        printf("  %s, turned %g degrees: %.1f dB\n", view->name, turns[i], psnr);
        CHECK(psnr >= FLOOR);
    }
    check_headset(&scene, view, report);
}

static int pack(const char *path, fxs_packed_scene *packed, fxs_pack_report *report)
{
    fxs_message m;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    if (fxs_scene_file_open(path, NULL, &file, &info, &m))
        return -1;
    int result = fxs_pack(file, &info, packed, report, NULL, &m);
    fxs_scene_file_close(file);
    return result;
}

static void test_captured_scene(void)
{
    char path[512];
    fxs_message m;
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_file_view *views = 0;
    const char *folder = getenv("FXS_SCENES");
    folder = folder ? folder : "../shared/scenes";
    snprintf(path, sizeof path, "%s/snowmiku/snowmiku.ply", folder);
    if (access(path, R_OK))
        SKIP("the scene is not here");
    if (!CHECK(!pack(path, &packed, &report)))
        return;
    snprintf(path, sizeof path, "%s/snowmiku/cameras.json", folder);
    long count = fxs_camera_file_read(path, &views, &m);
    CHECK(count > 72);
    for (long i = 8; i < count && i <= 72; i += 32) {
        fxs_view_resize(&views[i], WIDTH, HEIGHT);
        check_view(&packed, &report, &views[i]);
    }
    free(views);
    fxs_packed_scene_free(&packed);
}

static int write_scene(const char *path, const char *name, uint64_t count)
{
    fxs_message m;
    fxs_scene_writer *writer;
    const fxs_procedural_scene *scene = fxs_procedural_find(name);
    if (open_writer("ply", path, count, scene->sh_degree, 0, &writer, &m))
        return -1;
    for (uint64_t i = 0; i < count; i++) {
        fxs_gaussian gaussian;
        scene->gaussian(i, count, 1, &gaussian);
        fxs_scene_writer_put(writer, &gaussian, 1, &m);
    }
    return close_writer(writer, &m);
}

static void check_procedural(const char *name, const double eye[3], const double look[3])
{
    char path[] = "/tmp/fixsplat-stereo-XXXXXX";
    fxs_message m;
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_file_view view;
    int fd = mkstemp(path);
    if (CHECK(fd >= 0 && !close(fd) && !write_scene(path, name, 50000) && !pack(path, &packed, &report))) {
        CHECK(!fxs_view_look_at(&view, eye, look, up, 50, WIDTH, HEIGHT, &m));
        snprintf(view.name, sizeof view.name, "%s", name);
        check_view(&packed, &report, &view);
        fxs_packed_scene_free(&packed);
    }
    unlink(path);
}

static void test_procedural_scenes(void)
{
    check_procedural("knot", (const double[3]){0.9, -2.6, -12.8}, (const double[3]){0, 0.42, 0});
    check_procedural("landscape", (const double[3]){4.6, -1.9, -12.7}, (const double[3]){0, -2.2, 0});
}

int main(void)
{
    RUN(test_random_pairs);
    RUN(test_unseen_splats_are_not_looked_for);
    RUN(test_eye_turned_to_any_side);
    RUN(test_eyes_with_other_principal_points);
    RUN(test_near_planes);
    RUN(test_arguments);
    RUN(test_time);
    RUN(test_too_many_slots);
    RUN(test_procedural_scenes);
    RUN(test_captured_scene);
    return check_report();
}
