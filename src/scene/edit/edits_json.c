/* Lists of edits by hand: reads and writes them as JSON files, and does the edits. docs/convert.md describes the
   files. */
#include <fixsplat/internal/edits.h>

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include "src/base/number.h"
#include "src/base/output_internal.h"
#include "src/base/text_internal.h"

#define FARTHEST 0x1p28   /* largest coordinate of a camera, scene units */

static const char *const names[FXS_EDIT_KINDS] = {"box", "sphere", "lasso", "brush", "object"};

/* The fields of a camera in the file: real numbers, which are rounded to integers with `bits` fraction bits. */
static const struct {
    const char *name;
    size_t at;
    int count, bits;          /* bits of 32: an int64_t, else an int32_t */
    double most;
} camera_fields[] = {
    {"width", offsetof(fxs_camera, width), 1, 0, FXS_MAX_SIZE},
    {"height", offsetof(fxs_camera, height), 1, 0, FXS_MAX_SIZE},
    {"fx", offsetof(fxs_camera, fx_q12), 1, 12, 524287},
    {"fy", offsetof(fxs_camera, fy_q12), 1, 12, 524287},
    {"cx", offsetof(fxs_camera, cx_q12), 1, 12, 524287},
    {"cy", offsetof(fxs_camera, cy_q12), 1, 12, 524287},
    {"rotation", offsetof(fxs_camera, rotation_q30), 9, 30, 1},
    {"position", offsetof(fxs_camera, position_q32), 3, 32, FARTHEST},
    {"near", offsetof(fxs_camera, near_q32), 1, 32, FARTHEST}
};

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>

#define WORK_MOST ((uint64_t)1 << 34)   /* most pixels that the shapes of a file write */

enum { OBJECT_WORK = 128, HINT_WORK = 16 };

/* Coordinates of a corner, a disc and a hint. */
static const int each_of[FXS_EDIT_KINDS] = {0, 0, 2, 3, FXS_EDIT_HINT};

typedef struct reader {
    fxs_edits *edits;
    const char *path;
    fxs_message *message;
    uint64_t *work;           /* pixels that the shapes so far write */
} reader;

static int wrong(const reader *r, const char *what)
{
    return fxs_fail(r->message, "%s: edit %u: %s", r->path, (unsigned)r->edits->count + 1, what);
}

