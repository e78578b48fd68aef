/* Frames that a back end on a GPU draws, compared with the CPU renderer byte for byte: random, wild and moving frames,
   sizes, real scenes, levels of detail, scenes in several buffers, frames larger than a buffer. The test program
   defines render_on_device and device_most. */
#ifndef DEVICE_FRAMES_H
#define DEVICE_FRAMES_H

#include <math.h>
#include <string.h>

#include <fixsplat/camera.h>
#include "check.h"
#include "moving_scene.h"
#include "one_scene.h"
#include "random_tree.h"
#include "random_world.h"
#include "tree_scene.h"

enum { SCENES = 2, OBJECTS = 4 };

static uint64_t part_bytes;   /* largest number of bytes of a scene in an upload to the GPU; 0: no limit */
static fxs_message why;
static int divided;           /* number of frames that were drawn in windows */

static int render_on_device(const fxs_request *request, fxs_stats *stats);

/* Returns where the back end has the size of the device's largest storage buffer. */
static uint64_t *device_most(void);

static int render_there(const fxs_request *request, fxs_stats *stats)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    const size_t bytes = fxs_request_bytes(&context, request, 0);
    void *memory = check_aligned(bytes);
    const int error = fxs_render(&context, request, memory, bytes, stats);
    free(memory);
    return error;
}

static int is_equal(const picture *a, const picture *b)
{
    size_t first = a->bytes, differing = 0;
    for (size_t i = 0; i < a->bytes; i++)
        if (a->block[i] != b->block[i]) {
            first = first < i ? first : i;
            differing++;
        }
    if (differing)
        printf("  %zu of %zu bytes differ, from %zu on: %d, not %d\n", differing, a->bytes, first, b->block[first],
               a->block[first]);
    return !differing;
}

/* Compares the pictures of each eye; a and b have as many elements as the request has eyes. */
static int is_same(fxs_request *request, picture *a, picture *b)
{
    fxs_stats of_a, of_b;
    for (uint32_t eye = 0; eye < request->eyes; eye++)
        request->targets[eye] = a[eye].targets;
    const int error_a = render_there(request, &of_a);
    for (uint32_t eye = 0; eye < request->eyes; eye++)
        request->targets[eye] = b[eye].targets;
    const int error_b = render_on_device(request, &of_b);
    if (error_a || error_b) {
        printf("  %d, %d: %s\n", error_a, error_b, error_b ? why.text : "");
        return error_a == error_b;
    }
    const int in_windows = of_b.bands > request->eyes;     /* a Gaussian may be visible in several windows */
    divided += in_windows;
    return CHECK(in_windows ? of_a.visible <= of_b.visible : of_a.visible == of_b.visible) &&
           CHECK(of_a.gaussians == of_b.gaussians) && CHECK(of_a.drawn == of_b.drawn) && is_equal(a, b) &&
           (request->eyes == 1 || is_equal(&a[1], &b[1]));
}

static void random_crops(fxs_object *object, fxs_crop crops[2])
{
    object->crops = crops;
    object->crop_count = (uint32_t)between(0, 2);
    for (int i = 0; i < 2; i++) {
        crops[i].outside = between(0, 1);
        for (int k = 0; k < 3; k++) {
            crops[i].low_q32[k] = (int64_t)between(-4194304, 0) * 4096;
            crops[i].high_q32[k] = (int64_t)between(0, 4194304) * 4096;
        }
    }
}

static void random_object(fxs_object *object, const fxs_scene *scene, fxs_crop crops[2])
{
    fxs_camera turned;
    fxs_object_init(object, scene);
    object->id = (uint32_t)next();
    if (between(0, 2) == 0)
        return;
    random_camera(&turned);
    memcpy(object->rotation_q30, turned.rotation_q30, sizeof object->rotation_q30);
    object->scale_q32 = between(0, 1) ? FXS_ONE_Q32 : (int64_t)between(1 << 20, 1 << 27) * 64;
    object->opacity_q16 = (uint32_t)between(1, 65536);
    object->visible = between(0, 7) != 0;
    for (int i = 0; i < 3; i++) {
        object->translation_q32[i] = (int64_t)between(-1048576, 1048576) * 4096;
        object->tint_q13[i] = between(0, 1) ? 8192 : (uint32_t)between(0, 32768);
    }
    random_crops(object, crops);
}

