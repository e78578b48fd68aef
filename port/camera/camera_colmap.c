/* COLMAP sparse models, as its page "Output Format" and the list in its src/colmap/sensor/models.h describe them. */
#include "camera_internal.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CAMERAS 1000000
#define MAX_PARAMS 12

/* Models whose pinhole part comes first and whose other parameters are distortions; the index is COLMAP's model id. */
static const struct {
    const char *name;   /* NULL: not a pinhole with distortions */
    int focals, params;
} models[] = {
    {"SIMPLE_PINHOLE", 1, 3}, {"PINHOLE", 2, 4}, {"SIMPLE_RADIAL", 1, 4}, {"RADIAL", 1, 5},
    {"OPENCV", 2, 8}, {NULL, 0, 0}, {"FULL_OPENCV", 2, 12},
};
#define MODELS (sizeof models / sizeof *models)

typedef struct camera {
    double id, width, height, fx, fy, cx, cy;
} camera;

typedef struct camera_list {
    const char *path;
    camera *cameras;
    size_t count, capacity;
} camera_list;

static int not_pinhole(const camera_list *list, double id, fxs_message *message)
{
    return fxs_fail(message, "%s: camera %.0f: not a pinhole camera; undistort the images first", list->path, id);
}

static int add_camera(camera_list *list, size_t model, double id, const double size[2], const double *params,
                      fxs_message *message)
{
    int focals = models[model].focals;
    for (int i = focals + 2; i < models[model].params; i++)
        if (params[i] != 0)
            return not_pinhole(list, id, message);
    if (list->count == MAX_CAMERAS)
        return fxs_fail(message, "%s: more than %d cameras", list->path, MAX_CAMERAS);
    if (list->count == list->capacity) {
        size_t capacity = 2 * list->capacity + 16;
        camera *cameras = realloc(list->cameras, capacity * sizeof *cameras);
        if (!cameras)
            return fxs_fail_memory(message, list->path, capacity * sizeof *cameras);
        list->cameras = cameras;
        list->capacity = capacity;
    }
    list->cameras[list->count++] = (camera){id, size[0], size[1], params[0], params[focals - 1], params[focals],
                                            params[focals + 1]};
    return 0;
}

static int compare_ids(const void *a, const void *b)
{
    const camera *p = a, *q = b;
    return (p->id > q->id) - (p->id < q->id);
}

/* The rows of the rotation of a quaternion w, x, y, z of any length; 0 where that is 0 or not finite. */
static int quaternion_rows(const double q[4], double r[9])
{
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 1e-12 && isfinite(length)))
        return 0;
    double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    r[0] = 1 - 2 * (y * y + z * z);
    r[1] = 2 * (x * y - w * z);
    r[2] = 2 * (x * z + w * y);
    r[3] = 2 * (x * y + w * z);
    r[4] = 1 - 2 * (x * x + z * z);
    r[5] = 2 * (y * z - w * x);
    r[6] = 2 * (x * z - w * y);
    r[7] = 2 * (y * z + w * x);
    r[8] = 1 - 2 * (x * x + y * y);
    return 1;
}

/* pose: a quaternion w, x, y, z and a translation, world to camera. */
static int add_image(fxs_view_list *list, const camera_list *cameras, const char *name, const double pose[7],
                     double camera_id)
{
    fxs_file_view *view;
    FXS_TRY(fxs_view_list_add(list, name, &view));
    const camera key = {.id = camera_id};
    const camera *found = cameras->count ?
        bsearch(&key, cameras->cameras, cameras->count, sizeof key, compare_ids) : NULL;
    if (!found)
        return fxs_view_list_fault(list, "its camera is not in the cameras file");
    double *r = view->rotation;
    const double *t = pose + 4;
    if (!quaternion_rows(pose, r))
        return fxs_view_list_fault(list, "its quaternion is zero or not finite");
    /* centre = -R^T t */
    for (int i = 0; i < 3; i++)
        view->position[i] = -(r[i] * t[0] + r[3 + i] * t[1] + r[6 + i] * t[2]);
    view->fx = found->fx;
    view->fy = found->fy;
    view->cx = found->cx;
    view->cy = found->cy;
    return fxs_view_list_finish(list, found->width, found->height);
}

/* Binary, little-endian */

typedef struct cursor {
    const unsigned char *at;
    size_t left;
    int short_of;   /* 1: something was read past the end, as 0 */
} cursor;

static uint64_t take(cursor *in, size_t bytes)
{
    uint64_t value = 0;
    if (in->left < bytes) {
        in->short_of = 1;
        in->left = 0;
        return 0;
    }
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)in->at[i] << 8 * i;
    in->at += bytes;
    in->left -= bytes;
    return value;
}

static void take_doubles(cursor *in, double *out, int count)
{
    for (int i = 0; i < count; i++) {
        uint64_t bits = take(in, 8);
        memcpy(&out[i], &bits, 8);
    }
}

static cursor cursor_at(const fxs_text *text)
{
    return (cursor){(const unsigned char *)text->data, text->size, 0};
}

