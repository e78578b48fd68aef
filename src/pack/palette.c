/* Learns palettes of SH vectors. Each stage is k-means with signed entries, in two levels: first the middles of groups
 * of GROUP entries, then the entries of each group, so that a search compares with few vectors. After all stages, joint
 * rounds move the entries of all stages towards the sums that Gaussians actually choose. Last, entries are quantised to
 * 8 bits with one step. Vectors are int16 in units of 2^-unit_exponent. */
#include <fixsplat/pack.h>
#include <fixsplat/internal/allocator.h>

#include "palette.h"
#include "src/base/report.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "encode.h"
#include "pack_stage.h"
#include "palette_vector.h"

enum {
    ENTRIES = FXS_PALETTE_ENTRIES, WIDTH = FXS_PALETTE_STRIDE, STAGES = FXS_PALETTE_STAGES,
    GROUPS = FXS_PALETTE_GROUPS, GROUP = FXS_PALETTE_GROUP, MOST = FXS_PALETTE_MOST,
    NEVER = 1 << 30,               /* larger than any cost of a palette search */
    SAMPLE = 16384,
    LLOYD_ROUNDS = 5, JOINT_ROUNDS = 2,
    JOBS = 16
};

/* Returns the number of palette entries that keeps the packed scene within 40 bytes per Gaussian, 20 in file profile
   small. The palette gets at least 0.1 bytes per Gaussian, or 0.4 bytes in scenes below 10,000 Gaussians. */
uint32_t fxs_palette_entries_for(uint64_t count, uint64_t chunks, enum fxs_profile profile, int sh_degree)
{
    const uint32_t stages = fxs_palette_stages(profile, sh_degree), stage_bytes = stages * FXS_PALETTE_STRIDE;
    if (!stages)
        return 0;
    const uint64_t limit = count * (profile == FXS_PROFILE_SMALL ? 20 : 40);
    const uint64_t others = sizeof(fxs_packed_header) + 64 +
                            chunks * (sizeof(fxs_chunk) + fxs_chunk_bytes(profile, sh_degree));
    const uint64_t left = limit > others ? limit - others : 0, least = count < 10000 ? 2 * count / 5 : count / 10;
    const uint64_t entries = (left > least ? left : least) / stage_bytes;
    return entries < 1 ? 1 : entries > ENTRIES ? ENTRIES : (uint32_t)entries;
}

void fxs_sh_item_set(fxs_sh_item *item, const fxs_gaussian *g, double opacity, int sh_degree)
{
    const int count = 3 * FXS_SH_COUNT(sh_degree);
    const float *s = g->scale;
    const float least = s[0] < s[1] ? s[0] < s[2] ? s[0] : s[2] : s[1] < s[2] ? s[1] : s[2];
    const float most = fxs_largest_coefficient(g->sh, count);
    int32_t codes[45];
    memset(item, 0, sizeof *item);
    memcpy(item->position, g->position, sizeof item->position);
    item->area = (int16_t)fxs_floor_within(8 * FXS_LOG2_E * ((double)s[0] + s[1] + s[2] - least) + 0.5, -1000, 1000);
    item->opacity = (uint8_t)fxs_floor_within(255 * opacity + 0.5, 0, 255);
    item->step = (most < FLT_MAX ? most : FLT_MAX) / 127;
    fxs_code_coefficients(g->sh, count, item->step, codes);
    for (int i = 0; i < count; i++)
        item->codes[i] = (int8_t)codes[i];
}

static void copy_held(fxs_sh_vector to, const fxs_sh_vector from, int sign)
{
    for (int d = 0; d < WIDTH; d++)
        to[d] = hold(sign * from[d]);
}

/* Computes the squared lengths of a stage's palette entries. Unused entries and groups get the cost NEVER, so that no
   search takes them. */
