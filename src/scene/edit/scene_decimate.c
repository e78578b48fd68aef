/* Reduces the number of Gaussians by merging pairs. Each round sorts the Gaussians in space and finds for each the
   neighbour with the least loss. The best quarter of the pairs is merged. The loss sums changes of log-determinants of
   covariances and of colours, weighted by opacity times area. */
#include <fixsplat/scene.h>
#include <fixsplat/internal/allocator.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/gaussian/attributes.h"
#include "src/base/report.h"
#include "src/pack/weight.h"
#include "src/pack/order.h"
#include "src/scene/formats_internal.h"
#include "src/gaussian/transform_internal.h"

enum {
    CHUNK = 256,
    NEAREST = 16,
    COEFFICIENTS = 45
};

static const double colour_weight = 20;    /* weight of the colour loss relative to the shape loss */
static const double thinnest = 0.1;        /* smallest sigma of a merged Gaussian, relative to its largest sigma */

typedef struct shape {
    double covariance[6];
    double log_determinant;
    double weight;
} shape;

typedef struct pair {
    double loss;
    uint32_t a, b;
} pair;

typedef struct decimated {
    const fxs_reader *reader;
    void *data;
    const fxs_allocator *allocator;
    fxs_gaussian *gaussians;
    uint32_t count, next;
    shape *shapes;
    fxs_order_entry *entries;
    pair *pairs;
    uint8_t *merged;
} decimated;

static double opacity_of(const fxs_gaussian *g)
{
    return fxs_opacity_of_logit(g->opacity);
}

/* Covariance of a Gaussian: R S S R^T, with R the rotation by a quaternion w, x, y, z of any length and S the
   sigmas. */
static void find_covariance(double covariance[6], const float q[4], const double sigma[3])
{
    static const uint8_t rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    double r[3][3];
    fxs_rotation_matrix(r, q[0], q[1], q[2], q[3]);
    for (int k = 0; k < 6; k++) {
        covariance[k] = 0;
        for (int axis = 0; axis < 3; axis++)
            covariance[k] += r[rows[k]][axis] * r[columns[k]][axis] * sigma[axis] * sigma[axis];
    }
}

static double determinant(const double c[6])
{
    return c[0] * (c[1] * c[2] - c[5] * c[5]) - c[3] * (c[3] * c[2] - c[5] * c[4]) + c[4] * (c[3] * c[5] - c[1] * c[4]);
}

static void find_sigmas(double sigma[3], const fxs_gaussian *g, double least)
{
    double most = 0;
    for (int i = 0; i < 3; i++) {
        sigma[i] = fxs_exp(fmin(fmax(g->scale[i], -20), 20));
        most = sigma[i] > most ? sigma[i] : most;
    }
    for (int i = 0; i < 3; i++)
        sigma[i] = sigma[i] > least * most ? sigma[i] : least * most;
}

static void find_shape(shape *s, const fxs_gaussian *g)
{
    double sigma[3];
    find_sigmas(sigma, g, thinnest);
    find_covariance(s->covariance, g->rotation, sigma);
    s->log_determinant = 2 * fxs_log(sigma[0] * sigma[1] * sigma[2]);
    s->weight = fxs_weight(g);
}

/* Covariance of a merged pair of Gaussians A, B: v A + w B + v w d d^T. The weights have the sum v + w = 1, and d is
   the vector between the centres. */
