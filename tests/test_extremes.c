/* Renders frames at the limits that the public header states: objects, orthographic cameras, targets, stereo pairs. */
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/parts.h>
#include "one_scene.h"
#include "random_scene.h"
#include "fastest.h"

#define MOST 256
#define ONE ((int64_t)1 << 32)

static fxs_context plain;          /* a context with plain C kernels and a single thread */
static fxs_options options = {.size = sizeof(fxs_options)};
static uint32_t pixels[2][MOST * MOST];

/* Makes a scene of Gaussians of all shapes in a box of 4 x 4 x 4 / 2^thin units. Their sigma is 1/20 to 1 times
   2^log2 units. */
static packed_scene cloud(uint32_t count, int log2, int thin)
{
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, count, 0);
    for (uint32_t c = 0; c < s.header->chunk_count; c++) {
        fxs_chunk *chunk = &s.chunks[c];
        for (int i = 0; i < 3; i++) {
            chunk->origin_q32[i] = -2 * ONE;
            chunk->step_q32[i] = i < 2 ? 262144 : 262144u >> thin;
            chunk->colour_q16[i] = 20000;
            chunk->colour_step_q20[i] = 4000;
        }
        chunk->scale_q16 = log2 * 65536;
        chunk->scale_step_q24 = 70;
        fill_words(packed_scene_rows(&s, c), s.header->chunk_bytes);
    }
    if (packed_scene_finish(&s))
        abort();
    return s;
}

static fxs_camera camera_at(int32_t size, int64_t z_q32)
{
    fxs_camera camera;
    fxs_camera_init(&camera, size, size);
    camera.position_q32[2] = z_q32;
    return camera;
}

static int draw(const fxs_context *context, const fxs_object *object, const fxs_camera *camera, uint32_t *to)
{
    const fxs_targets targets = one_target(FXS_FORMAT_RGBA8, to, 4 * (ptrdiff_t)camera->width);
    const size_t bytes = fxs_frame_bytes(context, object, 1, camera->width, camera->height, 0);
    void *memory = check_aligned(bytes);
    const int error = render_frame(context, object, 1, camera, &options, &targets, memory, bytes, 0);
    free(memory);
    return error;
}

static int apart(const uint32_t *a, const uint32_t *b)
{
    int most = 0;
    for (int c = 0; c < 24; c += 8) {
        const int difference = abs((int)(*a >> c & 255) - (int)(*b >> c & 255));
        most = difference > most ? difference : most;
    }
    return most;
}

/* ---- Objects ----------------------------------------------------------------------------------------------------- */

static void bin_everywhere(const fxs_stage_view *view, const fxs_splat *splats, const fxs_bounds *bounds,
                           uint32_t count, fxs_box *boxes)
{
    (void)view;
    (void)splats;
    for (uint32_t i = 0; i < count; i++) {
        ((fxs_bounds *)(uintptr_t)&bounds[i])->half_width_q8 = FXS_EVERYWHERE_Q8;
        boxes[i] = FXS_LARGE;
    }
}

static void test_faint_objects_are_listed_whole(void)
{
    fxs_context everywhere = plain;
    fxs_camera camera = camera_at(200, -8 * ONE);
    fxs_kernels kernels = fxs_kernels_c;
    kernels.bin = bin_everywhere;
    everywhere.config.kernels = &kernels;
    camera.fx_q12 = camera.fy_q12 = 250 << 12;
    for (state = 1; state < 6;) {
        const uint64_t seed = state;
        packed_scene s = cloud(200, 0, 0);
        fxs_object object = one_object(&s.scene);
        for (object.opacity_q16 = 16384; object.opacity_q16 > 600; object.opacity_q16 /= 2)
            CHECK(!draw(&plain, &object, &camera, pixels[0]) && !draw(&everywhere, &object, &camera, pixels[1]) &&
                  !memcmp(pixels[0], pixels[1], sizeof pixels[0]));
        free(s.data);
        state = seed + 1;
    }
}

