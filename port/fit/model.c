#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lanes.h"
#include "random.h"

static float logit(float opacity)
{
    return ln(opacity / (1.0f - opacity));
}

static float *plane(const fxs_fit_model *m, int which)
{
    return m->parameters + (size_t)which * m->stride;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

static float *planes_of(size_t stride, size_t planes)
{
    void *memory;
    if (posix_memalign(&memory, 64, stride * planes * sizeof(float)))
        return NULL;
    return memset(memory, 0, stride * planes * sizeof(float));
}

void fxs_fit_model_free(fxs_fit_model *m)
{
    free(m->parameters);
    free(m->means);
    free(m->squares);
    free(m->by_centre);
    free(m->views);
    free(m->masters);
    memset(m, 0, sizeof *m);
}

static size_t stride_of(size_t count)
{
    return (count + FXS_FIT_BLOCK - 1) / FXS_FIT_BLOCK * FXS_FIT_BLOCK;
}

/* Beyond the count there are Gaussians of no opacity that no camera's near plane lets through. */
static void fill_rest(fxs_fit_model *m)
{
    for (size_t i = m->count; i < m->stride; i++) {
        plane(m, FXS_FIT_ROTATION)[i] = 1;
        plane(m, FXS_FIT_OPACITY)[i] = -80;
    }
}

/* ---- Beginning --------------------------------------------------------------------------------------------------- */

/* Points in cells of a grid, by cell. */
typedef struct grid {
    const fxs_fit_point *points;
    float low[3], cell;
    int32_t size[3];
    uint32_t *starts, *members;
} grid;

static int32_t cell_along(const grid *g, const float *position, int axis)
{
    const float at = (position[axis] - g->low[axis]) / g->cell;
    return at < (float)(g->size[axis] - 1) ? (int32_t)at : g->size[axis] - 1;
}

static size_t cell_of(const grid *g, const int32_t c[3])
{
    return ((size_t)c[2] * (size_t)g->size[1] + (size_t)c[1]) * (size_t)g->size[0] + (size_t)c[0];
}

/* The three least squares of distances, those of 0 counted too but not the point itself. */
static void look_in_cell(const grid *g, const int32_t cell[3], uint32_t self, float nearest[3])
{
    const size_t c = cell_of(g, cell);
    const float *p = g->points[self].position;
    for (uint32_t k = g->starts[c]; k < g->starts[c + 1]; k++) {
        const float *q = g->points[g->members[k]].position;
        const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
        float d = (x * x + y * y) + z * z;
        if (g->members[k] == self)
            continue;
        for (int i = 0; i < 3; i++)
            if (d < nearest[i]) {
                const float swap = nearest[i];
                nearest[i] = d;
                d = swap;
            }
    }
}

/* Cells that are `ring` away from `centre` along an axis at least. */
static void look_in_ring(const grid *g, const int32_t centre[3], int32_t ring, uint32_t self, float nearest[3])
{
    for (int32_t z = centre[2] - ring; z <= centre[2] + ring; z++)
        for (int32_t y = centre[1] - ring; y <= centre[1] + ring; y++) {
            const int is_face = z == centre[2] - ring || z == centre[2] + ring || y == centre[1] - ring ||
                                y == centre[1] + ring;
            const int32_t step = is_face || !ring ? 1 : 2 * ring;
            for (int32_t x = centre[0] - ring; x <= centre[0] + ring; x += step) {
                const int32_t cell[3] = {x, y, z};
                if (x >= 0 && y >= 0 && z >= 0 && x < g->size[0] && y < g->size[1] && z < g->size[2])
                    look_in_cell(g, cell, self, nearest);
            }
        }
}

/* The mean square of the distances to the three nearest. */
static float spread(const grid *g, uint32_t self)
{
    float nearest[3] = {INFINITY, INFINITY, INFINITY};
    int32_t centre[3], most = 0;
    for (int i = 0; i < 3; i++) {
        centre[i] = cell_along(g, g->points[self].position, i);
        most = g->size[i] > most ? g->size[i] : most;
    }
    for (int32_t ring = 0; ring < most; ring++) {
        const float reach = (float)(ring - 1) * g->cell;     /* what lies in this ring is farther */
        if (ring > 1 && nearest[2] <= reach * reach)
            break;
        look_in_ring(g, centre, ring, self, nearest);
    }
    float sum = 0;
    int found = 0;
    for (int i = 0; i < 3; i++)
        if (nearest[i] < INFINITY) {
            sum += nearest[i];
            found++;
        }
    return found ? sum / (float)found : 1;
}

static int make_grid(grid *g, const fxs_fit_point *points, size_t count)
{
    float high[3], widest = 0;
    g->points = points;
    for (int i = 0; i < 3; i++) {
        g->low[i] = high[i] = points[0].position[i];
        for (size_t p = 1; p < count; p++) {
            g->low[i] = fminf(g->low[i], points[p].position[i]);
            high[i] = fmaxf(high[i], points[p].position[i]);
        }
        widest = fmaxf(widest, high[i] - g->low[i]);
    }
    /* Cells as wide as 1 / 128 of the widest side: 2 M at most. */
    g->cell = widest > 0 ? widest / 128 : 1;
    size_t cells = 1;
    for (int i = 0; i < 3; i++) {
        g->size[i] = (int32_t)((high[i] - g->low[i]) / g->cell) + 1;
        cells *= (size_t)g->size[i];
    }
    g->starts = calloc(cells + 2, sizeof *g->starts);
    g->members = malloc(count * sizeof *g->members);
    if (!g->starts || !g->members)
        return FXS_ERR_MEMORY;
    for (int pass = 0; pass < 2; pass++)
        for (size_t p = 0; p < count; p++) {
            const int32_t cell[3] = {cell_along(g, points[p].position, 0), cell_along(g, points[p].position, 1),
                                     cell_along(g, points[p].position, 2)};
            uint32_t *start = &g->starts[cell_of(g, cell) + 1];
            if (pass)
                g->members[(*start)++] = (uint32_t)p;
            else
                start[1]++;
            if (!pass && p + 1 == count)
                for (size_t c = 0; c < cells; c++)
                    g->starts[c + 1] += g->starts[c];
        }
    return 0;
}

static void set_point(fxs_fit_model *m, size_t i, const fxs_fit_point *point, float mean_square, float opacity)
{
    for (int k = 0; k < 3; k++) {
        plane(m, FXS_FIT_POSITION + k)[i] = point->position[k];
        plane(m, FXS_FIT_SCALE + k)[i] = 0.5f * ln(mean_square > 1e-7f ? mean_square : 1e-7f);
        plane(m, FXS_FIT_COLOUR + k)[i] = ((float)point->colour[k] / 255.0f - 0.5f) / 0.282094792f;
    }
    plane(m, FXS_FIT_ROTATION)[i] = 1;
    plane(m, FXS_FIT_OPACITY)[i] = logit(opacity);
}

int fxs_fit_model_begin(fxs_fit_model *m, const fxs_fit_point *points, size_t count, float opacity)
{
    grid g = {0};
    memset(m, 0, sizeof *m);
    m->count = count;
    m->stride = stride_of(count);
    int error = make_grid(&g, points, count);
    if (!error && !((m->parameters = planes_of(m->stride, FXS_FIT_PARAMETERS)) &&
                    (m->means = planes_of(m->stride, FXS_FIT_PARAMETERS)) &&
                    (m->squares = planes_of(m->stride, FXS_FIT_PARAMETERS)) &&
                    (m->by_centre = planes_of(m->stride, 1)) && (m->views = planes_of(m->stride, 1))))
        error = FXS_ERR_MEMORY;
    for (size_t i = 0; !error && i < count; i++)
        set_point(m, i, &points[i], spread(&g, (uint32_t)i), opacity);
    free(g.starts);
    free(g.members);
    if (error)
        fxs_fit_model_free(m);
    else
        fill_rest(m);
    return error;
}

/* ---- Another model ----------------------------------------------------------------------------------------------- */

/* Plane by plane, in place of the old ones: `moments` leaves out what is not kept. */
static int rebuild_planes(float **planes, size_t stride, size_t new_stride, const fxs_fit_origin *origins, size_t count,
                          int moments)
{
    float *made = planes_of(new_stride, FXS_FIT_PARAMETERS);
    if (!made)
        return FXS_ERR_MEMORY;
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        for (size_t i = 0; i < count; i++)
            if (!moments || origins[i].kind == FXS_FIT_KEPT)
                made[k * new_stride + i] = (*planes)[k * stride + origins[i].source];
    free(*planes);
    *planes = made;
    return 0;
}

int fxs_fit_model_rebuild(fxs_fit_model *m, const fxs_fit_origin *origins, size_t count)
{
    const size_t stride = stride_of(count);
    float *by_centre = planes_of(stride, 1), *views = planes_of(stride, 1);
    if (!by_centre || !views || rebuild_planes(&m->parameters, m->stride, stride, origins, count, 0) ||
        rebuild_planes(&m->means, m->stride, stride, origins, count, 1) ||
        rebuild_planes(&m->squares, m->stride, stride, origins, count, 1)) {
        free(by_centre);
        free(views);
        return FXS_ERR_MEMORY;
    }
    free(m->by_centre);
    free(m->views);
    m->by_centre = by_centre;
    m->views = views;
    m->count = count;
    m->stride = stride;
    fill_rest(m);
    return 0;
}

static float largest_scale(const fxs_fit_model *m, size_t i)
{
    const float x = plane(m, FXS_FIT_SCALE)[i], y = plane(m, FXS_FIT_SCALE + 1)[i], z = plane(m, FXS_FIT_SCALE + 2)[i];
    return exp_e(fmaxf(fmaxf(x, y), z));
}

/* A child is drawn from its parent, and 1.6 times as small. */
static void set_child(fxs_fit_model *m, size_t i, uint64_t seed, uint64_t step, uint64_t index)
{
    float q[4], r[3][3], at[3], length = 0;
    for (int k = 0; k < 4; k++) {
        q[k] = plane(m, FXS_FIT_ROTATION + k)[i];
        length += q[k] * q[k];
    }
    length = sqrtf(length);
    for (int k = 0; k < 4; k++)
        q[k] /= length;
    const float w = q[0], x = q[1], y = q[2], z = q[3];
    const float rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                              {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                              {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(r, rows, sizeof r);
    for (int k = 0; k < 3; k++) {
        const uint64_t random[3] = {fxs_fit_random(seed, step, 16 * index + 3 * (uint64_t)k),
                                    fxs_fit_random(seed, step, 16 * index + 3 * (uint64_t)k + 1),
                                    fxs_fit_random(seed, step, 16 * index + 3 * (uint64_t)k + 2)};
        float *scale = &plane(m, FXS_FIT_SCALE + k)[i];
        at[k] = exp_e(*scale) * fxs_fit_normal(random);
        *scale -= 0.470003629f;    /* ln 1.6 */
    }
    for (int k = 0; k < 3; k++)
        plane(m, FXS_FIT_POSITION + k)[i] += (r[k][0] * at[0] + r[k][1] * at[1]) + r[k][2] * at[2];
}

/* What becomes of Gaussian i: 0 it goes, 1 it stays, 2 it is cloned, 3 it is split. */
static int fate_of(const fxs_fit_model *m, const fxs_fit_densify *d, float least_logit, size_t i)
{
    const float scale = largest_scale(m, i), opacity = plane(m, FXS_FIT_OPACITY)[i];
    const int is_wanted = m->views[i] > 0 && m->by_centre[i] / m->views[i] >= d->gradient;
    if (!(opacity >= least_logit))
        return 0;
    if (is_wanted && scale > d->small)
        return scale / 1.6f > d->large ? 0 : 3;
    if (scale > d->large)
        return 0;
    return is_wanted ? 2 : 1;
}

int fxs_fit_model_densify(fxs_fit_model *m, const fxs_fit_densify *d)
{
    fxs_fit_origin *origins = malloc(2 * m->count * sizeof *origins);
    if (!origins)
        return FXS_ERR_MEMORY;
    const float least_logit = logit(d->opacity);
    size_t kept = 0, count = 0;
    for (size_t i = 0; i < m->count; i++) {
        const int fate = fate_of(m, d, least_logit, i);
        if (fate == 1 || fate == 2)
            origins[kept++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT};
    }
    count = kept;
    for (size_t i = 0; i < m->count; i++) {
        const int fate = fate_of(m, d, least_logit, i);
        if (fate == 2 && count < d->most)
            origins[count++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_CLONE};
        for (int child = 0; fate == 3 && child < 2; child++)
            origins[count++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_CHILD};
    }
    const int error = fxs_fit_model_rebuild(m, origins, count);
    for (size_t i = kept; !error && i < count; i++)
        if (origins[i].kind == FXS_FIT_CHILD)
            set_child(m, i, d->seed, d->step, i);
    free(origins);
    return error;
}

void fxs_fit_model_reset_opacity(fxs_fit_model *m, float opacity)
{
    const float most = logit(opacity);
    for (size_t i = 0; i < m->count; i++)
        plane(m, FXS_FIT_OPACITY)[i] = fminf(plane(m, FXS_FIT_OPACITY)[i], most);
    memset(m->means + FXS_FIT_OPACITY * m->stride, 0, m->stride * sizeof *m->means);
    memset(m->squares + FXS_FIT_OPACITY * m->stride, 0, m->stride * sizeof *m->squares);
}

/* ---- Order ------------------------------------------------------------------------------------------------------- */

typedef struct place {
    uint32_t code, index;
} place;

/* Ten bits, two zeros between each and the next. */
static uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
}

static int by_code(const void *a, const void *b)
{
    const place *p = a, *q = b;
    return p->code != q->code ? (p->code > q->code) - (p->code < q->code) : (p->index > q->index) - (p->index < q->index);
}

/* What is far from the middle by many spreads shares the outer cells: x / (1 + |x|). */
static uint32_t code_of(const fxs_fit_model *m, const float middle[3], float spread, size_t i)
{
    uint32_t code = 0;
    for (int k = 0; k < 3; k++) {
        const float x = (plane(m, FXS_FIT_POSITION + k)[i] - middle[k]) / spread, y = x / (1.0f + fabsf(x));
        code |= spread_bits((uint32_t)((y + 1.0f) * 511.5f)) << k;
    }
    return code;
}

int fxs_fit_model_order(fxs_fit_model *m)
{
    place *places = malloc(m->count * sizeof *places);
    fxs_fit_origin *origins = malloc(m->count * sizeof *origins);
    float middle[3];
    double spread = 0;
    int error = places && origins ? 0 : FXS_ERR_MEMORY;
    for (int k = 0; k < 3 && !error; k++) {
        double sum = 0;
        for (size_t i = 0; i < m->count; i++)
            sum += (double)plane(m, FXS_FIT_POSITION + k)[i];
        middle[k] = (float)(sum / (double)m->count);
        for (size_t i = 0; i < m->count; i++)
            spread += fabs((double)(plane(m, FXS_FIT_POSITION + k)[i] - middle[k]));
    }
    for (size_t i = 0; i < m->count && !error; i++)
        places[i] = (place){code_of(m, middle, (float)(spread / (3 * (double)m->count) + 1e-6), i), (uint32_t)i};
    if (!error) {
        qsort(places, m->count, sizeof *places, by_code);
        for (size_t i = 0; i < m->count; i++)
            origins[i] = (fxs_fit_origin){places[i].index, FXS_FIT_KEPT};
        error = fxs_fit_model_rebuild(m, origins, m->count);
    }
    free(places);
    free(origins);
    return error;
}
