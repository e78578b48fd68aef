/* Renders random packed scenes. A constant hash of all frames must hold for every compiler, optimisation level
   and processor. `test_random N` prints the hash of case N. The test needs only the sources in src/. */
#include <inttypes.h>

#include "one_scene.h"
#include "random_scene.h"

#define CASES 300
#define EXPECTED 0x48a05448584659ebu
#define EXPECTED_COMPACT 0x140bdce390a7a5cbu
#define EXPECTED_SMALL 0x0291571e5e98d100u
#define EXPECTED_NEAR 0xc079978b5e3b85d8u
#define EXPECTED_WORLDS 0x9041eca0ed934fa8u

/* Renders a random frame and returns a hash of its pixels. near: 1 for a random near plane, 0 for the default. */
static uint64_t hash_case(enum fxs_profile profile, int which, int near)
{
    state = (uint64_t)which * 0x1234567u;
    packed_scene packed = random_scene(profile, 3000);
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    random_camera(&camera);
    if (near)
        random_near(&camera);
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    options.cutoff = between(0, 3) ? FXS_CUTOFF_MAHALANOBIS : FXS_CUTOFF_SQUARE;
    const enum fxs_format format = (enum fxs_format)between(0, 1);
    options.background[0] = (uint8_t)between(0, 255);
    size_t bytes = one_frame_bytes(&context, &packed.scene, camera.width, camera.height, 0);
    size_t pixels = (size_t)camera.width * (size_t)camera.height * 4;
    void *memory = check_aligned(bytes);
    uint8_t *rgba = malloc(pixels);
    if (!CHECK(memory && rgba && !one_render(&context, &packed.scene, &camera, &options, format, memory, bytes, rgba,
                                             (ptrdiff_t)camera.width * 4, 0)))
        exit(1);
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < pixels; i++)
        hash = (hash ^ rgba[i]) * 0x100000001b3u;
    free(rgba);
    free(memory);
    free(packed.data);
    return hash;
}

static void check_profile(enum fxs_profile profile, int near, uint64_t expected)
{
    uint64_t sum = 0;
    for (int i = 0; i < CASES; i++)
        sum = sum * 3 + hash_case(profile, i, near);
    printf("  %d random frames: %016" PRIx64 "\n", CASES, sum);
    CHECK(sum == expected);
}

static void test_default(void)
{
    check_profile(FXS_PROFILE_DEFAULT, 0, EXPECTED);
}

static void test_compact(void)
{
    check_profile(FXS_PROFILE_COMPACT, 0, EXPECTED_COMPACT);
}

static void test_small(void)
{
    check_profile(FXS_PROFILE_SMALL, 0, EXPECTED_SMALL);
}

static void test_near_planes(void)
{
    check_profile(FXS_PROFILE_DEFAULT, 1, EXPECTED_NEAR);
}

/* ---- Several objects, every target, an occluder and a background ------------------------------------------------ */

enum { OBJECTS = 8, MOST_PIXELS = 100 * 80 };

static void fold(uint64_t *hash, const void *pixels, size_t count, size_t size)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t word = 0;
        uint16_t half;
        const unsigned char *at = (const unsigned char *)pixels + i * size;
        if (size == 4)
            memcpy(&word, at, 4);
        else if (size == 2)
            memcpy(&half, at, 2), word = half;
        else
            word = *at;
        *hash = (*hash ^ word) * 0x100000001b3u;
    }
}

static void random_object(fxs_object *object, const fxs_scene *scene, fxs_crop crops[2])
{
    fxs_camera turned;
    fxs_object_init(object, scene);
    random_camera(&turned);
    memcpy(object->rotation_q30, turned.rotation_q30, sizeof object->rotation_q30);
    object->scale_q32 = between(0, 2) ? (int64_t)between(1 << 22, 1 << 26) << 8 : object->scale_q32;
    object->opacity_q16 = (uint32_t)(between(0, 2) ? 65536 : between(0, 65536));
    object->visible = between(0, 9) != 0;
    object->id = (uint32_t)between(0, 1 << 20);
    object->crops = crops;
    object->crop_count = (uint32_t)(between(0, 1) ? 0 : between(1, 2));
    for (int i = 0; i < 3; i++) {
        object->translation_q32[i] = (int64_t)between(-524288, 524288) * 4096;
        object->tint_q13[i] = (uint32_t)(between(0, 1) ? 8192 : between(0, 32768));
        for (int k = 0; k < 2; k++) {
            crops[k].low_q32[i] = (int64_t)between(-4194304, 0) * 4096;
            crops[k].high_q32[i] = (int64_t)between(0, 4194304) * 4096;
            crops[k].outside = k;
        }
    }
}