static void test_end_of_a_long_list(void)
{
    enum { SIZE = 16, CORNER = 5 };
    static fxs_id ids[SIZE * SIZE];
    static uint32_t medians[SIZE * SIZE];
    state = 17;
    const packed_scene many = cloud(70000, -3, 0), wall = cloud(200, 3, 14);
    fxs_object objects[2] = {one_object(&many.scene), one_object(&wall.scene)};
    const fxs_camera camera = camera_at(SIZE, -8 * ONE);
    fxs_targets targets = one_target(FXS_FORMAT_RGBA8, pixels[0], 4 * SIZE);
    fxs_stats stats;
    objects[0].scale_q32 = ONE >> 10;
    objects[0].translation_q32[0] = objects[0].translation_q32[1] = -7 * ONE;
    objects[0].id = 1;
    objects[1].id = 2;
    objects[1].translation_q32[2] = 4 * ONE;
    targets.id = (fxs_image){ids, 8 * SIZE};
    targets.median_depth = (fxs_image){medians, 4 * SIZE};
    const size_t bytes = fxs_frame_bytes(&plain, objects, 2, SIZE, SIZE, 0);
    void *memory = check_aligned(bytes);
    for (int last = 0; last < 2; last++) {
        fxs_context context = plain;
        context.config.kernels = kernels_for(last ? ~0u : 0);
        CHECK(!render_frame(&context, objects, 2, &camera, &options, &targets, memory, bytes, &stats));
        CHECK(stats.entries > 40000 && ids[SIZE + 1].object == 1);
        for (int i = CORNER * SIZE + CORNER; i < SIZE * SIZE; i++)
            CHECK(i % SIZE < CORNER || (ids[i].object == 2 && medians[i] / 65536 == 10));
    }
    free(memory);
    free(many.data);
    free(wall.data);
}

/* Blends 80,000 Gaussians in a tile. The pixels stay transparent, so the renderer goes through the whole list of
   Gaussians. */
static void test_occluder_behind_a_long_list(void)
{
    enum { SIZE = 16, COUNT = 80000 };
    static uint16_t expected[SIZE * SIZE][4], behind[SIZE * SIZE][4];
    static uint32_t occluder[SIZE * SIZE];
    const fxs_camera camera = camera_at(SIZE, -4 * ONE);
    memset(occluder, 0xff, sizeof occluder);
    for (uint64_t seed = 1; seed <= 6; seed++) {
        state = seed;
        const packed_scene many = cloud(COUNT, -5, 0);
        fxs_object object = one_object(&many.scene);
        fxs_targets targets = one_target(FXS_FORMAT_RGBA16_COVERAGE, expected, 8 * SIZE);
        fxs_context context = plain;
        fxs_stats stats;
        object.opacity_q16 = 640;
        context.config.kernels = kernels_for(seed % 2 ? ~0u : 0);
        const size_t bytes = fxs_frame_bytes(&plain, &object, 1, SIZE, SIZE, 0);
        void *memory = check_aligned(bytes);
        CHECK(!render_frame(&plain, &object, 1, &camera, &options, &targets, memory, bytes, &stats));
        CHECK(stats.entries > 32768);
        for (int i = 0; i < SIZE * SIZE; i++)
            CHECK(expected[i][3] < 65000);
        targets.colour.pixels = behind;
        targets.occluder = (fxs_image){occluder, 4 * SIZE};
        CHECK(!render_frame(&context, &object, 1, &camera, &options, &targets, memory, bytes, 0));
        CHECK(!memcmp(behind, expected, sizeof behind));
        free(memory);
        free(many.data);
    }
}

static void test_pixel_of_an_orthographic_picture(void)
{
    fxs_camera camera = camera_at(MOST, -8 * ONE);
    state = 3;
    packed_scene s = cloud(700, -3, 0);
    const fxs_object object = one_object(&s.scene);
    camera.projection = FXS_ORTHOGRAPHIC;
    camera.fx_q12 = camera.fy_q12 = 80 << 12;
    CHECK(!draw(&plain, &object, &camera, pixels[0]));
    for (int32_t x = 0; x < MOST; x += 36) {
        const int32_t y = MOST - 1 - x;
        fxs_camera beside = camera;
        uint32_t pixel;
        beside.width = beside.height = 1;
        beside.cx_q12 -= x << 12;
        beside.cy_q12 -= y << 12;
        CHECK(!draw(&plain, &object, &beside, &pixel) && apart(&pixel, &pixels[0][y * MOST + x]) <= 3);
    }
    free(s.data);
}

