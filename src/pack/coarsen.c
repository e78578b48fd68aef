/* Reduces a set of Gaussians to a smaller number by merging neighbours. coarsen_stages.h holds the algorithm. */
#include "coarsen.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/packed.h>

#include "src/gaussian/attributes.h"
#include "src/gaussian/transform_internal.h"
#include "merger.h"
#include "pack_stage.h"

static inline void gather_rows(group *to, const float *const rows[LANES])
{
    for (int i = 0; i < LANES; i++)
        for (int k = 0; k < FIELDS; k++)
            to->f[k][i] = rows[i][k];
}

#define ISA c
#include "coarsen_stages.h"

size_t fxs_merger_bytes(void)
{
    return sizeof(fxs_merger);
}

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

void fxs_coarse_axes(fxs_gaussian *gaussian, const float covariance[6])
{
    double c[6];
    for (int k = 0; k < 6; k++)
        c[k] = (double)covariance[k];
    fxs_set_covariance(gaussian, c, 1e-37);
}

static fxs_way way_of(const fxs_merger *m, uint32_t i)
{
    fxs_way way = m->ways[i];
    way.centre = m->fields[i][CENTRE];
    way.width = sqrtf(m->fields[i][WIDTH]);
    return way;
}

/* The largest opacity follows from the mean. Above the cap by a factor r, the variances grow by sqrt(r). */
static void set_largest_opacity(const fxs_merger *m, uint32_t i, fxs_coarse *out)
{
    const fxs_way way = way_of(m, i);
    const float opacity = m->fields[i][OPACITY] / (float)fxs_way_share(&way);
    const float over = opacity > OPACITY_MOST ? opacity / OPACITY_MOST : 1;
    out->opacity = opacity / over + FXS_FAINTEST;
    out->area *= sqrtf(over);
    for (int k = 0; k < 6; k++)
        out->covariance[k] *= sqrtf(over);
}

static void write_coarse(const fxs_merger *m, uint32_t i, fxs_coarse *out)
{
    *out = *m->from[i];
    if (!m->age[i]) {
        if (m->moves && !m->fades && m->ways[i].mean < 1) {
            out->opacity = m->fields[i][OPACITY] + FXS_FAINTEST;
            out->gaussian.opacity = fxs_logit_of_opacity(out->opacity);
        }
        return;
    }
    for (int k = 0; k < 3; k++) {
        out->gaussian.position[k] = m->fields[i][X + k];
        out->gaussian.dc[k] = fxs_dc_of_colour(m->fields[i][COLOUR + k]);
    }
    for (uint32_t k = 0; k < m->sh_count; k++)
        out->gaussian.sh[k] = m->sh[i][k] / (float)FXS_SH_0;
    for (int k = 0; k < 6; k++)
        out->covariance[k] = m->fields[i][XX + k];
    out->area = m->fields[i][AREA];
    out->opacity = m->fields[i][OPACITY] + FXS_FAINTEST;
    if (m->moves && m->fades)
        set_largest_opacity(m, i, out);
    fxs_coarse_axes(&out->gaussian, out->covariance);
    out->gaussian.opacity = fxs_logit_of_opacity(out->opacity);
}

void fxs_merge_begin(fxs_merger *m, int sh_degree)
{
    m->count = 0;
    m->moves = 0;
    m->sh_count = 3 * (uint32_t)FXS_SH_COUNT(sh_degree);
}

static void add(fxs_merger *m, const fxs_coarse *c)
{
    const uint32_t i = m->count++;
    memset(m->compared[i], 0, sizeof m->compared[i]);
    m->from[i] = c;
    m->into[i] = (uint16_t)i;
    m->age[i] = 0;
    for (int k = 0; k < 3; k++)
        m->fields[i][X + k] = c->gaussian.position[k];
    for (int k = 0; k < 6; k++)
        m->fields[i][XX + k] = c->covariance[k];
    m->fields[i][OPACITY] = fxs_coarse_drawn(c);
    m->fields[i][AREA] = c->area;
    for (int k = 0; k < 3; k++)
        m->fields[i][COLOUR + k] = (float)fxs_colour_of_dc(c->gaussian.dc[k]);
    for (uint32_t k = 0; k < m->sh_count; k++)
        m->sh[i][k] = (float)FXS_SH_0 * c->gaussian.sh[k];
    compare_sh(m, i);
}

void fxs_merge_add(fxs_merger *m, const fxs_coarse *gaussians, uint32_t count)
{
    for (uint32_t i = 0; i < count && m->count < MOST; i++)
        add(m, &gaussians[i]);
}

void fxs_merge_add_moving(fxs_merger *m, const fxs_coarse *gaussians, const fxs_way *ways, uint32_t count, int fades)
{
    const uint32_t first = m->count;
    fxs_merge_add(m, gaussians, count);
    m->moves = 1;
    m->fades = fades;
    for (uint32_t i = first; i < m->count; i++) {
        const fxs_way *way = &ways[i - first];
        m->ways[i] = *way;
        m->fields[i][OPACITY] *= way->mean;
        m->fields[i][CENTRE] = way->centre;
        m->fields[i][WIDTH] = way->width * way->width;
    }
}

void fxs_merge_ways(const fxs_merger *m, fxs_way *ways)
{
    for (uint32_t i = 0; i < m->count; i++)
        if (m->into[i] == i)
            *ways++ = way_of(m, i);
}

void fxs_merge_into(const fxs_merger *m, uint16_t *into)
{
    uint32_t places = 0;
    for (uint32_t i = 0; i < m->count; i++)
        if (m->into[i] == i)
            into[i] = (uint16_t)places++;
    for (uint32_t i = 0; i < m->count; i++)
        if (m->into[i] != i)
            into[i] = into[now(m, i)];
}

uint32_t fxs_merge_end(fxs_merger *m, uint32_t most, fxs_coarse *out, fxs_merge_error *sums)
{
    uint32_t written = 0;
    *sums = (fxs_merge_error){0, 0};
    if (m->count > most)
        fxs_pack_stages_choose(~0u)->coarsen(m, most, sums);
    for (uint32_t i = 0; i < m->count; i++)
        if (m->into[i] == i)
            write_coarse(m, i, &out[written++]);
    return written;
}
