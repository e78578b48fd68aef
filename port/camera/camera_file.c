/* Which reader a camera file is for, by its name and content. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "camera_internal.h"

#define MAX_PATH 4096    /* characters */

static int read_json(fxs_view_list *list)
{
    fxs_text json;
    FXS_TRY(fxs_text_load(list->path, &json, list->message));
    int status = fxs_camera_json_parse(list, &json);
    free(json.data);
    return status;
}

static int read_colmap(fxs_view_list *list, const char *folder, int folder_length, int binary)
{
    char cameras_path[MAX_PATH], images_path[MAX_PATH];
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

static int read_folder(fxs_view_list *list)
{
    char path[MAX_PATH];
    struct stat status;
    int folder_length = snprintf(path, sizeof path, "%s/images.bin", list->path) - 10;
    if (!stat(path, &status))
        return read_colmap(list, path, folder_length, 1);
    snprintf(path + folder_length, 11, "images.txt");
    if (!stat(path, &status))
        return read_colmap(list, path, folder_length, 0);
    return fxs_fail(list->message, "%s: no images.bin or images.txt in this folder", list->path);
}

static int read_views(fxs_view_list *list)
{
    const char *path = list->path, *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    struct stat status;
    if (!stat(path, &status) && S_ISDIR(status.st_mode))
        return read_folder(list);
    if (!strcmp(name, "images.bin") || !strcmp(name, "cameras.bin"))
        return read_colmap(list, path, (int)(name - path), 1);
    if (!strcmp(name, "images.txt") || !strcmp(name, "cameras.txt"))
        return read_colmap(list, path, (int)(name - path), 0);
    return read_json(list);
}

int fxs_view_list_read(fxs_view_list *list)
{
    if (strlen(list->path) > MAX_PATH - 16)
        return fxs_fail(list->message, "%s: name too long", list->path);
    FXS_TRY(read_views(list));
    return list->count ? 0 : fxs_fail(list->message, "%s: no views", list->path);
}

/* Takes the views out of the list. */
static int take_views(const fxs_view_list *list, fxs_file_view **views)
{
    *views = malloc(list->count * sizeof **views);
    if (!*views)
        return fxs_fail_memory(list->message, list->path, list->count * sizeof **views);
    for (size_t i = 0; i < list->count; i++)
        (*views)[i] = list->views[i].view;
    return 0;
}

long fxs_camera_file_read(const char *path, fxs_file_view **views, fxs_message *message)
{
    fxs_view_list list;
    memset(&list, 0, sizeof list);
    list.path = path;
    list.message = message;
    int status = fxs_view_list_read(&list);
    if (!status)
        status = take_views(&list, views);
    const long count = (long)list.count;
    fxs_view_list_free(&list);
    return status ? status : count;
}
