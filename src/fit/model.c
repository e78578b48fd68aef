/* The Gaussians of a fit: memory, initial Gaussians, and sorting along a Morton curve. */
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/run.h"
#include "src/base/os_calls.h"
#include "src/fit/stages/curve.h"
#include "src/gaussian/nearest.h"
#include "src/fit/stages/planes.h"

static float *planes_of(size_t stride, size_t planes)
{
    void *memory = fxs_aligned_allocate(stride * planes * sizeof(float));
    return memory ? memset(memory, 0, stride * planes * sizeof(float)) : NULL;
}

void fxs_fit_model_free(fxs_fit_model *m)
{
    fxs_aligned_free(m->parameters);
    fxs_aligned_free(m->means);
    fxs_aligned_free(m->squares);
    fxs_aligned_free(m->by_centre);
    fxs_aligned_free(m->views);
    fxs_aligned_free(m->masters);
    free(m->origins);
    memset(m, 0, sizeof *m);
}

static size_t stride_of(size_t count)
{
    return (count + FXS_FIT_GROUP - 1) / FXS_FIT_GROUP * FXS_FIT_GROUP;
}

static size_t plane_count(const fxs_fit_model *m)
{
    return m->origins ? FXS_FIT_COLOUR : FXS_FIT_PARAMETERS;
}

static void clear_rest(const fxs_fit_model *m, float *planes, size_t count)
{
    for (float *p = planes; planes && p < planes + count * m->stride; p += m->stride)
        memset(p + m->count, 0, (m->stride - m->count) * sizeof *p);
}

/* Fills the unused memory beyond the last Gaussian with Gaussians of practically no opacity and size. */
static void fill_rest(fxs_fit_model *m)
{
    float *const blocks[] = {m->parameters, m->means, m->squares, m->by_centre, m->views};
    for (int i = 0; i < 5; i++)
        clear_rest(m, blocks[i], i < 3 ? plane_count(m) : 1);
    for (size_t i = m->count; i < m->stride; i++) {
        for (int k = 0; k < 3; k++)
            plane(m, FXS_FIT_SCALE + k)[i] = -FXS_FIT_FARTHEST;
        plane(m, FXS_FIT_ROTATION)[i] = 1;
        plane(m, FXS_FIT_OPACITY)[i] = -FXS_FIT_FARTHEST;
    }
}

int fxs_fit_model_room(fxs_fit_model *m, size_t count)
{
    memset(m, 0, sizeof *m);
    m->count = count;
    m->stride = stride_of(count);
    if (!(m->parameters = planes_of(m->stride, FXS_FIT_PARAMETERS)) ||
        !(m->means = planes_of(m->stride, FXS_FIT_PARAMETERS)) ||
        !(m->squares = planes_of(m->stride, FXS_FIT_PARAMETERS)) || !(m->by_centre = planes_of(m->stride, 1)) ||
        !(m->views = planes_of(m->stride, 1))) {
        fxs_fit_model_free(m);
        return FXS_ERR_MEMORY;
    }
    fill_rest(m);
    return 0;
}

int fxs_fit_model_part(fxs_fit_model *m, size_t count)
{
    memset(m, 0, sizeof *m);
    m->count = count;
    m->stride = stride_of(count);
    m->origins = malloc((count ? count : 1) * sizeof *m->origins);
    if (!m->origins || !(m->parameters = planes_of(m->stride, plane_count(m))) ||
        !(m->by_centre = planes_of(m->stride, 1)) || !(m->views = planes_of(m->stride, 1))) {
        fxs_fit_model_free(m);
        return FXS_ERR_MEMORY;
    }
    for (size_t i = 0; i < count; i++)
        m->origins[i] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT};
    fill_rest(m);
    return 0;
}

int fxs_fit_model_resize(fxs_fit_model *m, size_t count)
{
    fxs_fit_model made;
    if (m->stride == stride_of(count)) {
        m->count = count;
        fill_rest(m);
        return 0;
    }
    if (fxs_fit_model_room(&made, count))
        return FXS_ERR_MEMORY;
    made.gains = m->gains;
    made.poses = m->poses;
    made.cameras = m->cameras;
    fxs_fit_model_free(m);
    *m = made;
    return 0;
}

static void set_point(fxs_fit_model *m, size_t i, const fxs_fit_point *point, float ln_scale, float opacity)
{
    for (int k = 0; k < 3; k++) {
        plane(m, FXS_FIT_POSITION + k)[i] = point->position[k];
        plane(m, FXS_FIT_SCALE + k)[i] = ln_scale;
        plane(m, FXS_FIT_COLOUR + k)[i] = ((float)point->colour[k] / 255.0f - 0.5f) / 0.282094792f;
    }
    plane(m, FXS_FIT_ROTATION)[i] = 1;
    plane(m, FXS_FIT_OPACITY)[i] = opacity;
}

