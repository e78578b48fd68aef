/* Packs a scene file in three passes, so that its Gaussians need not fit in memory. Pass 1 drops Gaussians that
 * cannot be drawn, and orders the rest into chunks of 256. Pass 2 finds the ranges of the attributes per chunk and
 * a sample for the SH palette. Pass 3 writes the codes, and is repeated for every HELD chunks if the scene has a
 * palette. While a job reads a batch, PARTS jobs work on the preceding batch. */
#include <fixsplat/pack.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/packed.h>
#include "src/base/exponential.h"
#include "src/base/report.h"
#include "src/base/options.h"
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/start.h>
#include "src/base/pages_internal.h"
#include "src/base/run.h"
#include "src/base/try_internal.h"
#include "src/gaussian/attributes.h"
#include "src/gaussian/origin_internal.h"
#include "coded.h"
#include "framing.h"
#include "move.h"
#include "lives.h"
#include "order.h"
#include "pack_stage.h"
#include "part.h"
#include "tree.h"

#define BATCH 4096
#define HELD (1u << 16)   /* most chunks (of 256 Gaussians) in memory that wait until their SH coefficients are coded */
#define FINISHED 512
#define PARTS 16     /* number of parallel jobs per batch; fixed, so that sums do not depend on the number of threads */
#define AHEAD 8
#define POSITION_LIMIT 134000000.0   /* largest coordinate of a centre, just under 2^27 scene units */
#define FAINT_LOGIT (-2.708f)        /* logit of opacity 1/16; Gaussians below are faint */
#define FOG 0.1    /* a scene is foggy if faint Gaussians have at least this share of the weight (area times opacity) */

#if defined(__GNUC__)
#define PREFETCH(address) __builtin_prefetch(address)
#define PREFETCH_TO_WRITE(address) __builtin_prefetch(address, 1)
#else
#define PREFETCH(address) ((void)(address))
#define PREFETCH_TO_WRITE(address) ((void)(address))
#endif

typedef struct batch {
    fxs_gaussian gaussians[BATCH];
    fxs_motion *motions;             /* of a moving scene, BATCH of them */
    uint64_t first;
    long count;                      /* number of Gaussians in the batch; 0: end of file; negative: error */
} batch;

typedef struct findings {
    fxs_pack_dropped dropped;
    uint64_t brought_in;
    double faint, others;
    fxs_loss loss;
    float low[3], high[3];
    uint64_t source;
    int changed;                     /* 1: a Gaussian's centre differs from an earlier pass over the file */
    uint64_t limited;                /* number of Gaussians with a motion beyond the range of its codes */
} findings;

typedef struct packer packer;

/* Functions for packing a part of a scene. Pointers keep these functions out of programs that pack no parts. */
typedef struct part_steps {
    int (*plan)(packer *p);
    int (*allocate)(packer *p, fxs_packed_scene *part);
    int (*finish)(packer *p, unsigned char *bytes);
} part_steps;

typedef void part_fn(packer *p, batch *b, uint32_t part);

struct packer {
    fxs_scene_file *file;
    const fxs_scene_file_info *info;
    fxs_pack_report *report;
    fxs_pack_options options;
    fxs_message *message;
    const fxs_pack_stages *stages;
    findings *findings;
    batch *batches;
    int ready;
    part_fn *work;
    double done, share;
    fxs_order_entry *entries;
    fxs_seen *seen;
    uint64_t seen_step;
    uint32_t *slots;                 /* index of each Gaussian in the packed scene, or FXS_NO_SLOT */
    uint64_t slot_count;
    const part_steps *by_part;       /* functions for packing a part; null: the whole scene is packed */
    uint32_t part, parts;
    uint32_t first, end;
    float (*boxes)[6];               /* bounding boxes of all chunks; only while packing a part of a scene */
    fxs_tree *tree;
    fxs_chunk_ranges *ranges;
    fxs_life *lives;                 /* of a moving scene, one per Gaussian of the file; else null, like the next two */
    fxs_chunk_time *times;
    fxs_chunk_motion *motions;
    fxs_motion_header *motion_header;
    uint32_t motion_bytes;           /* bytes of a Gaussian's motion codes */
    fxs_encoder encoder;
    const fxs_coded *coded;          /* codes of already quantised attributes to copy, or null */
    fxs_palette *palette;            /* palette of SH vectors; null: no palette is learned */
    fxs_sh_item *sample;
    fxs_sh_item *items;              /* SH items of Gaussians that wait for palette codes; null: all are in `sample` */
    uint32_t held;
    uint32_t first_chunk, end_chunk;
    uint32_t finished;
    fxs_packed_header *header;
    fxs_chunk *chunks;
    unsigned char *palette_bytes, *rows;
    size_t bytes;
};

static int fail_memory(const packer *p, uint64_t count)
{
    return fxs_fail_as(FXS_ERR_MEMORY, p->message, "out of memory for %llu Gaussians", (unsigned long long)count);
}

static void read_batch(packer *p, batch *b, uint64_t first)
{
    uint64_t left = p->info->count - first;
    b->first = first;
    b->count = fxs_scene_file_read(p->file, b->gaussians, BATCH, p->message);
    if (b->count > 0 && (uint64_t)b->count > left)
        b->count = (long)left;
    const fxs_motion *motions = b->motions && b->count > 0 ? fxs_scene_file_motions(p->file) : 0;
    if (motions)
        memcpy(b->motions, motions, (size_t)b->count * sizeof *motions);
    else if (b->motions && b->count > 0)
        b->count = fxs_fail(p->message, "the file has no motion");
}

static void read_or_work(void *argument, uint32_t job)
{
    packer *p = argument;
    batch *b = &p->batches[p->ready];
    if (job == 0)
        read_batch(p, &p->batches[!p->ready], b->first + (uint64_t)b->count);
    else
        p->work(p, b, job - 1);
}

static double tree_share(const packer *p)
{
    return p->options.tree ? 0.5 : 0;
}

static void begin(packer *p, double share)
{
    p->done += p->share;
    p->share = share;
}

static int report_progress(void *argument, double done)
{
    const packer *p = argument;
    return fxs_report(&p->options.progress, fmin(1, p->done + p->share * done));
}

static int fail_stopped(const packer *p)
{
    return fxs_fail_as(FXS_ERR_STOPPED, p->message, "import stopped");
}

/* Returns the share of a pass in the progress of packing. With a palette, SH coding takes half of the time before the
   level-of-detail tree. */
static double pass_share(const packer *p)
{
    return (1 - tree_share(p)) * (fxs_palette_stages(p->encoder.profile, p->encoder.sh_degree) ? 0.25 : 1.0 / 3);
}

static int pass(packer *p, part_fn *work, double share)
{
    batch *b = p->batches;
    p->work = work;
    p->ready = 0;
    b->first = 0;
    b->count = 0;
    begin(p, share);
    FXS_TRY(fxs_scene_file_rewind(p->file, p->message));
    do {
        p->options.workers.run(p->options.workers.pool, read_or_work, p, 1 + PARTS);
        p->ready = !p->ready;
        b = &p->batches[p->ready];
        if (b->count >= 0 && report_progress(p, (double)b->first / (double)p->info->count))
            return fail_stopped(p);
    } while (b->count > 0);
    return (int)b->count;
}

