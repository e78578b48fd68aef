/* Two Gaussians become the one with their moments, weighted by opacity times area. The pair with the least error goes
   first, and what became of it goes on as a candidate. The error of a pair is the integral, over a plane that the
   Gaussians are projected to, of the squared difference between the fields of the two and of the one, with colours
   multiplied by opacity; the mean of the planes across the three axes. For Gaussians G of peak 1 with covariances A and
   B at distance d it has a closed form: <Ga, Gb> = 2 pi sqrt(|A| |B| / |A + B|) exp(-d^T (A + B)^-1 d / 2).

   Every operation is one of floats that IEEE 754 defines, so the result is the same on every processor. */
#include "coarsen.h"

#include <math.h>
#include <string.h>

#include "src/gaussian/attributes.h"
#include "src/gaussian/transform_internal.h"

enum {
    MOST = FXS_MERGE_MOST,
    NEAREST = 16,                      /* candidates of a Gaussian */
    PLANES = 3,
    COLOURS = 48                       /* dc, then SH, times the basis of degree 0 */
};

#define OPACITY_MOST 0.99f             /* of what was merged, or that of the more opaque of two */
#define ALPHA_WEIGHT 0.3f              /* of the squared error of alpha by itself, against that of a colour */
#define THINNEST 1e-3f                 /* share of the trace that is added to variances where errors are computed */
#define LEAST 1e-30f
#define PI 3.14159265f

/* The axes of each plane, by their places in a covariance: xx, yy, xy. */
static const uint8_t plane[PLANES][3] = {{0, 1, 3}, {0, 2, 4}, {1, 2, 5}};
static const uint8_t plane_axes[PLANES][2] = {{0, 1}, {0, 2}, {1, 2}};

/* A Gaussian of the set, or one that was merged. */
typedef struct shape {
    float at[3], covariance[6];
    float area, opacity;
    float thick[6];                    /* the covariance with THINNEST */
    float root[PLANES];                /* root of the determinant in each plane, of `thick` */
} shape;

struct fxs_merger {
    uint32_t count, left;
    const fxs_coarse *from[MOST];
    shape shapes[MOST];
    float colours[MOST][COLOURS];
    float squares[MOST];               /* of the colours, and of ALPHA_WEIGHT */
    uint16_t into[MOST];               /* itself, or what it was merged into */
    uint8_t merged[MOST];              /* 1: no longer as it was added */
    uint16_t nearest[MOST][NEAREST];
    uint8_t nearest_count[MOST];
    float least[MOST];                 /* the error with its best partner */
    uint16_t partner[MOST];
};

size_t fxs_merger_bytes(void)
{
    return sizeof(fxs_merger);
}

/* ---- Numbers ----------------------------------------------------------------------------------------------------- */

static float larger(float x, float y)
{
    return x > y ? x : y;
}

/* e^-x for x >= 0, within 1e-6 of its value; 0 from 80 on. 2^n times e^r with |r| <= ln 2 / 2. */
static float falling(float x)
{
    if (!(x < 80))
        return 0;
    const int32_t n = (int32_t)(x * 1.44269504f + 0.5f);
    const float r = (float)n * 0.693145752f - x + (float)n * 1.42860677e-6f;
    const float sum = 1 + r * (1 + r * (0.5f + r * (0.166666667f + r * (0.0416666667f + r * 0.00833333333f))));
    const uint32_t bits = (uint32_t)(127 - n) << 23;
    float scale;
    memcpy(&scale, &bits, sizeof scale);
    return sum * scale;
}

static float minor(const float c[6], int p)
{
    const float u = c[plane[p][0]], v = c[plane[p][1]], uv = c[plane[p][2]];
    return larger(u * v - uv * uv, 1e-6f * u * v);
}

static float area_of(const float c[6])
{
    return sqrtf(larger(minor(c, 0) + minor(c, 1) + minor(c, 2), LEAST));
}

/* ---- Gaussians --------------------------------------------------------------------------------------------------- */