static const cJSON *item_of(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static int is_text(const cJSON *object, const char *name, const char *text)
{
    const char *value = fxs_json_string(object, name);
    return value && !strcmp(value, text);
}

static int take_camera(const reader *r, const cJSON *camera, fxs_camera *out)
{
    double numbers[9];
    for (size_t i = 0; i < sizeof camera_fields / sizeof *camera_fields; i++) {
        const cJSON *item = item_of(camera, camera_fields[i].name);
        const int count = camera_fields[i].count, bits = camera_fields[i].bits;
        if (count > 1 ? !fxs_json_numbers(item, numbers, count) : !cJSON_IsNumber(item))
            return wrong(r, "\"camera\" needs width, height, fx, fy, cx, cy, near, position and the 9 numbers of "
                            "rotation (rows right, down, forward)");
        if (count == 1)
            numbers[0] = item->valuedouble;
        for (int k = 0; k < count; k++) {
            if (!(fabs(numbers[k]) <= camera_fields[i].most))
                return wrong(r, "a number of \"camera\" is out of range");
            const int64_t value = (int64_t)floor(ldexp(numbers[k], bits) + 0.5);
            char *at = (char *)out + camera_fields[i].at;
            if (bits == 32)
                ((int64_t *)(void *)at)[k] = value;
            else
                ((int32_t *)(void *)at)[k] = (int32_t)value;
        }
    }
    out->projection = cJSON_IsTrue(item_of(camera, "orthographic")) ? FXS_ORTHOGRAPHIC : FXS_PERSPECTIVE;
    return 0;
}

/* True if x may be coordinate i of a corner, a disc or a hint. */
static int is_coordinate(enum fxs_edit_kind kind, int i, double x)
{
    const int is_radius = kind == FXS_EDIT_BRUSH && i == 2, is_hint = kind == FXS_EDIT_OBJECT;
    const double least = is_radius || is_hint ? 0 : -FXS_EDIT_OUTSIDE;
    const double most = is_radius ? FXS_BRUSH_MOST : !is_hint ? FXS_EDIT_OUTSIDE : i == 4 ? 1 : FXS_MAX_SIZE - 1;
    return x == floor(x) && x >= least && x <= most;
}

static int take_points(const reader *r, const cJSON *list, fxs_edit_shape *shape)
{
    const int each = each_of[shape->kind], count = cJSON_IsArray(list) ? cJSON_GetArraySize(list) : 0;
    const cJSON *item;
    uint32_t n = 0;
    if (!count || count % each || (uint32_t)count > FXS_EDIT_NUMBERS_MOST)
        return wrong(r, "\"points\" of a lasso is a list of x, y, of a brush of x, y, radius, of an object of x, y, "
                        "right, bottom, 0 or 1, at most 196608 numbers");
    int32_t *points = fxs_allocate(NULL, (size_t)count, sizeof *points);
    if (!points)
        return fxs_fail_memory(r->message, r->path, (uint64_t)count * sizeof *points);
    shape->points = points;
    cJSON_ArrayForEach(item, list) {
        const double x = cJSON_IsNumber(item) ? item->valuedouble : NAN;
        if (!is_coordinate(shape->kind, (int)n % each, x))
            return wrong(r, "\"points\" are whole pixels, up to 2^20, a radius 0 to 1024; of an object, pixels of the "
                            "picture, then 0 or 1");
        points[n++] = (int32_t)x;
    }
    shape->point_numbers = n;
    return 0;
}

static int take_shape(const reader *r, const cJSON *item, fxs_edit_shape *shape)
{
    int kind = 0;
    while (kind < FXS_EDIT_KINDS && !is_text(item, "shape", names[kind]))
        kind++;
    if (kind == FXS_EDIT_KINDS)
        return wrong(r, "\"shape\" is box, sphere, lasso, brush or object");
    shape->kind = (enum fxs_edit_kind)kind;
    shape->subtract = cJSON_IsTrue(item_of(item, "subtract"));
    shape->front = cJSON_IsTrue(item_of(item, "front"));
    if (kind >= FXS_EDIT_LASSO) {
        const int error = take_camera(r, item_of(item, "camera"), &shape->camera);
        return error ? error : take_points(r, item_of(item, "points"), shape);
    }
    const int count = kind == FXS_EDIT_BOX ? 6 : 4;
    int is_finite = fxs_json_numbers(item_of(item, "numbers"), shape->numbers, count);
    for (int i = 0; i < count; i++)
        is_finite &= isfinite(shape->numbers[i]) != 0;
    return is_finite ? 0 : wrong(r, "\"numbers\" of a box are 6, of a sphere 4");
}

/* Returns about how many pixels a shape writes. An object takes as long as its frame and its weights, and each hint of
   it some passes over the picture. */
static uint64_t work_of(const fxs_edit_shape *s)
{
    const uint64_t pixels = (uint64_t)s->camera.width * (uint64_t)s->camera.height;
    if (s->kind == FXS_EDIT_OBJECT)
        return (OBJECT_WORK + HINT_WORK * (uint64_t)(s->point_numbers / FXS_EDIT_HINT)) * pixels;
    uint64_t work = s->kind < FXS_EDIT_LASSO ? 0 : s->front ? 16 * pixels : pixels;
    if (s->kind == FXS_EDIT_LASSO)
        work += s->point_numbers / 2 * (uint64_t)s->camera.height;
    for (uint32_t i = 2; s->kind == FXS_EDIT_BRUSH && i < s->point_numbers; i += 3)
        work += (2 * (uint64_t)s->points[i] + 1) * (2 * (uint64_t)s->points[i] + 1);
    return work;
}

static int take_edit(const reader *r, const cJSON *edit)
{
    fxs_edits *all = r->edits;
    const cJSON *list = item_of(edit, "select"), *item;
    const int keep = is_text(edit, "act", "keep");
    if (!keep && !is_text(edit, "act", "delete"))
        return wrong(r, "\"act\" is delete or keep");
    if (!cJSON_IsArray(list) || !cJSON_GetArraySize(list))
        return wrong(r, "\"select\" is not a list of shapes");
    all->edits[all->count].keep = keep;
    all->edits[all->count].first = all->shape_count;
    cJSON_ArrayForEach(item, list) {
        const int error = take_shape(r, item, &all->shapes[all->shape_count++]);
        if (error)
            return error;
        *r->work += work_of(&all->shapes[all->shape_count - 1]);
        if (*r->work > WORK_MOST)
            return wrong(r, "the shapes have more pixels than 2^34");
    }
    all->edits[all->count++].end = all->shape_count;
    return 0;
}

static int take_scene(const reader *r, const cJSON *scene)
{
    size_t gaussians;
    char *end;
    const char *text = fxs_json_string(scene, "checksum");
    const unsigned long checksum = text ? strtoul(text, &end, 16) : 0;
    if (!text || strlen(text) != 8 || *end || !fxs_json_whole(item_of(scene, "gaussians"), FXS_MAX_COUNT, &gaussians))
        return fxs_fail(r->message, "%s: \"scene\" needs the number of its gaussians, and a checksum of 8 digits",
                        r->path);
    r->edits->gaussians = (uint32_t)gaussians;
    r->edits->checksum = (uint32_t)checksum;
    return 0;
}

static int take_root(const reader *r, const cJSON *root)
{
    const cJSON *list = item_of(root, "edits"), *item, *version = item_of(root, "version");
    uint64_t shapes = 0;
    if (!is_text(root, "format", "fixsplat edits") || !cJSON_IsArray(list))
        return fxs_fail(r->message, "%s: is no file of edits, which the viewer saves", r->path);
    if (!cJSON_IsNumber(version) || version->valuedouble != 1)
        return fxs_fail(r->message, "%s: edits of another version; this program reads version 1", r->path);
    FXS_TRY(take_scene(r, item_of(root, "scene")));
    cJSON_ArrayForEach(item, list)
        shapes += (uint64_t)cJSON_GetArraySize(item_of(item, "select"));
    if ((uint64_t)cJSON_GetArraySize(list) > FXS_EDITS_MOST || shapes > FXS_EDITS_MOST)
        return fxs_fail(r->message, "%s: more than %u edits or shapes", r->path, FXS_EDITS_MOST);
    r->edits->edits = fxs_allocate_zeroed(NULL, (size_t)cJSON_GetArraySize(list) + 1, sizeof *r->edits->edits);
    r->edits->shapes = fxs_allocate_zeroed(NULL, (size_t)shapes + 1, sizeof *r->edits->shapes);
    if (!r->edits->edits || !r->edits->shapes)
        return fxs_fail_memory(r->message, r->path, shapes * sizeof *r->edits->shapes);
    cJSON_ArrayForEach(item, list)
        FXS_TRY(take_edit(r, item));
    return 0;
}

static int read_text(fxs_edits *edits, const fxs_text *text, fxs_message *message)
{
    uint64_t work = 0;
    const reader r = {edits, text->path, message, &work};
    cJSON *root;
    int error = fxs_json_parse(text, NULL, &root, message);
    if (error)
        return error;
    error = take_root(&r, root);
    cJSON_Delete(root);
    return error;
}

#else

static int read_text(fxs_edits *edits, const fxs_text *text, fxs_message *message)
{
    (void)edits;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot be read: built without cJSON", text->path);
}

#endif

int fxs_edits_read(fxs_edits *edits, const char *path, fxs_message *message)
{
    fxs_text text;
    memset(edits, 0, sizeof *edits);
    if (fxs_text_load(path, &text, message))
        return FXS_ERR_FILE;
    const int error = read_text(edits, &text, message);
    free(text.data);
    if (error)
        fxs_edits_free(edits);
    return error;
}

void fxs_edits_free(fxs_edits *edits)
{
    for (uint32_t i = 0; i < edits->shape_count; i++)
        fxs_release(NULL, (void *)(uintptr_t)edits->shapes[i].points);
    fxs_release(NULL, edits->shapes);
    fxs_release(NULL, edits->edits);
    memset(edits, 0, sizeof *edits);
}

int fxs_edits_do(const fxs_edits *edits, fxs_editor *editor, const fxs_context *context, fxs_message *message)
{
    const uint32_t checksum = fxs_edit_checksum(&editor->scene);
    if (edits->gaussians != editor->left || edits->checksum != checksum)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "the edits are for another scene, or for another packing of "
                           "it: of %u Gaussians with the checksum %08x, not of %u with %08x",
                           (unsigned)edits->gaussians, (unsigned)edits->checksum, (unsigned)editor->left,
                           (unsigned)checksum);
    for (uint32_t i = 0; i < edits->count; i++) {
        for (uint32_t k = edits->edits[i].first; k < edits->edits[i].end; k++)
            FXS_TRY(fxs_editor_select(editor, context, &edits->shapes[k], message));
        FXS_TRY(fxs_editor_act(editor, edits->edits[i].keep, message));
    }
    return 0;
}

