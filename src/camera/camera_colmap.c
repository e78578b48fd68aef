/* Reads cameras from COLMAP's sparse models. The formats are described on COLMAP's page "Output Format" and in its
   src/colmap/sensor/models.h. */
#include "camera_internal.h"
#include "colmap_internal.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CAMERAS 1000000
#define MAX_PARAMS 16

/* COLMAP's camera models, indexed by model id. A model's parameters are focal lengths, principal point and lens
   coefficients, one letter for each coefficient, as in fxs_lens_coefficient. */
static const struct {
    const char *name;
    int focals;
    enum fxs_lens_kind kind;
    const char *coefficients;
} models[] = {
    {"SIMPLE_PINHOLE", 1, FXS_LENS_BROWN, ""}, {"PINHOLE", 2, FXS_LENS_BROWN, ""},
    {"SIMPLE_RADIAL", 1, FXS_LENS_BROWN, "0"}, {"RADIAL", 1, FXS_LENS_BROWN, "01"},
    {"OPENCV", 2, FXS_LENS_BROWN, "01pq"}, {"OPENCV_FISHEYE", 2, FXS_LENS_FISHEYE, "0123"},
    {"FULL_OPENCV", 2, FXS_LENS_BROWN, "01pq2abc"}, {"FOV", 2, FXS_LENS_FOV, "0"},
    {"SIMPLE_RADIAL_FISHEYE", 1, FXS_LENS_FISHEYE, "0"}, {"RADIAL_FISHEYE", 1, FXS_LENS_FISHEYE, "01"},
    {"THIN_PRISM_FISHEYE", 2, FXS_LENS_FISHEYE, "01pq23su"},
    {"RAD_TAN_THIN_PRISM_FISHEYE", 2, FXS_LENS_FISHEYE_AFTER, "012345qpstuv"},
    {"SIMPLE_DIVISION", 1, FXS_LENS_DIVISION, "0"}, {"DIVISION", 2, FXS_LENS_DIVISION, "0"},
    {"SIMPLE_FISHEYE", 1, FXS_LENS_FISHEYE, ""}, {"FISHEYE", 2, FXS_LENS_FISHEYE, ""},
    {"EUCM", 2, FXS_LENS_EUCM, "01"},
};
#define MODELS (sizeof models / sizeof *models)

typedef struct camera {
    double id, width, height, fx, fy, cx, cy;
    fxs_lens lens;
} camera;

typedef struct camera_list {
    const char *path;
    fxs_message *message;
    camera *cameras;
    size_t count, capacity;
} camera_list;

static int params_of(size_t model)
{
    return models[model].focals + 2 + (int)strlen(models[model].coefficients);
}

int fxs_colmap_params(uint64_t model)
{
    return model < MODELS ? params_of((size_t)model) : 0;
}

static int not_known(const camera_list *list, double id)
{
    return fxs_fail(list->message, "%s: camera %.0f: a camera model that is not known here; expected one of COLMAP 3 "
                    "and 4, %s to %s", list->path, id, models[0].name, models[MODELS - 1].name);
}

static int read_lens(size_t model, const double *params, fxs_lens *lens)
{
    memset(lens, 0, sizeof *lens);
    lens->kind = models[model].kind;
    for (const char *c = models[model].coefficients; *c; c++)
        *fxs_lens_coefficient(lens, *c) = *params++;
    return fxs_lens_complete(lens);
}

static int add_camera(camera_list *list, size_t model, double id, const double size[2], const double *params)
{
    const int focals = models[model].focals;
    fxs_lens lens;
    if (!read_lens(model, params + focals + 2, &lens))
        return fxs_fail(list->message, "%s: camera %.0f: a coefficient of its lens is not a finite number, or out of "
                        "its range", list->path, id);
    if (list->count == MAX_CAMERAS)
        return fxs_fail(list->message, "%s: more than %d cameras", list->path, MAX_CAMERAS);
    if (list->count == list->capacity) {
        size_t capacity = 2 * list->capacity + 16;
        camera *cameras = realloc(list->cameras, capacity * sizeof *cameras);
        if (!cameras)
            return fxs_fail_memory(list->message, list->path, capacity * sizeof *cameras);
        list->cameras = cameras;
        list->capacity = capacity;
    }
    list->cameras[list->count++] = (camera){id, size[0], size[1], params[0], params[focals - 1], params[focals],
                                            params[focals + 1], lens};
    return 0;
}

static int compare_ids(const void *a, const void *b)
{
    const camera *p = a, *q = b;
    return (p->id > q->id) - (p->id < q->id);
}

/* Computes the rotation of a quaternion w, x, y, z of any length. Returns 0 if the quaternion is 0 or not finite. */
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

/* Adds a camera to the list of views. `pose` is a quaternion w, x, y, z and a translation, from world to camera. */
static int add_image(fxs_view_list *list, const camera_list *cameras, const char *name, const double pose[7],
                     double camera_id)
{
    fxs_listed_view *listed;
    FXS_TRY(fxs_view_list_add(list, name, &listed));
    fxs_view *view = &listed->view;
    const camera key = {.id = camera_id};
    const camera *found = cameras->count ?
        bsearch(&key, cameras->cameras, cameras->count, sizeof key, compare_ids) : NULL;
    if (!found)
        return fxs_view_list_fault(list, "its camera is not in the cameras file");
    double *r = view->rotation;
    const double *t = pose + 4;
    if (!quaternion_rows(pose, r))
        return fxs_view_list_fault(list, "its quaternion is zero or not finite");
    /* The camera's centre is -R^T t, for rotation R and translation t from world to camera. */
    for (int i = 0; i < 3; i++)
        view->position[i] = -(r[i] * t[0] + r[3 + i] * t[1] + r[6 + i] * t[2]);
    view->fx = found->fx;
    view->fy = found->fy;
    view->cx = found->cx;
    view->cy = found->cy;
    listed->lens = found->lens;
    view->bends = !fxs_lens_is_pinhole(&found->lens);
    return fxs_view_list_finish(list, found->width, found->height);
}

