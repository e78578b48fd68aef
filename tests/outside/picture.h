/* A picture of a scene, for programs outside the tree; in the common subset of C99 and C++17. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include <fixsplat/kernels.h>

enum { WIDTH = 160, HEIGHT = 120 };

/* Memory aligned to 64, never freed. */
static void *aligned(size_t bytes)
{
    char *block = (char *)malloc(bytes + 64);
    return block ? block + (64 - (size_t)block % 64) : 0;
}

/* Draws the scene, seen along z, and prints the sum of its bytes. Returns 0, or 1 where nothing can be seen. */
static int picture(const fxs_scene *scene)
{
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    fxs_camera_init(&camera, WIDTH, HEIGHT);
    camera.fx_q12 = camera.fy_q12 = 150 << 12;
    camera.position_q32[2] = -((int64_t)10 << 32);
    if (fxs_version() != FXS_VERSION_NUMBER || fxs_init(&context, 0))
        return 1;
    fxs_kernels_choose(&context.kernels, fxs_cpu_detect());
    fxs_options_init(&options);
    fxs_object object;
    fxs_targets targets;
    fxs_object_init(&object, scene);
    fxs_targets_init(&targets);
    targets.colour.pixels = pixels;
    targets.colour.stride = WIDTH * 4;
    const size_t bytes = fxs_frame_bytes(&context, &object, 1, WIDTH, HEIGHT, 0);
    void *memory = aligned(bytes);
    if (!memory || fxs_render(&context, &object, 1, &camera, &options, &targets, memory, bytes, 0))
        return 1;

    uint32_t sum = 2166136261u, lit = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++) {
        sum = (sum ^ pixels[i]) * 16777619u;
        lit += i % 4 != 3 && pixels[i] > 32;
    }
    printf("%08x\n", (unsigned)sum);
    return lit < 1000;
}