/* ---- Writing ----------------------------------------------------------------------------------------------------- */

int fxs_edits_add_shape(fxs_edits *edits, const fxs_edit_shape *shape, fxs_message *message)
{
    fxs_edit_shape *shapes = fxs_enlarge(NULL, edits->shapes, edits->shape_count, (size_t)edits->shape_count + 1,
                                         sizeof *shapes);
    int32_t *points = shapes ? fxs_allocate(NULL, (size_t)shape->point_numbers + 1, sizeof *points) : NULL;
    edits->shapes = shapes ? shapes : edits->shapes;
    if (!points)
        return fxs_fail_memory(message, NULL, (uint64_t)shape->point_numbers * sizeof *points);
    if (shape->point_numbers)
        memcpy(points, shape->points, shape->point_numbers * sizeof *points);
    shapes[edits->shape_count] = *shape;
    shapes[edits->shape_count++].points = points;
    return 0;
}

void fxs_edits_drop_shapes(fxs_edits *edits, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; i < end; i++)
        fxs_release(NULL, (void *)(uintptr_t)edits->shapes[i].points);
    for (uint32_t i = end; i < edits->shape_count; i++)
        edits->shapes[first + i - end] = edits->shapes[i];
    edits->shape_count -= end - first;
}

int fxs_edits_add(fxs_edits *edits, uint32_t done, int keep, fxs_message *message)
{
    const uint32_t first = done ? edits->edits[done - 1].end : 0;
    const uint32_t chosen = edits->count ? edits->edits[edits->count - 1].end : 0;
    void *more = fxs_enlarge(NULL, edits->edits, done, (size_t)done + 1, sizeof *edits->edits);
    if (!more)
        return fxs_fail_memory(message, NULL, (uint64_t)done * sizeof *edits->edits);
    edits->edits = more;
    fxs_edits_drop_shapes(edits, first, chosen);
    edits->edits[done].keep = keep;
    edits->edits[done].first = first;
    edits->edits[done].end = edits->shape_count;
    edits->count = done + 1;
    return 0;
}