static void join(double out[6], const double a[6], const double b[6], double v, double w, const float from[3],
                 const float to[3])
{
    const double x = (double)to[0] - from[0], y = (double)to[1] - from[1], z = (double)to[2] - from[2];
    const double products[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
    for (int k = 0; k < 6; k++)
        out[k] = v * a[k] + w * b[k] + v * w * products[k];
}

/* Returns the squared colour difference of two Gaussians, averaged over all directions of view. */
static double colour_difference(const fxs_gaussian *a, const fxs_gaussian *b)
{
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += ((double)a->dc[c] - b->dc[c]) * ((double)a->dc[c] - b->dc[c]);
    for (int k = 0; k < COEFFICIENTS; k++)
        sum += ((double)a->sh[k] - b->sh[k]) * ((double)a->sh[k] - b->sh[k]);
    return FXS_SH_0 * FXS_SH_0 * sum;
}

/* Loss of merging Gaussians with covariances A, B and weights v, w: ((v + w) ln |joint covariance| - v ln |A| - w ln
   |B|) / 2 + v w / (v + w) colour_weight colour_difference. */
static double loss_of(const decimated *d, uint32_t a, uint32_t b)
{
    const shape *s = &d->shapes[a], *t = &d->shapes[b];
    const fxs_gaussian *g = &d->gaussians[a], *h = &d->gaussians[b];
    const double sum = s->weight + t->weight, v = sum > 0 ? s->weight / sum : 0.5;
    double joint[6];
    join(joint, s->covariance, t->covariance, v, 1 - v, g->position, h->position);
    const double shapes = fxs_log(determinant(joint)) - v * s->log_determinant - (1 - v) * t->log_determinant;
    return sum * (shapes / 2 + v * (1 - v) * colour_weight * colour_difference(g, h));
}

/* Sets the opacity of a merged Gaussian so that opacity times area equals `weight`. The logit is at least -20. */
static void set_opacity(fxs_gaussian *g, double weight, double most)
{
    const double opacity = fmin(weight / (fxs_weight(g) / opacity_of(g)), most > 0.99 ? most : 0.99);
    g->opacity = opacity > 2e-9 ? (float)fxs_log(opacity / (1 - opacity)) : -20;
}

static void merge(fxs_gaussian *a, const fxs_gaussian *b)
{
    const double weight = fxs_weight(a) + fxs_weight(b), v = weight > 0 ? fxs_weight(a) / weight : 0.5, w = 1 - v;
    double sigma[3], first[6], second[6], joint[6];
    find_sigmas(sigma, a, 0);
    find_covariance(first, a->rotation, sigma);
    find_sigmas(sigma, b, 0);
    find_covariance(second, b->rotation, sigma);
    join(joint, first, second, v, w, a->position, b->position);
    const double most = fmax(opacity_of(a), opacity_of(b));
    for (int i = 0; i < 3; i++) {
        a->position[i] = (float)(v * a->position[i] + w * b->position[i]);
        a->dc[i] = (float)(v * a->dc[i] + w * b->dc[i]);
    }
    for (int k = 0; k < COEFFICIENTS; k++)
        a->sh[k] = (float)(v * a->sh[k] + w * b->sh[k]);
    fxs_set_covariance(a, joint, 0);
    a->opacity = 0;
    set_opacity(a, weight, most < 1 ? most : 0.99);
}

static void run(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

static int find_order(decimated *d, fxs_message *message)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = run, .workers.count = 1,
                                      .allocator = d->allocator};
    memset(d->entries, 0, d->count * sizeof *d->entries);
    for (uint32_t i = 0; i < d->count; i++)
        memcpy(d->entries[i].position, d->gaussians[i].position, sizeof d->entries[i].position);
    return fxs_order(d->entries, d->count, 0, &options) ? fxs_fail_memory(message, NULL, 0) : 0;
}

static uint32_t find_nearest(uint32_t nearest[NEAREST], const fxs_order_entry *chunk, uint32_t count, uint32_t of)
{
    float distances[NEAREST];
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        float distance = 0;
        for (int k = 0; k < 3; k++) {
            const float x = chunk[i].position[k] - chunk[of].position[k];
            distance += x * x;
        }
        if (i == of || (found == NEAREST && !(distance < distances[NEAREST - 1])))
            continue;
        uint32_t at = found < NEAREST ? found++ : NEAREST - 1;
        for (; at > 0 && distance < distances[at - 1]; at--) {
            distances[at] = distances[at - 1];
            nearest[at] = nearest[at - 1];
        }
        distances[at] = distance;
        nearest[at] = i;
    }
    return found;
}

static uint32_t find_pairs(decimated *d)
{
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < d->count; i++) {
        const uint32_t first = i / CHUNK * CHUNK, count = d->count - first < CHUNK ? d->count - first : CHUNK;
        const uint32_t own = d->entries[i].index;
        uint32_t nearest[NEAREST];
        pair best = {INFINITY, 0, 0};
        const uint32_t found = find_nearest(nearest, d->entries + first, count, i - first);
        for (uint32_t k = 0; k < found; k++) {
            const uint32_t other = d->entries[first + nearest[k]].index, a = own < other ? own : other,
                           b = own < other ? other : own;
            const double loss = loss_of(d, a, b);
            if (!k || loss < best.loss)
                best = (pair){loss, a, b};
        }
        if (found)
            d->pairs[pairs++] = best;
    }
    return pairs;
}

static int compare_pairs(const void *a, const void *b)
{
    const pair *x = a, *y = b;
    return x->loss != y->loss ? (x->loss > y->loss) - (x->loss < y->loss)
           : x->a != y->a     ? (x->a > y->a) - (x->a < y->a)
                              : (x->b > y->b) - (x->b < y->b);
}

static void merge_pairs(decimated *d, uint32_t pairs, uint32_t target)
{
    uint32_t left = d->count, kept = 0;
    memset(d->merged, 0, d->count);
    for (uint32_t i = 0; i < (pairs + 3) / 4 && left > target; i++) {
        const pair *p = &d->pairs[i];
        if (d->merged[p->a] || d->merged[p->b])
            continue;
        merge(&d->gaussians[p->a], &d->gaussians[p->b]);
        d->merged[p->a] = 1;
        d->merged[p->b] = 2;
        left--;
    }
    for (uint32_t i = 0; i < d->count; i++)
        if (d->merged[i] != 2)
            d->gaussians[kept++] = d->gaussians[i];
    d->count = left;
}

