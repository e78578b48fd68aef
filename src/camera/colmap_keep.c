/* Keeps a COLMAP model in its place while photographs are added to it. With the centres C of the images that both
 * models have, and their means m, the old place of a centre is
 *
 *     C' = s C + d,   s^2 = sum |C' - m'|^2 / sum |C - m|^2,   d = m' - s m,
 *
 * and the translation t = -R C of an image becomes s t - R d. */
#include "colmap_keep.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "src/base/output_internal.h"
#include "colmap_internal.h"

enum { NAME = 4096, POSE = 7 * 8, POINT = 24 };

/* An image in the bytes of images.bin: number, pose (quaternion, translation), camera, name, and points in the picture,
   POINT bytes each, which end with the number of a point of the scene. */
typedef struct image {
    uint32_t number;
    unsigned char *start, *pose, *points;
    size_t bytes;
    double rotation[9], translation[3], centre[3];
    int is_kept;
} image;

typedef struct model {
    char images_path[NAME], points_path[NAME], cameras_path[NAME];
    fxs_text images, points, cameras;
    image *list;
    size_t count;
} model;

static void give_doubles(unsigned char *to, const double *values, int count)
{
    for (int i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], 8);
        for (int k = 0; k < 8; k++)
            *to++ = (unsigned char)(bits >> 8 * k);
    }
}