static long first_of(const batch *b, uint32_t part)
{
    return b->count * (long)part / PARTS;
}

/* Returns 1 if all values are finite. The loop has no early exit, because almost all values are finite. */
static int all_finite(const float *values, int count)
{
    int finite = 1;
    for (int i = 0; i < count; i++)
        finite &= fabsf(values[i]) <= FLT_MAX;
    return finite;
}

/* Returns a Gaussian's scale, clamped. NaN and infinity become the smallest scale, so that an invalid sigma does not
   outweigh all others. */
static float known_scale(float scale)
{
    return fxs_held_scale(scale < INFINITY ? scale : -INFINITY);
}

static double log_area(const fxs_gaussian *g)
{
    const float a = known_scale(g->scale[0]), b = known_scale(g->scale[1]), c = known_scale(g->scale[2]);
    const float less = a < b ? a : b, least = less < c ? less : c;
    return (double)(a + b + c - least);
}

/* Returns the weight of a Gaussian, area times opacity. An opacity of NaN counts as opaque. */
double fxs_weight(const fxs_gaussian *g)
{
    return fxs_exp(log_area(g)) / (isnan(g->opacity) ? 1 : 1 + fxs_exp(-(double)g->opacity));
}

int fxs_drawable(const fxs_gaussian *g, int sh_degree, fxs_pack_dropped *dropped)
{
    const float *s = g->scale, *q = g->rotation;
    const int finite = all_finite(g->position, 3) && s[0] < INFINITY && s[1] < INFINITY && s[2] < INFINITY &&
                       all_finite(q, 4) && g->opacity < INFINITY && all_finite(g->dc, 3) &&
                       all_finite(g->sh, 3 * FXS_SH_COUNT(sh_degree));
    const int turned = q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0;
    const int transparent = g->opacity == -INFINITY;
    if (finite && turned && !transparent)
        return 1;
    dropped->not_finite += !finite;
    dropped->rotation += (uint64_t)(finite && !turned);
    dropped->transparent += (uint64_t)(finite && turned);
    dropped->weight += fxs_weight(g);
    return 0;
}

double fxs_dropped_share(const fxs_pack_dropped *dropped)
{
    return dropped->weight > 0 ? dropped->weight / (dropped->weight + dropped->kept) : 0;
}

static int is_far(const fxs_gaussian *g)
{
    return fabsf(g->position[0]) > (float)POSITION_LIMIT || fabsf(g->position[1]) > (float)POSITION_LIMIT ||
           fabsf(g->position[2]) > (float)POSITION_LIMIT;
}

/* Clamps the position and scales of a Gaussian, which every pass over the file must do alike. */
static const fxs_gaussian *fit(fxs_gaussian *g)
{
    fxs_bring_in(g, POSITION_LIMIT);
    fxs_hold_scales(g);
    return g;
}

static void widen_bounds(findings *f, const fxs_range position[3])
{
    for (int i = 0; i < 3; i++) {
        f->low[i] = position[i].low < f->low[i] ? position[i].low : f->low[i];
        f->high[i] = position[i].high > f->high[i] ? position[i].high : f->high[i];
    }
}

/* Returns the box of the positions that a Gaussian has in a scene. */
static void find_reach(const packer *p, fxs_range position[3], const fxs_gaussian *g, const fxs_motion *motion,
                       const fxs_life *life)
{
    for (int i = 0; i < 3; i++)
        position[i] = p->lives ? (fxs_range){INFINITY, -INFINITY} : (fxs_range){g->position[i], g->position[i]};
    if (p->lives)
        fxs_motion_sweep(position, g, motion, life);
}

static void take_position(packer *p, fxs_order_entry *entry, fxs_gaussian *g, const fxs_motion *motion, fxs_life *life,
                          double weight, findings *f)
{
    fxs_range position[3];
    if (!fxs_drawable(g, p->info->sh_degree, &f->dropped)) {
        entry->position[0] = NAN;
        return;
    }
    if (motion && !fxs_motion_usable(motion)) {
        f->dropped.not_finite++;
        f->dropped.weight += weight;
        entry->position[0] = NAN;
        return;
    }
    f->brought_in += (uint64_t)is_far(g);
    fit(g);
    if (motion)
        *life = fxs_life_of(motion, fxs_opacity_of_logit(g->opacity), &p->info->time);
    find_reach(p, position, g, motion, life);
    for (int i = 0; i < 3; i++)
        entry->position[i] = p->lives ? (position[i].low + position[i].high) / 2 : g->position[i];
    entry->index = g->opacity < FAINT_LOGIT;
    *(entry->index ? &f->faint : &f->others) += weight;
    widen_bounds(f, position);
}

static uint64_t hash_of(const fxs_gaussian *g, uint64_t index)
{
    uint64_t hash = (index + 1) * 0x9e3779b97f4a7c15u;
    uint32_t words[sizeof *g / sizeof(uint32_t)];
    memcpy(words, g, sizeof words);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        hash = (hash ^ words[i]) * 0xd6e8feb86659fd93u;
    return hash ^ hash >> 32;
}

static void take_positions(packer *p, batch *b, uint32_t part)
{
    const long first = first_of(b, part), end = first_of(b, part + 1);
    double areas[BATCH / PARTS + 1], rests[BATCH / PARTS + 1];
    for (long i = first; i < end; i++) {
        areas[i - first] = log_area(&b->gaussians[i]);
        rests[i - first] = -(double)b->gaussians[i].opacity;
    }
    p->stages->exponentials(areas, (uint32_t)(end - first));
    p->stages->exponentials(rests, (uint32_t)(end - first));
    for (long i = first; i < end; i++) {
        const uint64_t index = b->first + (uint64_t)i;
        if (p->by_part)
            p->findings[part].source += hash_of(&b->gaussians[i], index);
        take_position(p, &p->entries[index], &b->gaussians[i], p->lives ? &b->motions[i] : 0,
                      p->lives ? &p->lives[index] : 0, areas[i - first] / (1 + rests[i - first]),
                      &p->findings[part]);
        if (index % p->seen_step == 0 && !isnan(p->entries[index].position[0]))
            p->seen[index / p->seen_step] = fxs_seen_of(&b->gaussians[i]);
    }
}

static int read_positions(packer *p)
{
    fxs_pack_report *report = p->report;
    fxs_pack_dropped *dropped = &report->dropped;
    for (uint32_t part = 0; part < PARTS; part++)
        for (int i = 0; i < 3; i++) {
            p->findings[part].low[i] = INFINITY;
            p->findings[part].high[i] = -INFINITY;
        }
    FXS_TRY(pass(p, take_positions, pass_share(p)));
    report->read = p->batches[p->ready].first;
    for (uint64_t i = report->read; i < p->info->count; i++)
        p->entries[i].position[0] = NAN;
    for (int i = 0; i < 3; i++) {
        report->low[i] = INFINITY;
        report->high[i] = -INFINITY;
    }
    for (const findings *f = p->findings; f < p->findings + PARTS; f++) {
        for (int i = 0; i < 3; i++) {
            report->low[i] = fmin(report->low[i], f->low[i]);
            report->high[i] = fmax(report->high[i], f->high[i]);
        }
        dropped->not_finite += f->dropped.not_finite;
        dropped->rotation += f->dropped.rotation;
        dropped->transparent += f->dropped.transparent;
        dropped->weight += f->dropped.weight;
        dropped->kept += f->faint + f->others;
        report->brought_in += f->brought_in;
    }
    report->packed = report->read - dropped->not_finite - dropped->rotation - dropped->transparent;
    return 0;
}

