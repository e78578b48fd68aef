#include "scene_picture.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>

static int render(const fxs_opened *opened, int width, int height, const uint8_t background[3], uint32_t threads,
                  uint8_t *pixels, fxs_message *message)
{
    const fxs_backend_options options = {.size = sizeof(fxs_backend_options), .threads = threads};
    fxs_renderer *renderer;
    fxs_object object;
    fxs_request request;
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    request.targets[0].colour = (fxs_image){pixels, (ptrdiff_t)width * 4};
    memcpy(request.options.background, background, 3);
    int error = fxs_opened_camera(opened, width, height, &request.cameras[0], message);
    error = error ? error : fxs_renderer_create("cpu", &options, &renderer, message);
    if (error)
        return error;
    error = fxs_renderer_render(renderer, &request, 0, message);
    fxs_renderer_destroy(renderer);
    return error;
}

int scene_picture(const fxs_opened *opened, int width, int height, const uint8_t background[3], uint32_t threads,
                  fxs_encoded *encoded, fxs_message *message)
{
    uint8_t *pixels = malloc((size_t)width * (size_t)height * 4);
    *encoded = (fxs_encoded){0};
    if (!pixels)
        return fxs_fail_memory(message, 0, 0);
    int error = render(opened, width, height, background, threads, pixels, message);
    if (!error)
        error = fxs_image_encode(FXS_IMAGE_JPG, PICTURE_QUALITY, pixels, width, height, encoded, message);
    free(pixels);
    return error;
}