static int read_cameras_bin(camera_list *list, const fxs_text *text, fxs_message *message)
{
    cursor in = cursor_at(text);
    for (uint64_t count = take(&in, 8); count; count--) {
        double id = (double)take(&in, 4), size[2], params[MAX_PARAMS];
        uint64_t model = take(&in, 4);
        if (!in.short_of && (model >= MODELS || !models[model].name))
            return not_pinhole(list, id, message);
        size[0] = (double)take(&in, 8);
        size[1] = (double)take(&in, 8);
        take_doubles(&in, params, in.short_of ? 0 : models[model].params);
        if (in.short_of)
            break;
        FXS_TRY(add_camera(list, model, id, size, params, message));
    }
    return in.short_of ? fxs_fail(message, "%s: cut short", list->path) : 0;
}

static int read_images_bin(fxs_view_list *list, const camera_list *cameras, const fxs_text *text)
{
    cursor in = cursor_at(text);
    for (uint64_t count = take(&in, 8); count; count--) {
        double pose[7];
        take(&in, 4);   /* image id */
        take_doubles(&in, pose, 7);
        double camera_id = (double)take(&in, 4);
        const unsigned char *name = in.at, *end = in.left ? memchr(name, 0, in.left) : NULL;
        if (!end)
            return fxs_fail(list->message, "%s: cut short", list->path);
        in.left -= (size_t)(end + 1 - name);
        in.at = end + 1;
        uint64_t points = take(&in, 8);
        if (in.short_of || points > in.left / 24)   /* x, y, id of a 3D point */
            return fxs_fail(list->message, "%s: cut short", list->path);
        in.at += points * 24;
        in.left -= points * 24;
        FXS_TRY(add_image(list, cameras, (const char *)name, pose, camera_id));
    }
    return in.short_of ? fxs_fail(list->message, "%s: cut short", list->path) : 0;
}

/* Text */

/* Cuts the next line off and returns it without leading blanks; NULL at the end. */
static char *next_line(char **rest)
{
    char *line = *rest;
    if (!*line)
        return NULL;
    size_t length = strcspn(line, "\n");
    *rest = line + length + (line[length] != 0);
    line[length] = 0;
    return line + strspn(line, " \t\r");
}

/* The next line that is not a comment or empty. */
static char *next_entry(char **rest)
{
    char *line;
    do
        line = next_line(rest);
    while (line && (!*line || *line == '#'));
    return line;
}

/* Cuts the next word off the line; empty at its end. */
static char *next_word(char **line)
{
    char *word = *line + strspn(*line, " \t\r");
    size_t length = strcspn(word, " \t\r");
    *line = word + length + (word[length] != 0);
    word[length] = 0;
    return word;
}

static int read_numbers(char **line, double *out, int count)
{
    for (int i = 0; i < count; i++) {
        char *word = next_word(line), *end;
        out[i] = strtod(word, &end);
        if (end == word || *end || !isfinite(out[i]))
            return 0;
    }
    return 1;
}

static int read_cameras_txt(camera_list *list, const fxs_text *text, fxs_message *message)
{
    char *rest = text->data, *line;
    while ((line = next_entry(&rest))) {
        double id, size[2], params[MAX_PARAMS];
        size_t model = 0;
        if (!read_numbers(&line, &id, 1))
            return fxs_fail(message, "%s: a line does not begin with a camera's number", list->path);
        const char *name = next_word(&line);
        while (model < MODELS && (!models[model].name || strcmp(name, models[model].name)))
            model++;
        if (model == MODELS)
            return not_pinhole(list, id, message);
        if (!read_numbers(&line, size, 2) || !read_numbers(&line, params, models[model].params) || *next_word(&line))
            return fxs_fail(message, "%s: camera %.0f: not a size and %d parameters", list->path, id,
                            models[model].params);
        FXS_TRY(add_camera(list, model, id, size, params, message));
    }
    return 0;
}

/* Two lines an image; the second, its 2D points, may be empty. */
static int read_images_txt(fxs_view_list *list, const camera_list *cameras, const fxs_text *text)
{
    char *rest = text->data, *line;
    while ((line = next_entry(&rest))) {
        double values[9];   /* image id, quaternion, translation, camera id */
        char *name = NULL;
        if (read_numbers(&line, values, 9))
            name = next_word(&line);
        if (!name || !*name)
            return fxs_fail(list->message, "%s: image %zu: not nine numbers and a name", list->path, list->count);
        FXS_TRY(add_image(list, cameras, name, values + 1, values[8]));
        next_line(&rest);
    }
    return 0;
}

/* Names come first in a view and are padded with zeros, so that this orders by name. */
static int compare_views(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(fxs_file_view));
}

int fxs_camera_colmap_parse(fxs_view_list *list, int binary, const fxs_text *cameras, const fxs_text *images)
{
    camera_list found = {cameras->path, NULL, 0, 0};
    if (!binary && (strlen(cameras->data) < cameras->size || strlen(images->data) < images->size))
        return fxs_fail(list->message, "%s: zero bytes in this text or in cameras.txt", list->path);
    int status = binary ? read_cameras_bin(&found, cameras, list->message)
                        : read_cameras_txt(&found, cameras, list->message);
    if (!status && found.count)
        qsort(found.cameras, found.count, sizeof *found.cameras, compare_ids);
    if (!status)
        status = binary ? read_images_bin(list, &found, images) : read_images_txt(list, &found, images);
    free(found.cameras);
    if (!status && list->count)
        qsort(list->views, list->count, sizeof *list->views, compare_views);
    return status;
}
