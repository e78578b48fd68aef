#include "pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../src/packed.h"
#include "encode.h"
#include "order.h"

#define BATCH 4096                   /* Gaussians read at once */
#define PARTS_PER_THREAD 4           /* so that the thread that reads gets its share of the other work */
#define MAX_RECORD ((FXS_CHUNK_BYTES(3) - FXS_CHUNK_POSITION) / FXS_CHUNK)   /* bytes */
#define POSITION_LIMIT 134000000.0   /* just under 2^27 units */

#if defined(__GNUC__)
#define PREFETCH(address) __builtin_prefetch(address, 1)
#else
#define PREFETCH(address) ((void)(address))
#endif

typedef struct batch {
    fxs_gaussian gaussians[BATCH];
    uint64_t first;                  /* index in the file */
    long count;                      /* 0: the end; -1: not read, with a message */
} batch;

/* What the jobs of one part found, in all batches. */
typedef struct findings {
    fxs_pack_dropped dropped;
    fxs_pack_error largest;
    float low[3], high[3];
} findings;

/* Where a byte of the codes of a chunk's Gaussian `at` lies: at offset + at * stride in the chunk. */
typedef struct code_byte {
    uint32_t offset, stride;
} code_byte;

typedef struct packer packer;
typedef void part_fn(packer *p, const batch *b, uint32_t part);

struct packer {
    fxs_scene_file *file;
    const fxs_scene_file_info *info;
    fxs_pack_report *report;
    fxs_pack_options options;
    fxs_message *message;
    uint32_t parts;                  /* jobs that share a batch */
    findings *findings;              /* of each part */
    batch *batches;                  /* two: one is worked on while the other is filled */
    int ready;                       /* the one that is worked on */
    part_fn *work;
    fxs_order_entry *entries;
    uint32_t *slots;                 /* where Gaussian i of the file goes, or FXS_NO_SLOT */
    fxs_chunk_ranges *ranges;        /* of each chunk */
    fxs_chunk *headers;
    unsigned char *chunks;
    uint32_t chunk_count, chunk_bytes;
    uint32_t record_bytes;           /* codes of one Gaussian */
    code_byte record[MAX_RECORD];
};

/* ---- Passes over the file -------------------------------------------------------------------------------------- */

