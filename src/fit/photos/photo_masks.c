/* Finds and reads masks of photographs. */
#include "photo_masks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include <fixsplat/internal/message.h>
#include "src/base/files_internal.h"

static int is_there(char path[FXS_PHOTO_PATH], const char *folder, const char *name, size_t length)
{
    const int written = snprintf(path, FXS_PHOTO_PATH, "%s/%.*s.png", folder, (int)length, name);
    return written > 0 && written < FXS_PHOTO_PATH && fxs_file_kind(path) != FXS_FILE_NONE;
}

int fxs_photo_mask_in(const char *folder, const char *name, char path[FXS_PHOTO_PATH])
{
    const char *slash = strrchr(name, '/'), *dot = strrchr(slash ? slash : name, '.');
    if (is_there(path, folder, name, strlen(name)) ||
        (dot && is_there(path, folder, name, (size_t)(dot - name))))
        return 1;
    *path = 0;
    return 0;
}

static const char *folder_of(const fxs_photo_list *list, const fxs_photos_options *options)
{
    return options->masks ? options->masks : list->masks;
}

static int names_masks(const fxs_view_list *views)
{
    for (size_t i = 0; i < views->count; i++)
        if (views->views[i].mask)
            return 1;
    return 0;
}

int fxs_photo_masks_are_there(const fxs_photo_list *list, const fxs_photos_options *options)
{
    return *folder_of(list, options) || (!options->masks && (names_masks(&list->fit) || names_masks(&list->held_out)));
}

static const char *name_in(const char *folder, const char *image)
{
    const char *slash = strrchr(image, '/'), *last = slash ? slash + 1 : image;
    const size_t length = strlen(folder);
    if (!length || strncmp(image, folder, length) || (folder[length - 1] != '/' && image[length] != '/'))
        return last;
    const char *name = image + length + strspn(image + length, "/");
    return strncmp(name, "../", 3) ? name : last;
}

int fxs_photo_mask_find(const fxs_photo_list *list, const fxs_photos_options *options, const fxs_listed_view *view,
                        const char *image, fxs_photo_masking *masking, fxs_message *message)
{
    const char *folder = folder_of(list, options), *name = name_in(list->images, image);
    *masking = (fxs_photo_masking){.is_inverse = options->invert_masks,
                                   .ignores_transparent = options->ignore_transparent};
    if (!options->masks && view->mask)
        return fxs_photo_list_path(list, view->mask, masking->path, message);
    if (*folder && !fxs_photo_mask_in(folder, name, masking->path) && !strncmp(name, "images/", 7))
        fxs_photo_mask_in(folder, name + 7, masking->path);
    return 0;
}

static int has_mask(const fxs_photo_list *list, const fxs_photos_options *options, const fxs_view_list *views)
{
    char image[FXS_PHOTO_PATH];
    fxs_photo_masking masking = {.path = ""};
    fxs_message why;
    for (size_t i = 0; i < views->count && !*masking.path; i++)
        if (!fxs_photo_list_image(list, &views->views[i], image, &why))
            fxs_photo_mask_find(list, options, &views->views[i], image, &masking, &why);
    return *masking.path != 0;
}

int fxs_photo_masks_check(const fxs_photo_list *list, const fxs_photos_options *options, fxs_message *message)
{
    const char *folder = folder_of(list, options);
    if (!options->masks || !*folder)
        return 0;
    if (fxs_file_kind(folder) != FXS_FILE_FOLDER)
        return fxs_fail(message, "%s: no such folder of masks", folder);
    if (!has_mask(list, options, &list->fit) && !has_mask(list, options, &list->held_out))
        return fxs_fail(message, "%s: it has a mask of none of the photographs; that of IMAGE.jpg is IMAGE.jpg.png or "
                        "IMAGE.png", folder);
    return 0;
}

static int take_mask(const char *path, const uint8_t *rgba, size_t pixels, int is_inverse, uint8_t *counts,
                     fxs_message *message)
{
    int brightest = 0;
    for (size_t i = 0; i < pixels; i++) {
        const int grey = fxs_photo_mask_grey(rgba + 4 * i);
        brightest = grey > brightest ? grey : brightest;
        counts[i] = (grey >= FXS_PHOTO_MASK_WHITE) != is_inverse;
    }
    if (brightest > 0 && brightest < FXS_PHOTO_MASK_WHITE)
        return fxs_fail(message, "%s: nothing is brighter than %d of 255: a mask is white where the photograph counts, "
                        "and black elsewhere", path, brightest / (3 * 255));
    return 0;
}

static int read_mask(const fxs_photo_masking *masking, const char *image, int width, int height, uint8_t *counts,
                     fxs_message *message)
{
    uint8_t *rgba;
    int own_width, own_height, error;
    FXS_TRY(fxs_image_file_read(masking->path, &rgba, &own_width, &own_height, message));
    if (own_width != width || own_height != height)
        error = fxs_fail(message, "%s: %d x %d pixels, its photograph %s has %d x %d", masking->path, own_width,
                         own_height, image, width, height);
    else
        error = take_mask(masking->path, rgba, (size_t)width * (size_t)height, masking->is_inverse, counts, message);
    free(rgba);
    return error;
}

static void take_alpha(uint8_t *rgba, size_t pixels, uint8_t *counts)
{
    for (size_t i = 0; i < pixels; i++)
        if (rgba[4 * i + 3] < 128)
            counts[i] = 0;
        else
            rgba[4 * i + 3] = 255;
}

int fxs_photo_mask_read(const fxs_photo_masking *masking, const char *image, uint8_t *rgba, int width, int height,
                        uint8_t **counts, fxs_message *message)
{
    const size_t pixels = (size_t)width * (size_t)height;
    int error = 0;
    *counts = NULL;
    if (!*masking->path && !masking->ignores_transparent)
        return 0;
    if (!(*counts = malloc(pixels)))
        return fxs_fail_memory(message, image, pixels);
    memset(*counts, 1, pixels);
    if (*masking->path)
        error = read_mask(masking, image, width, height, *counts, message);
    if (!error && masking->ignores_transparent)
        take_alpha(rgba, pixels, *counts);
    if (error || !memchr(*counts, 0, pixels)) {
        free(*counts);
        *counts = NULL;
    }
    return error;
}
