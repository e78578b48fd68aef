/* Refines depths by the shapes of the Gaussians. The renderer gives the depth of a Gaussian's centre; a surface needs
   the depth at which a pixel's ray passes the Gaussian. */
#include "volume.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include "src/base/exponential.h"
#include "src/base/run.h"
#include "src/base/sine.h"
#include "src/core/chunk.h"
#include "src/pack/decode.h"

enum { ROWS_OF_JOB = 16 };

#define FLATTEST 0.1             /* least sigma of an axis, as a part of the Gaussian's largest */
#define SAME 1.0                 /* largest distance of the median from the Gaussian's centre, in its largest sigmas */
#define EXTENT 3.0               /* largest distance of the refined depth from it */

/* A Gaussian in the world: its centre, the upper triangle of the inverse of its covariance, and its largest sigma. */
typedef struct shape {
    float centre[3], inverse[6], sigma;
} shape;

struct fxs_shapes {
    const fxs_object *objects;
    uint32_t count;
    size_t *first;               /* first shape of each object */
    shape *shapes;
};

/* True if a still, visible object has shapes. */
static int has_shapes(const fxs_object *object)
{
    return object->visible && !object->scene->motion && !object->scene->places;
}

static size_t slots_of(const fxs_object *object)
{
    return has_shapes(object) ? FXS_CHUNK * (size_t)object->scene->chunk_count : 0;
}

static void rotation_of(const float q[4], double r[3][3])
{
    double square = 0;
    for (int i = 0; i < 4; i++)
        square += (double)q[i] * (double)q[i];
    const double n = square > 0 ? 2 / square : 0;
    const double w = (double)q[0], x = (double)q[1], y = (double)q[2], z = (double)q[3];
    const double rows[3][3] = {{1 - n * (y * y + z * z), n * (x * y - w * z), n * (x * z + w * y)},
                               {n * (x * y + w * z), 1 - n * (x * x + z * z), n * (y * z - w * x)},
                               {n * (x * z - w * y), n * (y * z + w * x), 1 - n * (x * x + y * y)}};
    memcpy(r, rows, sizeof rows);
}

/* Computes the inverse covariance as the sum over the axes a of a a^T / sigma^2. */
static void shape_of(const fxs_object *object, const fxs_gaussian *g, shape *s)
{
    const double size = (double)object->scale_q32 * 0x1p-32;
    double r[3][3], sigma[3], most = 0, inverse[6] = {0};
    rotation_of(g->rotation, r);
    for (int i = 0; i < 3; i++) {
        sigma[i] = size * fxs_exp((double)g->scale[i]);
        most = sigma[i] > most ? sigma[i] : most;
    }
    for (int axis = 0; axis < 3; axis++) {
        const double width = sigma[axis] > FLATTEST * most ? sigma[axis] : FLATTEST * most;
        double a[3] = {0};
        for (int i = 0; i < 9; i++)
            a[i / 3] += object->rotation_q30[i] * 0x1p-30 * r[i % 3][axis];
        for (int i = 0, k = 0; i < 3; i++)
            for (int j = i; j < 3; j++)
                inverse[k++] += a[i] * a[j] / (width * width);
    }
    for (int i = 0; i < 3; i++) {
        double at = (double)object->translation_q32[i] * 0x1p-32;
        for (int k = 0; k < 3; k++)
            at += size * object->rotation_q30[3 * i + k] * 0x1p-30 * (double)g->position[k];
        s->centre[i] = (float)at;
    }
    for (int k = 0; k < 6; k++)
        s->inverse[k] = (float)inverse[k];
    s->sigma = (float)most;
}

static int decode_object(const fxs_object *object, shape *to, fxs_message *message)
{
    const fxs_scene *scene = object->scene;
    const size_t slots = slots_of(object);
    fxs_chunk chunk;
    fxs_gaussian g;
    for (size_t i = 0; i < slots; i++) {
        if (i % FXS_CHUNK == 0 && fxs_chunk_read(&chunk, scene, (uint32_t)(i / FXS_CHUNK)))
            return fxs_fail_as(FXS_ERR_SCENE, message, "%s", fxs_strerror(FXS_ERR_SCENE));
        fxs_decode(scene, &chunk, scene->rows + i / FXS_CHUNK * scene->chunk_bytes, (uint32_t)(i % FXS_CHUNK), &g);
        shape_of(object, &g, &to[i]);
    }
    return 0;
}

int fxs_shapes_make(fxs_shapes **shapes, const fxs_object *objects, uint32_t count, fxs_message *message)
{
    size_t slots = 0;
    fxs_shapes *s = *shapes = fxs_allocate_zeroed(NULL, 1, sizeof *s);
    int error = s ? 0 : fxs_fail_memory(message, NULL, sizeof *s);
    if (!error) {
        s->objects = objects;
        s->count = count;
        s->first = fxs_allocate(NULL, (size_t)count + 1, sizeof *s->first);
        for (uint32_t i = 0; i < count; i++)
            slots += slots_of(&objects[i]);
        s->shapes = fxs_allocate(NULL, slots + 1, sizeof *s->shapes);
        if (!s->first || !s->shapes)
            error = fxs_fail_memory(message, NULL, slots * sizeof *s->shapes);
    }
    slots = 0;
    for (uint32_t i = 0; i < count && !error; i++) {
        s->first[i] = slots;
        error = decode_object(&objects[i], s->shapes + slots, message);
        slots += slots_of(&objects[i]);
    }
    if (error) {
        fxs_shapes_free(s);
        *shapes = NULL;
    }
    return error;
}

