/* Fuzzes the reading of photographs for a fit. Bits 0, 1 and 5 of byte 0 pick the layout. Three sizes of two bytes
   split the input into cameras, images, points and a photograph. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/fit.h>

enum { FILES = 4 };

static char folder[] = "/tmp/fixsplat-fuzz-XXXXXX";

static const char *const names[][FILES] = {
    {"cameras.bin", "images.bin", "points3D.bin", "images/a"},
    {"cameras.txt", "images.txt", "points3D.txt", "images/a"},
    {"transforms_train.json", "transforms_test.json", "p.ply", "a.png"},
    {"cameras.json", "none", "input.ply", "images/a.jpg"},
    {"cameras.csv", "none", "points.ply", "images/a"},
    {"cameras.xml", "none", "points.ply", "images/a"},
    {"bundle.out", "list.txt", "none", "images/a"},
    {"transforms.json", "none", "p.ply", "a"},
};

static const char *path_of(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void remove_folder(void)
{
    rmdir(path_of("images"));
    rmdir(folder);
}

static void make_folder(void)
{
    if (!mkdtemp(folder) || mkdir(path_of("images"), 0700))
        abort();
    atexit(remove_folder);
}

static void put(const char *name, const uint8_t *data, size_t size)
{
    FILE *file = fopen(path_of(name), "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file))
        abort();
}

static void check_photo(const fxs_fit_photo *photo)
{
    const fxs_view *v = &photo->view;
    unsigned sum = 0;
    if (v->width < 1 || v->height < 1 || v->width > 16 || v->height > 16 || !isfinite(v->fx + v->fy + v->cx + v->cy))
        abort();
    for (int i = 0; i < 3 * v->width * v->height; i++)
        sum += photo->pixels[i];
    for (int i = 0; i < v->width * v->height && photo->mask; i++)
        sum += photo->mask[i];
    if (sum == UINT32_MAX)
        abort();
}

static void check(const fxs_photos *photos)
{
    if (!photos->fit_count || !photos->point_count)
        abort();
    for (size_t i = 0; i < photos->fit_count; i++)
        check_photo(&photos->fit[i]);
    for (size_t i = 0; i < photos->held_out_count; i++)
        check_photo(&photos->held_out[i]);
    for (size_t i = 0; i < photos->point_count; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(photos->points[i].position[k]))
                abort();
}

static void look_at(void *argument, const char *why)
{
    (void)argument;
    if (!*why || strchr(why, '\n'))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int made;
    if (!made)
        make_folder();
    made = 1;
    if (size < 7)
        return 0;
    const char *const *files = names[(data[0] & 3) | (data[0] >> 3 & 4)];
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = 16,
                                        .hold_out = data[0] >> 2 & 3, .skip_bad = data[0] >> 4 & 1,
                                        .ignore_transparent = data[0] >> 7 & 1, .invert_masks = data[0] >> 6 & 1,
                                        .left_out = look_at};
    const uint8_t *at = data + 7, *end = data + size;
    for (int i = 0; i < FILES; i++) {
        const size_t left = (size_t)(end - at);
        const size_t stated = i < 3 ? (size_t)(data[1 + 2 * i] | data[2 + 2 * i] << 8) : left;
        const size_t part = stated < left ? stated : left;
        if (part)
            put(files[i], at, part);
        at += part;
    }
    fxs_photos photos;
    fxs_message message;
    const int error = fxs_photos_read(folder, &options, &photos, &message);
    if (!error)
        check(&photos);
    else if (photos.fit || photos.held_out || photos.points || !message.text[0] || strchr(message.text, '\n'))
        abort();
    fxs_photos_free(&photos);
    for (int i = 0; i < FILES; i++)
        unlink(path_of(files[i]));
    return 0;
}