static int read_cameras_bin(camera_list *list, const fxs_text *text)
{
    fxs_colmap_cursor in = fxs_colmap_begin(text);
    for (uint64_t count = fxs_colmap_take(&in, 8); count; count--) {
        double id = (double)fxs_colmap_take(&in, 4), size[2], params[MAX_PARAMS];
        const size_t model = (size_t)fxs_colmap_take(&in, 4);
        if (!in.short_of && (model >= MODELS))
            return not_known(list, id);
        size[0] = (double)fxs_colmap_take(&in, 8);
        size[1] = (double)fxs_colmap_take(&in, 8);
        if (!in.short_of)
            fxs_colmap_take_doubles(&in, params, params_of(model));
        if (in.short_of)
            break;
        FXS_TRY(add_camera(list, model, id, size, params));
    }
    return in.short_of ? fxs_fail(list->message, "%s: cut short", list->path) : 0;
}

static int read_images_bin(fxs_view_list *list, const camera_list *cameras, const fxs_text *text)
{
    fxs_colmap_cursor in = fxs_colmap_begin(text);
    for (uint64_t count = fxs_colmap_take(&in, 8); count; count--) {
        double pose[7];
        fxs_colmap_take(&in, 4);
        fxs_colmap_take_doubles(&in, pose, 7);
        double camera_id = (double)fxs_colmap_take(&in, 4);
        const unsigned char *name = in.at, *end = in.left ? memchr(name, 0, in.left) : NULL;
        if (!end)
            return fxs_fail(list->message, "%s: cut short", list->path);
        in.left -= (size_t)(end + 1 - name);
        in.at = end + 1;
        fxs_colmap_skip(&in, fxs_colmap_take(&in, 8), 24);
        if (in.short_of)
            return fxs_fail(list->message, "%s: cut short", list->path);
        FXS_TRY(add_image(list, cameras, (const char *)name, pose, camera_id));
    }
    return in.short_of ? fxs_fail(list->message, "%s: cut short", list->path) : 0;
}

static int read_cameras_txt(camera_list *list, const fxs_text *text)
{
    char *rest = fxs_text_begin(text), *line;
    while ((line = fxs_colmap_entry(&rest))) {
        double id, size[2], params[MAX_PARAMS];
        size_t model = 0;
        if (!fxs_colmap_numbers(&line, &id, 1))
            return fxs_fail(list->message, "%s: a line does not begin with a camera's number", list->path);
        const char *name = fxs_colmap_word(&line);
        while (model < MODELS && strcmp(name, models[model].name))
            model++;
        if (model == MODELS)
            return not_known(list, id);
        if (!fxs_colmap_numbers(&line, size, 2) || !fxs_colmap_numbers(&line, params, params_of(model)) ||
            *fxs_colmap_word(&line))
            return fxs_fail(list->message, "%s: camera %.0f: not a size and %d parameters", list->path, id,
                            params_of(model));
        FXS_TRY(add_camera(list, model, id, size, params));
    }
    return 0;
}

static int read_images_txt(fxs_view_list *list, const camera_list *cameras, const fxs_text *text)
{
    char *rest = fxs_text_begin(text), *line;
    while ((line = fxs_colmap_entry(&rest))) {
        double values[9];   /* numbers of an image in a COLMAP model: id, quaternion, translation, camera id */
        char *name = NULL;
        if (fxs_colmap_numbers(&line, values, 9))
            name = fxs_colmap_rest(line);
        if (!name || !*name)
            return fxs_fail(list->message, "%s: image %zu: not nine numbers and a name", list->path, list->count);
        FXS_TRY(add_image(list, cameras, name, values + 1, values[8]));
        fxs_colmap_line(&rest);
    }
    return 0;
}

static int compare_views(const void *a, const void *b)
{
    const fxs_listed_view *v = a, *w = b;
    const int order = strcmp(v->image, w->image);
    return order ? order : memcmp(&v->view, &w->view, sizeof v->view);
}

int fxs_camera_colmap_parse(fxs_view_list *list, int binary, const fxs_text *cameras, const fxs_text *images)
{
    camera_list found = {cameras->path, list->message, NULL, 0, 0};
    if (!binary && (strlen(cameras->data) < cameras->size || strlen(images->data) < images->size))
        return fxs_fail(list->message, "%s: zero bytes in this text or in cameras.txt", list->path);
    int status = binary ? read_cameras_bin(&found, cameras)
                        : read_cameras_txt(&found, cameras);
    if (!status && found.count)
        qsort(found.cameras, found.count, sizeof *found.cameras, compare_ids);
    if (!status)
        status = binary ? read_images_bin(list, &found, images) : read_images_txt(list, &found, images);
    free(found.cameras);
    if (!status && list->count)
        qsort(list->views, list->count, sizeof *list->views, compare_views);
    return status;
}
