/* all SCENE PACKED: opens the file SCENE, draws the scene, and writes it as the packed scene PACKED. Compiles as C99
   and as C++17. */
#include "picture.h"

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>

int main(int argc, char **argv)
{
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    fxs_message message;
    fxs_opened *opened;
    fxs_renderer *renderer;
    fxs_object object;
    fxs_request request;
    if (argc != 3 || fxs_open(argv[1], 0, &opened, &message) || fxs_renderer_create(0, 0, &renderer, &message))
        return 1;
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    request.targets[0].colour.pixels = pixels;
    request.targets[0].colour.stride = WIDTH * 4;
    picture_camera(&request.cameras[0]);
    if (fxs_renderer_render(renderer, &request, 0, &message) || picture_print(pixels) ||
        fxs_file_write(argv[2], opened->data, opened->bytes, &message))
        return 1;
    fxs_renderer_destroy(renderer);
    fxs_close(opened);
    return fxs_image_file_known("picture.png") != 1;
}
