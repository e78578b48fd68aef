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
    const int one = 1 << 30;
    fxs_camera camera = {WIDTH, HEIGHT, 150 << 12, 150 << 12, 80 << 12, 60 << 12, {one, 0, 0, 0, one, 0, 0, 0, one},
                         {0, 0, -((int64_t)10 << 32)}, 0};
    fxs_context context;
    fxs_options options;
    if (fxs_init(&context, 0))
        return 1;
    fxs_kernels_choose(&context.kernels, fxs_cpu_detect());
    fxs_options_default(&options);
    const size_t bytes = fxs_frame_bytes(&context, scene, WIDTH, HEIGHT, 0);
    void *memory = aligned(bytes);
    if (!memory || fxs_render(&context, scene, &camera, &options, memory, bytes, pixels, WIDTH * 4, 0))
        return 1;

    uint32_t sum = 2166136261u, lit = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++) {
        sum = (sum ^ pixels[i]) * 16777619u;
        lit += i % 4 != 3 && pixels[i] > 32;
    }
    printf("%08x\n", (unsigned)sum);
    return lit < 1000;
}
