/* Interpolates views (cameras) between key views. Positions, focal lengths, principal points and quaternions follow
   Catmull-Rom splines. */
#include <math.h>

#include "src/base/exponential.h"
#include <fixsplat/camera.h>
#include "camera_internal.h"

typedef struct spline {
    long first, count;
    double weight[4];
} spline;

/* Catmull-Rom weights of four neighbouring keys: (-t + 2 t^2 - t^3, 2 - 5 t^2 + 3 t^3, t + 4 t^2 - 3 t^3, -t^2 + t^3) /
   2. Both ends of the path continue linearly: 2 v0 - v1. */
static spline spline_at(long count, double at)
{
    const long first = at >= (double)(count - 1) ? count - 2 : (long)at;
    const double t = at - (double)first, t2 = t * t, t3 = t2 * t;
    spline s = {first, count, {(-t + 2 * t2 - t3) / 2, (2 - 5 * t2 + 3 * t3) / 2, (t + 4 * t2 - 3 * t3) / 2,
                               (t3 - t2) / 2}};
    for (int end = 0; end < 2; end++)
        if (end ? first + 2 >= count : first < 1) {
            double *w = s.weight;
            const double beyond = w[end ? 3 : 0];
            w[end ? 2 : 1] += 2 * beyond;
            w[end ? 1 : 2] -= beyond;
            w[end ? 3 : 0] = 0;
        }
    return s;
}

static void blend(const spline *s, const fxs_view *keys, int values, void (*get)(const fxs_view *, double *),
                  double *out)
{
    double value[8];
    for (int i = 0; i < values; i++)
        out[i] = 0;
    for (long k = 0; k < 4; k++) {
        const long key = s->first - 1 + k;
        if (key < 0 || key >= s->count)
            continue;
        get(&keys[key], value);
        for (int i = 0; i < values; i++)
            out[i] += s->weight[k] * value[i];
    }
}

static void lens_of(const fxs_view *view, double *v)
{
    v[0] = fxs_log(view->fx);
    v[1] = fxs_log(view->fy);
    v[2] = view->cx;
    v[3] = view->cy;
    v[4] = fxs_log(view->near > 0 ? view->near : 0.2);
}

static void position_of(const fxs_view *view, double *v)
{
    for (int i = 0; i < 3; i++)
        v[i] = view->position[i];
}

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

/* Quaternions q and -q are the same rotation, so each key takes the sign closer to the previous key. */
static void turn_between(const spline *s, const fxs_view *keys, double rotation[9])
{
    double sum[4] = {0, 0, 0, 0}, before[4] = {0, 0, 0, 0}, q[4];
    for (long k = 0; k < 4; k++) {
        const long key = s->first - 1 + k;
        if (key < 0 || key >= s->count)
            continue;
        fxs_quaternion_of(keys[key].rotation, q);
        const double dot = before[0] * q[0] + before[1] * q[1] + before[2] * q[2] + before[3] * q[3];
        for (int i = 0; i < 4; i++) {
            before[i] = dot < 0 ? -q[i] : q[i];
            sum[i] += s->weight[k] * before[i];
        }
    }
    matrix_of(sum, rotation);
}

/* Interpolates key views. If `at` is a whole number, the result is exactly that key. */
void fxs_view_between(const fxs_view *keys, long count, double at, fxs_view *view)
{
    double lens[5];
    const long key = at < (double)(count - 1) ? at > 0 ? (long)at : 0 : count - 1;
    *view = keys[key];
    if (!(at > (double)key) || key == count - 1)
        return;
    const spline s = spline_at(count, at);
    blend(&s, keys, 5, lens_of, lens);
    blend(&s, keys, 3, position_of, view->position);
    turn_between(&s, keys, view->rotation);
    view->fx = fxs_exp(lens[0]);
    view->fy = fxs_exp(lens[1]);
    view->cx = lens[2];
    view->cy = lens[3];
    view->near = fxs_exp(lens[4]);
}
