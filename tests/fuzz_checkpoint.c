/* Fuzzes the resuming of a fit from a checkpoint file. The fuzz target corrects the checksum of the file. A resumed
   fit runs two more steps. Its parameters must be finite and must pack to a scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/fit/fit_internal.h"
#include "src/base/random.h"

enum { SIDE = 20, POINTS = 5, HEAD = 8, PRINT = 56, PRINT_BYTES = 8, END = 12 };

static uint8_t pixels[3 * SIDE * SIDE];
static fxs_fit_photo photo;
static fxs_fit_options options;
static uint8_t whole[1 << 14];
static size_t whole_size;
static char path[] = "/tmp/fixsplat-fuzz-XXXXXX";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void remove_file(void)
{
    unlink(path);
}

static void save_one(void)
{
    fxs_fit *fit;
    fxs_fit_point points[POINTS];
    fxs_message message;
    FILE *file;
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        pixels[i] = (uint8_t)(i * 7);
    photo.view = (fxs_view){.name = "a", .width = SIDE, .height = SIDE, .fx = 20, .fy = 20, .cx = 10, .cy = 10,
                                 .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .position = {0, 0, -4}};
    photo.pixels = pixels;
    for (int i = 0; i < POINTS; i++)
        points[i] = (fxs_fit_point){{(float)i / 3 - 1, (float)(i % 2), 0}, {200, 100, 50}};
    fxs_fit_options_init(&options);
    const int made = mkstemp(path);
    if (made < 0 || close(made) || atexit(remove_file))
        abort();
    if (fxs_fit_create(&fit, &photo, 1, points, POINTS, &options, &message) || fxs_fit_save(fit, path, &message))
        abort();
    fxs_fit_destroy(fit);
    file = fopen(path, "rb");
    whole_size = file ? fread(whole, 1, sizeof whole, file) : 0;
    if (!whole_size || fclose(file))
        abort();
}

static void seal(uint8_t *bytes, size_t size)
{
    uint64_t sum = 0;
    for (size_t i = 0; i + 8 < size; i += 4)
        sum = fxs_random_mix(sum ^ (bytes[i] | (uint32_t)bytes[i + 1] << 8 | (uint32_t)bytes[i + 2] << 16 |
                                 (uint32_t)bytes[i + 3] << 24));
    for (size_t i = 0; i < 8; i++)
        bytes[size - 8 + i] = (uint8_t)(sum >> 8 * i);
}

static void check_numbers(const fxs_fit *fit)
{
    const fxs_fit_model *m = &fit->model;
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        for (size_t i = 0; i < m->count; i++)
            if (!isfinite(m->parameters[k * m->stride + i]))
                abort();
}

static void go_on(fxs_fit *fit)
{
    fxs_fit_report report;
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_message message;
    for (int i = 0; i < 2; i++)
        if (fxs_fit_step(fit, &report, &message))
            return;
    check_numbers(fit);
    if (fxs_fit_pack(fit, &packed, NULL, &message))
        return;
    if (fxs_scene_open(&scene, packed.data, packed.bytes))
        abort();
    fxs_packed_scene_free(&packed);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t bytes[1 << 14];
    fxs_fit *fit;
    fxs_message message;
    if (!whole_size)
        save_one();
    size = size / 4 * 4;
    if (size < PRINT + PRINT_BYTES + END || size > sizeof bytes)
        return 0;
    memcpy(bytes, data, size);
    memcpy(bytes, whole, HEAD);
    memcpy(bytes + PRINT, whole + PRINT, PRINT_BYTES);
    memcpy(bytes + size - END, whole + whole_size - END, 4);
    seal(bytes, size);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file))
        abort();
    options.cpu = size / 4 % 2 ? ~0u : 0;
    const int error = fxs_fit_resume(&fit, path, &photo, 1, &options, &message);
    if (error && (fit || !*message.text || strchr(message.text, '\n')))
        abort();
    if (!error)
        go_on(fit);
    fxs_fit_destroy(fit);
    return 0;
}