int fxs_fit_model_begin(fxs_fit_model *m, const fxs_fit_point *points, size_t count, float opacity)
{
    const float *const first[3] = {points->position, points->position + 1, points->position + 2};
    if (fxs_fit_model_room(m, count))
        return FXS_ERR_MEMORY;
    if (fxs_nearest_squares(first, sizeof *points / sizeof(float), count, m->views)) {
        fxs_fit_model_free(m);
        return FXS_ERR_MEMORY;
    }
    for (size_t i = 0; i < count; i++)
        set_point(m, i, &points[i], 0.5f * ln(fmaxf(m->views[i], 1e-7f)), logit_of(opacity));
    memset(m->views, 0, m->stride * sizeof *m->views);
    return 0;
}

void fxs_fit_model_widen(fxs_fit_model *m, float factor)
{
    for (int k = 0; k < 3; k++)
        for (size_t i = 0; i < m->count; i++)
            plane(m, FXS_FIT_SCALE + k)[i] += ln(factor);
}

void fxs_fit_model_set_sigma(fxs_fit_model *m, size_t first, float sigma)
{
    for (int k = 0; k < 3; k++)
        for (size_t i = first; i < m->count; i++)
            plane(m, FXS_FIT_SCALE + k)[i] = ln(sigma);
}

void fxs_fit_model_give(const fxs_fit_model *m, size_t i, fxs_gaussian *out)
{
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        memcpy((char *)out + k * sizeof(float), &m->parameters[k * m->stride + i], sizeof(float));
}

static int set_stride(float **planes, size_t count, size_t old, size_t stride)
{
    if (stride == old || !*planes)
        return 0;
    if (stride < old) {
        for (size_t k = 0; k < count; k++)
            memmove(*planes + k * stride, *planes + k * old, stride * sizeof **planes);
        return 0;
    }
    float *made = planes_of(stride, count);
    if (!made)
        return FXS_ERR_MEMORY;
    for (size_t k = 0; k < count; k++)
        memcpy(made + k * stride, *planes + k * old, old * sizeof **planes);
    fxs_aligned_free(*planes);
    *planes = made;
    return 0;
}

static int make_room(fxs_fit_model *m, size_t stride)
{
    float **const blocks[3] = {&m->parameters, &m->means, &m->squares};
    for (int i = 0; i < 3; i++)
        if (set_stride(blocks[i], plane_count(m), m->stride, stride)) {
            while (i--)
                set_stride(blocks[i], plane_count(m), stride, m->stride);
            return FXS_ERR_MEMORY;
        }
    m->stride = stride;
    return 0;
}

static void narrow(fxs_fit_model *m, size_t stride)
{
    float **const blocks[3] = {&m->parameters, &m->means, &m->squares};
    for (int i = 0; i < 3; i++)
        set_stride(blocks[i], plane_count(m), m->stride, stride);
    m->stride = stride;
}

enum { GATHER_JOBS = 4 };
typedef struct gathering {
    const fxs_fit_model *model;
    const fxs_fit_origin *origins;
    size_t count;
    float *spare;
} gathering;

static void gather(const gathering *g, float *planes, int moments, float *spare, uint32_t job)
{
    const fxs_fit_origin *const origins = g->origins;
    const size_t stride = g->model->stride, end = planes ? plane_count(g->model) * stride : 0;
    for (float *p = planes + job * stride; p < planes + end; p += GATHER_JOBS * stride) {
        for (size_t i = 0; i < g->count; i++)
            spare[i] = moments && origins[i].kind != FXS_FIT_KEPT ? 0 : p[origins[i].source];
        memcpy(p, spare, stride * sizeof *p);
    }
}

static void gather_job(void *argument, uint32_t job)
{
    const gathering *g = argument;
    float *const spare = g->spare + job * g->model->stride;
    gather(g, g->model->parameters, 0, spare, job);
    gather(g, g->model->means, 1, spare, job);
    gather(g, g->model->squares, 1, spare, job);
}

/* Returns the origins of the Gaussians of a part after a change. */
static fxs_fit_origin *origins_after(const fxs_fit_model *m, const fxs_fit_origin *origins, size_t count)
{
    fxs_fit_origin *made = malloc(count * sizeof *made);
    for (size_t i = 0; made && i < count; i++) {
        const fxs_fit_origin before = m->origins[origins[i].source];
        made[i] = (fxs_fit_origin){before.source, origins[i].kind == FXS_FIT_KEPT ? before.kind : FXS_FIT_CLONE};
    }
    return made;
}

