/* Reads cameras.json of Inria's 3D Gaussian splatting code, and transforms.json of nerfstudio and Blender. */
#include "camera_internal.h"

#ifdef FXS_WITH_CJSON

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

/* Reads a number from a JSON object. Returns `absent` if it is missing, INFINITY if it is not a number. */
static double number(const cJSON *object, const char *name, double absent)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return !item ? absent : cJSON_IsNumber(item) ? item->valuedouble : INFINITY;
}

static int matrix(const cJSON *array, double *out, int size)
{
    const cJSON *row;
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) != size)
        return 0;
    cJSON_ArrayForEach(row, array) {
        if (!fxs_json_numbers(row, out, size))
            return 0;
        out += size;
    }
    return 1;
}

/* Reads a camera of cameras.json. The member "rotation" maps camera to world. Inria's own files lack the members cx, cy
   and orthographic. */
static int read_inria_view(fxs_view_list *list, const cJSON *item)
{
    double width = number(item, "width", 0), height = number(item, "height", 0), r[9];
    fxs_listed_view *listed;
    FXS_TRY(fxs_view_list_add(list, fxs_json_string(item, "img_name"), &listed));
    fxs_view *view = &listed->view;
    if (!fxs_json_numbers(cJSON_GetObjectItemCaseSensitive(item, "position"), view->position, 3))
        return fxs_view_list_fault(list, "\"position\" is not three numbers");
    if (!matrix(cJSON_GetObjectItemCaseSensitive(item, "rotation"), r, 3))
        return fxs_view_list_fault(list, "\"rotation\" is not three rows of three numbers");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            view->rotation[3 * i + j] = r[3 * j + i];
    view->fx = number(item, "fx", 0);
    view->fy = number(item, "fy", 0);
    view->cx = number(item, "cx", width / 2);
    view->cy = number(item, "cy", height / 2);
    if (cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(item, "orthographic")))
        view->projection = FXS_ORTHOGRAPHIC;
    return fxs_view_list_finish(list, width, height);
}

static const char *const lens_names[] = {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "sx1", "sy1"};
enum { LENS_NAMES = sizeof lens_names / sizeof *lens_names };

/* Lens models of transforms.json by their "camera_model". Their coefficients are letters of fxs_lens_coefficient; -
   means unused. Coefficient k4 belongs to r^8, except in FULL_OPENCV. */
static const struct lens_model {
    const char *name;
    enum fxs_lens_kind kind;
    const char *coefficients;
} lens_models[] = {
    {"OPENCV", FXS_LENS_BROWN, "0123--pq--"}, {"FULL_OPENCV", FXS_LENS_BROWN, "012abcpq--"},
    {"SIMPLE_PINHOLE", FXS_LENS_BROWN, "0123--pq--"}, {"PINHOLE", FXS_LENS_BROWN, "0123--pq--"},
    {"SIMPLE_RADIAL", FXS_LENS_BROWN, "0123--pq--"}, {"RADIAL", FXS_LENS_BROWN, "0123--pq--"},
    {"OPENCV_FISHEYE", FXS_LENS_FISHEYE, "0123------"}, {"SIMPLE_RADIAL_FISHEYE", FXS_LENS_FISHEYE, "0123------"},
    {"RADIAL_FISHEYE", FXS_LENS_FISHEYE, "0123------"}, {"THIN_PRISM_FISHEYE", FXS_LENS_FISHEYE, "0123--pqsu"},
};
enum { LENS_MODELS = sizeof lens_models / sizeof *lens_models, OPENCV = 0, FULL_OPENCV = 1, OPENCV_FISHEYE = 6 };

/* Focal lengths, principal point and size in a transforms.json. NAN: absent. */
typedef struct intrinsics {
    double w, h, fl_x, fl_y, cx, cy, camera_angle_x, camera_angle_y;
    double lens[LENS_NAMES];
} intrinsics;

static intrinsics read_intrinsics(const cJSON *object)
{
    intrinsics in = {number(object, "w", NAN), number(object, "h", NAN),
                     number(object, "fl_x", NAN), number(object, "fl_y", NAN),
                     number(object, "cx", NAN), number(object, "cy", NAN),
                     number(object, "camera_angle_x", NAN), number(object, "camera_angle_y", NAN), {0}};
    for (int i = 0; i < LENS_NAMES; i++)
        in.lens[i] = number(object, lens_names[i], NAN);
    return in;
}

static double first(double a, double b)
{
    return isnan(a) ? b : a;
}

static double focal_length(double length, double angle, double size)
{
    if (!isnan(length) || isnan(angle))
        return length;
    return angle > 0 && angle < 3.14159 ? size / (2 * fxs_tangent(angle / 2)) : 0;
}