static uint64_t hash_world(int which)
{
    static uint8_t colour[MOST_PIXELS * 8], coverage[MOST_PIXELS], backdrop[MOST_PIXELS * 4];
    static uint32_t mean[MOST_PIXELS], median[MOST_PIXELS], occluder[MOST_PIXELS];
    static fxs_id ids[MOST_PIXELS];
    state = (uint64_t)which * 0x7654321u;
    packed_scene scenes[OBJECTS];
    fxs_object objects[OBJECTS];
    fxs_crop crops[OBJECTS][2];
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    fxs_targets targets;
    for (int i = 0; i < OBJECTS; i++) {
        scenes[i] = random_scene((enum fxs_profile)between(0, 2), 700);
        random_object(&objects[i], &scenes[i].scene, crops[i]);
    }
    random_camera(&camera);
    camera.projection = between(0, 3) ? FXS_PERSPECTIVE : FXS_ORTHOGRAPHIC;
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    fxs_targets_init(&targets);
    targets.format = (enum fxs_format)between(0, 3);
    targets.depth_bits = between(0, 28);
    const ptrdiff_t row = camera.width;
    const size_t pixels = (size_t)camera.width * (size_t)camera.height;
    for (size_t i = 0; i < pixels; i++) {
        occluder[i] = between(0, 3) ? FXS_NOTHING : (uint32_t)between(0, INT32_MAX) >> between(0, 16);
        for (int c = 0; c < 4; c++)
            backdrop[4 * i + (size_t)c] = (uint8_t)between(0, 255);
    }
    targets.colour = (fxs_image){colour, row * (targets.format == FXS_FORMAT_RGBA16_COVERAGE ? 8 : 4)};
    targets.coverage = (fxs_image){coverage, row};
    targets.mean_depth = (fxs_image){mean, row * 4};
    targets.median_depth = (fxs_image){median, row * 4};
    targets.id = (fxs_image){ids, row * 8};
    targets.occluder = (fxs_image){between(0, 1) ? occluder : 0, row * 4};
    if (targets.format == FXS_FORMAT_RGBA8 || targets.format == FXS_FORMAT_RGB565)
        targets.backdrop = (fxs_image){between(0, 1) ? backdrop : 0, row * 4};
    memset(colour, 0, sizeof colour);
    size_t bytes = fxs_frame_bytes(&context, objects, OBJECTS, camera.width, camera.height, 0);
    void *memory = check_aligned(bytes);
    if (!CHECK(memory && !render_frame(&context, objects, OBJECTS, &camera, &options, &targets, memory, bytes, 0)))
        exit(1);
    uint64_t hash = 0xcbf29ce484222325u;
    fold(&hash, colour, pixels * 4, targets.format == FXS_FORMAT_RGBA16_COVERAGE ? 2 : 1);
    fold(&hash, coverage, pixels, 1);
    fold(&hash, mean, pixels, 4);
    fold(&hash, median, pixels, 4);
    fold(&hash, ids, pixels * 2, 4);
    free(memory);
    for (int i = 0; i < OBJECTS; i++)
        free(scenes[i].data);
    return hash;
}

static void test_worlds(void)
{
    uint64_t sum = 0;
    for (int i = 0; i < CASES; i++)
        sum = sum * 3 + hash_world(i);
    printf("  %d random worlds: %016" PRIx64 "\n", CASES, sum);
    CHECK(sum == EXPECTED_WORLDS);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        printf("%016" PRIx64 "\n", hash_case(FXS_PROFILE_DEFAULT, atoi(argv[1]), 0));
        return 0;
    }
    RUN(test_default);
    RUN(test_compact);
    RUN(test_small);
    RUN(test_near_planes);
    RUN(test_worlds);
    return check_report();
}