/* The covariance R S S R^T. */
void fxs_coarse_set(fxs_coarse *c, const fxs_gaussian *g)
{
    static const uint8_t rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    double r[3][3], square[3];
    c->gaussian = *g;
    for (int i = 0; i < 3; i++)
        square[i] = fxs_exp(2 * (double)g->scale[i]);
    fxs_rotation_matrix(r, g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]);
    for (int k = 0; k < 6; k++) {
        double sum = 0;
        for (int axis = 0; axis < 3; axis++)
            sum += r[rows[k]][axis] * r[columns[k]][axis] * square[axis];
        c->covariance[k] = (float)sum;
    }
    c->area = (float)sqrt(square[0] * square[1] + square[0] * square[2] + square[1] * square[2]);
    c->opacity = (float)fxs_opacity_of_logit(g->opacity);
}

/* L with L L^T = covariance; no axis is below a millionth of the largest. */
static void factorise(double l[3][3], const float c[6])
{
    const double least = 1e-12 * ((double)c[0] + c[1] + c[2]) + 1e-37;
    memset(l, 0, 9 * sizeof(double));
    l[0][0] = sqrt(c[0] + least);
    l[1][0] = c[3] / l[0][0];
    l[2][0] = c[4] / l[0][0];
    l[1][1] = sqrt(fmax(c[1] + least - l[1][0] * l[1][0], least));
    l[2][1] = (c[5] - l[2][0] * l[1][0]) / l[1][1];
    l[2][2] = sqrt(fmax(c[2] + least - l[2][0] * l[2][0] - l[2][1] * l[2][1], least));
}

/* What became of Gaussian i of the set. */
static void write_coarse(const fxs_merger *m, uint32_t i, fxs_coarse *out)
{
    const shape *s = &m->shapes[i];
    double axes[3][3];
    *out = *m->from[i];
    if (!m->merged[i])
        return;
    for (int k = 0; k < 3; k++) {
        out->gaussian.position[k] = s->at[k];
        out->gaussian.dc[k] = fxs_dc_of_colour(m->colours[i][k]);
    }
    for (int k = 0; k < 45; k++)
        out->gaussian.sh[k] = (float)(m->colours[i][3 + k] / FXS_SH_0);
    memcpy(out->covariance, s->covariance, sizeof out->covariance);
    out->area = s->area;
    out->opacity = s->opacity;
    factorise(axes, s->covariance);
    fxs_set_axes(&out->gaussian, axes);
    out->gaussian.opacity = fxs_logit_of_opacity(s->opacity);
}

/* ---- Two become one ---------------------------------------------------------------------------------------------- */

static void complete(shape *s)
{
    const float more = THINNEST * (s->covariance[0] + s->covariance[1] + s->covariance[2]);
    for (int k = 0; k < 6; k++)
        s->thick[k] = s->covariance[k] + (k < 3 ? more : 0);
    for (int p = 0; p < PLANES; p++)
        s->root[p] = sqrtf(larger(minor(s->thick, p), LEAST));
}

/* Returns the share of a. Where opacity would exceed its most, the scales grow instead. */
static float join(shape *out, const shape *a, const shape *b)
{
    const float first = a->opacity * a->area, second = b->opacity * b->area, sum = first + second;
    const float v = sum > 0 ? first / sum : 0.5f, w = 1 - v, d[3] = {b->at[0] - a->at[0], b->at[1] - a->at[1],
                                                                      b->at[2] - a->at[2]};
    const float most = larger(OPACITY_MOST, larger(a->opacity, b->opacity));
    const float products[6] = {d[0] * d[0], d[1] * d[1], d[2] * d[2], d[0] * d[1], d[0] * d[2], d[1] * d[2]};
    for (int i = 0; i < 3; i++)
        out->at[i] = a->at[i] + w * d[i];
    for (int k = 0; k < 6; k++)
        out->covariance[k] = v * a->covariance[k] + w * b->covariance[k] + v * w * products[k];
    out->area = area_of(out->covariance);
    out->opacity = sum / out->area;
    if (out->opacity > most) {
        const float more = out->opacity / most;
        for (int k = 0; k < 6; k++)
            out->covariance[k] *= more;
        out->area *= more;
        out->opacity = most;
    }
    complete(out);
    return v;
}