static int find_inner_bounds(packer *p)
{
    enum { MIDDLE = 65536 };
    uint64_t count = p->info->count, step = count / MIDDLE + 1;
    float *sample = fxs_allocate(p->options.allocator, MIDDLE, sizeof *sample);
    if (!sample)
        return fxs_fail_memory(p->message, NULL, 0);
    for (int axis = 0; axis < 3; axis++) {
        size_t n = 0;
        for (uint64_t i = 0; i < count; i += step)
            if (!isnan(p->entries[i].position[0]))
                sample[n++] = p->entries[i].position[axis];
        p->report->inner_low[axis] = n ? fxs_value_of_rank(sample, n, n / 20) : p->report->low[axis];
        p->report->inner_high[axis] = n ? fxs_value_of_rank(sample, n, n - 1 - n / 20) : p->report->high[axis];
    }
    fxs_release(p->options.allocator, sample);
    return 0;
}

static int find_seen_bounds(packer *p)
{
    const uint32_t count = (uint32_t)((p->info->count - 1) / p->seen_step + 1);
    fxs_seen_place *places = fxs_allocate(p->options.allocator, 5 * (size_t)count, sizeof *places);
    if (!places)
        return fxs_fail_memory(p->message, NULL, 0);
    fxs_seen_bounds(p->seen, count, places, p->report->inner_low, p->report->inner_high);
    fxs_release(p->options.allocator, places);
    fxs_release(p->options.allocator, p->seen);
    p->seen = 0;
    return 0;
}

/* Gives faint Gaussians chunks of their own, with finer steps of opacity, if the scene is foggy. In a foggy scene,
   faint Gaussians have at least a share FOG of the weight. */
static void part_fog(packer *p)
{
    double faint = 0;
    for (const findings *f = p->findings; f < p->findings + PARTS; f++)
        faint += f->faint;
    for (uint64_t i = 0; i < p->info->count && faint < FOG * p->report->dropped.kept; i++)
        p->entries[i].index = 0;
}

/* Returns the longest box of a chunk relative to its distance from the scene's middle. A position step is then at most
   1/2048 of the distance, in file profile small 1/512. */
static float longest_box(enum fxs_profile profile)
{
    return profile == FXS_PROFILE_SMALL ? 4 : 32;
}

static void place_in_slots(packer *p)
{
    for (uint32_t i = 0; i < p->info->count; i++) {
        const uint32_t entry = p->entries[i].index, index = entry & ~FXS_BEGINS_CHUNK;
        const uint32_t later = p->entries[i + 4 * AHEAD < p->info->count ? i + 4 * AHEAD : i].index;
        PREFETCH_TO_WRITE(&p->slots[later & ~FXS_BEGINS_CHUNK]);
        if (i % FXS_CHUNK == 0 || entry & FXS_BEGINS_CHUNK)
            p->slot_count += (FXS_CHUNK - p->slot_count % FXS_CHUNK) % FXS_CHUNK;
        p->slots[index] = i < p->report->packed ? (uint32_t)p->slot_count++ : FXS_NO_SLOT;
    }
}

static int find_slots(packer *p)
{
    uint32_t count = (uint32_t)p->info->count;
    part_fog(p);
    const float longest = longest_box(p->encoder.profile);
    if (!p->coded && (p->lives ? fxs_order_in_time(p->entries, p->lives, count, &p->info->time, longest, &p->options)
                               : fxs_order(p->entries, count, longest, &p->options)))
        return fail_memory(p, count);
    for (uint32_t i = 0; p->coded && i < count; i++)
        p->entries[i].index = i;
    p->slots = fxs_allocate(p->options.allocator, count, sizeof *p->slots);
    fxs_use_large_pages(p->slots, count * sizeof *p->slots);
    if (!p->slots)
        return fail_memory(p, count);
    place_in_slots(p);
    if (p->slot_count > FXS_MAX_COUNT)
        return fxs_fail(p->message, "%u Gaussians: too many, with some far beyond the others", count);
    p->end = fxs_chunks_of((uint32_t)p->slot_count);
    return 0;
}

static int find_boxes(packer *p)
{
    fxs_range *ranges = fxs_allocate(p->options.allocator, 3 * (size_t)p->end, sizeof *ranges);
    p->boxes = fxs_allocate(p->options.allocator, p->end, sizeof *p->boxes);
    for (uint32_t i = 0; i < 3 * p->end && ranges; i++)
        ranges[i] = (fxs_range){INFINITY, -INFINITY};
    for (uint32_t i = 0; i < p->report->packed && ranges; i++) {
        const fxs_order_entry *e = &p->entries[i];
        fxs_range *r = ranges + p->slots[e->index & ~FXS_BEGINS_CHUNK] / FXS_CHUNK * 3;
        for (int k = 0; k < 3; k++) {
            r[k].low = e->position[k] < r[k].low ? e->position[k] : r[k].low;
            r[k].high = e->position[k] > r[k].high ? e->position[k] : r[k].high;
        }
    }
    for (uint32_t i = 0; i < p->end && ranges && p->boxes; i++) {
        fxs_chunk chunk;
        fxs_encode_places(&chunk, ranges + 3 * i);
        fxs_chunk_box(&chunk, p->boxes[i]);
    }
    fxs_release(p->options.allocator, ranges);
    return ranges && p->boxes ? 0 : fail_memory(p, p->report->packed);
}

static int plan_part(packer *p)
{
    const uint32_t chunks = p->end;
    if (p->parts > chunks)
        return fxs_fail_as(FXS_ERR_ARGUMENT, p->message, "%u blocks of a scene that has %u chunks of %d Gaussians",
                           (unsigned)p->parts, (unsigned)chunks, FXS_CHUNK);
    FXS_TRY(find_boxes(p));
    if (p->options.tree && chunks > 1)
        FXS_TRY(fxs_tree_plan(&p->tree, p->boxes, NULL, chunks, &p->options, p->message));
    p->first = fxs_part_first(chunks, p->part, p->parts);
    p->end = fxs_part_first(chunks, p->part + 1, p->parts);
    return 0;
}

static int fail_changed(const packer *p)
{
    return fxs_fail(p->message, "the file changed while it was read");
}

static void widen_life(fxs_life *all, const fxs_life *life)
{
    all->from = life->from < all->from ? life->from : all->from;
    all->to = life->to > all->to ? life->to : all->to;
    all->start = life->start < all->start ? life->start : all->start;
    all->end = life->end > all->end ? life->end : all->end;
}

