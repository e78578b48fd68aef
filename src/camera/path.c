/* Cameras on a path through keys. The values of the keys follow cubic Hermite curves. The slope at key i is (v[i+1] -
   v[i-1]) / (at[i+1] - at[i-1]); at the ends, the slope to the neighbour. With equal distances, the curve is a
   Catmull-Rom spline. Only + - * / and sqrt are used, so a path is the same on every machine. */
#include "path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/base/exponential.h"
#include "src/base/try_internal.h"
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "camera_internal.h"
#include "lens.h"

enum { POSITION = 0, QUATERNION = 3, FOCAL = 7, CENTRE = 9, NEAR_PLANE = 11 };
enum { EYE = 0, LOOK = 3, UP = 6, ANGLE = 9 };

static void matrix_of(const double q[4], double r[9])
{
    const double s = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        r[4 * i] = 1 - s * (q[1 + j] * q[1 + j] + q[1 + k] * q[1 + k]);
        r[3 * i + j] = s * (q[1 + i] * q[1 + j] - q[0] * q[1 + k]);
        r[3 * i + k] = s * (q[1 + i] * q[1 + k] + q[0] * q[1 + j]);
    }
}

static void values_of(const fxs_view *view, double v[FXS_KEY_VALUES])
{
    memcpy(v + POSITION, view->position, sizeof view->position);
    fxs_quaternion_of(view->rotation, v + QUATERNION);
    v[FOCAL] = fxs_log(view->fx);
    v[FOCAL + 1] = fxs_log(view->fy);
    v[CENTRE] = view->cx;
    v[CENTRE + 1] = view->cy;
    v[NEAR_PLANE] = fxs_log(view->near > 0 ? view->near : 0.2);
}

static void set_values(fxs_view *view, const double v[FXS_KEY_VALUES])
{
    memcpy(view->position, v + POSITION, sizeof view->position);
    matrix_of(v + QUATERNION, view->rotation);
    view->fx = fxs_exp(v[FOCAL]);
    view->fy = fxs_exp(v[FOCAL + 1]);
    view->cx = v[CENTRE];
    view->cy = v[CENTRE + 1];
    view->near = fxs_exp(v[NEAR_PLANE]);
}

/* Makes keys of views. Quaternions q and -q are the same rotation, so each key takes the sign closer to the previous
   key. */
static void make_keys(fxs_path_key *keys, const fxs_view *views, long count)
{
    for (long i = 0; i < count; i++) {
        double *v = keys[i].values, dot = 0;
        values_of(&views[i], v);
        for (int k = QUATERNION; k < FOCAL; k++)
            dot += i ? v[k] * keys[i - 1].values[k] : 0;
        for (int k = QUATERNION; k < FOCAL && dot < 0; k++)
            v[k] = -v[k];
    }
}

/* Computes the values at share t of the way from key i to the next key. */
static void blend(const fxs_path_key *keys, long count, long i, double t, double smoothness, double *values)
{
    const fxs_path_key *a = &keys[i], *b = a + 1, *before = i ? a - 1 : a, *after = i + 2 < count ? b + 1 : b;
    const double s = 1 - t, length = smoothness * (b->at - a->at);
    const double from = (1 + 2 * t) * s * s, to = (3 - 2 * t) * t * t;
    const double out = t * s * s * length / (b->at - before->at), in = s * t * t * length / (after->at - a->at);
    for (int k = 0; k < FXS_KEY_VALUES; k++)
        values[k] = from * a->values[k] + to * b->values[k] + out * (b->values[k] - before->values[k]) -
                    in * (after->values[k] - a->values[k]);
}

void fxs_view_between(const fxs_view *keys, long count, double at, fxs_view *view)
{
    const long key = at < (double)(count - 1) ? at > 0 ? (long)at : 0 : count - 1;
    const long first = key ? key - 1 : 0, last = key + 2 < count ? key + 2 : count - 1;
    fxs_path_key four[4];
    double values[FXS_KEY_VALUES];
    *view = keys[key];
    if (!(at > (double)key) || key == count - 1)
        return;
    make_keys(four, keys + first, last - first + 1);
    for (int i = 0; i < 4; i++)
        four[i].at = i;
    blend(four, last - first + 1, key - first, at - (double)key, 1, values);
    set_values(view, values);
}

