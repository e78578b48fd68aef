/* Random packed scenes, cameras and options, drawn small; the hashes of all frames folded into one constant that
 * every compiler, optimisation level and processor must give. `test_random N` prints the hash of case N of the
 * default profile alone. Needs src/ only. */
#include <inttypes.h>

#include "one_scene.h"
#include "random_scene.h"

#define CASES 300
#define EXPECTED 0x4271a9e7e1545376u
#define EXPECTED_COMPACT 0x2f591171f5e73047u
#define EXPECTED_SMALL 0x9d092ef7761c9857u
#define EXPECTED_NEAR 0xfd82acde1bc259edu

/* near: with a random near plane; else with the default. */
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
    fxs_init(&context, 0);
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
    return check_report();
}