/* Finds the time of each chunk of a moving scene. The lives of its Gaussians are about their centres. */
static int find_times(packer *p)
{
    fxs_life *all = fxs_allocate(p->options.allocator, p->end, sizeof *all);
    int32_t *ticks = fxs_allocate(p->options.allocator, 2 * (size_t)p->end, sizeof *ticks);
    float (*centres)[2] = fxs_allocate(p->options.allocator, p->end, sizeof *centres);
    p->times = fxs_allocate(p->options.allocator, p->end, sizeof *p->times);
    const int enough = all && ticks && centres && p->times;
    for (uint32_t i = 0; enough && i < p->end; i++) {
        all[i] = (fxs_life){INFINITY, -INFINITY, INFINITY, -INFINITY, 0};
        centres[i][0] = INFINITY;
        centres[i][1] = -INFINITY;
    }
    for (uint64_t i = 0; enough && i < p->info->count; i++)
        if (p->slots[i] != FXS_NO_SLOT) {
            const uint32_t chunk = p->slots[i] / FXS_CHUNK;
            widen_life(&all[chunk], &p->lives[i]);
            centres[chunk][0] = fminf(centres[chunk][0], p->lives[i].centre);
            centres[chunk][1] = fmaxf(centres[chunk][1], p->lives[i].centre);
        }
    for (uint32_t i = 0; enough && i < p->end; i++)
        fxs_chunk_time_set(&p->times[i], &p->motions[i], &all[i], centres[i][0], centres[i][1], &p->info->time);
    if (enough)
        p->motion_header->most_chunks = fxs_motion_most(p->motions, p->end, ticks);
    fxs_release(p->options.allocator, all);
    fxs_release(p->options.allocator, ticks);
    fxs_release(p->options.allocator, centres);
    return enough ? 0 : fail_memory(p, p->info->count);
}

static int is_within(const fxs_chunk_ranges *ranges, const fxs_gaussian *g)
{
    for (int i = 0; i < 3; i++)
        if (!(g->position[i] >= ranges->position[i].low && g->position[i] <= ranges->position[i].high))
            return 0;
    return 1;
}

static int is_packed(const packer *p, uint32_t chunk)
{
    return chunk >= p->first && chunk < p->end;
}

static int is_read(const packer *p, uint32_t slot)
{
    return is_packed(p, slot / FXS_CHUNK) ||
           (p->by_part && p->sample && slot != FXS_NO_SLOT &&
            fxs_palette_sample_at(p->header->count, slot / FXS_CHUNK) != FXS_NOT_SAMPLED);
}

static void take_sample(packer *p, uint32_t slot, const fxs_gaussian *g, double opacity)
{
    const uint32_t at = fxs_palette_sample_at(p->header->count, slot / FXS_CHUNK);
    if (at != FXS_NOT_SAMPLED)
        fxs_sh_item_set(&p->sample[at + slot % FXS_CHUNK], g, opacity, p->encoder.sh_degree);
}

static void find_opacities(const packer *p, double *x, uint32_t count)
{
    p->stages->exponentials(x, count);
    for (uint32_t i = 0; i < count; i++)
        x[i] = 1 / (1 + x[i]);
}

static void take_moving_ranges(const packer *p, fxs_chunk_ranges *ranges, fxs_chunk_time *time, const fxs_gaussian *g,
                               const fxs_motion *motion, const fxs_life *life, double opacity)
{
    fxs_gaussian rest = *g;
    fxs_motion_rest(&rest, motion, time);
    p->stages->take_ranges(ranges, &rest, opacity, p->encoder.sh_degree);
    fxs_motion_sweep(ranges->position, g, motion, life);
    fxs_motion_take(time, g, motion);
}

/* Collects the attribute ranges of the chunks with chunk % PARTS == part, so that parallel jobs share no ranges. */
static void take_ranges(packer *p, batch *b, uint32_t part)
{
    const uint32_t *slots = p->slots + b->first;
    uint16_t own[BATCH];
    double opacities[BATCH];
    uint32_t count = 0;
    for (uint32_t i = 0; i < (uint32_t)b->count; i++) {
        own[count] = (uint16_t)i;
        count += slots[i] / FXS_CHUNK % PARTS == part && is_read(p, slots[i]);
    }
    for (uint32_t i = 0; i < count; i++)
        opacities[i] = -(double)b->gaussians[own[i]].opacity;
    find_opacities(p, opacities, count);
    for (uint32_t i = 0; i < count; i++) {
        const fxs_gaussian *g = fit(&b->gaussians[own[i]]);
        const uint32_t chunk = slots[own[i]] / FXS_CHUNK;
        const uint32_t later = slots[own[i + AHEAD < count ? i + AHEAD : i]] / FXS_CHUNK;
        if (is_packed(p, later))
            PREFETCH_TO_WRITE(&p->ranges[later - p->first]);
        if (is_packed(p, chunk) && p->lives)
            take_moving_ranges(p, &p->ranges[chunk], &p->times[chunk], g, &b->motions[own[i]],
                               &p->lives[b->first + own[i]], opacities[i]);
        else if (is_packed(p, chunk))
            p->stages->take_ranges(&p->ranges[chunk - p->first], g, opacities[i], p->encoder.sh_degree);
        if (p->sample)
            take_sample(p, slots[own[i]], g, opacities[i]);
    }
}

static int find_headers(packer *p)
{
    if (p->coded) {
        memcpy(p->chunks, p->coded->chunks, p->header->chunk_count * sizeof *p->chunks);
        return 0;
    }
    const uint32_t chunks = p->end - p->first;
    p->ranges = fxs_allocate(p->options.allocator, chunks, sizeof *p->ranges);
    if (!p->ranges)
        return fxs_fail_memory(p->message, NULL, 0);
    for (uint32_t i = 0; i < chunks; i++)
        fxs_ranges_clear(&p->ranges[i]);
    FXS_TRY(pass(p, take_ranges, pass_share(p)));
    for (uint32_t i = 0; i < chunks; i++) {
        for (int k = 0; k < 3; k++) {
            const fxs_range *r = &p->ranges[i].position[k];
            if (!(r->low <= r->high && (p->lives || (r->low >= p->report->low[k] && r->high <= p->report->high[k]))))
                return fail_changed(p);
        }
        fxs_encode_header(&p->chunks[i], &p->ranges[i], p->info);
        if (p->lives) {
            p->chunks[i].opacity_law = 0;        /* codes in proportion to the opacity, so that a fade is a product */
            fxs_chunk_shift_set(&p->motions[i], &p->times[i], &p->chunks[i]);
        }
    }
    return 0;
}

static int allocate_palette(packer *p)
{
    if (p->coded) {
        p->header->palette_step_q19 = fxs_palette_step_q19(p->coded->palette);
        fxs_palette_write(p->coded->palette, (int8_t *)p->palette_bytes);
        return 0;
    }
    const uint32_t sampled = fxs_palette_sample(p->header->count);
    p->sample = fxs_allocate_zeroed(p->options.allocator, sampled, sizeof *p->sample);
    fxs_use_large_pages(p->sample, sampled * sizeof *p->sample);
    p->palette = fxs_allocate_zeroed(p->options.allocator, 1, sizeof *p->palette);
    if (!p->sample || !p->palette)
        return fail_memory(p, p->header->count);
    p->palette->profile = p->encoder.profile;
    p->palette->sh_degree = p->encoder.sh_degree;
    return 0;
}