static void test_camera_of_any_size(void)
{
    static const int32_t sizes[] = {INT32_MIN, -1, 0, FXS_MAX_SIZE + 1, INT32_MAX};
    const packed_scene s = cloud(1, 0, 0);
    const fxs_object object = one_object(&s.scene);
    const fxs_targets targets = one_target(FXS_FORMAT_RGBA8, pixels[0], 4 * MOST);
    fxs_camera camera;
    for (int i = 0; i < 5; i++) {
        fxs_camera_init(&camera, sizes[i], sizes[i]);
        CHECK(render_frame(&plain, &object, 1, &camera, &options, &targets, pixels[1], 0, 0) == FXS_ERR_SIZE);
    }
    free(s.data);
}

static int render_to(ptrdiff_t stride, void *top, int32_t height)
{
    fxs_targets targets;
    fxs_camera camera;
    static unsigned char memory[1 << 16] __attribute__((aligned(64)));
    fxs_camera_init(&camera, 8, height);
    fxs_targets_init(&targets);
    targets.colour = (fxs_image){pixels[0], 32};
    targets.coverage = (fxs_image){top, stride};
    return render_frame(&plain, 0, 0, &camera, &options, &targets, memory, sizeof memory, 0);
}

static void test_strides_beyond_all_memory(void)
{
    const ptrdiff_t most = (PTRDIFF_MAX - 8) / 20;
    static const ptrdiff_t ends[] = {PTRDIFF_MAX, PTRDIFF_MIN};
    unsigned char *last = (unsigned char *)(uintptr_t)(UINTPTR_MAX - 80), *first = (unsigned char *)(uintptr_t)80;
    for (int i = 0; i < 2; i++)
        for (int32_t height = 1; height < 40; height += 19)
            CHECK(render_to(ends[i], pixels[1], height) == FXS_ERR_TARGET);
    CHECK(render_to(most + 1, first, 20) == FXS_ERR_TARGET && render_to(-most - 1, last, 20) == FXS_ERR_TARGET);
    CHECK(render_to(8, last, 20) == FXS_ERR_TARGET && render_to(-8, first, 20) == FXS_ERR_TARGET);
    CHECK(!render_to(8, pixels[1], 20) && !render_to(-8, pixels[1] + MOST, 20));
}

static int draw_pair(const fxs_object *object, const fxs_camera cameras[2], const fxs_targets targets[2])
{
    const size_t bytes = fxs_frame_bytes(&plain, object, 1, cameras[0].width, cameras[0].height, 0);
    void *memory = check_aligned(bytes);
    const int error = render_eyes(&plain, object, 1, cameras, &options, targets, memory, bytes, 0);
    free(memory);
    return error;
}

static void test_object_too_far_from_one_eye(void)
{
    const packed_scene s = cloud(9, 0, 0);
    fxs_object object = one_object(&s.scene);
    const fxs_targets targets[2] = {one_target(FXS_FORMAT_RGBA8, pixels[0], 128),
                                    one_target(FXS_FORMAT_RGBA8, pixels[1], 128)};
    object.scale_q32 = 65536;
    for (int i = 0; i < 2; i++) {
        const fxs_camera far = camera_at(32, -5000 * ONE), near = camera_at(32, -ONE);
        const fxs_camera cameras[2] = {i ? far : near, i ? near : far};
        memset(pixels, 0xa5, sizeof pixels);
        CHECK(draw_pair(&object, cameras, targets) == FXS_ERR_OBJECT);
        for (int k = 0; k < 32 * 32; k++)
            CHECK(pixels[0][k] == 0xa5a5a5a5 && pixels[1][k] == 0xa5a5a5a5);
    }
    free(s.data);
}

static void test_targets_of_both_eyes(void)
{
    const packed_scene s = cloud(9, 0, 0);
    const fxs_object object = one_object(&s.scene);
    const fxs_camera cameras[2] = {camera_at(32, -8 * ONE), camera_at(32, -8 * ONE)};
    fxs_targets targets[2] = {one_target(FXS_FORMAT_RGBA8, pixels[0], 256),
                              one_target(FXS_FORMAT_RGBA8, pixels[0] + 32, 256)};
    CHECK(!draw_pair(&object, cameras, targets));
    targets[1].colour.pixels = pixels[0] + 31;
    CHECK(draw_pair(&object, cameras, targets) == FXS_ERR_TARGET);
    targets[1].colour.pixels = pixels[0] + 32;
    targets[0].occluder = targets[1].occluder = (fxs_image){pixels[1], 128};
    CHECK(!draw_pair(&object, cameras, targets));
    targets[0].mean_depth = (fxs_image){pixels[1] + 4096, 128};
    targets[1].occluder = targets[0].mean_depth;
    CHECK(draw_pair(&object, cameras, targets) == FXS_ERR_TARGET);
    free(s.data);
}