static void print_list(FILE *file, const char *name, const double *numbers, int count)
{
    fprintf(file, ", \"%s\": ", name);
    if (count == 1)
        fxs_print_number(file, 17, *numbers);
    else
        fxs_print_list(file, 17, ", ", numbers, count);
}

static void print_camera(FILE *file, const fxs_camera *camera)
{
    fprintf(file, ", \"camera\": {\"orthographic\": %s", camera->projection == FXS_ORTHOGRAPHIC ? "true" : "false");
    for (size_t i = 0; i < sizeof camera_fields / sizeof *camera_fields; i++) {
        const char *at = (const char *)camera + camera_fields[i].at;
        double numbers[9];
        for (int k = 0; k < camera_fields[i].count; k++)
            numbers[k] = ldexp(camera_fields[i].bits == 32 ? (double)((const int64_t *)(const void *)at)[k]
                                                           : ((const int32_t *)(const void *)at)[k],
                               -camera_fields[i].bits);
        print_list(file, camera_fields[i].name, numbers, camera_fields[i].count);
    }
    fputs("}", file);
}

static void print_shape(FILE *file, const fxs_edit_shape *s)
{
    fprintf(file, "{\"shape\": \"%s\", \"front\": %s, \"subtract\": %s", names[s->kind], s->front ? "true" : "false",
            s->subtract ? "true" : "false");
    if (s->kind < FXS_EDIT_LASSO)
        print_list(file, "numbers", s->numbers, s->kind == FXS_EDIT_BOX ? 6 : 4);
    else
        print_camera(file, &s->camera);
    for (uint32_t i = 0; i < s->point_numbers; i++)
        fprintf(file, "%s%ld", i ? ", " : ", \"points\": [", (long)s->points[i]);
    fputs(s->point_numbers ? "]}" : "}", file);
}

int fxs_edits_write(const fxs_edits *edits, uint32_t done, const char *path, fxs_message *message)
{
    fxs_output out;
    FXS_TRY(fxs_output_open(&out, path, 0, message));
    fprintf(out.file, "{\"format\": \"fixsplat edits\", \"version\": 1, \"scene\": {\"gaussians\": %lu, \"checksum\": "
            "\"%08lx\"},\n\"edits\": [", (unsigned long)edits->gaussians, (unsigned long)edits->checksum);
    for (uint32_t i = 0; i < done; i++) {
        fprintf(out.file, "%s\n{\"act\": \"%s\", \"select\": [", i ? "," : "",
                edits->edits[i].keep ? "keep" : "delete");
        for (uint32_t k = edits->edits[i].first; k < edits->edits[i].end; k++) {
            fputs(k > edits->edits[i].first ? ",\n " : "", out.file);
            print_shape(out.file, &edits->shapes[k]);
        }
        fputs("]}", out.file);
    }
    fputs("]}\n", out.file);
    return fxs_output_close(&out, message);
}