static int find_palette(packer *p)
{
    fxs_packed_header *h = p->header;
    fxs_pack_options options = p->options;
    options.progress = (fxs_progress){report_progress, p};
    begin(p, 0.0625);
    FXS_TRY(fxs_palette_learn(p->palette, h->palette_entries, p->sample, h->count, &options, p->message));
    h->palette_step_q19 = fxs_palette_step_q19(p->palette);
    fxs_palette_write(p->palette, (int8_t *)p->palette_bytes);
    const uint32_t chunks = p->end - p->first;
    if (chunks > p->held || fxs_palette_sample(h->count) < h->count) {
        const uint32_t held = p->held < chunks ? p->held : chunks;
        fxs_release(p->options.allocator, p->sample);
        p->sample = 0;
        p->items = fxs_allocate(p->options.allocator, (size_t)held * FXS_CHUNK, sizeof *p->items);
        fxs_use_large_pages(p->items, (size_t)held * FXS_CHUNK * sizeof *p->items);
    }
    return p->sample || p->items ? 0 : fail_memory(p, h->count);
}

static unsigned char *row_of(const packer *p, uint32_t slot)
{
    return p->rows + (size_t)(slot - p->first * FXS_CHUNK) * (p->header->chunk_bytes / FXS_CHUNK);
}

static void fetch(const packer *p, uint32_t slot)
{
    const uint32_t bytes = p->header->chunk_bytes / FXS_CHUNK, chunk = slot / FXS_CHUNK;
    if (chunk < p->first_chunk || chunk >= p->end_chunk)
        return;
    PREFETCH_TO_WRITE(row_of(p, slot));
    PREFETCH_TO_WRITE(row_of(p, slot) + bytes - 1);
    PREFETCH(&p->chunks[chunk - p->first]);
    PREFETCH(&p->chunks[chunk - p->first].opacity_law);
    if (p->ranges)
        PREFETCH(&p->ranges[chunk - p->first]);
}

/* Codes a part of a batch of Gaussians. Stores the codes of each Gaussian together. Storing codes by attribute here
   would touch a cache line per byte, because neighbours in the file lie in different chunks. */
static void encode_part(packer *p, batch *b, uint32_t part)
{
    const uint32_t bytes = p->header->chunk_bytes / FXS_CHUNK, *slots = p->slots + b->first;
    /* local copy, because the `findings` of several jobs share cache lines */
    fxs_loss loss = p->findings[part].loss;
    double opacities[BATCH / PARTS + 1];
    uint64_t limited = 0;
    int changed = 0;
    const long first = first_of(b, part), end = first_of(b, part + 1);
    for (long i = first; i < end; i++)
        opacities[i - first] = -(double)b->gaussians[i].opacity;
    find_opacities(p, opacities, p->coded ? 0 : (uint32_t)(end - first));
    for (long i = first; i < end; i++) {
        const uint32_t slot = slots[i], chunk = slot / FXS_CHUNK;
        fetch(p, slots[i + AHEAD < end ? i + AHEAD : i]);
        if (chunk < p->first_chunk || chunk >= p->end_chunk)
            continue;
        unsigned char record[FXS_RECORD_BYTES] = {0}, *to = row_of(p, slot);
        if (p->coded) {
            p->coded->record(p->coded->argument, slot, record);
            memcpy(to, record, bytes);
            continue;
        }
        fxs_gaussian *g = &b->gaussians[i];
        fit(g);
        if (p->lives) {
            limited += (uint64_t)fxs_motion_encode(record + bytes - p->motion_bytes, &p->info->time, &p->times[chunk],
                                                   &p->motions[chunk], &p->chunks[chunk], g, &b->motions[i]);
            fxs_motion_rest(g, &b->motions[i], &p->times[chunk]);
        }
        changed |= !is_within(&p->ranges[chunk - p->first], g);
        p->stages->encode(&p->encoder, &p->chunks[chunk - p->first], g, opacities[i - first], record, &loss);
        memcpy(to, record, bytes);
        if (p->items)
            fxs_sh_item_set(&p->items[slot - p->first_chunk * FXS_CHUNK], g, opacities[i - first],
                            p->encoder.sh_degree);
    }
    p->findings[part].loss = loss;
    p->findings[part].changed |= changed;
    p->findings[part].limited += limited;
}

static void code_chunk(const packer *p, uint32_t chunk, unsigned char *records, fxs_loss *loss)
{
    const uint32_t first = chunk * FXS_CHUNK, left = p->header->count - first;
    const uint32_t bytes = p->header->chunk_bytes / FXS_CHUNK;
    const fxs_sh_item *items = p->sample ? p->sample + first : p->items + (first - p->first_chunk * FXS_CHUNK);
    fxs_sh_loss sh = {loss->largest[FXS_LOSS_SH], loss->squares[FXS_LOSS_SH]};
    fxs_palette_code_chunk(p->palette, items, left < FXS_CHUNK ? left : FXS_CHUNK, p->chunks[chunk - p->first].sh_mean,
                           records + bytes - p->motion_bytes -
                               fxs_sh_bytes(p->encoder.profile, p->encoder.sh_degree), bytes, &sh);
    loss->largest[FXS_LOSS_SH] = sh.largest;
    loss->squares[FXS_LOSS_SH] = sh.squares;
}

static void finish_part(void *argument, uint32_t part)
{
    const packer *p = argument;
    const uint32_t end = p->end_chunk - p->finished < FINISHED ? p->end_chunk : p->finished + FINISHED;
    unsigned char records[FXS_CHUNK * FXS_RECORD_BYTES];
    fxs_loss loss = p->findings[part].loss;
    for (uint32_t chunk = p->finished + part; chunk < end; chunk += PARTS) {
        unsigned char *rows = row_of(p, chunk * FXS_CHUNK);
        memcpy(records, rows, p->header->chunk_bytes);
        if (p->palette)
            code_chunk(p, chunk, records, &loss);
        fxs_encode_rows(&p->encoder, p->motion_bytes, records, rows);
    }
    p->findings[part].loss = loss;
}

static int finish(packer *p)
{
    const double chunks = p->end_chunk - p->first_chunk;
    for (p->finished = p->first_chunk; p->finished < p->end_chunk; p->finished += FINISHED) {
        p->options.workers.run(p->options.workers.pool, finish_part, p, PARTS);
        if (p->palette && report_progress(p, fmin(1, (p->finished + FINISHED - p->first_chunk) / chunks)))
            return fail_stopped(p);
    }
    return 0;
}

