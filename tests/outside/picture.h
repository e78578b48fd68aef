/* Renders a picture of a scene, for test programs outside the source tree. Compiles as C99 and as C++17. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include <fixsplat/internal/kernels.h>

enum { WIDTH = 160, HEIGHT = 120 };

static inline void *aligned(size_t bytes)
{
    char *block = (char *)malloc(bytes + 64);
    return block ? block + (64 - (size_t)block % 64) : 0;
}

static inline void picture_camera(fxs_camera *camera)
{
    fxs_camera_init(camera, WIDTH, HEIGHT);
    camera->fx_q12 = camera->fy_q12 = 150 << 12;
    camera->position_q32[2] = -((int64_t)10 << 32);
}

static inline int picture_print(const unsigned char *pixels)
{
    uint32_t sum = 2166136261u, lit = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++) {
        sum = (sum ^ pixels[i]) * 16777619u;
        lit += i % 4 != 3 && pixels[i] > 32;
    }
    printf("%08x\n", (unsigned)sum);
    return fxs_version() != FXS_VERSION_NUMBER || lit < 1000;
}

/* Draws the scene with the core library (the renderer alone) and prints the picture's hash. Returns 0, or 1 if the
   picture is empty. */
static inline int picture(const fxs_scene *scene)
{
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    fxs_context context;
    fxs_object object;
    fxs_request request;
    if (fxs_context_init(&context, 0))
        return 1;
    static fxs_kernels fastest;
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    context.config.kernels = &fastest;
    fxs_object_init(&object, scene);
    fxs_request_init(&request, &object, 1);
    picture_camera(&request.cameras[0]);
    request.targets[0].colour.pixels = pixels;
    request.targets[0].colour.stride = WIDTH * 4;
    const size_t bytes = fxs_frame_bytes(&context, &object, 1, WIDTH, HEIGHT, 0);
    void *memory = aligned(bytes);
    if (!memory || fxs_render(&context, &request, memory, bytes, 0))
        return 1;
    return picture_print(pixels);
}
