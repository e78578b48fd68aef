/* How the reference's Gaussians become more and fewer. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "planes.h"
#include "random.h"

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

/* Of a Gaussian: it goes, stays as it is, is cloned, is split. */
enum { GOES, STAYS, CLONED, SPLIT };

static float mean_gradient(const fxs_fit_model *m, size_t i)
{
    return m->views[i] > 0 ? m->by_centre[i] / m->views[i] : 0;
}

static int has_rotation(const fxs_fit_model *m, size_t i)
{
    float square = 0;
    for (int k = 0; k < 4; k++)
        square += plane(m, FXS_FIT_ROTATION + k)[i] * plane(m, FXS_FIT_ROTATION + k)[i];
    return square > 1e-20f;
}

static uint8_t fate_of(const fxs_fit_model *m, const fxs_fit_densify *d, float least_logit, size_t i)
{
    const float scale = largest_scale(m, i);
    const int is_wanted = mean_gradient(m, i) >= d->gradient, is_split = is_wanted && scale > d->small;
    if (!(plane(m, FXS_FIT_OPACITY)[i] >= least_logit) || (is_split ? scale / 1.6f : scale) > d->large ||
        !has_rotation(m, i))
        return GOES;
    return is_split ? SPLIT : is_wanted ? CLONED : STAYS;
}

typedef struct wanted {
    float gradient;
    uint32_t index;
} wanted;

static int by_gradient(const void *a, const void *b)
{
    const wanted *p = a, *q = b;
    return p->gradient != q->gradient ? (p->gradient < q->gradient) - (p->gradient > q->gradient)
                                      : (p->index > q->index) - (p->index < q->index);
}

/* Of those that are to be cloned and split, the `room` of the largest gradients are; of equal ones, the first. */
static int limit(const fxs_fit_model *m, const fxs_fit_densify *d, uint8_t *fates, size_t grown, size_t room)
{
    wanted *all_wanted = malloc(grown * sizeof *all_wanted);
    if (!all_wanted)
        return FXS_ERR_MEMORY;
    size_t n = 0;
    for (size_t i = 0; i < m->count; i++)
        if (fates[i] >= CLONED)
            all_wanted[n++] = (wanted){mean_gradient(m, i), (uint32_t)i};
    qsort(all_wanted, grown, sizeof *all_wanted, by_gradient);
    for (size_t k = room; k < grown; k++)
        fates[all_wanted[k].index] = largest_scale(m, all_wanted[k].index) > d->large ? GOES : STAYS;
    free(all_wanted);
    return 0;
}

/* What was kept, then clones and pairs of children in the order of what they come from. */
static size_t set_origins(const uint8_t *fates, size_t count, fxs_fit_origin *origins, size_t *kept)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (fates[i] == STAYS || fates[i] == CLONED)
            origins[n++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT};
    *kept = n;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < (fates[i] == SPLIT) + (fates[i] >= CLONED); k++)
            origins[n++] = (fxs_fit_origin){(uint32_t)i, fates[i] == SPLIT ? FXS_FIT_CHILD : FXS_FIT_CLONE};
    return n;
}

static int carry_out(fxs_fit_model *m, const fxs_fit_densify *d, const uint8_t *fates, size_t most)
{
    fxs_fit_origin *origins = malloc(most * sizeof *origins);
    if (!origins)
        return FXS_ERR_MEMORY;
    size_t kept;
    const size_t count = set_origins(fates, m->count, origins, &kept);
    const int error = count ? fxs_fit_model_rebuild(m, origins, count) : 0;
    for (size_t i = kept; !error && i < count; i++)
        if (origins[i].kind == FXS_FIT_CHILD)
            set_child(m, i, d->seed, d->step, i);
    free(origins);
    return error;
}

int fxs_fit_model_densify(fxs_fit_model *m, const fxs_fit_densify *d)
{
    uint8_t *fates = malloc(m->count);
    if (!fates)
        return FXS_ERR_MEMORY;
    const float least_logit = logit_of(d->opacity);
    size_t staying = 0, grown = 0;
    for (size_t i = 0; i < m->count; i++) {
        fates[i] = fate_of(m, d, least_logit, i);
        staying += fates[i] != GOES;
        grown += fates[i] >= CLONED;
    }
    const size_t room = d->most > staying ? d->most - staying : 0;
    int error = grown > room ? limit(m, d, fates, grown, room) : 0;
    if (!error)
        error = carry_out(m, d, fates, staying + (grown < room ? grown : room) + 1);
    free(fates);
    return error;
}

void fxs_fit_model_reset_opacity(fxs_fit_model *m, float opacity)
{
    const float most = logit_of(opacity);
    for (size_t i = 0; i < m->count; i++)
        plane(m, FXS_FIT_OPACITY)[i] = fminf(plane(m, FXS_FIT_OPACITY)[i], most);
    memset(m->means + FXS_FIT_OPACITY * m->stride, 0, m->stride * sizeof *m->means);
    memset(m->squares + FXS_FIT_OPACITY * m->stride, 0, m->stride * sizeof *m->squares);
}