static void prepare_stage(fxs_palette *p, uint32_t stage)
{
    for (uint32_t j = 0; j < ENTRIES; j++)
        p->squares[stage][j] = j < p->entries ? dot(p->vectors[stage][j], p->vectors[stage][j]) : NEVER;
    for (uint32_t g = 0; g < GROUPS; g++)
        p->group_squares[stage][g] = g < groups_of(p) ? dot(p->groups[stage][g], p->groups[stage][g]) : NEVER;
}

typedef struct learner {
    fxs_palette *palette;
    const fxs_pack_stages *stages;
    fxs_sh_vector *vectors;      /* SH vectors of the sample, minus the chosen palette entries of the finished stages */
    uint32_t count;
    uint8_t (*indices)[STAGES];
    int32_t (*sums)[WIDTH];        /* per palette entry: sum of its assigned SH vectors, at most 2^14 vectors */
    int32_t *total;
    const fxs_pack_options *options;
    uint32_t rounds, stage;
    int32_t most;
} learner;

static int stopped(learner *l)
{
    const double all = 2.0 * (l->palette->stages + 4) * LLOYD_ROUNDS + JOINT_ROUNDS;
    return fxs_report(&l->options->progress, l->rounds++ / all);
}

static void run(learner *l, void (*job)(void *, uint32_t))
{
    l->options->workers.run(l->options->workers.pool, job, l, JOBS);
}

static uint32_t first_of(const learner *l, uint32_t job)
{
    return (uint32_t)((uint64_t)l->count * job / JOBS);
}

static void find_group(void *argument, uint32_t job)
{
    const learner *l = argument;
    const fxs_palette *p = l->palette;
    for (uint32_t i = first_of(l, job); i < first_of(l, job + 1); i++)
        l->indices[i][l->stage] = (uint8_t)l->stages->nearest(p->groups[l->stage], p->group_squares[l->stage],
                                                              groups_of(p), l->vectors[i]);
}

static void find_entry(void *argument, uint32_t job)
{
    const learner *l = argument;
    const fxs_palette *p = l->palette;
    for (uint32_t i = first_of(l, job); i < first_of(l, job + 1); i++) {
        uint8_t *index = &l->indices[i][l->stage];
        const uint32_t first = *index % ENTRIES / GROUP * GROUP, left = p->entries - first;
        *index = (uint8_t)(first + l->stages->nearest(p->vectors[l->stage] + first, p->squares[l->stage] + first,
                                                      left < GROUP ? left : GROUP, l->vectors[i]));
    }
}

static void add_to(learner *l, uint32_t entry, const fxs_sh_vector vector, int sign)
{
    for (int d = 0; d < WIDTH; d++)
        l->sums[entry][d] += sign * vector[d];
    l->total[entry]++;
}

static int32_t mean_of(int32_t sum, int32_t total)
{
    return (sum < 0 ? sum - total / 2 : sum + total / 2) / total;
}

/* Moves each palette vector by the mean of its assigned vectors if keep is 1, or to the mean if keep is 0. */
static void move(learner *l, fxs_sh_vector *vectors, uint32_t count, int keep)
{
    for (uint32_t j = 0; j < count; j++)
        for (int d = 0; d < WIDTH && l->total[j]; d++)
            vectors[j][d] = hold(keep * vectors[j][d] + mean_of(l->sums[j][d], l->total[j]));
    memset(l->sums, 0, l->palette->entries * sizeof *l->sums);
    memset(l->total, 0, l->palette->entries * sizeof *l->total);
}

static int learn_vectors(learner *l, fxs_sh_vector *vectors, uint32_t count, void (*find_all)(void *, uint32_t))
{
    for (uint32_t round = 0; round < LLOYD_ROUNDS; round++) {
        if (stopped(l))
            return -1;
        prepare_stage(l->palette, l->stage);
        run(l, find_all);
        for (uint32_t i = 0; i < l->count; i++) {
            const uint32_t index = l->indices[i][l->stage];
            add_to(l, index % ENTRIES, l->vectors[i], index & FXS_PALETTE_NEGATIVE ? -1 : 1);
        }
        move(l, vectors, count, 0);
    }
    prepare_stage(l->palette, l->stage);
    run(l, find_all);
    return 0;
}

