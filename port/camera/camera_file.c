#include "camera_internal.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define MAX_VIEWS 1000000
#define MAX_SIZE 16384   /* pixels */
#define MAX_PATH 4096    /* characters */

int fxs_view_fault(const fxs_view_list *list, const char *fault)
{
    return fxs_fail(list->message, "%s: view %s: %s", list->path, list->views[list->count - 1].name, fault);
}

fxs_file_view *fxs_view_add(fxs_view_list *list, const char *name)
{
    if (list->count == MAX_VIEWS) {
        fxs_fail(list->message, "%s: more than %d views", list->path, MAX_VIEWS);
        return NULL;
    }
    if (list->count == list->capacity) {
        size_t capacity = 2 * list->capacity + 16;
        fxs_file_view *views = realloc(list->views, capacity * sizeof *views);
        if (!views) {
            fxs_fail(list->message, "%s: out of memory", list->path);
            return NULL;
        }
        list->views = views;
        list->capacity = capacity;
    }
    fxs_file_view *view = memset(&list->views[list->count], 0, sizeof *view);
    if (name)
        snprintf(view->name, sizeof view->name, "%s", name);
    else
        snprintf(view->name, sizeof view->name, "%zu", list->count);
    for (char *c = view->name; *c; c++)
        if ((unsigned char)*c < ' ')   /* a message is one line */
            *c = '?';
    list->count++;
    return view;
}

static int size_valid(double size)
{
    return size >= 1 && size <= MAX_SIZE && size == floor(size);
}

static int rotation_valid(const double r[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double dot = r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
            if (!(fabs(dot - (i == j)) <= 1e-3))
                return 0;
        }
    double determinant = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                         r[2] * (r[3] * r[7] - r[4] * r[6]);
    return determinant > 0;
}

/* The nearest rotation, by Newton's iteration for the polar decomposition: R = R (3 I - R^T R) / 2. It squares the
   error, so that three steps take 1e-3 to the last bit. */
static void orthonormalise(double r[9])
{
    for (int step = 0; step < 3; step++) {
        double old[9], factor[9];
        memcpy(old, r, sizeof old);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                factor[3 * i + j] = 1.5 * (i == j) -
                                    0.5 * (old[i] * old[j] + old[3 + i] * old[3 + j] + old[6 + i] * old[6 + j]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                r[3 * i + j] = old[3 * i] * factor[j] + old[3 * i + 1] * factor[3 + j] + old[3 * i + 2] * factor[6 + j];
    }
}

int fxs_view_finish(fxs_view_list *list, double width, double height)
{
    fxs_file_view *view = &list->views[list->count - 1];
    if (!size_valid(width) || !size_valid(height))
        return fxs_view_fault(list, "width and height are not whole numbers from 1 to 16384");
    view->width = (int)width;
    view->height = (int)height;
    if (!(view->fx > 0 && view->fy > 0 && isfinite(view->fx) && isfinite(view->fy)))
        return fxs_view_fault(list, "no focal length above 0");
    if (!isfinite(view->cx) || !isfinite(view->cy))
        return fxs_view_fault(list, "principal point not finite");
    if (!isfinite(view->position[0]) || !isfinite(view->position[1]) || !isfinite(view->position[2]))
        return fxs_view_fault(list, "position not finite");
    if (!rotation_valid(view->rotation))
        return fxs_view_fault(list, "rotation not orthonormal within 1e-3 with determinant 1");
    orthonormalise(view->rotation);
    return 0;
}

static int read_json(fxs_view_list *list)
{
    fxs_text json;
    if (fxs_text_load(list->path, &json, list->message))
        return -1;
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
    if (fxs_text_load(cameras_path, &cameras, list->message))
        return -1;
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
    if (strlen(path) > MAX_PATH - 16)
        return fxs_fail(list->message, "%s: name too long", path);
    if (!stat(path, &status) && S_ISDIR(status.st_mode))
        return read_folder(list);
    if (!strcmp(name, "images.bin") || !strcmp(name, "cameras.bin"))
        return read_colmap(list, path, (int)(name - path), 1);
    if (!strcmp(name, "images.txt") || !strcmp(name, "cameras.txt"))
        return read_colmap(list, path, (int)(name - path), 0);
    return read_json(list);
}

long fxs_camera_file_read(const char *path, fxs_file_view **views, fxs_message *message)
{
    fxs_view_list list = {path, message, NULL, 0, 0};
    int status = read_views(&list);
    if (!status && !list.count)
        status = fxs_fail(message, "%s: no views", path);
    if (status) {
        free(list.views);
        return -1;
    }
    *views = list.views;
    return (long)list.count;
}