static int read_lens(fxs_view_list *list, const struct lens_model *model, const intrinsics *own,
                     const intrinsics *file, fxs_lens *lens)
{
    lens->kind = model->kind;
    for (int i = 0; i < LENS_NAMES; i++) {
        const double value = first(first(own->lens[i], file->lens[i]), 0);
        if (!isfinite(value))
            return fxs_view_list_fault(list, "a coefficient of its lens is not a finite number");
        if (model->coefficients[i] != '-')
            *fxs_lens_coefficient(lens, model->coefficients[i]) = value;
    }
    return 0;
}

static int read_frame(fxs_view_list *list, const cJSON *frame, const intrinsics *file, const struct lens_model *model)
{
    fxs_listed_view *listed;
    intrinsics own = read_intrinsics(frame);
    double m[16], width = first(own.w, file->w), height = first(own.h, file->h);
    FXS_TRY(fxs_view_list_add(list, fxs_json_string(frame, "file_path"), &listed));
    FXS_TRY(fxs_view_list_mask(list, listed, fxs_json_string(frame, "mask_path")));
    fxs_view *view = &listed->view;
    listed->time = number(frame, "time", NAN);
    if (isnan(width) && isnan(height)) {
        width = height = 800;   /* Blender's synthetic scenes state no picture size */
        listed->sizeless = isnan(first(own.fl_x, file->fl_x)) ? FXS_SIZE_OF_WIDTH : FXS_SIZE_STATED;
    }
    FXS_TRY(read_lens(list, model, &own, file, &listed->lens));
    view->bends = !fxs_lens_is_pinhole(&listed->lens);
    if (!matrix(cJSON_GetObjectItemCaseSensitive(frame, "transform_matrix"), m, 4))
        return fxs_view_list_fault(list, "\"transform_matrix\" is not four rows of four numbers");
    if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
        return fxs_view_list_fault(list, "the last row of \"transform_matrix\" is not 0 0 0 1");
    /* Reads the pose of a frame in transforms.json. Its matrix maps camera to world, with y up and z backwards. */
    for (int i = 0; i < 3; i++) {
        view->rotation[i] = m[4 * i];
        view->rotation[3 + i] = -m[4 * i + 1];
        view->rotation[6 + i] = -m[4 * i + 2];
        view->position[i] = m[4 * i + 3];
    }
    view->fx = first(focal_length(own.fl_x, own.camera_angle_x, width),
                     focal_length(file->fl_x, file->camera_angle_x, width));
    view->fy = first(focal_length(own.fl_y, own.camera_angle_y, height),
                     focal_length(file->fl_y, file->camera_angle_y, height));
    view->fy = first(view->fy, view->fx);
    view->cx = first(first(own.cx, file->cx), width / 2);
    view->cy = first(first(own.cy, file->cy), height / 2);
    return fxs_view_list_finish(list, width, height);
}

/* Finds the lens model of a transforms.json by name; NULL: unknown. A file without camera_model has FULL_OPENCV if k5
   or k6 exists, OPENCV_FISHEYE for instant-ngp's "is_fisheye", else OPENCV. */
static const struct lens_model *find_model(const cJSON *root, const char *name)
{
    const int full = cJSON_HasObjectItem(root, "k5") || cJSON_HasObjectItem(root, "k6");
    if (!name)
        return &lens_models[cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(root, "is_fisheye")) ? OPENCV_FISHEYE :
                            full ? FULL_OPENCV : OPENCV];
    for (int i = 0; i < LENS_MODELS; i++)
        if (!strcmp(name, lens_models[i].name))
            return &lens_models[i];
    return NULL;
}

enum { TRAIN, TEST, VAL, PARTS };

typedef struct name_list {
    const char **names;
    unsigned char *met;
    size_t count;
} name_list;

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void keep_one_of_each(name_list *names)
{
    size_t kept = 0;
    for (size_t i = 0; i < names->count; i++)
        if (!kept || strcmp(names->names[kept - 1], names->names[i]))
            names->names[kept++] = names->names[i];
    names->count = kept;
}