/* Finds the last of `count` ascending numbers, `stride` doubles apart, that is not above x. */
static long last_below(const double *numbers, size_t stride, long count, double x)
{
    long low = 0, high = count - 1;
    while (low < high) {
        const long middle = (low + high + 1) / 2;
        if (numbers[stride * (size_t)middle] <= x)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* Makes the view of a track from its eye, look-at point, up and field of view. */
static int look(const fxs_path *path, const double v[FXS_KEY_VALUES], fxs_view *view, fxs_message *message)
{
    const fxs_view *frame = &path->frame;
    const int is_wide = path->is_wide && frame->width > frame->height;
    FXS_TRY(fxs_view_look_at(view, v + EYE, v + LOOK, v + UP, &(fxs_picture){v[ANGLE], frame->width, frame->height},
                             message));
    view->fx = (is_wide ? frame->width : frame->height) / 2.0 / fxs_tangent(v[ANGLE] * (3.141592653589793 / 360));
    view->fy = view->fx;
    view->near = frame->near;
    return 0;
}

static int view_at(const fxs_path *path, double at, fxs_view *view, fxs_message *message)
{
    const long i = last_below(&path->keys->at, sizeof *path->keys / sizeof(double), path->count - 1, at);
    const fxs_path_key *key = &path->keys[i];
    const double t = fmin(fmax((at - key->at) / (key[1].at - key->at), 0), 1);
    double values[FXS_KEY_VALUES];
    blend(path->keys, path->count, i, path->steps ? t >= 1 : t, path->smoothness, values);
    *view = path->frame;
    if (!path->of_views)
        return look(path, values, view, message);
    set_values(view, values);
    return 0;
}

/* Length of the difference of the rotations is 2 sin(angle / 2) sqrt(2). */
double fxs_path_step(const fxs_view *from, const fxs_view *to, double unit)
{
    double length = 0, turn = 0;
    for (int i = 0; i < 3; i++)
        length += (to->position[i] - from->position[i]) * (to->position[i] - from->position[i]);
    for (int i = 0; i < 9; i++)
        turn += (to->rotation[i] - from->rotation[i]) * (to->rotation[i] - from->rotation[i]);
    return sqrt(length) / unit + sqrt(turn / 2) + 2 * fabs(to->fy - from->fy) / (to->fy + from->fy);
}

/* Places the keys of a path without times by the way from key to key. Of keys that are alike, the first is kept. */
static int place_keys(fxs_path *path, double unit, fxs_message *message)
{
    fxs_view before, view;
    long kept = 0;
    double at = 0;
    for (long i = 0; i < path->count; i++) {
        view = path->frame;
        if (path->of_views)
            set_values(&view, path->keys[i].values);
        else
            FXS_TRY(look(path, path->keys[i].values, &view, message));
        const double step = i ? fxs_path_step(&before, &view, unit) : 1;
        if (!(step > 1e-9))
            continue;
        at += i ? step : 0;
        path->keys[kept] = path->keys[i];
        path->keys[kept++].at = at;
        before = view;
    }
    path->count = kept;
    path->end = at;
    return kept < 2 ? fxs_fail_as(FXS_ERR_ARGUMENT, message, "its keys are all alike") : 0;
}

/* Returns place number i of the samples, within the path. */
static double place_of(const fxs_path *path, double i)
{
    const double each = (double)path->samples / (double)(path->count - 1);
    const long k = (long)fmin(i / each, (double)(path->count - 2));
    const fxs_path_key *key = &path->keys[k];
    return fmin(fmax(key->at + (i / each - (double)k) * (key[1].at - key->at), 0), path->end);
}

int fxs_path_even(fxs_path *path, double unit, long frames, double seconds, fxs_message *message)
{
    fxs_view before, view;
    if (path->steps)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "its camera jumps from key to key, at no even speed");
    if (!path->timed)
        FXS_TRY(place_keys(path, unit, message));
    path->frames = frames;
    path->ease = path->closed ? 0 : fmin(1 / seconds, 0.25);
    path->samples = (path->count - 1) * (64 + 16 * frames / (path->count - 1));
    path->lengths = fxs_allocate(NULL, (size_t)path->samples + 1, sizeof *path->lengths);
    if (!path->lengths)
        return fxs_fail_memory(message, NULL, ((size_t)path->samples + 1) * sizeof *path->lengths);
    path->lengths[0] = 0;
    for (long i = 0; i <= path->samples; i++) {
        FXS_TRY(view_at(path, place_of(path, (double)i), &view, message));
        if (i)
            path->lengths[i] = path->lengths[i - 1] + fxs_path_step(&before, &view, unit);
        before = view;
    }
    return path->lengths[path->samples] > 0 ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, message, "its keys are all alike");
}

/* Share of the way after a share x of the time. The speed rises in the time e as 3 y^2 - 2 y^3, y = x / e, then stays
   at 1 / (1 - e), and falls in the same way. */
static double eased(double x, double e)
{
    if (x > 0.5)
        return 1 - eased(1 - x, e);
    const double y = x / e;
    return (x < e ? e * y * y * y * (1 - y / 2) : x - e / 2) / (1 - e);
}

static double place_of_frame(const fxs_path *path, double frame)
{
    const double all = path->lengths[path->samples] * (1 + path->returns);
    const double last = (double)(path->closed ? path->frames : path->frames - 1), x = frame / last;
    double way = all * (path->closed ? x - floor(x) : eased(fmin(fmax(x, 0), 1), path->ease));
    if (way > path->lengths[path->samples])
        way = all - way;
    const long low = last_below(path->lengths, 1, path->samples, way);
    const double step = path->lengths[low + 1] - path->lengths[low];
    return place_of(path, (double)low + (step > 0 ? fmin((way - path->lengths[low]) / step, 1) : 0));
}

int fxs_path_view(const fxs_path *path, double frame, fxs_view *view, fxs_message *message)
{
    double at = path->frames ? 0 : fmin(fmax(frame / path->rate, 0), path->end * (1 + path->returns));
    at = path->frames ? place_of_frame(path, frame) : at > path->end ? 2 * path->end - at : at;
    FXS_TRY(view_at(path, at, view, message));
    snprintf(view->name, sizeof view->name, "frame %.0f", floor(frame));
    return 0;
}

int fxs_path_of_views(fxs_path *path, const fxs_view *views, long count, fxs_message *message)
{
    *path = (fxs_path){.count = count, .of_views = 1, .smoothness = 1, .frame = views[0]};
    path->keys = fxs_allocate(NULL, (size_t)count, sizeof *path->keys);
    if (!path->keys)
        return fxs_fail_memory(message, NULL, (size_t)count * sizeof *path->keys);
    make_keys(path->keys, views, count);
    return 0;
}

void fxs_path_free(fxs_path *path)
{
    fxs_release(NULL, path->keys);
    fxs_release(NULL, path->lengths);
    *path = (fxs_path){.count = 0};
}