static void sum_losses(packer *p)
{
    fxs_loss all = {{0}, {0}};
    for (const findings *f = p->findings; f < p->findings + PARTS; f++) {
        p->report->limited += f->limited;
        for (int i = 0; i < FXS_LOSSES; i++) {
            all.largest[i] = fmax(all.largest[i], f->loss.largest[i]);
            all.squares[i] += f->loss.squares[i];
        }
    }
    const double one = (double)p->report->packed, three = 3 * one, sh = three * FXS_SH_COUNT(p->encoder.sh_degree);
    const double *most = all.largest, *sum = all.squares;
    p->report->largest = (fxs_pack_error){most[FXS_LOSS_POSITION], most[FXS_LOSS_SCALE] / FXS_LOG2_E,
                                          most[FXS_LOSS_ROTATION], most[FXS_LOSS_OPACITY],
                                          most[FXS_LOSS_DC] / FXS_SH_0, most[FXS_LOSS_SH]};
    p->report->rms = (fxs_pack_error){sqrt(sum[FXS_LOSS_POSITION] / three),
                                      sqrt(sum[FXS_LOSS_SCALE] / three) / FXS_LOG2_E,
                                      sqrt(sum[FXS_LOSS_ROTATION] / one), sqrt(sum[FXS_LOSS_OPACITY] / one),
                                      sqrt(sum[FXS_LOSS_DC] / three) / FXS_SH_0,
                                      sh > 0 ? sqrt(sum[FXS_LOSS_SH] / sh) : 0};
}

static int write_chunks(packer *p, uint32_t first, uint32_t end, double share)
{
    p->first_chunk = first;
    p->end_chunk = end;
    if (p->items)
        memset(p->items, 0, (size_t)(end - first) * FXS_CHUNK * sizeof *p->items);
    FXS_TRY(pass(p, encode_part, p->palette ? share / 4 : share));
    for (uint32_t part = 0; part < PARTS; part++)
        if (p->findings[part].changed)
            return fail_changed(p);
    begin(p, p->palette ? share * 3 / 4 : 0);
    return finish(p);
}

static int write_codes(packer *p)
{
    const uint32_t chunks = p->end - p->first;
    if (p->palette)
        FXS_TRY(find_palette(p));
    const uint32_t held = p->items ? p->held : chunks;
    const double left = 1 - tree_share(p) - p->done - p->share;
    for (uint32_t first = p->first; first < p->end; first += held) {
        const uint32_t end = p->end - first < held ? p->end : first + held;
        FXS_TRY(write_chunks(p, first, end, left * (end - first) / chunks));
    }
    sum_losses(p);
    return 0;
}

static void turn_headers(packer *p)
{
    for (uint32_t i = 0; p->lives && i < p->end; i++)
        fxs_chunk_motion_turn(&p->motions[i]);
    if (p->lives)
        fxs_motion_header_turn(p->motion_header);
    for (uint32_t i = 0; i < p->end - p->first; i++)
        fxs_chunk_turn(&p->chunks[i]);
    fxs_packed_header_turn(p->header);
}

static void write_bounds(fxs_packed_header *header, const fxs_pack_report *report)
{
    for (int i = 0; i < 3; i++) {
        header->low_q32[i] = (int64_t)floor(ldexp(report->low[i], 32));
        header->high_q32[i] = (int64_t)ceil(ldexp(report->high[i], 32));
        header->inner_low_q32[i] = (int64_t)floor(ldexp(report->inner_low[i], 32));
        header->inner_high_q32[i] = (int64_t)ceil(ldexp(report->inner_high[i], 32));
    }
}

size_t fxs_pack_bytes(const fxs_scene_file_info *info, enum fxs_profile profile)
{
    const uint32_t entries = fxs_palette_entries_for(info->count, fxs_chunks_of(info->count), profile,
                                                     info->sh_degree);
    return info->count > FXS_MAX_COUNT ? 0
           : fxs_scene_bytes((uint32_t)info->count, info->sh_degree, profile, entries);
}

static void begin_tree(unsigned char *to, uint32_t nodes)
{
    fxs_tree_header header = {.magic = FXS_TREE_MAGIC, .node_count = nodes};
    fxs_tree_header_turn(&header);
    memcpy(to, &header, sizeof header);
}

static fxs_packed_header header_of(const packer *p, int has_tree)
{
    const uint32_t count = (uint32_t)p->slot_count, chunks = fxs_chunks_of(count);
    const enum fxs_profile profile = p->encoder.profile;
    fxs_packed_header h = {.magic = FXS_PACKED_MAGIC,
                           .version = fxs_packed_version(p->lives != NULL, has_tree),
                           .count = count, .holes = count - (uint32_t)p->report->packed, .chunk_count = chunks,
                           .chunk_bytes = fxs_chunk_bytes(profile, p->encoder.sh_degree) +
                                          FXS_CHUNK * p->motion_bytes,
                           .sh_degree = (uint32_t)p->encoder.sh_degree,
                           .flags = p->info->antialiased ? FXS_PACKED_ANTIALIASED : 0, .profile = (uint32_t)profile,
                           .palette_entries = fxs_palette_entries_for(p->report->packed, chunks, profile,
                                                                      p->encoder.sh_degree)};
    write_bounds(&h, p->report);
    fxs_packed_header_turn(&h);
    fxs_start_to(&h, &p->info->start);
    fxs_packed_header_turn(&h);
    return h;
}

/* Allocates `bytes` bytes for a packed scene. Always fails if `bytes` is SIZE_MAX. */
static int allocate_packed(packer *p, fxs_packed_scene *scene, size_t bytes)
{
    scene->bytes = bytes;
    scene->allocator = p->options.allocator;
    scene->allocation = bytes < SIZE_MAX - 63 ? fxs_allocate_zeroed(p->options.allocator, 1, bytes + 63) : 0;
    if (!scene->allocation) {
        fxs_fail(p->message, "out of memory: %zu bytes for the packed scene", bytes);
        p->message->bytes_needed = bytes + 63;
        return FXS_ERR_MEMORY;
    }
    fxs_use_large_pages(scene->allocation, bytes + 63);
    scene->data = (void *)(((uintptr_t)scene->allocation + 63) / 64 * 64);
    return 0;
}

static uint32_t motion_flags(const fxs_time *time)
{
    return (time->loops ? FXS_MOTION_LOOPS : 0) | (time->turns ? FXS_MOTION_TURNS : 0) |
           (time->fades ? FXS_MOTION_FADES : 0);
}

static void begin_motion(packer *p, unsigned char *to)
{
    const fxs_time *time = &p->info->time;
    const double octaves = time->least > 0 ? -fxs_log(time->least) * FXS_LOG2_E : 16;
    p->motion_header = (fxs_motion_header *)(void *)to;
    p->motions = (fxs_chunk_motion *)(void *)(p->motion_header + 1);
    *p->motion_header = (fxs_motion_header){.magic = FXS_MOTION_MAGIC, .flags = motion_flags(time),
                                            .duration_q16 = (uint32_t)fmax(1, floor(ldexp(time->duration, 16))),
                                            .rate_q16 = (uint32_t)floor(ldexp(fmin(time->rate, 1000), 16) + 0.5),
                                            .degree = (uint32_t)time->degree,
                                            .cut_q16 = (uint32_t)ldexp(fmin(octaves, 16), 16)};
}

