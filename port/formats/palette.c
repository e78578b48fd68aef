#include "palette.h"

#include <math.h>
#include <string.h>

enum {
    ENTRIES = FXS_PALETTE_ENTRIES, WIDTH = FXS_PALETTE_STRIDE, STAGES = FXS_PALETTE_STAGES,
    BEAM = 6,                      /* sums kept from stage to stage */
    LLOYD_ROUNDS = 10, JOINT_ROUNDS = 3,
    JOBS = 16
};

/* 48 bytes a stage and entry are to cost at most 0.4 bytes a Gaussian in four stages. */
uint32_t fxs_palette_entries_for(uint64_t count)
{
    uint64_t entries = count / 480;
    return entries < 1 ? 1 : entries > ENTRIES ? ENTRIES : (uint32_t)entries;
}

/* ---- Distances ------------------------------------------------------------------------------------------------- */

/* out[j] = vector * entry j, for all of a stage. Each is summed in one order, however many are done at once. */
static void multiply(float *restrict out, const float *values, const float *restrict vector)
{
    memset(out, 0, ENTRIES * sizeof *out);
    for (int d = 0; d < WIDTH; d++) {
        const float x = vector[d], *restrict row = values + d * ENTRIES;
        for (int j = 0; j < ENTRIES; j++)
            out[j] += x * row[j];
    }
}

static void get_entry(fxs_sh_vector entry, const fxs_palette *p, uint32_t stage, uint32_t index)
{
    for (int d = 0; d < WIDTH; d++)
        entry[d] = p->values[stage][d][index];
}

static void subtract(fxs_sh_vector vector, const fxs_palette *p, uint32_t stage, uint32_t index)
{
    for (int d = 0; d < WIDTH; d++)
        vector[d] -= p->values[stage][d][index];
}

/* The squares and products of a stage, from its values. */
static void prepare_stage(fxs_palette *p, uint32_t stage)
{
    for (uint32_t j = 0; j < ENTRIES; j++) {
        float square = 0;
        for (int d = 0; d < WIDTH; d++)
            square += p->values[stage][d][j] * p->values[stage][d][j];
        p->squares[stage][j] = j < p->entries ? square : INFINITY;
    }
    for (uint32_t s = 0; s < stage; s++)
        for (uint32_t i = 0; i < p->entries; i++) {
            fxs_sh_vector entry;
            get_entry(entry, p, s, i);
            multiply(p->products[stage][s][i], p->values[stage][0], entry);
        }
}

/* ---- Finding --------------------------------------------------------------------------------------------------- */

/* A sum of entries of the first stages; cost = |x - sum|^2 - |x|^2. */
typedef struct candidate {
    float cost;
    uint8_t indices[STAGES];
} candidate;

/* Puts a candidate among the best, which are in order; of equal ones the first stays. Returns how many there are. */
static uint32_t insert(candidate best[BEAM], uint32_t count, const candidate *from, uint32_t stage, uint32_t index,
                       float cost)
{
    uint32_t at = count < BEAM ? count++ : BEAM - 1;
    for (; at > 0 && best[at - 1].cost > cost; at--)
        best[at] = best[at - 1];
    best[at] = *from;
    best[at].indices[stage] = (uint8_t)index;
    best[at].cost = cost;
    return count;
}

static uint32_t extend(candidate best[BEAM], const candidate *from, uint32_t count, const fxs_palette *p,
                       uint32_t stage, const fxs_sh_vector vector)
{
    float products[ENTRIES], costs[ENTRIES];
    uint32_t kept = 0;
    multiply(products, p->values[stage][0], vector);
    for (uint32_t b = 0; b < count; b++) {
        for (int j = 0; j < ENTRIES; j++)
            costs[j] = from[b].cost + (p->squares[stage][j] - 2 * products[j]);
        for (uint32_t s = 0; s < stage; s++) {
            const float *restrict row = p->products[stage][s][from[b].indices[s]];
            for (int j = 0; j < ENTRIES; j++)
                costs[j] += 2 * row[j];
        }
        for (uint32_t j = 0; j < p->entries; j++)
            if (kept < BEAM || costs[j] < best[BEAM - 1].cost)
                kept = insert(best, kept, &from[b], stage, j, costs[j]);
    }
    return kept;
}