int fxs_fit_model_rebuild(fxs_fit_model *m, const fxs_fit_origin *origins, size_t count, fxs_run_fn *run, void *pool)
{
    const size_t stride = stride_of(count), widest = stride > m->stride ? stride : m->stride;
    float *by_centre = planes_of(stride, 1), *views = planes_of(stride, 1), *spare = planes_of(widest, GATHER_JOBS);
    fxs_fit_origin *after = m->origins ? origins_after(m, origins, count) : NULL;
    if (!by_centre || !views || !spare || !after != !m->origins || make_room(m, widest)) {
        free(after);
        fxs_aligned_free(by_centre);
        fxs_aligned_free(views);
        fxs_aligned_free(spare);
        return FXS_ERR_MEMORY;
    }
    gathering g = {m, origins, count, spare};
    run(pool, gather_job, &g, GATHER_JOBS);
    narrow(m, stride);
    fxs_aligned_free(spare);
    fxs_aligned_free(m->by_centre);
    fxs_aligned_free(m->views);
    m->by_centre = by_centre;
    m->views = views;
    m->count = count;
    free(m->origins);
    m->origins = after;
    fill_rest(m);
    return 0;
}

/* Sets squares[i] to the mean squared distance of a Gaussian or, behind them, of a point from the three nearest. */
static int find_squares(const fxs_fit_model *m, const fxs_fit_point *points, size_t count, float *squares)
{
    const size_t all = m->count + count;
    float *places = malloc(3 * all * sizeof *places);
    const float *const axes[3] = {places, places + all, places + 2 * all};
    for (size_t k = 0; k < 3 && places; k++)
        for (size_t i = 0; i < all; i++)
            places[k * all + i] = i < m->count ? plane(m, FXS_FIT_POSITION + (int)k)[i]
                                               : points[i - m->count].position[k];
    const int error = places ? fxs_nearest_squares(axes, 1, all, squares) : FXS_ERR_MEMORY;
    free(places);
    return error;
}

int fxs_fit_model_add(fxs_fit_model *m, const fxs_fit_point *points, size_t count, float opacity, float factor)
{
    const size_t first = m->count, all = first + count;
    float *squares = malloc(all * sizeof *squares);
    fxs_fit_origin *origins = malloc(all * sizeof *origins);
    int error = squares && origins ? find_squares(m, points, count, squares) : FXS_ERR_MEMORY;
    for (size_t i = 0; i < all && !error; i++)
        origins[i] = i < first ? (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT} : (fxs_fit_origin){0, FXS_FIT_CLONE};
    error = error ? error : fxs_fit_model_rebuild(m, origins, all, fxs_run_here, NULL);
    for (size_t i = first; i < all && !error; i++) {
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
            plane(m, k)[i] = 0;
        set_point(m, i, &points[i - first], 0.5f * ln(fmaxf(squares[i], 1e-7f)) + ln(factor), logit_of(opacity));
    }
    free(squares);
    free(origins);
    return error;
}

typedef struct place {
    uint32_t code, index;
} place;

static int by_code(const void *a, const void *b)
{
    const place *p = a, *q = b;
    if (p->code != q->code)
        return (p->code > q->code) - (p->code < q->code);
    return (p->index > q->index) - (p->index < q->index);
}

/* Sums a plane of positions in a fixed order (curve.h). If `middle` is not null, sums distances from *middle
   instead. */
static double sum_plane(const fxs_fit_model *m, int k, const float *middle)
{
    double sums[CURVE_SUMS] = {0};
    for (size_t i = 0; i < m->count; i++)
        sums[i % CURVE_SUMS] += curve_term(plane(m, FXS_FIT_POSITION + k)[i], middle);
    return curve_sum(sums);
}

int fxs_fit_model_order(fxs_fit_model *m)
{
    place *places = malloc(m->count * sizeof *places);
    fxs_fit_origin *origins = malloc(m->count * sizeof *origins);
    double sums[3];
    curve of = {{0}, 0};
    int error = places && origins ? 0 : FXS_ERR_MEMORY;
    for (int k = 0; k < 3; k++)
        of.middle[k] = curve_middle(sum_plane(m, k, NULL), m->count);
    for (int k = 0; k < 3; k++)
        sums[k] = sum_plane(m, k, &of.middle[k]);
    of.spread = curve_spread(sums, m->count);
    for (size_t i = 0; i < m->count && !error; i++)
        places[i] = (place){code_of(m, &of, i), (uint32_t)i};
    if (!error) {
        qsort(places, m->count, sizeof *places, by_code);
        for (size_t i = 0; i < m->count; i++)
            origins[i] = (fxs_fit_origin){places[i].index, FXS_FIT_KEPT};
        error = fxs_fit_model_rebuild(m, origins, m->count, fxs_run_here, NULL);
    }
    free(places);
    free(origins);
    return error;
}