static float dot(const float *a, const float *b)
{
    float sums[4] = {0};
    for (int k = 0; k < COLOURS; k += 4)
        for (int i = 0; i < 4; i++)
            sums[i] += a[k + i] * b[k + i];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/* <Ga, Gb> / pi in a plane */
static float product_of(const shape *a, const shape *b, int p)
{
    const float u = a->thick[plane[p][0]] + b->thick[plane[p][0]], v = a->thick[plane[p][1]] + b->thick[plane[p][1]];
    const float uv = a->thick[plane[p][2]] + b->thick[plane[p][2]], determinant = larger(u * v - uv * uv, LEAST);
    const float x = b->at[plane_axes[p][0]] - a->at[plane_axes[p][0]];
    const float y = b->at[plane_axes[p][1]] - a->at[plane_axes[p][1]];
    const float square = (v * x * x - 2 * uv * x * y + u * y * y) / determinant;
    return 2 * a->root[p] * b->root[p] / sqrtf(determinant) * falling(0.5f * larger(square, 0));
}

/* The error of merging a and b. */
static float error_of(const fxs_merger *m, uint32_t a, uint32_t b)
{
    const shape *s = &m->shapes[a], *t = &m->shapes[b];
    shape both;
    const float v = join(&both, s, t), w = 1 - v;
    const float aa = m->squares[a], bb = m->squares[b];
    const float ab = dot(m->colours[a], m->colours[b]) + ALPHA_WEIGHT * ALPHA_WEIGHT;
    const float am = v * aa + w * ab, bm = v * ab + w * bb, mm = v * am + w * bm;
    const float x = s->opacity, y = t->opacity, z = both.opacity;
    float sum = 0;
    for (int p = 0; p < PLANES; p++)
        sum += x * x * aa * s->root[p] + y * y * bb * t->root[p] + z * z * mm * both.root[p] +
               2 * (x * y * ab * product_of(s, t, p) - x * z * am * product_of(s, &both, p) -
                    y * z * bm * product_of(t, &both, p));
    return larger(sum, 0) * (PI / PLANES);
}

/* ---- Candidates -------------------------------------------------------------------------------------------------- */

static void find_nearest(fxs_merger *m, uint32_t of)
{
    float distances[NEAREST];
    uint32_t found = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        float distance = 0;
        for (int k = 0; k < 3; k++) {
            const float x = m->shapes[i].at[k] - m->shapes[of].at[k];
            distance += x * x;
        }
        if (i == of || (found == NEAREST && !(distance < distances[NEAREST - 1])))
            continue;
        uint32_t at = found < NEAREST ? found++ : NEAREST - 1;
        for (; at > 0 && distance < distances[at - 1]; at--) {
            distances[at] = distances[at - 1];
            m->nearest[of][at] = m->nearest[of][at - 1];
        }
        distances[at] = distance;
        m->nearest[of][at] = (uint16_t)i;
    }
    m->nearest_count[of] = (uint8_t)found;
}

static uint32_t now(const fxs_merger *m, uint32_t i)
{
    while (m->into[i] != i)
        i = m->into[i];
    return i;
}

static void offer(fxs_merger *m, uint32_t to, uint32_t partner, float error)
{
    if (error < m->least[to]) {
        m->least[to] = error;
        m->partner[to] = (uint16_t)partner;
    }
}

static void find_partner(fxs_merger *m, uint32_t of)
{
    m->least[of] = INFINITY;
    for (uint32_t k = 0; k < m->nearest_count[of]; k++) {
        const uint32_t other = now(m, m->nearest[of][k]);
        if (other != of)
            offer(m, of, other, error_of(m, of, other));
    }
}

/* The candidates of a and b become those of a: the NEAREST of least error. */
static void join_candidates(fxs_merger *m, uint32_t a, uint32_t b)
{
    uint16_t found[NEAREST];
    float errors[NEAREST];
    uint32_t count = 0;
    for (uint32_t k = 0; k < 2u * NEAREST; k++) {
        const uint32_t from = k < NEAREST ? a : b, place = k % NEAREST;
        if (place >= m->nearest_count[from])
            continue;
        const uint16_t other = (uint16_t)now(m, m->nearest[from][place]);
        uint32_t at = 0;
        while (at < count && found[at] != other)
            at++;
        if (other == a || at < count)
            continue;
        const float error = error_of(m, a, other);
        offer(m, other, a, error);
        if (count == NEAREST && !(error < errors[count - 1]))
            continue;
        for (at = count < NEAREST ? count++ : NEAREST - 1; at > 0 && error < errors[at - 1]; at--) {
            errors[at] = errors[at - 1];
            found[at] = found[at - 1];
        }
        errors[at] = error;
        found[at] = other;
    }
    memcpy(m->nearest[a], found, sizeof found);
    m->nearest_count[a] = (uint8_t)count;
    m->least[a] = count ? errors[0] : INFINITY;
    m->partner[a] = count ? found[0] : 0;
}