static int allocate_scene(packer *p, fxs_packed_scene *scene)
{
    const uint32_t chunks = fxs_chunks_of((uint32_t)p->slot_count);
    const fxs_packed_header h = header_of(p, p->options.tree && chunks > 1);
    const size_t tree = fxs_version_has_tree(h.version) ? fxs_tree_bytes(chunks, h.chunk_bytes) : 0;
    const size_t leaves =
        p->lives ? fxs_moving_scene_bytes(h.count, p->encoder.sh_degree, p->encoder.profile, h.palette_entries,
                                          (uint32_t)p->info->time.degree, motion_flags(&p->info->time), tree > 0)
                 : fxs_scene_bytes(h.count, p->encoder.sh_degree, p->encoder.profile, h.palette_entries);
    FXS_TRY(allocate_packed(p, scene, leaves && leaves <= SIZE_MAX - 63 - tree ? leaves + tree : SIZE_MAX));
    p->header = scene->data;
    *p->header = h;
    p->chunks = (fxs_chunk *)(void *)(p->header + 1);
    p->palette_bytes = (unsigned char *)(p->chunks + chunks);
    p->rows = (unsigned char *)scene->data + leaves - (size_t)chunks * h.chunk_bytes;
    if (p->lives) {
        begin_motion(p, p->rows - fxs_motion_table_bytes(fxs_chunks_with_nodes(chunks, tree > 0)));
        FXS_TRY(find_times(p));
    }
    if (tree)
        begin_tree((unsigned char *)scene->data + leaves, chunks - 1);
    return h.palette_entries ? allocate_palette(p) : 0;
}

static void write_source(const packer *p, uint32_t source[2])
{
    const fxs_grid grids[2] = {p->info->colour, p->info->sh};
    uint64_t sum = 0, numbers[4];
    memcpy(numbers, grids, sizeof numbers);
    for (const findings *f = p->findings; f < p->findings + PARTS; f++)
        sum += f->source;
    for (int i = 0; i < 4; i++)
        sum = (sum ^ numbers[i]) * 0xd6e8feb86659fd93u;
    source[0] = (uint32_t)sum;
    source[1] = (uint32_t)(sum >> 32);
}

static int allocate_part(packer *p, fxs_packed_scene *part)
{
    const fxs_packed_header h = header_of(p, p->tree != 0);
    fxs_part_header head = {.magic = FXS_PART_MAGIC, .version = FXS_PART_VERSION, .program = FXS_VERSION_NUMBER,
                            .number = p->part, .count = p->parts, .first = p->first,
                            .chunk_count = p->end - p->first};
    fxs_crc32_table table;
    fxs_part_layout l;
    fxs_crc32_fill(&table);
    write_source(p, head.source);
    for (uint32_t i = 0; i < h.chunk_count; i++)
        head.boxes = fxs_part_add_box(&table, head.boxes, p->boxes[i]);
    fxs_release(p->options.allocator, p->boxes);
    p->boxes = 0;
    if (p->tree)
        fxs_tree_count_within(p->tree, p->first, p->end, &head.node_count, &head.top_count);
    const int error = fxs_part_lay_out(&l, &head, &h);
    FXS_TRY(allocate_packed(p, part, error || l.bytes >= SIZE_MAX ? SIZE_MAX : (size_t)l.bytes));
    unsigned char *bytes = part->data;
    memcpy(bytes, &head, sizeof head);
    p->header = (fxs_packed_header *)(void *)(bytes + l.scene);
    *p->header = h;
    p->chunks = (fxs_chunk *)(void *)(bytes + l.chunks);
    p->palette_bytes = bytes + l.palette;
    p->rows = bytes + l.rows;
    return h.palette_entries ? allocate_palette(p) : 0;
}

static int build_part_of_tree(packer *p, unsigned char *bytes, const fxs_part_layout *l, const fxs_packed_header *h)
{
    const fxs_scene scene = {.profile = p->encoder.profile, .sh_degree = p->encoder.sh_degree,
                             .chunk_bytes = h->chunk_bytes, .palette = (int8_t *)p->palette_bytes,
                             .palette_entries = h->palette_entries, .palette_step_q19 = h->palette_step_q19};
    const fxs_tree_run run = {.scene = &scene, .palette = p->palette, .first = p->first, .end = p->end,
                              .chunks = bytes + l->chunks, .rows = bytes + l->rows,
                              .node_chunks = bytes + l->node_chunks, .node_rows = bytes + l->node_rows,
                              .sums = bytes + l->sums, .tops = bytes + l->tops};
    fxs_pack_options options = p->options;
    begin(p, tree_share(p));
    options.progress = (fxs_progress){report_progress, p};
    return fxs_tree_build_run(p->tree, &run, &options, p->message);
}

static int finish_part_of_scene(packer *p, unsigned char *bytes)
{
    const fxs_packed_header h = *p->header;
    fxs_part_header *head = (fxs_part_header *)(void *)bytes;
    fxs_part_layout l;
    if (fxs_part_lay_out(&l, head, &h))
        return fail_changed(p);
    for (uint32_t i = 0; i < head->chunk_count; i++)
        if (!fxs_chunk_valid(&p->chunks[i]))
            return fail_changed(p);
    turn_headers(p);
    if (p->palette) {
        head->unit_exponent = p->palette->unit_exponent;
        head->centred = p->palette->centred;
        memcpy(bytes + l.groups, p->palette->groups, (size_t)(l.rows - l.groups));
        fxs_little_endian(bytes, (size_t)l.groups, (size_t)(l.rows - l.groups) / 2, 2);
    }
    fxs_part_header_turn(head);
    return p->tree ? build_part_of_tree(p, bytes, &l, &h) : 0;
}

/* Counts the chunks that are alive at one time, nodes included. */
static int count_alive(packer *p, uint32_t chunks)
{
    fxs_chunk_motion *motions = fxs_allocate(p->options.allocator, chunks, sizeof *motions);
    int32_t *ticks = fxs_allocate(p->options.allocator, 2 * (size_t)chunks, sizeof *ticks);
    const int enough = motions && ticks;
    for (uint32_t i = 0; enough && i < chunks; i++) {
        motions[i] = p->motions[i];
        fxs_chunk_motion_turn(&motions[i]);
    }
    if (enough)
        p->motion_header->most_chunks = fxs_little_32(fxs_motion_most(motions, chunks, ticks));
    fxs_release(p->options.allocator, motions);
    fxs_release(p->options.allocator, ticks);
    return enough ? 0 : fail_memory(p, p->info->count);
}

static int build_tree(packer *p, const fxs_scene *scene, void *data)
{
    fxs_pack_options options = p->options;
    begin(p, tree_share(p));
    options.progress = (fxs_progress){report_progress, p};
    FXS_TRY(fxs_tree_build(scene, data, p->coded ? p->coded->palette : p->palette, &options, p->message));
    return p->lives ? count_alive(p, fxs_scene_chunks(scene)) : 0;
}

static int prepare_motion(packer *p)
{
    const fxs_time *time = &p->info->time;
    if (!(time->duration < ldexp(FXS_MOTION_DURATION_MOST, -16)) || time->degree < 0 ||
        time->degree > (int)FXS_MOTION_DEGREE)
        return fxs_fail(p->message, "a duration of %.0f seconds: expected less than %.0f", time->duration,
                        ldexp(FXS_MOTION_DURATION_MOST, -16));
    if (p->coded || p->by_part)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, p->message, "a moving scene is not packed in blocks");
    p->motion_bytes = fxs_motion_bytes((uint32_t)time->degree, motion_flags(time)) / FXS_CHUNK;
    p->lives = fxs_allocate_zeroed(p->options.allocator, (size_t)p->info->count, sizeof *p->lives);
    for (int i = 0; i < 2; i++)
        p->batches[i].motions = fxs_allocate(p->options.allocator, BATCH, sizeof(fxs_motion));
    return p->lives && p->batches[0].motions && p->batches[1].motions ? 0 : fail_memory(p, p->info->count);
}

