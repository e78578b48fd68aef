/* Reads a camera file with the reader that suits its name and content. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include "camera_internal.h"
#include "lens_file.h"
#include "src/base/files_internal.h"
#include "src/base/foreign.h"

static int fail_foreign(const fxs_view_list *list, const fxs_text *text)
{
    const char *kind = fxs_foreign(text->data, text->size);
    return fxs_fail(list->message, "%s: expected cameras (transforms.json, cameras.json, images.bin or images.txt of "
                    "COLMAP, .xml of Metashape, .csv of RealityCapture, .out of Bundler, or a folder with one of "
                    "them), but this is %s", list->path, kind ? kind : text->size ? "another file" : "empty");
}

static int parse(fxs_view_list *list, fxs_text *text)
{
    const char *begin = text->data + strspn(text->data, " \t\r\n\xef\xbb\xbf");
    if (*begin == '{' || *begin == '[')
        return fxs_camera_json_parse(list, text);
    if (!strncmp(begin, "# Bundle file", 13)) {
        list->format = FXS_CAMERAS_OF_BUNDLER;
        return fxs_camera_bundler_read(list, text);
    }
    if (!strncmp(begin, "#name,", 6) || !strncmp(begin, "#name;", 6) ||
        (text->size && fxs_ends_in(list->path, ".csv"))) {
        list->format = FXS_CAMERAS_OF_CSV;
        return fxs_camera_csv_parse(list, text);
    }
    if (!strncmp(begin, "<?xml", 5) || !strncmp(begin, "<document", 9) ||
        (text->size && fxs_ends_in(list->path, ".xml"))) {
        list->format = FXS_CAMERAS_OF_METASHAPE;
        return fxs_camera_metashape_parse(list, text);
    }
    return fail_foreign(list, text);
}

static int read_text(fxs_view_list *list)
{
    fxs_text text;
    FXS_TRY(fxs_text_load(list->path, &text, list->message));
    const int status = parse(list, &text);
    free(text.data);
    return status;
}

static int read_colmap(fxs_view_list *list, const char *folder, int folder_length, int binary)
{
    char cameras_path[FXS_CAMERA_PATH], images_path[FXS_CAMERA_PATH];
    const char *ending = binary ? "bin" : "txt";
    snprintf(cameras_path, sizeof cameras_path, "%.*scameras.%s", folder_length, folder, ending);
    snprintf(images_path, sizeof images_path, "%.*simages.%s", folder_length, folder, ending);
    const char *model = list->path;
    fxs_text cameras, images;
    FXS_TRY(fxs_text_load(cameras_path, &cameras, list->message));
    int status = fxs_text_load(images_path, &images, list->message);
    if (!status) {
        list->path = images_path;
        status = fxs_camera_colmap_parse(list, binary, &cameras, &images);
        list->path = model;
        free(images.data);
    }
    free(cameras.data);
    return status;
}

int fxs_camera_file_find(const char *folder, char path[FXS_CAMERA_PATH], fxs_message *message)
{
    static const char *const known[] = {"sparse/0/images.bin", "sparse/0/images.txt", "sparse/images.bin",
                                        "sparse/images.txt", "images.bin", "images.txt", "sparse/1/images.bin",
                                        "sparse/1/images.txt", "colmap/sparse/0/images.bin",
                                        "colmap/sparse/0/images.txt", "transforms.json", "transforms_train.json",
                                        "transform_train.json", "cameras.json", "cameras.xml", "cameras.csv",
                                        "bundle.out"};
    const char *slash = *folder && folder[strlen(folder) - 1] == '/' ? "" : "/";
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const int length = snprintf(path, FXS_CAMERA_PATH, "%s%s%s", folder, slash, known[i]);
        if (length < FXS_CAMERA_PATH && fxs_file_kind(path) != FXS_FILE_NONE)
            return 0;
    }
    return fxs_fail(message, "%s: neither sparse/0 of COLMAP nor transforms.json, transforms_train.json, cameras.json, "
                    "cameras.xml, cameras.csv or bundle.out in this folder", folder);
}

static int read_file(fxs_view_list *list)
{
    const char *path = list->path, *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    if (!strcmp(name, "images.bin") || !strcmp(name, "cameras.bin"))
        return read_colmap(list, path, (int)(name - path), 1);
    if (!strcmp(name, "images.txt") || !strcmp(name, "cameras.txt"))
        return read_colmap(list, path, (int)(name - path), 0);
    return read_text(list);
}

static int read_views(fxs_view_list *list)
{
    char found[FXS_CAMERA_PATH];
    const char *path = list->path;
    if (fxs_file_kind(path) != FXS_FILE_FOLDER)
        return read_file(list);
    FXS_TRY(fxs_camera_file_find(path, found, list->message));
    list->path = found;
    const int error = read_file(list);
    list->path = path;
    return error;
}

int fxs_view_list_read(fxs_view_list *list)
{
    if (strlen(list->path) > FXS_CAMERA_PATH - 16)
        return fxs_fail(list->message, "%s: name too long", list->path);
    FXS_TRY(read_views(list));
    return list->count ? 0 : fxs_fail(list->message, "%s: no views", list->path);
}

static int take_views(const fxs_view_list *list, int width, int height, fxs_view **views, fxs_lens **lenses)
{
    const size_t bytes = list->count * (sizeof **views + sizeof **lenses);
    *views = malloc(list->count * sizeof **views);
    if (lenses)
        *lenses = malloc(list->count * sizeof **lenses);
    if (!*views || (lenses && !*lenses)) {
        free(*views);
        *views = NULL;
        if (lenses) {
            free(*lenses);
            *lenses = NULL;
        }
        return fxs_fail_memory(list->message, list->path, bytes);
    }
    for (size_t i = 0; i < list->count; i++) {
        const fxs_listed_view *listed = &list->views[i];
        fxs_view *view = memcpy(&(*views)[i], &listed->view, sizeof *view);
        if (width && listed->sizeless)
            fxs_view_set_size(listed, view, width, height);
        else if (width)
            fxs_view_resize(view, width, height);
        if (lenses)
            (*lenses)[i] = listed->lens;
    }
    return 0;
}

static long read_all(const char *path, int width, int height, fxs_view **views, fxs_lens **lenses,
                     fxs_message *message)
{
    fxs_view_list list;
    memset(&list, 0, sizeof list);
    list.path = path;
    list.message = message;
    int status = fxs_view_list_read(&list);
    if (!status)
        status = take_views(&list, width, height, views, lenses);
    const long count = (long)list.count;
    fxs_view_list_free(&list);
    return status ? status : count;
}

long fxs_camera_file_read(const char *path, fxs_view **views, fxs_message *message)
{
    return read_all(path, 0, 0, views, NULL, message);
}

long fxs_lens_file_read(const char *path, int width, int height, fxs_view **views, fxs_lens **lenses,
                        fxs_message *message)
{
    return read_all(path, width, height, views, lenses, message);
}