/* ---- The set ----------------------------------------------------------------------------------------------------- */

void fxs_merge_begin(fxs_merger *m)
{
    m->count = 0;
}

void fxs_merge_add(fxs_merger *m, const fxs_coarse *gaussians, uint32_t count)
{
    for (const fxs_coarse *c = gaussians; c < gaussians + count && m->count < MOST; c++) {
        const uint32_t i = m->count++;
        shape *s = &m->shapes[i];
        m->from[i] = c;
        m->into[i] = (uint16_t)i;
        m->merged[i] = 0;
        memcpy(s->at, c->gaussian.position, sizeof s->at);
        memcpy(s->covariance, c->covariance, sizeof s->covariance);
        s->area = c->area;
        s->opacity = c->opacity;
        complete(s);
        for (int k = 0; k < 3; k++)
            m->colours[i][k] = (float)fxs_colour_of_dc(c->gaussian.dc[k]);
        for (int k = 0; k < 45; k++)
            m->colours[i][3 + k] = (float)(FXS_SH_0 * c->gaussian.sh[k]);
        m->squares[i] = dot(m->colours[i], m->colours[i]) + ALPHA_WEIGHT * ALPHA_WEIGHT;
    }
}

static void merge(fxs_merger *m, uint32_t a, uint32_t b, fxs_merge_error *sums)
{
    shape both;
    const float v = join(&both, &m->shapes[a], &m->shapes[b]);
    const float error = m->least[a] < m->least[b] ? m->least[a] : m->least[b];
    sums->error += (double)error;
    sums->size += (double)error * both.area;
    m->shapes[a] = both;
    for (int k = 0; k < COLOURS; k++)
        m->colours[a][k] = v * m->colours[a][k] + (1 - v) * m->colours[b][k];
    m->squares[a] = dot(m->colours[a], m->colours[a]) + ALPHA_WEIGHT * ALPHA_WEIGHT;
    m->into[b] = (uint16_t)a;
    m->merged[a] = 1;
    m->least[b] = INFINITY;
    m->left--;
    join_candidates(m, a, b);
    for (uint32_t i = 0; i < m->count; i++)
        if (m->into[i] == i && i != a && (m->partner[i] == a || m->partner[i] == b))
            find_partner(m, i);
}

/* The Gaussian with the least error. Where none has a finite one, the first two. */
static uint32_t find_best(fxs_merger *m)
{
    uint32_t best = 0, other = 0;
    for (uint32_t i = 1; i < m->count; i++)
        best = m->least[i] < m->least[best] ? i : best;
    if (m->least[best] < INFINITY)
        return best;
    while (m->into[best] != best)
        best++;
    for (other = best + 1; m->into[other] != other; other++)
        ;
    m->partner[best] = (uint16_t)other;
    m->least[best] = 0;
    return best;
}

uint32_t fxs_merge_end(fxs_merger *m, uint32_t most, fxs_coarse *out, fxs_merge_error *sums)
{
    uint32_t written = 0;
    *sums = (fxs_merge_error){0, 0};
    m->left = m->count;
    for (uint32_t i = 0; i < m->count && m->left > most; i++)
        find_nearest(m, i);
    for (uint32_t i = 0; i < m->count && m->left > most; i++)
        find_partner(m, i);
    while (m->left > most) {
        const uint32_t best = find_best(m), other = m->partner[best];
        merge(m, best < other ? best : other, best < other ? other : best, sums);
    }
    for (uint32_t i = 0; i < m->count; i++)
        if (m->into[i] == i)
            write_coarse(m, i, &out[written++]);
    return written;
}