static void random_window(fxs_camera *camera)
{
    if (between(0, 3) == 0) {
        camera->whole_x = between(0, 50);
        camera->whole_y = between(0, 50);
        camera->whole_width = camera->width + camera->whole_x + between(0, 50);
        camera->whole_height = camera->height + camera->whole_y + between(0, 50);
    }
}

static void random_targets(picture *a, picture *b, uint32_t *read, const fxs_image *rates)
{
    const unsigned without = (unsigned)next();
    const int occluded = between(0, 2) == 0, over = between(0, 2) == 0 && !fxs_is_premultiplied(a->targets.format);
    const size_t pixels = (size_t)a->width * (size_t)a->height;
    picture *const both[] = {a, b};
    for (size_t i = 0; i < pixels; i++)
        read[i] = between(0, 9) ? (uint32_t)between(0, 1 << 20) : FXS_NOTHING;
    for (int i = 0; i < 2; i++) {
        fxs_targets *t = &both[i]->targets;
        leave_out(t, without);
        t->depth_bits = without >> 6 & 1 ? 0 : (int)(without >> 7 & 15) + 1;
        if (occluded)
            t->occluder = (fxs_image){read, 4 * (ptrdiff_t)a->width};
        if (over)
            t->backdrop = (fxs_image){read, 4 * (ptrdiff_t)a->width};
        t->rates = *rates;
    }
}

/* Gives a moving scene many codes whose products are halves or whose sums are ends of a range. */
static void fill_edges(const fxs_scene *scene, unsigned char *data)
{
    static const int16_t edges[] = {0, 0, 1, -1, 8192, -8192, 16384, -16384, 16383, 32767, -32768};
    const uint32_t still = fxs_chunk_bytes(scene->profile, scene->sh_degree);
    unsigned char *rows = data + (scene->rows - data);
    memset(data + (scene->motion - data) + offsetof(fxs_motion_header, cut_q16), 0, 4);
    for (uint32_t i = 0; i < scene->chunk_count; i++, rows += scene->chunk_bytes) {
        for (uint32_t at = still; at < scene->chunk_bytes; at += 2) {
            const uint16_t code = fxs_little_16((uint16_t)edges[between(0, 10)]);
            if (between(0, 3))
                memcpy(rows + at, &code, 2);
        }
        for (uint32_t g = 0; g < FXS_CHUNK && scene->profile != FXS_PROFILE_SMALL; g++)
            if (between(0, 1))
                memset(rows + FXS_ROW_ROTATION + 4 * g, 0, 4);
    }
}

static void set_moving(packed_scene *packed, fxs_scene *scene)
{
    size_t bytes;
    unsigned char *data = make_moving(scene, (uint32_t)between(0, 3), (uint32_t)between(0, 7), next(), &bytes);
    free(packed->data);
    packed->data = data;
    CHECK(!fxs_scene_open(scene, data, bytes));
    if (between(0, 1))
        fill_edges(scene, data);
}

static int64_t random_time(void)
{
    return (int64_t)between(-65536, 9 << 16) * 65536;
}

enum { STILL, MOVING, WILD };