static int read_names(const fxs_view_list *list, const cJSON *root, const char *key, name_list *names)
{
    const cJSON *array = cJSON_GetObjectItemCaseSensitive(root, key), *item;
    const int size = cJSON_IsArray(array) ? cJSON_GetArraySize(array) : 0;
    if (array && !cJSON_IsArray(array) && !cJSON_IsNull(array))
        return fxs_fail(list->message, "%s: %s: not a list of names", list->path, key);
    names->names = malloc(((size_t)size + 1) * sizeof *names->names);
    names->met = calloc((size_t)size + 1, 1);
    if (!names->names || !names->met)
        return fxs_fail_memory(list->message, list->path, (size_t)size * sizeof *names->names);
    cJSON_ArrayForEach(item, array) {
        if (!cJSON_IsString(item))
            return fxs_fail(list->message, "%s: %s: not a list of names", list->path, key);
        names->names[names->count++] = fxs_without_dots(item->valuestring);
    }
    qsort(names->names, names->count, sizeof *names->names, compare_names);
    keep_one_of_each(names);
    return 0;
}

static int meets(name_list *names, const char *name)
{
    const char *const *found = bsearch(&name, names->names, names->count, sizeof name, compare_names);
    if (found)
        names->met[found - names->names] = 1;
    return found != NULL;
}

/* Photographs for testing are listed in test_filenames, or in val_filenames if that list is empty. */
static int choose_parts(fxs_view_list *list, name_list parts[PARTS])
{
    for (size_t i = 0; i < list->count; i++) {
        fxs_listed_view *view = &list->views[i];
        const char *name = view->image ? fxs_without_dots(view->image) : "";
        const int train = meets(&parts[TRAIN], name), test = meets(&parts[TEST], name), val = meets(&parts[VAL], name);
        if (train && (test || val))
            return fxs_fail(list->message, "%s: view %s: both in train_filenames and in %s", list->path,
                            view->view.name, test ? "test_filenames" : "val_filenames");
        view->part = test || (val && !parts[TEST].count)            ? FXS_VIEW_TO_TEST :
                     train || (!val && !parts[TRAIN].count) ? FXS_VIEW_TO_FIT : FXS_VIEW_LEFT_OUT;
    }
    return 0;
}

static int read_parts(fxs_view_list *list, const cJSON *root)
{
    static const char *const keys[PARTS] = {"train_filenames", "test_filenames", "val_filenames"};
    name_list parts[PARTS];
    int error = 0;
    memset(parts, 0, sizeof parts);
    for (int i = 0; i < PARTS && !error; i++) {
        error = read_names(list, root, keys[i], &parts[i]);
        list->has_parts |= parts[i].count > 0;
    }
    if (!error && list->has_parts)
        error = choose_parts(list, parts);
    for (int i = 0; i < PARTS; i++) {
        for (size_t k = 0; k < parts[i].count && !error; k++)
            if (!parts[i].met[k])
                error = fxs_fail(list->message, "%s: %s: no frame has the file_path %.200s", list->path, keys[i],
                                 parts[i].names[k]);
        free(parts[i].names);
        free(parts[i].met);
    }
    return error;
}

static int read_transforms(fxs_view_list *list, const cJSON *root, const cJSON *frames)
{
    const char *name = fxs_json_string(root, "camera_model"), *points = fxs_json_string(root, "ply_file_path");
    const struct lens_model *model = find_model(root, name);
    intrinsics file = read_intrinsics(root);
    list->format = FXS_CAMERAS_OF_TRANSFORMS;
    if (!model)
        return fxs_fail(list->message, "%s: the camera_model \"%.40s\" is not known here; expected one of a "
                        "perspective camera, OPENCV_FISHEYE or THIN_PRISM_FISHEYE", list->path, name);
    if (points && !(list->points = malloc(strlen(points) + 1)))
        return fxs_fail_memory(list->message, list->path, 0);
    if (points)
        strcpy(list->points, points);
    const cJSON *frame;
    cJSON_ArrayForEach(frame, frames)
        FXS_TRY(read_frame(list, frame, &file, model));
    return read_parts(list, root);
}

static int read_root(fxs_view_list *list, const cJSON *root)
{
    const cJSON *frames = cJSON_GetObjectItemCaseSensitive(root, "frames"), *item;
    if (cJSON_IsArray(frames))
        return read_transforms(list, root, frames);
    if (!cJSON_IsArray(root))
        return fxs_fail(list->message, "%s: neither an array of cameras nor an object with \"frames\"", list->path);
    list->format = FXS_CAMERAS_OF_INRIA;
    cJSON_ArrayForEach(item, root)
        FXS_TRY(read_inria_view(list, item));
    return 0;
}

int fxs_camera_json_parse(fxs_view_list *list, const fxs_text *json)
{
    cJSON *root;
    FXS_TRY(fxs_json_parse(json, NULL, &root, list->message));
    int status = read_root(list, root);
    cJSON_Delete(root);
    return status;
}

#else

int fxs_camera_json_parse(fxs_view_list *list, const fxs_text *json)
{
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, list->message, "%s: cannot read JSON cameras: built without cJSON",
                       json->path);
}

#endif