static long decimated_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    decimated *d = handle;
    const uint32_t left = d->count - d->next, count = capacity < left ? (uint32_t)capacity : left;
    (void)message;
    memcpy(gaussians, d->gaussians + d->next, count * sizeof *gaussians);
    d->next += count;
    return (long)count;
}

static int decimated_rewind(void *handle, fxs_message *message)
{
    (void)message;
    ((decimated *)handle)->next = 0;
    return 0;
}

static void release_work(decimated *d)
{
    fxs_release(d->allocator, d->shapes);
    fxs_release(d->allocator, d->entries);
    fxs_release(d->allocator, d->pairs);
    fxs_release(d->allocator, d->merged);
    d->shapes = NULL;
    d->entries = NULL;
    d->pairs = NULL;
    d->merged = NULL;
}

static void decimated_close(void *handle)
{
    decimated *d = handle;
    release_work(d);
    fxs_release(d->allocator, d->gaussians);
    if (d->reader->close)
        d->reader->close(d->data);
    fxs_release(d->allocator, d->data);
}

static const fxs_reader decimated_format = {
    NULL, sizeof(decimated), NULL, decimated_read, decimated_rewind, decimated_close, NULL
};

static int make_room(decimated *d, uint32_t count, fxs_message *message)
{
    d->gaussians = fxs_allocate(d->allocator, count, sizeof *d->gaussians);
    d->shapes = fxs_allocate(d->allocator, count, sizeof *d->shapes);
    d->entries = fxs_allocate(d->allocator, count, sizeof *d->entries);
    d->pairs = fxs_allocate(d->allocator, count, sizeof *d->pairs);
    d->merged = fxs_allocate(d->allocator, count, 1);
    return d->gaussians && d->shapes && d->entries && d->pairs && d->merged
               ? 0 : fxs_fail_memory(message, NULL, (uint64_t)count *
                                          (sizeof *d->gaussians + sizeof *d->shapes + sizeof *d->entries +
                                           sizeof *d->pairs + 1));
}

static int load(decimated *d, fxs_scene_file *file, uint32_t count, fxs_message *message)
{
    FXS_TRY(fxs_scene_file_rewind(file, message));
    for (long n; (n = fxs_scene_file_read(file, d->gaussians + d->count, count - d->count, message)) != 0;) {
        if (n < 0)
            return (int)n;
        d->count += (uint32_t)n;
        if (d->count == count)
            break;
    }
    return d->count == count ? 0 : fxs_fail(message, "the file changed while it was read");
}

static int decimate(decimated *d, uint32_t target, const fxs_progress *progress, fxs_message *message)
{
    const uint32_t before = d->count;
    while (d->count > target) {
        FXS_TRY(find_order(d, message));
        for (uint32_t i = 0; i < d->count; i++)
            find_shape(&d->shapes[i], &d->gaussians[i]);
        const uint32_t pairs = find_pairs(d);
        qsort(d->pairs, pairs, sizeof *d->pairs, compare_pairs);
        merge_pairs(d, pairs, target);
        if (fxs_report(progress, (double)(before - d->count) / (before - target)))
            return fxs_fail_as(FXS_ERR_STOPPED, message, "stopped");
    }
    return 0;
}

int fxs_scene_file_decimate(fxs_scene_file *file, uint64_t target, fxs_scene_file_info *info,
                            const fxs_progress *progress, fxs_message *message)
{
    const fxs_allocator *allocator = fxs_stream_allocator(file);
    FXS_TRY(fxs_stream_check_still(info, "decimated", message));
    if (target < 1)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no Gaussian would be left");
    if (info->count <= target)
        return fxs_scene_file_rewind(file, message);
    if (info->count > FXS_MAX_COUNT)
        return fxs_fail(message, "%llu Gaussians: at most %u can be merged", (unsigned long long)info->count,
                        FXS_MAX_COUNT);
    decimated *d = fxs_allocate_zeroed(allocator, 1, sizeof *d);
    if (!d)
        return fxs_fail_memory(message, NULL, sizeof *d);
    d->allocator = allocator;
    int error = make_room(d, (uint32_t)info->count, message);
    if (!error)
        error = load(d, file, (uint32_t)info->count, message);
    if (!error)
        error = decimate(d, (uint32_t)target, progress, message);
    release_work(d);
    d->reader = &decimated_format;
    d->data = d;
    fxs_stream_swap(file, &d->reader, &d->data);
    info->count = d->count;
    return error;
}