static void begin_entries(learner *l)
{
    fxs_palette *p = l->palette;
    uint32_t counts[GROUPS] = {0}, taken[GROUPS] = {0};
    for (uint32_t i = 0; i < l->count; i++)
        counts[l->indices[i][l->stage] % ENTRIES]++;
    for (uint32_t i = 0; i < l->count; i++) {
        const uint32_t index = l->indices[i][l->stage], group = index % ENTRIES, n = taken[group]++;
        const uint32_t at = (uint32_t)((uint64_t)n * GROUP / counts[group]), j = group * GROUP + at;
        l->indices[i][l->stage] = (uint8_t)(group * GROUP);
        if (j < p->entries && ((uint64_t)at * counts[group] + GROUP - 1) / GROUP == n)
            copy_held(p->vectors[l->stage][j], l->vectors[i], index & FXS_PALETTE_NEGATIVE ? -1 : 1);
    }
}

/* Learns one stage of a palette. The groups of entries start as vectors spread evenly over the sample. */
static int learn_stage(learner *l, uint32_t stage)
{
    fxs_palette *p = l->palette;
    l->stage = stage;
    for (uint32_t g = 0; g < groups_of(p); g++)
        copy_held(p->groups[stage][g], l->vectors[(uint64_t)g * l->count / groups_of(p)], 1);
    if (learn_vectors(l, p->groups[stage], groups_of(p), find_group))
        return -1;
    begin_entries(l);
    if (learn_vectors(l, p->vectors[stage], p->entries, find_entry))
        return -1;
    for (uint32_t i = 0; i < l->count; i++)
        subtract_entry(l->vectors[i], p, stage, l->indices[i][stage]);
    return 0;
}

static void add_sums(learner *l)
{
    for (uint32_t i = 0; i < l->count; i++)
        for (uint32_t s = 0; s < l->palette->stages; s++)
            subtract_entry(l->vectors[i], l->palette, s, l->indices[i][s] ^ FXS_PALETTE_NEGATIVE);
}

static void find_sums(void *argument, uint32_t job)
{
    const learner *l = argument;
    for (uint32_t i = first_of(l, job); i < first_of(l, job + 1); i++)
        l->stages->find(l->palette, l->vectors[i], l->indices[i]);
}

static void learn_jointly(learner *l)
{
    fxs_palette *p = l->palette;
    run(l, find_sums);
    for (uint32_t s = 0; s < p->stages; s++) {
        for (uint32_t i = 0; i < l->count; i++) {
            const uint32_t index = l->indices[i][s];
            add_to(l, index % ENTRIES, l->vectors[i], index & FXS_PALETTE_NEGATIVE ? -1 : 1);
            subtract_entry(l->vectors[i], p, s, index ^ FXS_PALETTE_NEGATIVE);
        }
        move(l, p->vectors[s], p->entries, 1);
        for (uint32_t i = 0; i < l->count; i++)
            subtract_entry(l->vectors[i], p, s, l->indices[i][s]);
    }
    for (uint32_t s = 0; s < p->stages; s++)
        prepare_stage(p, s);
}

static void quantise(fxs_palette *p, int32_t most)
{
    for (uint32_t s = 0; s < p->stages; s++)
        for (uint32_t j = 0; j < p->entries; j++)
            for (int d = 0; d < WIDTH; d++)
                most = absolute(p->vectors[s][j][d]) > most ? absolute(p->vectors[s][j][d]) : most;
    p->step = most > 127 ? (most + 126) / 127 : 1;
    for (uint32_t s = 0; s < p->stages; s++) {
        for (uint32_t j = 0; j < p->entries; j++)
            for (int d = 0; d < WIDTH; d++)
                p->vectors[s][j][d] = (int16_t)(code_of(p->vectors[s][j][d], p->step) * p->step);
        prepare_stage(p, s);
    }
}

