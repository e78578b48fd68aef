/* Writes pictures and COLMAP models into a folder and reads the folder as photographs of a fit. */
#ifndef PHOTO_FOLDER_H
#define PHOTO_FOLDER_H

#include <math.h>
#include <stdint.h>

#include <fixsplat/fit.h>
#include "folder.h"

static fxs_message message;
static fxs_photos photos;

/* Adds bytes to an FNV-1a hash. The start value is 2166136261. */
static inline uint32_t hash_on(uint32_t hash, const void *data, size_t size)
{
    const uint8_t *bytes = data;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 16777619u;
    return hash;
}

static inline uint32_t random_number(void)
{
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return state >> 16;
}

static inline void put_text(const char *name)
{
    put_file(name, text, length);
    length = 0;
}

static inline void make_folder(const char *name)
{
    CHECK(!mkdir(in_folder(name), 0777));
}

/* Writes a picture as .ppm. rgb: the colours; null writes noise. */
static inline void put_ppm(const char *name, int width, int height, const uint8_t *rgb)
{
    static uint8_t bytes[1 << 17];
    size_t size = (size_t)sprintf((char *)bytes, "P6\n%d %d\n255\n", width, height);
    for (int i = 0; i < 3 * width * height; i++)
        bytes[size++] = rgb ? rgb[i] : (uint8_t)random_number();
    put_file(name, bytes, size);
}

static inline int read_photos(const char *name, const fxs_photos_options *options)
{
    fxs_photos_free(&photos);
    memset(&message, 0, sizeof message);
    const int error = fxs_photos_read(in_folder(name), options, &photos, &message);
    if (error)
        CHECK(message.text[0] && !strchr(message.text, '\n') && !photos.fit && !photos.held_out && !photos.points);
    return error;
}

static inline void check_refused(const char *name, const fxs_photos_options *options, int error, const char *words)
{
    const int got = read_photos(name, options);
    if (!CHECK(got == error && strstr(message.text, words)))
        printf("  %s: %d, \"%s\", expected \"%s\"\n", name, got, message.text, words);
}

#endif
