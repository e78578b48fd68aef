/* Moves faint Gaussians to the places of other Gaussians and adds new ones there, with little change to the picture
 * (Kheradmand et al. 2024, "3D Gaussian Splatting as Markov Chain Monte Carlo"). */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include "src/base/run.h"
#include "src/fit/stages/relocate_one.h"

typedef struct draws {
    uint64_t *sums;
    uint32_t *times, *sources;
    size_t count;
} draws;

static void sum_opacities(const fxs_fit_model *m, float least_opacity, draws *d)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < m->count; i++)
        d->sums[i] = sum += chance_of(m, least_opacity, i);
}

static void draw(const fxs_fit_model *m, const fxs_fit_relocate *r, uint64_t stream, draws *d)
{
    memset(d->times, 0, m->count * sizeof *d->times);
    for (size_t k = 0; k < d->count; k++) {
        d->sources[k] = drawn(r, stream, k, d->sums, m->count);
        d->times[d->sources[k]]++;
    }
}

static void share_all(fxs_fit_model *m, const draws *d, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (d->times[i] && d->times[i] != DEAD) {
            share(m, i, d->times[i]);
            forget(m, i);
        }
}

static void move(fxs_fit_model *m, size_t i, size_t source)
{
    for (int k = 0; k < (m->origins ? FXS_FIT_COLOUR : FXS_FIT_PARAMETERS); k++)
        plane(m, k)[i] = plane(m, k)[source];
    if (m->origins)
        m->origins[i].source = m->origins[source].source;
}

static void move_dead(fxs_fit_model *m, const fxs_fit_relocate *r, draws *d)
{
    d->count = 0;
    sum_opacities(m, r->opacity, d);
    for (size_t i = 0; i < m->count; i++)
        d->count += (size_t)is_dead(m, r, i);
    if (!d->count || !d->sums[m->count - 1])
        return;
    draw(m, r, 0, d);
    for (size_t i = 0; i < m->count; i++)
        if (is_dead(m, r, i))
            d->times[i] = DEAD;
    share_all(m, d, m->count);
    for (size_t i = 0, dead = 0; i < m->count; i++)
        if (d->times[i] == DEAD) {
            move(m, i, d->sources[dead]);
            forget(m, i);
            dead++;
        }
}

static void set_added(fxs_fit_model *m, const draws *d, size_t count)
{
    share_all(m, d, count);
    for (size_t i = 0; i < d->count; i++)
        for (int k = FXS_FIT_SCALE; k <= FXS_FIT_OPACITY; k++)
            plane(m, k)[count + i] = plane(m, k)[d->sources[i]];
}

static int add(fxs_fit_model *m, const fxs_fit_relocate *r, draws *d)
{
    const size_t count = m->count, more = count + count / 20, next = more < r->most ? more : r->most;
    if (next <= count)
        return 0;
    d->count = next - count;
    sum_opacities(m, 0, d);
    if (!d->sums[count - 1])
        return 0;
    fxs_fit_origin *origins = malloc(next * sizeof *origins);
    if (!origins)
        return FXS_ERR_MEMORY;
    draw(m, r, 1, d);
    for (size_t i = 0; i < next; i++)
        origins[i] = i < count ? (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT}
                               : (fxs_fit_origin){d->sources[i - count], FXS_FIT_CLONE};
    const int error = fxs_fit_model_rebuild(m, origins, next, fxs_run_here, NULL);
    if (!error)
        set_added(m, d, count);
    free(origins);
    return error;
}

int fxs_fit_model_relocate(fxs_fit_model *m, const fxs_fit_relocate *r)
{
    draws d = {malloc(m->count * sizeof *d.sums), malloc(m->count * sizeof *d.times),
               malloc(m->count * sizeof *d.sources), 0};
    int error = d.sums && d.times && d.sources ? 0 : FXS_ERR_MEMORY;
    if (!error) {
        move_dead(m, r, &d);
        error = add(m, r, &d);
    }
    free(d.sums);
    free(d.times);
    free(d.sources);
    return error;
}