static uint32_t step_for(uint32_t count)
{
    return (count - 1) / SAMPLE + 1;
}

uint32_t fxs_palette_sample(uint32_t count)
{
    const uint32_t step = step_for(count);
    return (step > FXS_CHUNK ? (count - 1) / step + 1 : fxs_chunks_of(count)) * FXS_CHUNK;
}

/* Returns the index of a chunk's first item in the palette sample. If sampled Gaussians are more than a chunk apart,
   the sample has one chunk per sampled Gaussian. */
uint32_t fxs_palette_sample_at(uint32_t count, uint32_t chunk)
{
    const uint32_t step = step_for(count), first = chunk * FXS_CHUNK, number = (first + step - 1) / step;
    if (step <= FXS_CHUNK)
        return first;
    return number * step - first < FXS_CHUNK && number * step < count ? number * FXS_CHUNK : FXS_NOT_SAMPLED;
}

/* Sets the unit of a palette, 2^-19 to 2^-8. It is the finest unit of which MOST units reach the smaller of two values:
   12 times the root mean square, and the maximum, of the SH coefficients. */
static void find_unit(fxs_palette *p, const fxs_sh_item *items, uint32_t count, uint32_t step)
{
    double squares = 0, numbers = 0, most = 0;
    for (uint32_t i = 0; i < count; i += step) {
        const fxs_sh_item *item = &items[fxs_palette_sample_at(count, i / FXS_CHUNK) + i % FXS_CHUNK];
        int32_t sum = 0;
        for (int k = 0; k < 45; k++)
            sum += item->codes[k] * item->codes[k];
        squares += (double)sum * item->step * item->step;
        numbers += 3 * FXS_SH_COUNT(p->sh_degree);
        most = 127.0 * item->step > most ? 127.0 * item->step : most;
    }
    const double usual = 12 * sqrt(squares / numbers), limit = usual < most ? usual : most;
    p->unit_exponent = 19;
    while (p->unit_exponent > 8 && ldexp(MOST, -p->unit_exponent) < limit)
        p->unit_exponent--;
}

static void take_sample(learner *l, const fxs_sh_item *items, uint32_t count, uint32_t step)
{
    l->count = 0;
    l->most = 0;
    for (uint32_t first = 0; first < count; first += FXS_CHUNK) {
        const uint32_t end = count - first < FXS_CHUNK ? count : first + FXS_CHUNK;
        fxs_sh_vector mean, vectors[FXS_CHUNK];
        if ((first + step - 1) / step * step >= end)
            continue;
        const fxs_sh_item *chunk = items + fxs_palette_sample_at(count, first / FXS_CHUNK);
        const uint32_t meant = l->palette->centred ? end - first : 0;
        for (uint32_t i = 0; i < meant; i++)
            vector_of(vectors[i], &chunk[i], l->palette->unit_exponent);
        find_mean(mean, vectors, chunk, meant);
        for (int d = 0; d < WIDTH; d++)
            l->most = absolute(mean[d]) > l->most ? absolute(mean[d]) : l->most;
        for (uint32_t i = (first + step - 1) / step * step; i < end; i += step, l->count++) {
            vector_of(l->vectors[l->count], &chunk[i - first], l->palette->unit_exponent);
            subtract(l->vectors[l->count], mean);
        }
    }
}

static double try_sample(learner *l, const fxs_sh_item *items, uint32_t count, uint32_t step, int centred)
{
    double sum = 0;
    l->palette->centred = centred;
    take_sample(l, items, count, step);
    for (uint32_t stage = 0; stage < 2; stage++)
        if (learn_stage(l, stage))
            return -1;
    for (uint32_t i = 0; i < l->count; i++)
        sum += dot(l->vectors[i], l->vectors[i]);
    return sum;
}