enum { WILD_OBJECTS = 6, WILD_SIZE = 100 };

static int64_t wild(int bits)
{
    const int64_t most = (int64_t)1 << bits;
    const int64_t x = between(0, 5) ? (int64_t)(next() >> (64 - bits) >> between(0, bits - 1)) : most;
    return between(0, 1) ? x : -x;
}

static int64_t wild_above(int64_t least, int bits)
{
    const int64_t x = wild(bits);
    return x < 0 ? (-x < least ? least : -x) : x < least ? least : x;
}

static void stretch_chunk(packed_scene *s)
{
    const uint32_t chunk_count = s->scene.chunk_count;
    packed_scene_turn(s, chunk_count);
    fxs_chunk *chunk = &s->chunks[between(0, (int32_t)chunk_count - 1)];
    chunk->origin_q32[between(0, 2)] = wild(59);
    chunk->step_shift = (uint16_t)between(0, 10);
    chunk->step_q32[between(0, 2)] = (uint32_t)next() >> between(0, 31);
    chunk->scale_q16 = between(-19 * 65536, 32 * 65536);
    packed_scene_turn(s, chunk_count);
    CHECK(!fxs_scene_open(&s->scene, s->data, s->bytes));
}

static void wild_object(fxs_object *object, const packed_scene *s, fxs_crop crops[2])
{
    fxs_camera turned;
    random_camera(&turned);
    fxs_object_init(object, &s->scene);
    memcpy(object->rotation_q30, turned.rotation_q30, sizeof turned.rotation_q30);
    for (int i = 0; i < 3; i++) {
        object->translation_q32[i] = between(0, 3) ? between(-3, 3) * ONE : wild(60);
        object->tint_q13[i] = between(0, 2) ? 8192 : (uint32_t)between(0, 32768);
        for (int k = 0; k < 2; k++) {
            const int64_t a = wild(63 - between(1, 30)), b = wild(63 - between(1, 30));
            crops[k].low_q32[i] = a < b ? a : b;
            crops[k].high_q32[i] = a < b ? b : a;
            crops[k].outside = between(0, 1);
        }
    }
    object->scale_q32 = between(0, 1) ? ONE : wild_above(65536, 48);
    object->opacity_q16 = between(0, 1) ? 65536 : (uint32_t)wild_above(0, 16);
    object->visible = between(0, 9) > 0;
    object->id = (uint32_t)next();
    object->crops = crops;
    object->crop_count = between(0, 3) ? 0 : (uint32_t)between(1, 2);
}

static void wild_camera(fxs_camera *camera)
{
    random_camera(camera);
    camera->projection = between(0, 1) ? FXS_ORTHOGRAPHIC : FXS_PERSPECTIVE;
    if (!between(0, 2))
        camera->fx_q12 = camera->fy_q12 = (int32_t)(wild_above(1, 31) - 1) | 1;
    if (!between(0, 3))
        camera->fy_q12 = (int32_t)(wild_above(1, 31) - 1) | 1;
    if (!between(0, 4))
        camera->cx_q12 = (int32_t)wild(30);
    if (!between(0, 4))
        camera->position_q32[between(0, 2)] = wild(60);
    if (!between(0, 4))
        camera->near_q32 = wild_above(4096, 60);
}

static void wild_targets(fxs_targets *t, unsigned char *bytes, uint32_t *occluder, const fxs_camera *camera,
                         unsigned which, int upward)
{
    fxs_targets_init(t);
    t->format = (enum fxs_format)(which % 4);
    t->depth_bits = (int)(which / 4 % 29);
    fxs_image *const images[] = {&t->colour, &t->coverage, &t->mean_depth, &t->median_depth, &t->id};
    const int sizes[] = {fxs_pixel_bytes(t->format), 1, 4, 4, 8};
    for (int i = 0; i < 5; i++) {
        const ptrdiff_t stride = (ptrdiff_t)camera->width * sizes[i];
        if (which >> (8 + i) & 1 || i == 0)
            *images[i] = (fxs_image){bytes + (upward ? stride * (camera->height - 1) : 0), upward ? -stride : stride};
        bytes += WILD_SIZE * WILD_SIZE * 8;
    }
    if (which >> 14 & 1)
        t->occluder = (fxs_image){occluder, 4 * (ptrdiff_t)camera->width};
}