void fxs_palette_find(const fxs_palette *p, fxs_sh_vector vector, uint8_t indices[STAGES])
{
    candidate best[2][BEAM] = {{{0, {0}}}};
    uint32_t count = 1;
    for (uint32_t stage = 0; stage < p->stages; stage++)
        count = extend(best[(stage + 1) & 1], best[stage & 1], count, p, stage, vector);
    memcpy(indices, best[p->stages & 1][0].indices, STAGES);
    for (uint32_t stage = 0; stage < p->stages; stage++)
        subtract(vector, p, stage, indices[stage]);
}

/* ---- Learning -------------------------------------------------------------------------------------------------- */

typedef struct learner {
    fxs_palette *palette;
    fxs_sh_vector *vectors;
    uint32_t count;
    uint8_t (*indices)[STAGES];    /* of each vector */
    double (*sums)[WIDTH];         /* of the vectors of each entry */
    uint32_t *counts;
    const fxs_pack_options *options;
    uint32_t rounds, stage;
} learner;

static int stopped(learner *l)
{
    const double all = (double)l->palette->stages * LLOYD_ROUNDS + JOINT_ROUNDS;
    return l->options->progress && l->options->progress(l->options->argument, l->rounds++ / all);
}

static void run(learner *l, void (*job)(void *, uint32_t))
{
    l->options->run(l->options->pool, job, l, JOBS);
}

static uint32_t first_of(const learner *l, uint32_t job)
{
    return (uint32_t)((uint64_t)l->count * job / JOBS);
}

static uint32_t nearest(const fxs_palette *p, uint32_t stage, const fxs_sh_vector vector)
{
    float costs[ENTRIES];
    uint32_t best = 0;
    multiply(costs, p->values[stage][0], vector);
    for (int j = 0; j < ENTRIES; j++)
        costs[j] = p->squares[stage][j] - 2 * costs[j];
    for (uint32_t j = 1; j < p->entries; j++)
        best = costs[j] < costs[best] ? j : best;
    return best;
}

static void find_nearest(void *argument, uint32_t job)
{
    const learner *l = argument;
    for (uint32_t i = first_of(l, job); i < first_of(l, job + 1); i++)
        l->indices[i][l->stage] = (uint8_t)nearest(l->palette, l->stage, l->vectors[i]);
}

/* Vectors spread evenly over the sample. */
static void begin_stage(learner *l, uint32_t stage)
{
    fxs_palette *p = l->palette;
    for (uint32_t j = 0; j < p->entries; j++)
        for (int d = 0; d < WIDTH; d++)
            p->values[stage][d][j] = l->vectors[(uint64_t)j * l->count / p->entries][d];
    prepare_stage(p, stage);
}

static void add_to(learner *l, uint32_t index, const fxs_sh_vector vector)
{
    for (int d = 0; d < WIDTH; d++)
        l->sums[index][d] += vector[d];
    l->counts[index]++;
}

static void forget_sums(learner *l)
{
    memset(l->sums, 0, l->palette->entries * sizeof *l->sums);
    memset(l->counts, 0, l->palette->entries * sizeof *l->counts);
}

/* Each entry becomes the mean of its vectors; one that has none takes a vector. */
static void move_entries(learner *l, uint32_t stage, uint32_t round)
{
    fxs_palette *p = l->palette;
    for (uint32_t j = 0; j < p->entries; j++) {
        const float *spare = l->vectors[(j * 7919 + round * 104729u) % l->count];
        for (int d = 0; d < WIDTH; d++)
            p->values[stage][d][j] = l->counts[j] ? (float)(l->sums[j][d] / l->counts[j]) : spare[d];
    }
    forget_sums(l);
    prepare_stage(p, stage);
}

/* k-means on what the stages before left; then the vectors are what this one leaves. */
static int learn_stage(learner *l, uint32_t stage)
{
    l->stage = stage;
    begin_stage(l, stage);
    for (uint32_t round = 0; round < LLOYD_ROUNDS; round++) {
        if (stopped(l))
            return -1;
        run(l, find_nearest);
        for (uint32_t i = 0; i < l->count; i++)
            add_to(l, l->indices[i][stage], l->vectors[i]);
        move_entries(l, stage, round);
    }
    run(l, find_nearest);
    for (uint32_t i = 0; i < l->count; i++)
        subtract(l->vectors[i], l->palette, stage, l->indices[i][stage]);
    return 0;
}