/* Learns a palette. The chunks' mean SH vectors are subtracted only if subtraction lowers the error. */
static int learn(learner *l, const fxs_sh_item *items, uint32_t count, uint32_t step)
{
    const double plain = try_sample(l, items, count, 4 * step, 0);
    const double centred = plain < 0 ? -1 : try_sample(l, items, count, 4 * step, 1);
    if (centred < 0)
        return -1;
    l->palette->centred = centred < plain;
    take_sample(l, items, count, step);
    for (uint32_t stage = 0; stage < l->palette->stages; stage++)
        if (learn_stage(l, stage))
            return -1;
    for (int round = 0; round < JOINT_ROUNDS; round++) {
        if (stopped(l))
            return -1;
        add_sums(l);
        learn_jointly(l);
    }
    quantise(l->palette, l->most);
    return 0;
}

typedef int learn_fn(learner *l, const fxs_sh_item *items, uint32_t count, uint32_t step);

static int learn_with(learn_fn *work, fxs_palette *palette, const fxs_sh_item *items, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message)
{
    const fxs_allocator *allocator = options->allocator;
    const uint32_t step = step_for(count), sampled = (count - 1) / step + 1;
    learner l = {.palette = palette, .stages = fxs_pack_stages_choose(~0u), .options = options};
    l.vectors = fxs_allocate(allocator, sampled, sizeof *l.vectors);
    l.indices = fxs_allocate_zeroed(allocator, sampled, sizeof *l.indices);
    l.sums = fxs_allocate_zeroed(allocator, palette->entries, sizeof *l.sums);
    l.total = fxs_allocate_zeroed(allocator, palette->entries, sizeof *l.total);
    int result = 0;
    if (!l.vectors || !l.indices || !l.sums || !l.total)
        result = fxs_fail_memory(message, NULL, 0);
    else
        result = work(&l, items, count, step) ? fxs_fail_as(FXS_ERR_STOPPED, message, "import stopped") : 0;
    fxs_release(allocator, l.vectors);
    fxs_release(allocator, l.indices);
    fxs_release(allocator, l.sums);
    fxs_release(allocator, l.total);
    return result;
}

int fxs_palette_learn(fxs_palette *palette, uint32_t entries, const fxs_sh_item *items, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message)
{
    palette->stages = fxs_palette_stages(palette->profile, palette->sh_degree);
    palette->entries = entries;
    find_unit(palette, items, count, step_for(count));
    return learn_with(learn, palette, items, count, options, message);
}

static int refine(learner *l, const fxs_sh_item *items, uint32_t count, uint32_t step)
{
    take_sample(l, items, count, step);
    learn_jointly(l);
    quantise(l->palette, l->most);
    return 0;
}

int fxs_palette_refine(fxs_palette *palette, const fxs_sh_item *items, uint32_t count,
                       const fxs_pack_options *options, fxs_message *message)
{
    return learn_with(refine, palette, items, count, options, message);
}

static int is_held(const int16_t *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (numbers[i] < -MOST || numbers[i] > MOST)
            return 0;
    return 1;
}

int fxs_palette_restore(fxs_palette *p, uint32_t entries)
{
    if (p->stages != fxs_palette_stages(p->profile, p->sh_degree) || p->entries != entries || p->step < 1 ||
        p->step > (MOST + 126) / 127 || p->unit_exponent < 8 || p->unit_exponent > 19 ||
        !is_held(p->vectors[0][0], sizeof p->vectors / sizeof(int16_t)) ||
        !is_held(p->groups[0][0], sizeof p->groups / sizeof(int16_t)))
        return 0;
    for (uint32_t stage = 0; stage < p->stages; stage++)
        prepare_stage(p, stage);
    return 1;
}

/* Computes the middles of the groups of palette entries, which a packed scene does not store. */
static void find_middles(fxs_palette *p, uint32_t stage)
{
    for (uint32_t g = 0; g < groups_of(p); g++) {
        const uint32_t first = g * GROUP, count = p->entries - first < GROUP ? p->entries - first : GROUP;
        for (int d = 0; d < WIDTH; d++) {
            int32_t sum = 0;
            for (uint32_t j = first; j < first + count; j++)
                sum += p->vectors[stage][j][d];
            p->groups[stage][g][d] = (int16_t)(sum / (int32_t)count);
        }
    }
}