typedef struct wild_frame {
    packed_scene scenes[2];
    fxs_object objects[WILD_OBJECTS];
    fxs_crop crops[WILD_OBJECTS][2];
    uint32_t count;
    fxs_camera camera;
    fxs_options options;
    unsigned which;
    uint32_t occluder[WILD_SIZE * WILD_SIZE];
    unsigned char bytes[3][WILD_SIZE * WILD_SIZE * 40];
} wild_frame;

static void make_wild_frame(wild_frame *w)
{
    for (int i = 0; i < 2; i++)
        w->scenes[i] = random_scene((enum fxs_profile)between(0, 2), 700);
    if (!between(0, 2))
        stretch_chunk(&w->scenes[0]);
    w->count = (uint32_t)between(0, WILD_OBJECTS);
    for (uint32_t i = 0; i < w->count; i++)
        wild_object(&w->objects[i], &w->scenes[between(0, 1)], w->crops[i]);
    wild_camera(&w->camera);
    fxs_options_init(&w->options);
    w->options.cutoff = between(0, 4) ? FXS_CUTOFF_MAHALANOBIS : FXS_CUTOFF_SQUARE;
    w->options.sh_degree = between(0, 3);
    w->which = (unsigned)next();
    for (int i = 0; i < WILD_SIZE * WILD_SIZE; i++)
        w->occluder[i] = between(0, 9) ? (uint32_t)next() >> between(0, 31) : (uint32_t)between(-1, 0);
}

static int draw_wild(const fxs_context *context, wild_frame *w, int number, int upward, int less)
{
    fxs_targets targets;
    size_t bytes = fxs_frame_bytes(context, w->objects, w->count, w->camera.width, w->camera.height, 0);
    unsigned char *memory = check_aligned(bytes);
    memset(w->bytes[number], 0xa5, sizeof w->bytes[number]);
    wild_targets(&targets, w->bytes[number], w->occluder, &w->camera, w->which, upward);
    fxs_stats stats;
    int error = FXS_ERR_MEMORY;
    if (less) {
        error = render_frame(context, w->objects, w->count, &w->camera, &w->options, &targets, memory, 0, &stats);
        if (error == FXS_ERR_MEMORY)
            error = render_frame(context, w->objects, w->count, &w->camera, &w->options, &targets, memory,
                               stats.memory.least, &stats);
    }
    if (error == FXS_ERR_MEMORY)
        error = render_frame(context, w->objects, w->count, &w->camera, &w->options, &targets, memory, bytes, &stats);
    free(memory);
    return error;
}

static void check_wild_pick(wild_frame *w)
{
    fxs_targets targets;
    fxs_pick_result result;
    wild_targets(&targets, w->bytes[0], w->occluder, &w->camera, w->which | 1u << 12, 0);
    const size_t bytes = fxs_frame_bytes(&plain, w->objects, w->count, w->camera.width, w->camera.height, 0);
    void *memory = check_aligned(bytes);
    CHECK(!render_frame(&plain, w->objects, w->count, &w->camera, &w->options, &targets, memory, bytes, 0));
    for (int i = 0; i < 3; i++) {
        const int x = between(0, w->camera.width - 1), y = between(0, w->camera.height - 1);
        const fxs_id *id = (const fxs_id *)targets.id.pixels + y * w->camera.width + x;
        const int found = pick_pixel(&plain, w->objects, w->count, &w->camera, &w->options, &targets, x, y, memory,
                                     bytes, &result);
        CHECK(found == (id->gaussian != FXS_NOTHING));
        CHECK(found < 1 || (result.id == id->object && result.gaussian == id->gaussian));
    }
    free(memory);
}

