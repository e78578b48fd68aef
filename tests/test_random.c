/* Random packed scenes, cameras and options, drawn small; the hashes of all frames folded into one constant that
 * every compiler, optimisation level and processor must give. `test_random N` prints the hash of case N alone. Needs
 * src/ only. */
#include <inttypes.h>

#include "random_scene.h"

#define CASES 300
#define EXPECTED 0x2df0384c9cc4811au

static uint64_t hash_case(int which)
{
    state = (uint64_t)which * 0x1234567u;
    size_t scene_bytes;
    void *data = random_scene(&scene_bytes, 3000);
    fxs_scene scene;
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    random_camera(&camera);
    fxs_init(&context, 0);
    fxs_options_default(&options);
    options.cutoff = between(0, 3) ? FXS_CUTOFF_MAHALANOBIS : FXS_CUTOFF_SQUARE;
    options.format = (enum fxs_format)between(0, 1);
    options.background[0] = (uint8_t)between(0, 255);
    if (!CHECK(fxs_scene_open(&scene, data, scene_bytes) == 0))
        exit(1);
    size_t bytes = fxs_frame_bytes(&context, &scene, camera.width, camera.height, 0);
    size_t pixels = (size_t)camera.width * (size_t)camera.height * 4;
    void *memory = check_aligned(bytes);
    uint8_t *rgba = malloc(pixels);
    if (!CHECK(memory && rgba && !fxs_render(&context, &scene, &camera, &options, memory, bytes, rgba,
                                             (ptrdiff_t)camera.width * 4, 0)))
        exit(1);
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < pixels; i++)
        hash = (hash ^ rgba[i]) * 0x100000001b3u;
    free(rgba);
    free(memory);
    free(data);
    return hash;
}

static void test_one_constant(void)
{
    uint64_t sum = 0;
    for (int i = 0; i < CASES; i++)
        sum = sum * 3 + hash_case(i);
    printf("  %d random frames: %016" PRIx64 "\n", CASES, sum);
    CHECK(sum == EXPECTED);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        printf("%016" PRIx64 "\n", hash_case(atoi(argv[1])));
        return 0;
    }
    RUN(test_one_constant);
    return check_report();
}
