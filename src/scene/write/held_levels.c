/* Builds levels of detail. Each set (about 256 neighbouring Gaussians) merges two sets of the previous level. */
#include "held_levels_internal.h"

#include <stdlib.h>
#include <string.h>

#include "src/pack/coarsen.h"

typedef struct work {
    fxs_coarse set[FXS_MERGE_MOST], out[FXS_MERGE_MOST];
    uint16_t into[FXS_MERGE_MOST];
    fxs_merger *merger;
} work;

const fxs_held_gaussian *fxs_level_gaussian(const fxs_levels *l, uint32_t level, uint32_t i)
{
    return level ? &l->levels[level].gaussians[i] : &l->held->gaussians[l->held->order[i]];
}

const int16_t *fxs_level_sh(const fxs_levels *l, uint32_t level, uint32_t i)
{
    const size_t at = level ? i : l->held->order[i];
    return (level ? l->levels[level].sh : l->held->sh) + at * l->held->coefficients;
}

uint32_t fxs_level_begin(const fxs_levels *l, uint32_t level, uint32_t set)
{
    const fxs_level *at = &l->levels[level];
    const uint64_t begin = (uint64_t)set * FXS_LEVEL_SET;
    return at->begins ? at->begins[set] : begin < at->count ? (uint32_t)begin : at->count;
}

static int allocate(fxs_level *to, uint32_t before, uint32_t most, uint32_t sets, uint32_t coefficients)
{
    to->gaussians = malloc(most * sizeof *to->gaussians);
    to->sh = malloc((size_t)most * coefficients * sizeof *to->sh + 1);
    to->into = malloc(before * sizeof *to->into);
    to->begins = malloc((sets + 1) * sizeof *to->begins);
    to->errors = calloc(sets, sizeof *to->errors);
    to->sets = sets;
    return to->gaussians && to->sh && to->into && to->begins && to->errors;
}

static void make_set(fxs_levels *l, uint32_t level, uint32_t first, work *w)
{
    fxs_level *to = &l->levels[level];
    const fxs_level *from = to - 1;
    const uint32_t last = first + 2 < from->sets ? first + 2 : from->sets;
    const uint32_t begin = fxs_level_begin(l, level - 1, first), end = fxs_level_begin(l, level - 1, last);
    const uint32_t most = from->sets == 1 ? (end - begin + 1) / 2 : FXS_LEVEL_SET, coefficients = l->held->coefficients;
    const int degree = coefficients == 45 ? 3 : coefficients == 24 ? 2 : coefficients == 9;
    fxs_merge_error error;
    for (uint32_t i = begin; i < end; i++) {
        fxs_gaussian g;
        fxs_held_get(fxs_level_gaussian(l, level - 1, i), fxs_level_sh(l, level - 1, i), &g, coefficients);
        fxs_coarse_set(&w->set[i - begin], &g);
    }
    fxs_merge_begin(w->merger, degree);
    fxs_merge_add(w->merger, w->set, end - begin);
    const uint32_t count = fxs_merge_end(w->merger, most, w->out, &error);
    fxs_merge_into(w->merger, w->into);
    for (uint32_t i = begin; i < end; i++)
        to->into[i] = to->count + w->into[i - begin];
    for (uint32_t i = 0; i < count; i++, to->count++)
        fxs_held_set(&to->gaussians[to->count], to->sh + (size_t)to->count * coefficients, &w->out[i].gaussian,
                     coefficients);
    to->errors[first / 2] = error.error;
    for (uint32_t set = first; set < last && from->errors; set++)
        to->errors[first / 2] += from->errors[set];
}

static int make_level(fxs_levels *l, work *w)
{
    const uint32_t level = l->count++;
    fxs_level *to = &l->levels[level];
    const fxs_level *from = to - 1;
    const uint32_t sets = (from->sets + 1) / 2;
    uint64_t most = (uint64_t)sets * FXS_LEVEL_SET;
    most = most < from->count ? most : from->count;
    if (!allocate(to, from->count, (uint32_t)most, sets, l->held->coefficients))
        return 0;
    for (uint32_t set = 0; set < sets; set++) {
        to->begins[set] = to->count;
        make_set(l, level, 2 * set, w);
    }
    to->begins[sets] = to->count;
    return 1;
}

int fxs_levels_make(fxs_levels *l, const fxs_held *held, uint32_t most, int (*progress)(void *argument, double done),
                    void *argument)
{
    work *w = malloc(sizeof *w);
    int made = w != NULL;
    memset(l, 0, sizeof *l);
    l->held = held;
    l->levels[0] = (fxs_level){.count = held->count, .sets = (held->count + FXS_LEVEL_SET - 1) / FXS_LEVEL_SET};
    l->count = 1;
    if (w)
        made = (w->merger = malloc(fxs_merger_bytes())) != NULL;
    while (made && l->count < most && l->count < FXS_LEVELS_MOST && l->levels[l->count - 1].count > 1)
        made = make_level(l, w) &&
               progress(argument, 1 - (double)l->levels[l->count - 1].count / held->count);
    if (w)
        free(w->merger);
    free(w);
    return made;
}

void fxs_levels_free(fxs_levels *l)
{
    for (uint32_t i = 1; i < l->count; i++) {
        free(l->levels[i].gaussians);
        free(l->levels[i].sh);
        free(l->levels[i].into);
        free(l->levels[i].begins);
        free(l->levels[i].errors);
    }
}
