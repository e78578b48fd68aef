/* Tests the simple interface renderer.h: a scene in memory in two formats, limits, damaged data and wrong arguments. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include "check.h"

enum { COUNT = 40, WIDTH = 64, HEIGHT = 48 };

static uint8_t records[COUNT][32];              /* .splat records of 32 bytes: position, sigma, RGBA, quaternion */
static uint8_t pixels[HEIGHT][WIDTH][4], again[HEIGHT][WIDTH][4];
static fxs_message why;

static void make_records(void)
{
    for (int i = 0; i < COUNT; i++) {
        const float numbers[6] = {(float)(i % 8) - 4, (float)(i / 8) - 2, (float)(i % 3), 0.4f, 0.3f, 0.2f};
        const uint8_t codes[8] = {(uint8_t)(i * 6), 200, 90, 255, 255, 128, 128, 128};
        memcpy(records[i], numbers, sizeof numbers);
        memcpy(records[i] + sizeof numbers, codes, sizeof codes);
    }
}

static int draw(const fxs_opened *opened, fxs_renderer *renderer, void *to, fxs_pick_result *picked)
{
    fxs_object object;
    fxs_request request;
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    request.targets[0].colour = (fxs_image){to, 4 * WIDTH};
    int error = fxs_opened_camera(opened, WIDTH, HEIGHT, &request.cameras[0], &why);
    error = error ? error : fxs_renderer_render(renderer, &request, NULL, &why);
    return error ? error : fxs_renderer_pick(renderer, &request, WIDTH / 2, HEIGHT / 2, picked, &why);
}

static void the_same_from_bytes(void)
{
    fxs_opened *splat = NULL, *fxs = NULL;
    fxs_renderer *renderer = NULL;
    fxs_pick_result picked;
    const fxs_scene_file_options limit = {.size = sizeof limit, .max_gaussians = COUNT - 1};
    const fxs_open_options careful = {.size = sizeof careful, .check_all = 1}, few =
        {.size = sizeof few, .file = &limit};
    CHECK(fxs_open_memory("a.splat", records, sizeof records, NULL, &splat, &why) == 0);
    CHECK(fxs_renderer_create(NULL, NULL, &renderer, &why) == 0);
    if (!splat || !renderer)
        return;
    CHECK(!strcmp(splat->info->format, "splat") && splat->info->count == COUNT);
    CHECK(draw(splat, renderer, pixels, &picked) == 1);
    CHECK(pixels[HEIGHT / 2][WIDTH / 2][1] > 100);

    uint8_t *room = malloc(splat->bytes + 128), *data = (uint8_t *)(((uintptr_t)room + 63) / 64 * 64);
    memcpy(data, splat->data, splat->bytes);
    CHECK(fxs_file_seal(data, splat->bytes) == 0);
    for (int shift = 0; shift < 2; shift++) {   /* opens the scene from aligned memory, then from unaligned memory */
        memmove(data + 4 * shift, data, splat->bytes);
        CHECK(fxs_open_memory("a.fxs", data + 4 * shift, splat->bytes, &careful, &fxs, &why) == 0);
        CHECK(fxs && !strcmp(fxs->info->format, "fxs") && (fxs->data == data) == !shift);
        memset(again, 0, sizeof again);
        CHECK(fxs && draw(fxs, renderer, again, &picked) == 1 && !memcmp(again, pixels, sizeof pixels));
        CHECK(fxs_opened_check(fxs, &why) == 0);
        fxs_renderer_forget(renderer, fxs ? fxs->scene : NULL);
        fxs_close(fxs);
    }
    memmove(data, data + 4, splat->bytes);
    CHECK(fxs_open_memory("a.fxs", data, splat->bytes, &few, &fxs, &why) == FXS_ERR_FILE && !fxs);
    data[splat->bytes - 1] ^= 1;
    CHECK(fxs_open_memory("a.fxs", data, splat->bytes, &careful, &fxs, &why) == FXS_ERR_FILE && !fxs);
    fxs_renderer_destroy(renderer);
    fxs_close(splat);
    free(room);
}

static void wrong_arguments(void)
{
    fxs_opened *opened = NULL;
    fxs_renderer *renderer = NULL;
    fxs_request request;
    fxs_camera camera;
    fxs_pick_result picked;
    fxs_object object;
    const fxs_open_options crowd = {.size = sizeof(fxs_open_options), .threads = 65};
    CHECK(fxs_open(NULL, NULL, &opened, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_open("a.splat", NULL, NULL, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_open_memory("a", NULL, 9, NULL, &opened, &why) == FXS_ERR_ARGUMENT && !opened);
    CHECK(fxs_open_gaussians("a", NULL, NULL, NULL, &opened, &why) == FXS_ERR_ARGUMENT && !opened);
    CHECK(fxs_open_memory("a", records, sizeof records, &crowd, &opened, &why) == FXS_ERR_ARGUMENT && !opened);
    CHECK(fxs_opened_check(NULL, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_renderer_create("nothing", NULL, &renderer, &why) == FXS_ERR_ARGUMENT && !renderer);
    CHECK(strstr(why.text, "\"nothing\"") && strstr(why.text, "cpu") && strstr(why.text, "cuda"));
    CHECK(fxs_renderer_create(NULL, NULL, NULL, &why) == FXS_ERR_ARGUMENT);
    CHECK(!fxs_renderer_backend(NULL));
    fxs_renderer_forget(NULL, NULL);
    fxs_renderer_destroy(NULL);
    fxs_close(NULL);

    CHECK(fxs_open_memory("a.splat", records, sizeof records, NULL, &opened, &why) == 0);
    CHECK(fxs_renderer_create("cpu", NULL, &renderer, &why) == 0);
    if (!opened || !renderer)
        return;
    CHECK(fxs_opened_camera(opened, 0, 9, &camera, &why) == FXS_ERR_SIZE);
    CHECK(fxs_opened_camera(opened, 9, FXS_MAX_SIZE + 1, &camera, &why) == FXS_ERR_SIZE);
    CHECK(fxs_opened_camera(opened, 9, 9, NULL, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_renderer_render(renderer, NULL, NULL, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_renderer_pick(renderer, NULL, 0, 0, &picked, &why) == FXS_ERR_ARGUMENT);
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    request.targets[0].colour = (fxs_image){pixels, 4 * WIDTH};
    CHECK(fxs_opened_camera(opened, WIDTH, HEIGHT, &request.cameras[0], &why) == 0);
    request.cameras[0].width = 20000;
    CHECK(fxs_renderer_render(renderer, &request, NULL, &why) == FXS_ERR_SIZE);
    fxs_renderer_destroy(renderer);
    fxs_close(opened);
}

int main(void)
{
    make_records();
    RUN(the_same_from_bytes);
    RUN(wrong_arguments);
    return check_report();
}