void fxs_shapes_free(fxs_shapes *s)
{
    if (!s)
        return;
    fxs_release(NULL, s->first);
    fxs_release(NULL, s->shapes);
    fxs_release(NULL, s);
}

/* ---- Depths ------------------------------------------------------------------------------------------------------ */

typedef struct refining {
    const fxs_shapes *shapes;
    const fxs_view *view;
    const fxs_id *ids;
    uint32_t *depths;
    double one;                  /* a depth of one unit */
} refining;

static const shape *find_shape(const fxs_shapes *s, const fxs_id *id, uint32_t *last)
{
    for (uint32_t i = 0; i < s->count; i++) {
        const uint32_t object = (*last + i) % s->count;
        if (s->objects[object].id != id->object)
            continue;
        *last = object;
        return id->gaussian < slots_of(&s->objects[object]) ? &s->shapes[s->first[object] + id->gaussian] : NULL;
    }
    return NULL;
}

/* Makes the ray of a pixel: `from` + depth * `along`, with depths along the camera's axis. */
static void ray_of(const fxs_view *v, int x, int y, double from[3], double along[3])
{
    const double across[3] = {(x + 0.5 - v->cx) / v->fx, (y + 0.5 - v->cy) / v->fy, 1};
    const int is_flat = v->projection == FXS_ORTHOGRAPHIC;
    for (int i = 0; i < 3; i++) {
        const double sideways = v->rotation[i] * across[0] + v->rotation[3 + i] * across[1];
        from[i] = v->position[i] + (is_flat ? sideways : 0);
        along[i] = v->rotation[6 + i] + (is_flat ? 0 : sideways);
    }
}

/* Returns a^T M b for the symmetric matrix with the upper triangle m. */
static double product(const float m[6], const double a[3], const double b[3])
{
    return a[0] * ((double)m[0] * b[0] + (double)m[1] * b[1] + (double)m[2] * b[2]) +
           a[1] * ((double)m[1] * b[0] + (double)m[3] * b[1] + (double)m[4] * b[2]) +
           a[2] * ((double)m[2] * b[0] + (double)m[4] * b[1] + (double)m[5] * b[2]);
}

/* Replaces the depth of a pixel by the depth at which its ray is nearest, in sigmas, to the centre of the Gaussian that
   contributes most: z = d^T M (c - o) / d^T M d. Not if the median is of another surface. */
static void refine_pixel(const refining *r, int x, int y, uint32_t *last)
{
    const size_t pixel = (size_t)y * (size_t)r->view->width + (size_t)x;
    const shape *s = r->depths[pixel] == FXS_NOTHING ? NULL : find_shape(r->shapes, &r->ids[pixel], last);
    double from[3], along[3], to[3], middle = 0;
    if (!s)
        return;
    ray_of(r->view, x, y, from, along);
    for (int i = 0; i < 3; i++) {
        to[i] = (double)s->centre[i] - from[i];
        middle += r->view->rotation[6 + i] * ((double)s->centre[i] - r->view->position[i]);
    }
    const double reach = EXTENT * (double)s->sigma, median = r->depths[pixel] / r->one;
    const double across = product(s->inverse, along, along);
    if (!(fabs(median - middle) <= SAME * (double)s->sigma) || !(across > 0))
        return;
    double depth = product(s->inverse, along, to) / across;
    depth = depth < middle - reach ? middle - reach : depth > middle + reach ? middle + reach : depth;
    depth = fxs_floor(depth * r->one + 0.5);
    r->depths[pixel] = depth < 1 ? 1 : depth < FXS_NOTHING - 1.0 ? (uint32_t)depth : FXS_NOTHING - 1;
}

static void refine_rows(void *argument, uint32_t job)
{
    const refining *r = argument;
    const int first = (int)job * ROWS_OF_JOB, end = first + ROWS_OF_JOB;
    uint32_t last = 0;
    for (int y = first; y < end && y < r->view->height; y++)
        for (int x = 0; x < r->view->width; x++)
            refine_pixel(r, x, y, &last);
}

void fxs_shapes_refine(const fxs_shapes *shapes, const fxs_view *view, const fxs_id *ids, uint32_t *depths,
                       int depth_bits, const fxs_workers *workers)
{
    refining r = {shapes, view, ids, depths, (double)(1 << depth_bits)};
    (workers->run ? workers->run : fxs_run_here)(workers->pool, refine_rows, &r,
                                                 (uint32_t)(view->height + ROWS_OF_JOB - 1) / ROWS_OF_JOB);
}