static void run_here(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

static void read_batch(packer *p, batch *b, uint64_t first)
{
    uint64_t left = p->info->count - first;
    b->first = first;
    b->count = fxs_scene_file_read(p->file, b->gaussians, BATCH, p->message);
    if (b->count > 0 && (uint64_t)b->count > left)
        b->count = (long)left;
}

static void read_or_work(void *argument, uint32_t job)
{
    packer *p = argument;
    const batch *b = &p->batches[p->ready];
    if (job == 0)
        read_batch(p, &p->batches[!p->ready], b->first + (uint64_t)b->count);
    else
        p->work(p, b, job - 1);
}

static int pass(packer *p, int which, part_fn *work)
{
    batch *b = p->batches;
    p->work = work;
    p->ready = 0;
    b->first = 0;
    b->count = 0;
    if (fxs_scene_file_rewind(p->file, p->message))
        return -1;
    do {
        p->options.run(p->options.pool, read_or_work, p, 1 + p->parts);
        p->ready = !p->ready;
        b = &p->batches[p->ready];
        if (b->count >= 0 && p->options.progress &&
            p->options.progress(p->options.argument, (which + (double)b->first / (double)p->info->count) / 3))
            return fxs_fail(p->message, "import stopped");
    } while (b->count > 0);
    return (int)b->count;
}

/* The first of a part's Gaussians in a batch. */
static long first_of(const packer *p, const batch *b, uint32_t part)
{
    return b->count * (long)part / (long)p->parts;
}

static int all_finite(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return 0;
    return 1;
}

static int drawable(const fxs_gaussian *g, int sh_degree, fxs_pack_dropped *dropped)
{
    float norm = 0;
    if (!all_finite(g->position, 3) || !all_finite(g->scale, 3) || !all_finite(g->rotation, 4) ||
        isnan(g->opacity) || !all_finite(g->dc, 3) || !all_finite(g->sh, 3 * (size_t)FXS_SH_COUNT(sh_degree)))
        return dropped->not_finite++, 0;
    for (int i = 0; i < 4; i++)
        norm += fabsf(g->rotation[i]);
    if (norm == 0 || !isfinite(norm))
        return dropped->rotation++, 0;
    for (int i = 0; i < 3; i++) {
        if (fabsf(g->scale[i]) > 20)
            return dropped->scale++, 0;
        if (fabs(g->position[i]) > POSITION_LIMIT)
            return dropped->position++, 0;
    }
    return 1;
}

static void take_position(packer *p, fxs_order_entry *entry, const fxs_gaussian *g, findings *f)
{
    memcpy(entry->position, g->position, sizeof g->position);
    if (!drawable(g, p->info->sh_degree, &f->dropped)) {
        entry->position[0] = NAN;
        return;
    }
    for (int i = 0; i < 3; i++) {
        f->low[i] = g->position[i] < f->low[i] ? g->position[i] : f->low[i];
        f->high[i] = g->position[i] > f->high[i] ? g->position[i] : f->high[i];
    }
}

static void take_positions(packer *p, const batch *b, uint32_t part)
{
    for (long i = first_of(p, b, part), end = first_of(p, b, part + 1); i < end; i++)
        take_position(p, &p->entries[b->first + (uint64_t)i], &b->gaussians[i], &p->findings[part]);
}

static int read_positions(packer *p)
{
    fxs_pack_report *report = p->report;
    fxs_pack_dropped *dropped = &report->dropped;
    for (uint32_t part = 0; part < p->parts; part++)
        for (int i = 0; i < 3; i++) {
            p->findings[part].low[i] = INFINITY;
            p->findings[part].high[i] = -INFINITY;
        }
    if (pass(p, 0, take_positions))
        return -1;
    report->read = p->batches[p->ready].first;
    for (uint64_t i = report->read; i < p->info->count; i++)
        p->entries[i].position[0] = NAN;
    for (int i = 0; i < 3; i++) {
        report->low[i] = INFINITY;
        report->high[i] = -INFINITY;
    }
    for (const findings *f = p->findings; f < p->findings + p->parts; f++) {
        for (int i = 0; i < 3; i++) {
            report->low[i] = fmin(report->low[i], f->low[i]);
            report->high[i] = fmax(report->high[i], f->high[i]);
        }
        dropped->not_finite += f->dropped.not_finite;
        dropped->rotation += f->dropped.rotation;
        dropped->scale += f->dropped.scale;
        dropped->position += f->dropped.position;
    }
    report->packed = report->read - dropped->not_finite - dropped->rotation - dropped->scale - dropped->position;
    return 0;
}

/* ---- Order ----------------------------------------------------------------------------------------------------- */

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Bounds of the middle 90 % as found on an evenly spaced sample. */
static int find_inner_bounds(packer *p)
{
    enum { SAMPLE = 65536 };
    uint64_t count = p->info->count, step = count / SAMPLE + 1;
    float *sample = malloc(SAMPLE * sizeof *sample);
    if (!sample)
        return fxs_fail(p->message, "out of memory");
    for (int axis = 0; axis < 3; axis++) {
        size_t n = 0;
        for (uint64_t i = 0; i < count; i += step)
            if (!isnan(p->entries[i].position[0]))
                sample[n++] = p->entries[i].position[axis];
        qsort(sample, n, sizeof *sample, compare_floats);
        p->report->inner_low[axis] = n ? sample[n / 20] : p->report->low[axis];
        p->report->inner_high[axis] = n ? sample[n - 1 - n / 20] : p->report->high[axis];
    }
    free(sample);
    return 0;
}

static int find_slots(packer *p)
{
    uint32_t count = (uint32_t)p->info->count;
    if (fxs_order(p->entries, count, p->report, &p->options))
        return fxs_fail(p->message, "out of memory for %u Gaussians", count);
    p->slots = malloc(count * sizeof *p->slots);
    if (!p->slots)
        return fxs_fail(p->message, "out of memory for %u Gaussians", count);
    for (uint32_t i = 0; i < count; i++)
        p->slots[p->entries[i].key.index] = i < p->report->packed ? i : FXS_NO_SLOT;
    free(p->entries);
    p->entries = 0;
    return 0;
}

/* ---- Chunks ---------------------------------------------------------------------------------------------------- */

/* A chunk is one part's, whatever the batch. */
static void take_ranges(packer *p, const batch *b, uint32_t part)
{
    for (long i = 0; i < b->count; i++) {
        uint32_t slot = p->slots[b->first + (uint64_t)i], chunk = slot / FXS_CHUNK;
        if (slot != FXS_NO_SLOT && chunk % p->parts == part)
            fxs_ranges_take(&p->ranges[chunk], &b->gaussians[i], p->info->sh_degree);
    }
}

static int find_headers(packer *p)
{
    uint32_t chunks = p->chunk_count;
    p->ranges = malloc(chunks * sizeof *p->ranges);
    p->headers = malloc(chunks * sizeof *p->headers);
    if (!p->ranges || !p->headers)
        return fxs_fail(p->message, "out of memory");
    for (uint32_t i = 0; i < chunks; i++)
        fxs_ranges_clear(&p->ranges[i]);
    if (pass(p, 1, take_ranges))
        return -1;
    for (uint32_t i = 0; i < chunks; i++)
        fxs_encode_header(&p->headers[i], &p->ranges[i]);
    return 0;
}

static void add_row(packer *p, uint32_t offset, uint32_t stride)
{
    for (uint32_t i = 0; i < stride; i++)
        p->record[p->record_bytes++] = (code_byte){offset + i, stride};
}

static void list_rows(packer *p)
{
    for (uint32_t i = 0; i < 3; i++)
        add_row(p, FXS_CHUNK_POSITION + 2 * FXS_CHUNK * i, 2);
    add_row(p, FXS_CHUNK_ROTATION, 4);
    add_row(p, FXS_CHUNK_SCALE, 4);
    add_row(p, FXS_CHUNK_COLOUR, 4);
    for (uint32_t i = 0; i < 3 * (uint32_t)FXS_SH_COUNT(p->info->sh_degree); i++)
        add_row(p, FXS_CHUNK_SH + FXS_CHUNK * i, 1);
}

/* Neighbours in the file are not neighbours on the curve: rows, a cache line each, would be fetched for one byte. So
   the codes of a Gaussian are kept together until all are known. */
static void encode_part(packer *p, const batch *b, uint32_t part)
{
    union {
        fxs_chunk header;
        unsigned char bytes[FXS_CHUNK_BYTES(3)];
    } chunk;                                              /* of one Gaussian */
    unsigned char record[MAX_RECORD];
    fxs_pack_error largest = p->findings[part].largest;   /* a copy: parts share cache lines */
    for (long i = first_of(p, b, part), end = first_of(p, b, part + 1); i < end; i++) {
        uint32_t slot = p->slots[b->first + (uint64_t)i];
        if (slot == FXS_NO_SLOT)
            continue;
        unsigned char *to = p->chunks + (size_t)(slot / FXS_CHUNK) * p->chunk_bytes + FXS_CHUNK_POSITION +
                            slot % FXS_CHUNK * p->record_bytes;
        PREFETCH(to);
        PREFETCH(to + p->record_bytes - 1);
        chunk.header = p->headers[slot / FXS_CHUNK];
        fxs_encode(chunk.bytes, 0, &b->gaussians[i], p->info->sh_degree, &largest);
        for (uint32_t k = 0; k < p->record_bytes; k++)
            record[k] = chunk.bytes[p->record[k].offset];
        memcpy(to, record, p->record_bytes);
    }
    p->findings[part].largest = largest;
}

/* Records to rows. */
static void transpose_part(void *argument, uint32_t part)
{
    const packer *p = argument;
    unsigned char records[FXS_CHUNK_BYTES(3)];
    for (uint32_t chunk = part; chunk < p->chunk_count; chunk += p->parts) {
        unsigned char *to = p->chunks + (size_t)chunk * p->chunk_bytes;
        memcpy(to, &p->headers[chunk], sizeof *p->headers);
        memcpy(records, to + FXS_CHUNK_POSITION, FXS_CHUNK * p->record_bytes);
        for (uint32_t k = 0; k < p->record_bytes; k++)
            for (uint32_t at = 0; at < FXS_CHUNK; at++)
                to[p->record[k].offset + at * p->record[k].stride] = records[at * p->record_bytes + k];
    }
}

static int write_codes(packer *p)
{
    fxs_pack_error *most = &p->report->largest;
    list_rows(p);
    if (pass(p, 2, encode_part))
        return -1;
    p->options.run(p->options.pool, transpose_part, p, p->parts);
    for (const findings *f = p->findings; f < p->findings + p->parts; f++) {
        most->position = fmax(most->position, f->largest.position);
        most->scale = fmax(most->scale, f->largest.scale);
        most->rotation = fmax(most->rotation, f->largest.rotation);
        most->opacity = fmax(most->opacity, f->largest.opacity);
        most->dc = fmax(most->dc, f->largest.dc);
        most->sh = fmax(most->sh, f->largest.sh);
    }
    return 0;
}

/* ---- Import ---------------------------------------------------------------------------------------------------- */

static int allocate_scene(packer *p, fxs_packed_scene *scene)
{
    size_t bytes = fxs_scene_bytes((uint32_t)p->report->packed, p->info->sh_degree);
    scene->allocation = calloc(1, bytes + 63);
    if (!scene->allocation)
        return fxs_fail(p->message, "out of memory: %zu bytes for the packed scene", bytes);
    scene->data = (void *)(((uintptr_t)scene->allocation + 63) / 64 * 64);
    scene->bytes = bytes;
    fxs_packed_header header = {FXS_PACKED_MAGIC, FXS_PACKED_VERSION, (uint32_t)p->report->packed, 0, 0,
                                (uint32_t)p->info->sh_degree, 0, {0}, {0}, {0}, {0}, {0}};
    header.chunk_count = p->chunk_count = (header.count + FXS_CHUNK - 1) / FXS_CHUNK;
    header.chunk_bytes = p->chunk_bytes;
    header.flags = p->info->antialiased ? FXS_PACKED_ANTIALIASED : 0;
    for (int i = 0; i < 3; i++) {
        header.low_q32[i] = (int64_t)floor(ldexp(p->report->low[i], 32));
        header.high_q32[i] = (int64_t)ceil(ldexp(p->report->high[i], 32));
        header.inner_low_q32[i] = (int64_t)floor(ldexp(p->report->inner_low[i], 32));
        header.inner_high_q32[i] = (int64_t)ceil(ldexp(p->report->inner_high[i], 32));
    }
    memcpy(scene->data, &header, sizeof header);
    p->chunks = (unsigned char *)scene->data + sizeof header;
    return 0;
}

static int pack(packer *p, fxs_packed_scene *scene)
{
    if (p->info->count == 0 || p->info->count > FXS_MAX_COUNT)
        return fxs_fail(p->message, "%llu Gaussians: expected 1 to %u", (unsigned long long)p->info->count,
                        FXS_MAX_COUNT);
    p->entries = calloc((size_t)p->info->count, sizeof *p->entries);
    p->batches = malloc(2 * sizeof *p->batches);
    p->findings = calloc(p->parts, sizeof *p->findings);
    if (!p->entries || !p->batches || !p->findings)
        return fxs_fail(p->message, "out of memory for %llu Gaussians", (unsigned long long)p->info->count);
    if (read_positions(p))
        return -1;
    if (p->report->packed == 0)
        return fxs_fail(p->message, "none of the %llu Gaussians can be drawn", (unsigned long long)p->report->read);
    return find_inner_bounds(p) || find_slots(p) || allocate_scene(p, scene) || find_headers(p) || write_codes(p);
}

int fxs_pack(fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene, fxs_pack_report *report,
             const fxs_pack_options *options, fxs_message *message)
{
    packer p;
    memset(&p, 0, sizeof p);
    memset(scene, 0, sizeof *scene);
    memset(report, 0, sizeof *report);
    p.file = file;
    p.info = info;
    p.report = report;
    p.message = message;
    p.chunk_bytes = FXS_CHUNK_BYTES(info->sh_degree);
    if (options)
        p.options = *options;
    if (!p.options.run)
        p.options.run = run_here;
    p.options.threads += p.options.threads == 0;
    p.parts = PARTS_PER_THREAD * p.options.threads;
    int result = pack(&p, scene) ? -1 : 0;
    free(p.entries);
    free(p.batches);
    free(p.findings);
    free(p.slots);
    free(p.ranges);
    free(p.headers);
    if (result)
        fxs_packed_scene_free(scene);
    return result;
}

void fxs_packed_scene_free(fxs_packed_scene *scene)
{
    free(scene->allocation);
    memset(scene, 0, sizeof *scene);
}