/* Renders a stereo pair. less: 1 renders in the minimum memory. Fewer bytes are tried first and must write nothing. */
static int draw_wild_pair(const fxs_context *context, wild_frame *w, const fxs_camera cameras[2], int less)
{
    fxs_targets targets[2];
    fxs_stats stats;
    size_t bytes = fxs_frame_bytes(context, w->objects, w->count, w->camera.width, w->camera.height, 0);
    void *memory = check_aligned(bytes);
    memset(w->bytes, 0xa5, 2 * sizeof *w->bytes);
    for (int i = 0; i < 2; i++)
        wild_targets(&targets[i], w->bytes[i], w->occluder, &w->camera, w->which, i);
    for (size_t room = 0; less && room < bytes;) {
        const int error = render_eyes(context, w->objects, w->count, cameras, &w->options, targets, memory, room,
                                      &stats);
        for (size_t i = 0; i < sizeof *w->bytes && error; i++)
            if (!CHECK(w->bytes[0][i] == 0xa5 && w->bytes[1][i] == 0xa5))
                break;
        if (error == FXS_ERR_MEMORY && CHECK(stats.memory.least > room)) {
            room = stats.memory.least;
            continue;
        }
        free(memory);
        return error;
    }
    const int error = render_eyes(context, w->objects, w->count, cameras, &w->options, targets, memory, bytes, 0);
    free(memory);
    return error;
}

static int check_wild_pair(wild_frame *w, const fxs_context *fast)
{
    const fxs_camera first = w->camera;
    fxs_camera cameras[2] = {first, first};
    if (between(0, 1))
        wild_camera(&cameras[1]);
    cameras[1].width = first.width;
    cameras[1].height = first.height;
    cameras[1].projection = first.projection;
    if (between(0, 1))
        cameras[1].position_q32[between(0, 2)] += between(-ONE / 256, ONE / 256);
    int same = 1, errors[2];
    for (int less = 0; less < 2; less++) {
        errors[less] = draw_wild_pair(less ? &plain : fast, w, cameras, less);
        for (int i = 0; i < 2 && !errors[less]; i++) {
            w->camera = cameras[i];
            same &= CHECK(!draw_wild(&plain, w, 2, i, 0) && !memcmp(w->bytes[2], w->bytes[i], sizeof w->bytes[i]));
        }
        w->camera = first;
    }
    return same & CHECK(errors[0] == errors[1]);
}

static int check_wild_frame(wild_frame *w)
{
    static const unsigned cpus[] = {FXS_CPU_SSE41, FXS_CPU_SSE41 | FXS_CPU_AVX2,
                                    FXS_CPU_SSE41 | FXS_CPU_AVX2 | FXS_CPU_AVX512, FXS_CPU_NEON};
    make_wild_frame(w);
    const int error = draw_wild(&plain, w, 0, 0, 0);
    int same = CHECK(!error || error == FXS_ERR_OBJECT);
    for (size_t i = 0; i < sizeof cpus / sizeof *cpus; i++) {
        fxs_context fast = plain;
        fast.config.kernels = kernels_for(cpus[i]);
        same &= CHECK(draw_wild(&fast, w, 1, 0, (int)i) == error);
        same &= CHECK(!memcmp(w->bytes[0], w->bytes[1], sizeof w->bytes[0]));
    }
    if (!error)
        check_wild_pick(w);
    fxs_context fast = plain;
    fast.config.kernels = kernels_for(~0u);
    same &= check_wild_pair(w, &fast);
    free(w->scenes[0].data);
    free(w->scenes[1].data);
    return same;
}

static void test_wild_frames(void)
{
    const char *seeds = getenv("FXS_WILD_FRAMES");
    const uint64_t last = seeds ? strtoull(seeds, 0, 10) : 300;
    wild_frame *w = malloc(sizeof *w);
    for (uint64_t seed = 1; seed <= last; seed++) {
        state = seed;
        if (!check_wild_frame(w))
            printf("  wild frame %lu\n", (unsigned long)seed);
    }
    free(w);
}

int main(void)
{
    fxs_context_init(&plain, 0);
    fxs_options_init(&options);
    RUN(test_faint_objects_are_listed_whole);
    RUN(test_end_of_a_long_list);
    RUN(test_occluder_behind_a_long_list);
    RUN(test_pixel_of_an_orthographic_picture);
    RUN(test_camera_of_any_size);
    RUN(test_strides_beyond_all_memory);
    RUN(test_object_too_far_from_one_eye);
    RUN(test_targets_of_both_eyes);
    RUN(test_wild_frames);
    return check_report();
}