static void set_pose(image *i, const double pose[7])
{
    const double w = pose[0], x = pose[1], y = pose[2], z = pose[3];
    const double rotation[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                                2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    memcpy(i->rotation, rotation, sizeof rotation);
    memcpy(i->translation, pose + 4, sizeof i->translation);
    for (int k = 0; k < 3; k++)
        i->centre[k] = -(rotation[k] * pose[4] + rotation[3 + k] * pose[5] + rotation[6 + k] * pose[6]);
}

static int take_image(fxs_colmap_cursor *in, image *i)
{
    double pose[7];
    i->start = (unsigned char *)in->at;
    i->number = (uint32_t)fxs_colmap_take(in, 4);
    i->pose = (unsigned char *)in->at;
    fxs_colmap_take_doubles(in, pose, 7);
    fxs_colmap_take(in, 4);
    const unsigned char *end = in->left ? memchr(in->at, 0, in->left) : NULL;
    fxs_colmap_skip(in, end ? (uint64_t)(end + 1 - in->at) : UINT64_MAX, 1);
    i->points = (unsigned char *)in->at;
    fxs_colmap_skip(in, fxs_colmap_take(in, 8), POINT);
    i->bytes = (size_t)(in->at - i->start);
    set_pose(i, pose);
    return !in->short_of;
}

static int compare_numbers(const void *a, const void *b)
{
    const image *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

static int read_model(model *m, const char *folder, fxs_message *message)
{
    memset(m, 0, sizeof *m);
    snprintf(m->images_path, NAME, "%s/images.bin", folder);
    snprintf(m->points_path, NAME, "%s/points3D.bin", folder);
    snprintf(m->cameras_path, NAME, "%s/cameras.bin", folder);
    FXS_TRY(fxs_text_load(m->cameras_path, &m->cameras, message));
    FXS_TRY(fxs_text_load(m->images_path, &m->images, message));
    FXS_TRY(fxs_text_load(m->points_path, &m->points, message));
    fxs_colmap_cursor in = fxs_colmap_begin(&m->images);
    const uint64_t count = fxs_colmap_take(&in, 8);
    if (count > in.left / POSE)
        return fxs_fail(message, "%s: cut short", m->images_path);
    m->list = calloc((size_t)count + 1, sizeof *m->list);
    if (!m->list)
        return fxs_fail_memory(message, m->images_path, (size_t)count * sizeof *m->list);
    for (; m->count < count; m->count++)
        if (!take_image(&in, &m->list[m->count]))
            return fxs_fail(message, "%s: cut short", m->images_path);
    qsort(m->list, m->count, sizeof *m->list, compare_numbers);
    return 0;
}

static void free_model(model *m)
{
    free(m->images.data);
    free(m->points.data);
    free(m->cameras.data);
    free(m->list);
}

typedef struct camera {
    unsigned char *start;          /* number, model, width and height, parameters */
    size_t bytes;
} camera;

static int take_camera(fxs_colmap_cursor *in, camera *c)
{
    c->start = (unsigned char *)in->at;
    fxs_colmap_take(in, 4);
    const int params = fxs_colmap_params(fxs_colmap_take(in, 4));
    fxs_colmap_skip(in, 2 + (uint64_t)params, 8);
    c->bytes = (size_t)(in->at - c->start);
    return params && !in->short_of;
}

/* Gives a camera the parameters that it has in the model before. */
static void keep_camera(const model *before, const camera *c)
{
    fxs_colmap_cursor in = fxs_colmap_begin(&before->cameras);
    camera old;
    for (uint64_t count = fxs_colmap_take(&in, 8); count && take_camera(&in, &old); count--)
        if (old.bytes == c->bytes && !memcmp(old.start, c->start, 8))
            memcpy(c->start, old.start, old.bytes);
}

static int keep_cameras(const model *before, const model *after, fxs_message *message)
{
    fxs_colmap_cursor in = fxs_colmap_begin(&after->cameras);
    uint64_t count = fxs_colmap_take(&in, 8);
    camera c;
    for (; count && take_camera(&in, &c); count--)
        keep_camera(before, &c);
    return count || in.short_of
               ? fxs_fail(message, "%s: cut short, or a camera model that is not known here", after->cameras_path) : 0;
}

typedef struct way {
    double scale, shift[3];
} way;

/* Finds the way back from the centres of images that both models have. */
static int find_way(model *before, const model *after, way *back, fxs_message *message)
{
    double means[2][3] = {{0}}, spreads[2] = {0};
    size_t both = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < after->count; i++) {
            image *old = bsearch(&after->list[i], before->list, before->count, sizeof *old, compare_numbers);
            if (!old)
                continue;
            both += pass == 0;
            old->is_kept = 1;
            for (int k = 0; k < 3; k++) {
                const double at[2] = {old->centre[k], after->list[i].centre[k]};
                for (int j = 0; j < 2; j++) {
                    const double off = at[j] - means[j][k] / (double)both;
                    means[j][k] += pass ? 0 : at[j];
                    spreads[j] += pass ? off * off : 0;
                }
            }
        }
    back->scale = sqrt(spreads[0] / spreads[1]);
    for (int k = 0; k < 3; k++)
        back->shift[k] = (means[0][k] - back->scale * means[1][k]) / (double)both;
    return both > 1 && back->scale > 0 && back->scale < 1e12
               ? 0 : fxs_fail(message, "%s: has too few of the images of %s", after->images_path, before->images_path);
}

static void move_images(const model *before, model *after, const way *back)
{
    for (size_t i = 0; i < after->count; i++) {
        image *own = &after->list[i];
        const image *old = bsearch(own, before->list, before->count, sizeof *old, compare_numbers);
        double t[3];
        for (int k = 0; k < 3; k++) {
            const double *r = own->rotation + 3 * k, *d = back->shift;
            t[k] = back->scale * own->translation[k] - (r[0] * d[0] + r[1] * d[1] + r[2] * d[2]);
        }
        if (old)
            memcpy(own->pose, old->pose, POSE);
        else
            give_doubles(own->pose + 4 * 8, t, 3);
    }
}

static int move_points(model *after, const way *back, fxs_message *message)
{
    fxs_colmap_cursor in = fxs_colmap_begin(&after->points);
    for (uint64_t count = fxs_colmap_take(&in, 8); count && !in.short_of; count--) {
        double position[3];
        fxs_colmap_take(&in, 8);
        unsigned char *at = (unsigned char *)in.at;
        fxs_colmap_take_doubles(&in, position, 3);
        fxs_colmap_skip(&in, 3 + 8, 1);        /* colour and error */
        fxs_colmap_skip(&in, fxs_colmap_take(&in, 8), 8);
        for (int k = 0; k < 3; k++)
            position[k] = back->scale * position[k] + back->shift[k];
        if (!in.short_of)
            give_doubles(at, position, 3);
    }
    return in.short_of ? fxs_fail(message, "%s: cut short", after->points_path) : 0;
}

/* Names the new file beside one that was read and that it then replaces. */
static void name_new(char text[NAME + 4], const char *path)
{
    snprintf(text, NAME + 4, "%s.new", path);
}

static int replace(fxs_output *output, const char *path, fxs_message *message)
{
    char name[NAME + 4];
    FXS_TRY(fxs_output_close(output, message));
    name_new(name, path);
    return fxs_file_rename(name, path) ? fxs_output_fail(path, errno, message) : 0;
}

/* Writes the images of the model, and behind them those that only the model before has, without their points. */
static int write_images(const model *before, const model *after, fxs_message *message)
{
    fxs_output output;
    uint64_t count = after->count;
    unsigned char head[8];
    char name[NAME + 4];
    for (size_t i = 0; i < before->count; i++)
        count += !before->list[i].is_kept;
    for (int k = 0; k < 8; k++)
        head[k] = (unsigned char)(count >> 8 * k);
    name_new(name, after->images_path);
    FXS_TRY(fxs_output_open(&output, name, 0, message));
    fxs_output_write(&output, head, 8, message);
    fxs_output_write(&output, after->images.data + 8, after->images.size - 8, message);
    for (size_t i = 0; i < before->count; i++) {
        const image *old = &before->list[i];
        unsigned char *end = old->start + old->bytes;
        if (old->is_kept)
            continue;
        for (unsigned char *at = old->points + 8; at < end; at += POINT)
            memset(at + POINT - 8, 255, 8);
        fxs_output_write(&output, old->start, old->bytes, message);
    }
    return replace(&output, after->images_path, message);
}

static int write_whole(const char *path, const fxs_text *text, fxs_message *message)
{
    fxs_output output;
    char name[NAME + 4];
    name_new(name, path);
    FXS_TRY(fxs_output_open(&output, name, 0, message));
    fxs_output_write(&output, text->data, text->size, message);
    return replace(&output, path, message);
}

int fxs_colmap_keep(const char *before, const char *folder, fxs_message *message)
{
    model old, made = {.count = 0};
    way back;
    int error = read_model(&old, before, message);
    error = error ? error : read_model(&made, folder, message);
    error = error ? error : find_way(&old, &made, &back, message);
    if (!error)
        move_images(&old, &made, &back);
    error = error ? error : move_points(&made, &back, message);
    error = error ? error : keep_cameras(&old, &made, message);
    error = error ? error : write_images(&old, &made, message);
    error = error ? error : write_whole(made.points_path, &made.points, message);
    error = error ? error : write_whole(made.cameras_path, &made.cameras, message);
    free_model(&old);
    free_model(&made);
    return error;
}