static int has_means(const fxs_scene *scene)
{
    for (uint32_t i = 0; i < scene->chunk_count; i++) {
        fxs_chunk chunk;
        memcpy(&chunk, scene->chunks + (size_t)i * sizeof chunk, sizeof chunk);
        for (int d = 0; d < WIDTH; d++)
            if (chunk.sh_mean[d])
                return 1;
    }
    return 0;
}

void fxs_palette_of_scene(fxs_palette *p, const fxs_scene *scene)
{
    const int8_t *from = scene->palette;
    memset(p, 0, sizeof *p);
    p->profile = scene->profile;
    p->sh_degree = scene->sh_degree;
    p->stages = fxs_palette_stages(scene->profile, scene->sh_degree);
    p->entries = scene->palette_entries;
    p->unit_exponent = 19;
    while (p->unit_exponent > 8 && scene->palette_step_q19 >> (19 - p->unit_exponent) > MOST / 127)
        p->unit_exponent--;
    const uint32_t step = scene->palette_step_q19 >> (19 - p->unit_exponent);
    p->step = step < 1 ? 1 : step > MOST / 127 ? MOST / 127 : (int32_t)step;
    p->centred = has_means(scene);
    for (uint32_t s = 0; s < p->stages; s++) {
        for (uint32_t j = 0; j < p->entries; j++)
            for (int d = 0; d < WIDTH; d++)
                p->vectors[s][j][d] = (int16_t)(*from++ * p->step);
        find_middles(p, s);
        prepare_stage(p, s);
    }
}

uint32_t fxs_palette_step_q19(const fxs_palette *p)
{
    return (uint32_t)p->step << (19 - p->unit_exponent);
}

void fxs_palette_write(const fxs_palette *p, int8_t *to)
{
    for (uint32_t s = 0; s < p->stages; s++)
        for (uint32_t j = 0; j < p->entries; j++)
            for (int d = 0; d < WIDTH; d++)
                *to++ = (int8_t)(p->vectors[s][j][d] / p->step);
}

void fxs_palette_code_chunk(const fxs_palette *p, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                            unsigned char *records, size_t stride, fxs_sh_loss *loss)
{
    fxs_pack_stages_choose(~0u)->code_chunk(p, items, count, mean, records, stride, loss);
}

/* Returns an SH coefficient's residual in file profile compact: (2 code + 1) gain, with a 3-bit code -4..3. */
static double residual_of(const unsigned char *record, uint32_t coefficient)
{
    uint32_t code = 0;
    for (uint32_t i = 0, bit = FXS_RESIDUAL_BIT + 3 * coefficient; i < 3; i++, bit++)
        code |= (uint32_t)(record[bit / 8] >> bit % 8 & 1) << i;
    return ((code < 4 ? 2 * (int)code : 2 * (int)code - 16) + 1) * fxs_gain(record[FXS_GAIN_BYTE]);
}

void fxs_palette_decode(const fxs_palette *p, const int8_t mean[48], const unsigned char *record, float sh[45])
{
    const uint32_t count = (uint32_t)FXS_SH_COUNT(p->sh_degree);
    fxs_sh_vector vector;
    memset(sh, 0, 45 * sizeof *sh);
    for (int d = 0; d < WIDTH; d++)
        vector[d] = (int16_t)(mean[d] * p->step);
    for (uint32_t s = 0; s < p->stages; s++)
        subtract_entry(vector, p, s, record[s] ^ FXS_PALETTE_NEGATIVE);
    for (uint32_t c = 0; c < 3; c++)
        for (uint32_t k = 0; k < count; k++) {
            const double rest = p->profile == FXS_PROFILE_COMPACT ? residual_of(record, c * count + k) : 0;
            sh[3 * k + c] = (float)(ldexp(vector[16 * c + k], -p->unit_exponent) + rest);
        }
}