static int random_frame(int kind, uint32_t eyes)
{
    packed_scene packed[SCENES];
    fxs_scene scenes[SCENES];
    fxs_object objects[OBJECTS];
    fxs_crop crops[OBJECTS][2];
    fxs_request request;
    const uint32_t count = (uint32_t)between(1, OBJECTS);
    for (int i = 0; i < SCENES; i++) {
        packed[i] = i || eyes == 1 ? random_scene((enum fxs_profile)between(0, 2), 1500)
                                   : random_tree((enum fxs_profile)between(0, 2), (uint32_t)between(2, 12), 0, 0);
        if (kind == WILD)
            fill_wild(&packed[i]);
        if (!CHECK(!fxs_scene_open(&scenes[i], packed[i].data, packed[i].bytes)))
            return 0;
        if (kind == MOVING && between(0, 3))
            set_moving(&packed[i], &scenes[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        random_object(&objects[i], &scenes[between(0, SCENES - 1)], crops[i]);
        objects[i].time_q32 = kind == MOVING && between(0, 1) ? random_time() : 0;
    }
    fxs_request_init(&request, objects, count);
    random_view(request.cameras, &request.options);
    random_near(request.cameras);
    random_window(request.cameras);
    if (kind == MOVING)
        request.options.time_q32 = random_time();
    if (kind == WILD)
        request.cameras->fx_q12 = between(1, INT32_MAX) >> between(0, 20), request.cameras->fx_q12 |= 1;
    if (eyes == 2) {
        request.eyes = 2;
        request.options.budget = between(0, 2) ? (uint32_t)between(1, 12 * FXS_CHUNK) : 0;
        random_other_eye(request.cameras);
    }
    picture a[2], b[2];
    uint32_t *read[2] = {0, 0};
    uint8_t rates[2][64];
    for (uint32_t eye = 0; eye < eyes; eye++) {
        a[eye] = picture_new(request.cameras->width, request.cameras->height, (enum fxs_format)between(0, 3));
        b[eye] = picture_new(request.cameras->width, request.cameras->height, a[eye].targets.format);
        read[eye] = malloc(4 * (size_t)a[eye].width * (size_t)a[eye].height);
        for (int i = 0; i < 64; i++)
            rates[eye][i] = (uint8_t)(1 << between(0, 2));
        const int rated = request.options.cutoff == FXS_CUTOFF_MAHALANOBIS && between(0, 1);
        random_targets(&a[eye], &b[eye], read[eye], &(fxs_image){rated ? rates[eye] : 0, 8});
    }
    const int same = is_same(&request, a, b);
    for (uint32_t eye = 0; eye < eyes; eye++) {
        free(read[eye]);
        picture_free(&a[eye]);
        picture_free(&b[eye]);
    }
    for (int i = 0; i < SCENES; i++)
        free(packed[i].data);
    return same;
}

static void random_frames(void)
{
    state = 20261;
    for (int i = 0; i < 200; i++)
        if (!CHECK(random_frame(STILL, 1))) {
            printf("  frame %d\n", i);
            return;
        }
}

static void random_eyes(void)
{
    state = 20265;
    for (int i = 0; i < 200; i++)
        if (!CHECK(random_frame(STILL, 2))) {
            printf("  frame %d\n", i);
            return;
        }
}

static void wild_frames(void)
{
    state = 20262;
    for (int i = 0; i < 200; i++)
        if (!CHECK(random_frame(WILD, 1))) {
            printf("  frame %d\n", i);
            return;
        }
}

/* Moving scenes at random times, alone and in stereo beside scenes with a tree and a budget; and in several buffers. */
static void moving_frames(void)
{
    state = 20267;
    for (int i = 0; i < 240; i++) {
        part_bytes = i % 4 == 3 ? 100000 : 0;
        if (!CHECK(random_frame(MOVING, 1 + (i % 3 == 1)))) {
            printf("  frame %d\n", i);
            break;
        }
    }
    part_bytes = 0;
}

static int look_at(fxs_camera *camera, int width, int height, double distance)
{
    const double eye[3] = {0.9, -2.6, -distance}, look[3] = {0, 0.4, 0}, up[3] = {0, -1, 0};
    fxs_view view;
    return CHECK(!fxs_view_look_at(&view, eye, look, up, &(fxs_picture){40, width, height}, &why) &&
                 !fxs_camera_from_view(camera, &view, &why));
}

static void compare_scene(const fxs_scene *scene, int width, int height, double distance, uint32_t budget)
{
    const fxs_object object = one_object(scene);
    fxs_request request;
    fxs_request_init(&request, &object, 1);
    request.options.budget = budget;
    if (!look_at(request.cameras, width, height, distance))
        return;
    /* traced 1: tests the shader trace_tiles, which writes depths and ids; 0: tests the shader blend_tiles */
    for (int traced = 0; traced < 2; traced++) {
        picture a = picture_new(width, height, FXS_FORMAT_RGBA8), b = picture_new(width, height, FXS_FORMAT_RGBA8);
        if (!traced) {
            const fxs_image none = {0, 0};
            a.targets.mean_depth = a.targets.median_depth = a.targets.id = none;
            b.targets.mean_depth = b.targets.median_depth = b.targets.id = none;
        }
        if (!CHECK(is_same(&request, &a, &b)))
            printf("  %d x %d, traced %d\n", width, height, traced);
        picture_free(&a);
        picture_free(&b);
    }
}

static void sizes(void)
{
    part p;
    if (!part_make(&p, "knot", 30000))
        return;
    const int all[][2] = {{1, 1}, {16, 16}, {15, 17}, {33, 31}, {100, 75}, {1279, 719}, {4096, 40}, {40, 4096}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        compare_scene(&p.scene, all[i][0], all[i][1], 12.8, 0);
    part_free(&p);
}

static void veils(void)
{
    state = 20264;
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
    fxs_scene scene;
    for (uint32_t c = 0; c < packed.header->chunk_count; c++) {
        packed.chunks[c].scale_q16 = 4 << 16;
        packed.chunks[c].scale_step_q24 = 0;
    }
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    compare_scene(&scene, 640, 480, 40, 0);
    free(packed.data);
}

static void captured_scenes(void)
{
    static const char *const names[] = {"snowmiku/snowmiku.ply", "skull/skull.sog",
                                        "kitchen-marble/kitchen-marble.spz"};
    int there = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        part p;
        if (part_load(&p, names[i])) {
            there++;
            compare_scene(&p.scene, 320, 180, 4, 0);
            compare_scene(&p.scene, 320, 180, 0.5, 0);
        }
        part_free(&p);
    }
    if (!there)
        SKIP("the captured scenes are not here");
}

static void parts_and_levels(void)
{
    for (int profile = 0; profile < 3; profile++) {
        fxs_packed_scene packed;
        fxs_scene scene;
        if (!CHECK(pack_tree("knot", (enum fxs_profile)profile, &packed, &scene)))
            return;
        for (int i = 0; i < 2; i++) {
            part_bytes = i ? 160000 : 0;
            compare_scene(&scene, 200, 150, 12.8, 0);
            compare_scene(&scene, 200, 150, 12.8, 5000);
            compare_scene(&scene, 200, 150, 2, 20000);
        }
        part_bytes = 0;
        fxs_packed_scene_free(&packed);
    }
}

static const char too_large[] =
    "the frame takes more than a storage buffer of this device can hold: set a budget of at most 7424 Gaussians";

/* A scene of which a single macro tile shows more Gaussians than a buffer holds is refused before anything is drawn;
   the budget that the message names helps. */
static void refuse_divided(const fxs_scene *scene)
{
    const fxs_object object = one_object(scene);
    fxs_request request;
    picture a = picture_new(200, 150, FXS_FORMAT_RGBA8), b = picture_new(200, 150, FXS_FORMAT_RGBA8);
    fxs_request_init(&request, &object, 1);
    if (!look_at(request.cameras, 200, 150, 100))
        return;
    request.targets[0] = b.targets;
    why.text[0] = 0;
    CHECK(render_on_device(&request, 0) == FXS_ERR_MEMORY && why.bytes_needed > *device_most());
    if (!CHECK(!strcmp(why.text, too_large)))
        printf("  %s\n", why.text);
    CHECK(is_equal(&a, &b));
    request.options.budget = 7424;
    CHECK(is_same(&request, &a, &b));
    picture_free(&a);
    picture_free(&b);
}

/* Frames on a device whose storage buffers are too small for a whole frame. */
static void divided_frames(void)
{
    const uint64_t most = *device_most();
    fxs_packed_scene packed;
    fxs_scene scene;
    state = 20266;
    CHECK(divided == 0);
    *device_most() = 250000;       /* below the usual room for lists: random frames are divided into macro tiles */
    for (int i = 0; i < 40; i++)
        if (!CHECK(random_frame(i % 3, i % 3 == 1 ? 2u : 1u))) {
            printf("  frame %d\n", i);
            break;
        }
    CHECK(divided > 25);
    if (CHECK(pack_tree("knot", FXS_PROFILE_DEFAULT, &packed, &scene))) {
        refuse_divided(&scene);
        *device_most() = (uint64_t)scene.chunk_count * FXS_CHUNK * 22;     /* a splat has 32 bytes */
        divided = 0;
        compare_scene(&scene, 333, 450, 4, 0);
        compare_scene(&scene, 640, 480, 4, scene.count - 2000);
        CHECK(divided == 4);
        fxs_packed_scene_free(&packed);
    }
    *device_most() = most;
}

static void device_frames(void)
{
    RUN(random_frames);
    RUN(random_eyes);
    RUN(wild_frames);
    RUN(moving_frames);
    RUN(sizes);
    RUN(veils);
    RUN(captured_scenes);
    RUN(parts_and_levels);
    RUN(divided_frames);
}

#endif
