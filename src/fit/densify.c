/* Densification by the reference recipe (Kerbl et al. 2023): clones, splits and removes Gaussians. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include "src/base/run.h"
#include "src/fit/stages/densify_one.h"

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
        fates[all_wanted[k].index] = fate_without_room(m, d, all_wanted[k].index);
    free(all_wanted);
    return 0;
}

/* Lists the Gaussians after densification. Those that stay come first, then clones and pairs of children in the order
   of the Gaussians that they come from. */
static size_t set_origins(const uint8_t *fates, size_t count, fxs_fit_origin *origins, size_t *kept)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (fates[i] == STAYS || fates[i] == CLONED)
            origins[n++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT};
    *kept = n;
    for (size_t i = 0; i < count; i++)
        if (fates[i] == SPLIT) {
            origins[n++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_FIRST_CHILD};
            origins[n++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_SECOND_CHILD};
        } else if (fates[i] == CLONED) {
            origins[n++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_CLONE};
        }
    return n;
}

static int carry_out(fxs_fit_model *m, const uint8_t *fates, size_t most)
{
    fxs_fit_origin *origins = malloc(most * sizeof *origins);
    if (!origins)
        return FXS_ERR_MEMORY;
    size_t kept;
    const size_t count = set_origins(fates, m->count, origins, &kept);
    const int error = count ? fxs_fit_model_rebuild(m, origins, count, fxs_run_here, NULL) : 0;
    for (size_t i = kept; !error && i < count; i++)
        if (origins[i].kind != FXS_FIT_CLONE)
            set_child(m, i, origins[i].kind == FXS_FIT_FIRST_CHILD ? 1.0f : -1.0f);
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
        error = carry_out(m, fates, staying + (grown < room ? grown : room) + 1);
    free(fates);
    return error;
}

void fxs_fit_model_reset_opacity(fxs_fit_model *m, float opacity)
{
    const float most = logit_of(opacity);
    for (size_t i = 0; i < m->count; i++)
        plane(m, FXS_FIT_OPACITY)[i] = fminf(plane(m, FXS_FIT_OPACITY)[i], most);
    if (m->origins)
        return;
    memset(m->means + FXS_FIT_OPACITY * m->stride, 0, m->stride * sizeof *m->means);
    memset(m->squares + FXS_FIT_OPACITY * m->stride, 0, m->stride * sizeof *m->squares);
}