static int pack(packer *p, fxs_packed_scene *scene)
{
    if (p->encoder.profile > FXS_PROFILE_SMALL || p->encoder.sh_degree < 0 || p->encoder.sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, p->message, "profile %d, SH degree %d: expected 0 to 2, 0 to 3",
                           (int)p->encoder.profile, p->encoder.sh_degree);
    if (p->info->count == 0 || p->info->count > FXS_MAX_COUNT)
        return fxs_fail(p->message, "%llu Gaussians: expected 1 to %u", (unsigned long long)p->info->count,
                        FXS_MAX_COUNT);
    p->entries = fxs_allocate_zeroed(p->options.allocator, (size_t)p->info->count, sizeof *p->entries);
    fxs_use_large_pages(p->entries, (size_t)p->info->count * sizeof *p->entries);
    p->batches = fxs_allocate(p->options.allocator, 2, sizeof *p->batches);
    for (int i = 0; i < 2 && p->batches; i++)
        p->batches[i].motions = 0;
    p->findings = fxs_allocate_zeroed(p->options.allocator, PARTS, sizeof *p->findings);
    p->seen_step = (p->info->count - 1) / FXS_SEEN_MOST + 1;
    p->seen = fxs_allocate_zeroed(p->options.allocator, FXS_SEEN_MOST, sizeof *p->seen);
    if (!p->entries || !p->batches || !p->findings || !p->seen)
        return fail_memory(p, p->info->count);
    if (p->info->time.duration > 0)
        FXS_TRY(prepare_motion(p));
    FXS_TRY(read_positions(p));
    if (p->coded && p->report->packed != p->info->count)
        return fail_changed(p);
    if (p->report->packed == 0)
        return fxs_fail(p->message, "none of the %llu Gaussians can be drawn", (unsigned long long)p->report->read);
    FXS_TRY(find_inner_bounds(p));
    FXS_TRY(find_slots(p));
    if (p->options.slots)
        memcpy(p->options.slots, p->slots, (size_t)p->info->count * sizeof *p->slots);
    if (p->by_part)
        FXS_TRY(p->by_part->plan(p));
    fxs_release(p->options.allocator, p->entries);
    p->entries = 0;
    FXS_TRY(find_seen_bounds(p));
    FXS_TRY(p->by_part ? p->by_part->allocate(p, scene) : allocate_scene(p, scene));
    FXS_TRY(find_headers(p));
    FXS_TRY(write_codes(p));
    if (p->by_part)
        return p->by_part->finish(p, scene->data);
    turn_headers(p);
    /* opening validates the packed scene, because the source file may have changed before the last pass */
    fxs_scene whole;
    if (fxs_scene_open(&whole, scene->data, scene->bytes))
        return fail_changed(p);
    return FXS_BUILDS_TREES && whole.nodes ? build_tree(p, &whole, scene->data) : 0;
}

int fxs_pack(fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene, fxs_pack_report *report,
             const fxs_pack_options *options, fxs_message *message)
{
    return fxs_pack_coded(file, info, NULL, scene, report, options, message);
}

int fxs_pack_coded(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded,
                   fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                   fxs_message *message)
{
    return fxs_pack_held(file, info, coded, HELD, scene, report, options, message);
}

static void move_to_origin(fxs_packed_scene *scene, const fxs_scene_file_info *info, fxs_pack_report *report)
{
    fxs_packed_move(scene->data, info->origin);
    for (int i = 0; i < 3; i++) {
        report->low[i] += info->origin[i];
        report->high[i] += info->origin[i];
        report->inner_low[i] += info->origin[i];
        report->inner_high[i] += info->origin[i];
    }
}

static int pack_as(const packer *how, fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene,
                   fxs_pack_report *report, const fxs_pack_options *options, fxs_message *message)
{
    packer p = *how;
    memset(scene, 0, sizeof *scene);
    memset(report, 0, sizeof *report);
    fxs_pack_options_init(&p.options);
    FXS_TRY(FXS_OPTIONS_READ(fxs_pack_options, &p.options, options, message));
    p.file = file;
    p.info = info;
    p.report = report;
    p.message = message;
    p.stages = fxs_pack_stages_choose(~0u);
    p.encoder.profile = p.options.profile;
    p.encoder.sh_degree = info->sh_degree;
    if (!p.options.workers.run)
        p.options.workers.run = fxs_run_here;
    p.options.workers.count += p.options.workers.count == 0;
    p.options.tree &= FXS_BUILDS_TREES;
    const int result = pack(&p, scene);
    if (!result && fxs_has_origin(info->origin))
        move_to_origin(scene, info, report);
    fxs_release(p.options.allocator, p.entries);
    for (int i = 0; i < 2 && p.batches; i++)
        fxs_release(p.options.allocator, p.batches[i].motions);
    fxs_release(p.options.allocator, p.batches);
    fxs_release(p.options.allocator, p.lives);
    fxs_release(p.options.allocator, p.times);
    fxs_release(p.options.allocator, p.findings);
    fxs_release(p.options.allocator, p.seen);
    fxs_release(p.options.allocator, p.slots);
    fxs_release(p.options.allocator, p.boxes);
    fxs_release(p.options.allocator, p.ranges);
    fxs_release(p.options.allocator, p.palette);
    fxs_release(p.options.allocator, p.sample);
    fxs_release(p.options.allocator, p.items);
    fxs_tree_free(p.tree);
    if (result)
        fxs_packed_scene_free(scene);
    return result;
}

int fxs_pack_held(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded, uint32_t held,
                  fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message)
{
    const packer how = {.coded = coded, .held = held};
    return pack_as(&how, file, info, scene, report, options, message);
}

int fxs_pack_part(fxs_scene_file *file, const fxs_scene_file_info *info, uint32_t number, uint32_t count,
                  fxs_packed_scene *part, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message)
{
    static const part_steps steps = {plan_part, allocate_part, finish_part_of_scene};
    const packer how = {.by_part = &steps, .part = number, .parts = count, .held = HELD};
    if (count > FXS_PARTS_MOST || number < 1 || number > count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "block %u of %u: expected 1 to %d", (unsigned)number,
                           (unsigned)count, FXS_PARTS_MOST);
    if (fxs_has_origin(info->origin))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "a scene so far out is not packed in blocks; move it near 0 "
                           "with convert --translate %.0f,%.0f,%.0f", 0 - info->origin[0], 0 - info->origin[1],
                           0 - info->origin[2]);
    return pack_as(&how, file, info, part, report, options, message);
}

void fxs_packed_scene_free(fxs_packed_scene *scene)
{
    fxs_release(scene->allocator, scene->allocation);
    memset(scene, 0, sizeof *scene);
}
