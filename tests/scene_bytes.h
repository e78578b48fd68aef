/* Builds a scene file byte by byte in memory and reads the file. */
#ifndef SCENE_BYTES_H
#define SCENE_BYTES_H

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/scene.h>
#include "check.h"

enum { MAX_FILE = 1 << 21 };

static const char path[] = "made/scene";   /* file name that appears in error messages */
static uint8_t bytes[MAX_FILE];
static size_t size, file_size;
static fxs_message message;
static fxs_scene_file_info info;
static fxs_scene_file_options open_options = {.size = sizeof(fxs_scene_file_options)};

static inline const char *scenes_folder(void)
{
    return getenv("FXS_SCENES") ? getenv("FXS_SCENES") : "../shared/scenes";
}

/* ---- Building a scene file ---- */

static inline void put(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    size += (size_t)vsnprintf((char *)bytes + size, MAX_FILE - size, format, arguments);
    va_end(arguments);
}

static inline void put_u32_at(size_t offset, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[offset + (size_t)i] = (uint8_t)(value >> 8 * i);
}

static inline void put_float_at(size_t offset, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    put_u32_at(offset, bits);
}

static inline void put_u8(int value)
{
    bytes[size++] = (uint8_t)value;
}

static inline void put_u16(int value)
{
    put_u8(value);
    put_u8(value >> 8);
}

static inline void put_u32(uint32_t value)
{
    put_u32_at(size, value);
    size += 4;
}

static inline void put_float(float value)
{
    put_float_at(size, value);
    size += 4;
}

static inline void put_file(size_t length)
{
    file_size = length;
}

/* ---- Files made by the library's writers ---- */

static char written[] = "/tmp/fixsplat_written_XXXXXX";

static inline void make_written(void)
{
    int descriptor = mkstemp(written);
    if (descriptor < 0 || close(descriptor))
        abort();
}

static inline void take_written(void)
{
    FILE *stream = fopen(written, "rb");
    put_file(stream ? fread(bytes, 1, MAX_FILE, stream) : 0);
    if (stream)
        fclose(stream);
}

/* ---- Reading a scene file ---- */

/* Reads the file in memory twice, with two different numbers of Gaussians in each call. Returns 0, or the error code
   of the reader. */
static inline int read_file(fxs_gaussian *gaussians, size_t capacity)
{
    fxs_scene_file *file;
    fxs_gaussian one;
    long count, total = 0;
    const int error = fxs_scene_file_open_memory(path, bytes, file_size, &open_options, &file, &info, &message);
    if (error) {
        CHECK(file == NULL);
        return error;
    }
    while ((count = fxs_scene_file_read(file, &one, 1, &message)) > 0)
        total += count;
    CHECK(count < 0 || total == (long)info.count);
    CHECK(fxs_scene_file_rewind(file, &message) == 0);
    CHECK(fxs_scene_file_read(file, gaussians, capacity, &message) == (count < 0 ? count : total));
    fxs_scene_file_close(file);
    return count < 0 ? (int)count : 0;
}

/* Expects that the first `length` bytes of the file fail with a message that contains `text`. */
static inline void check_cut_fails(size_t length, const char *text)
{
    static fxs_gaussian gaussians[1024];
    put_file(length);
    CHECK(read_file(gaussians, 1024) == (strstr(text, "built without") ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE));
    if (!CHECK(strncmp(message.text, path, strlen(path)) == 0) || !CHECK(strstr(message.text, text) != NULL))
        printf("  said: %s\n  not:  %s\n", message.text, text);
}

static inline void check_fails(const char *text)
{
    check_cut_fails(size, text);
}

static inline int is_near(double a, double b, double tolerance)
{
    return fabs(a - b) <= tolerance * (1 + fabs(b));
}

/* ---- Comparison of real files ---- */

static inline double opacity_of(const fxs_gaussian *g)
{
    return 1 / (1 + exp(-(double)g->opacity));
}

/* Returns the cosine of half the angle between two rotations. The quaternions q and -q count as equal. */
static inline double rotation_match(const fxs_gaussian *a, const fxs_gaussian *b)
{
    double dot = 0, norm_a = 0, norm_b = 0;
    for (int i = 0; i < 4; i++) {
        dot += (double)a->rotation[i] * (double)b->rotation[i];
        norm_a += (double)a->rotation[i] * (double)a->rotation[i];
        norm_b += (double)b->rotation[i] * (double)b->rotation[i];
    }
    return fabs(dot) / sqrt(norm_a * norm_b);
}

static inline int is_same(const fxs_gaussian *a, const fxs_gaussian *b, double tolerance)
{
    int same = rotation_match(a, b) >= 1 - tolerance * tolerance && is_near(opacity_of(a), opacity_of(b), tolerance);
    for (int i = 0; i < 3; i++)
        same &= is_near((double)a->position[i], (double)b->position[i], tolerance)
                && is_near((double)a->scale[i], (double)b->scale[i], tolerance)
                && is_near((double)a->dc[i], (double)b->dc[i], tolerance);
    for (int i = 0; i < 45; i++)
        same &= is_near((double)a->sh[i], (double)b->sh[i], tolerance);
    return same;
}

static inline void check_same_scenes(const char *name, const char *other, double tolerance)
{
    static fxs_gaussian gaussians[2][1000];
    const char *names[2] = {name, other};
    fxs_scene_file *files[2] = {NULL, NULL};
    fxs_scene_file_info infos[2];
    long count, total = 0, different = 0;
    char full[1024];
    for (int i = 0; i < 2; i++) {
        snprintf(full, sizeof full, "%s/%s", scenes_folder(), names[i]);
        if (!CHECK(fxs_scene_file_open(full, NULL, &files[i], &infos[i], &message) == 0)) {
            printf("  %s\n", message.text);
            fxs_scene_file_close(files[0]);
            return;
        }
    }
    CHECK(infos[0].count == infos[1].count && infos[0].sh_degree == infos[1].sh_degree);
    while ((count = fxs_scene_file_read(files[0], gaussians[0], 1000, &message)) > 0
           && CHECK(fxs_scene_file_read(files[1], gaussians[1], 1000, &message) == count)) {
        for (long i = 0; i < count; i++)
            different += !is_same(&gaussians[0][i], &gaussians[1][i], tolerance);
        total += count;
    }
    CHECK(count == 0 && different == 0 && (uint64_t)total == infos[0].count);
    fxs_scene_file_close(files[0]);
    fxs_scene_file_close(files[1]);
}

#endif