static void add(fxs_sh_vector vector, const fxs_palette *p, uint32_t stage, uint32_t index)
{
    for (int d = 0; d < WIDTH; d++)
        vector[d] += p->values[stage][d][index];
}

static void find_sums(void *argument, uint32_t job)
{
    const learner *l = argument;
    for (uint32_t i = first_of(l, job); i < first_of(l, job + 1); i++) {
        for (uint32_t s = 0; s < l->palette->stages; s++)
            add(l->vectors[i], l->palette, s, l->indices[i][s]);
        fxs_palette_find(l->palette, l->vectors[i], l->indices[i]);
    }
}

/* All stages at once: the best sums are found anew, then each stage's entries move to the mean of what the others
   leave. An entry that is in no sum stays. */
static void learn_jointly(learner *l)
{
    fxs_palette *p = l->palette;
    run(l, find_sums);
    for (uint32_t s = 0; s < p->stages; s++) {
        for (uint32_t i = 0; i < l->count; i++) {
            add(l->vectors[i], p, s, l->indices[i][s]);
            add_to(l, l->indices[i][s], l->vectors[i]);
        }
        for (uint32_t j = 0; j < p->entries; j++)
            for (int d = 0; d < WIDTH && l->counts[j]; d++)
                p->values[s][d][j] = (float)(l->sums[j][d] / l->counts[j]);
        forget_sums(l);
        for (uint32_t i = 0; i < l->count; i++)
            subtract(l->vectors[i], p, s, l->indices[i][s]);
    }
    for (uint32_t s = 0; s < p->stages; s++)
        prepare_stage(p, s);
}

/* To 8 bits, with one step for all. */
static void quantise(fxs_palette *p)
{
    float most = 0;
    for (uint32_t s = 0; s < p->stages; s++)
        for (int d = 0; d < WIDTH; d++)
            for (uint32_t j = 0; j < p->entries; j++)
                most = fmaxf(most, fabsf(p->values[s][d][j]));
    p->step_q19 = (uint32_t)fmin(ceil(ldexp(most, 19) / 127), 32767);
    double step = ldexp(p->step_q19, -19);
    for (uint32_t s = 0; s < p->stages; s++) {
        for (int d = 0; d < WIDTH; d++)
            for (uint32_t j = 0; j < p->entries; j++) {
                double code = step > 0 ? floor(p->values[s][d][j] / step + 0.5) : 0;
                code = code > -127 ? code < 127 ? code : 127 : -127;   /* NaN: a file that changed */
                p->codes[s][j][d] = (int8_t)code;
                p->values[s][d][j] = (float)(code * step);
            }
        prepare_stage(p, s);
    }
}

static int learn(learner *l)
{
    for (uint32_t stage = 0; stage < l->palette->stages; stage++)
        if (learn_stage(l, stage))
            return -1;
    for (int round = 0; round < JOINT_ROUNDS; round++) {
        if (stopped(l))
            return -1;
        learn_jointly(l);
    }
    quantise(l->palette);
    return 0;
}

int fxs_palette_learn(fxs_palette *palette, uint32_t stages, uint32_t entries, fxs_sh_vector *vectors, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message)
{
    const fxs_allocator *allocator = options->allocator;
    learner l = {palette, vectors, count, 0, 0, 0, options, 0, 0};
    memset(palette, 0, sizeof *palette);
    palette->stages = stages;
    palette->entries = entries;
    l.indices = fxs_allocate_zeroed(allocator, count, sizeof *l.indices);
    l.sums = fxs_allocate_zeroed(allocator, entries, sizeof *l.sums);
    l.counts = fxs_allocate_zeroed(allocator, entries, sizeof *l.counts);
    int result = !l.indices || !l.sums || !l.counts ? fxs_fail(message, "out of memory")
                 : learn(&l)                        ? fxs_fail(message, "import stopped") : 0;
    fxs_release(allocator, l.indices);
    fxs_release(allocator, l.sums);
    fxs_release(allocator, l.counts);
    return result;
}
