/* Writes the pictures of a scene that moves, as numbered files, at the frames of its source or 30 a second.
 *
 *     cc moving.c -o moving $(pkg-config --cflags --libs fixsplat)
 *     ./moving SCENE FOLDER             writes FOLDER/0000.png and so on */
#include <stdio.h>
#include <stdlib.h>

#include <fixsplat/image.h>
#include <fixsplat/renderer.h>

enum { WIDTH = 640, HEIGHT = 360 };

static unsigned char pixels[HEIGHT][WIDTH][4];

static int fail(const char *why)
{
    fprintf(stderr, "moving: %s\n", why);
    return 1;
}

int main(int argc, char **argv)
{
    fxs_message why;
    fxs_opened *opened;
    fxs_renderer *renderer;
    fxs_object object;
    fxs_request request;
    char path[4096];
    if (argc != 3)
        return fail("usage: moving SCENE FOLDER");
    if (fxs_open(argv[1], NULL, &opened, &why) || fxs_renderer_create(NULL, NULL, &renderer, &why))
        return fail(why.text);
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    request.targets[0].colour = (fxs_image){pixels, sizeof pixels[0]};
    if (fxs_opened_camera(opened, WIDTH, HEIGHT, &request.cameras[0], &why))
        return fail(why.text);

    const fxs_motion_info motion = fxs_scene_motion(opened->scene);
    const double second = 4294967296.0, rate = motion.rate_q32 ? (double)motion.rate_q32 / second : 30;
    const long frames = (long)((double)motion.duration_q32 / second * rate + 0.5);
    for (long i = 0; i < frames || i == 0; i++) {
        /* A scene that loops takes times beyond its duration; others stay as they are at their end. */
        request.options.time_q32 = (int64_t)((double)i / rate * second + 0.5);
        snprintf(path, sizeof path, "%s/%04ld.png", argv[2], i);
        if (fxs_renderer_render(renderer, &request, NULL, &why) ||
            fxs_image_file_write(path, pixels[0][0], WIDTH, HEIGHT, &why))
            return fail(why.text);
    }
    fxs_renderer_destroy(renderer);
    fxs_close(opened);
    return 0;
}
