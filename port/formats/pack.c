#include "pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../src/fixsplat.h"
#include "../../src/packed.h"
#include "encode.h"

#define BATCH 1024
#define DROPPED UINT32_MAX
#define POSITION_LIMIT 134000000.0   /* just under 2^27 units */

typedef struct order_key {
    uint64_t morton;
    uint32_t index;                  /* in the file */
} order_key;

typedef struct packer {
    fxs_scene_file *file;
    const fxs_scene_file_info *info;
    fxs_pack_report *report;
    fxs_progress_fn *progress;
    void *argument;
    fxs_message *message;
    float (*positions)[3];           /* in file order; first x is NaN for a dropped Gaussian */
    uint32_t *slots;                 /* where Gaussian i of the file goes, or DROPPED */
    fxs_chunk_ranges *ranges;
    fxs_chunk *chunks;
    unsigned char *rows;
    uint32_t chunk_bytes;
} packer;

/* ---- Passes over the file -------------------------------------------------------------------------------------- */

typedef void gaussian_fn(packer *p, uint64_t index, const fxs_gaussian *gaussian);

static int pass(packer *p, int which, gaussian_fn *use)
{
    fxs_gaussian batch[BATCH / 8];
    uint64_t index = 0;
    if (fxs_scene_file_rewind(p->file, p->message))
        return -1;
    for (;;) {
        long n = fxs_scene_file_read(p->file, batch, BATCH / 8, p->message);
        if (n <= 0)
            return (int)n;
        for (long i = 0; i < n && index < p->info->count; i++, index++)
            use(p, index, &batch[i]);
        if (p->progress && index % (BATCH * 16) < BATCH / 8 &&
            p->progress(p->argument, (which + (double)index / (double)p->info->count) / 3))
            return fxs_fail(p->message, "import stopped");
    }
}

static int all_finite(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return 0;
    return 1;
}

int fxs_drawable(const fxs_gaussian *g, int sh_degree, fxs_pack_dropped *dropped)
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

static void take_position(packer *p, uint64_t index, const fxs_gaussian *g)
{
    p->report->read++;
    memcpy(p->positions[index], g->position, sizeof g->position);
    if (!fxs_drawable(g, p->info->sh_degree, &p->report->dropped))
        p->positions[index][0] = NAN;
}

/* ---- Order: a Morton curve ------------------------------------------------------------------------------------- */

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Bounds of all, and of the middle 90 % as found on an evenly spaced sample. */
static int find_bounds(packer *p)
{
    enum { SAMPLE = 65536 };
    uint64_t count = p->info->count, step = count / SAMPLE + 1;
    float *sample = malloc(SAMPLE * sizeof *sample);
    if (!sample)
        return fxs_fail(p->message, "out of memory");
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        size_t n = 0;
        for (uint64_t i = 0; i < count; i++) {
            if (isnan(p->positions[i][0]))
                continue;
            float x = p->positions[i][axis];
            low = fmin(low, x);
            high = fmax(high, x);
            if (i % step == 0)
                sample[n++] = x;
        }
        qsort(sample, n, sizeof *sample, compare_floats);
        p->report->low[axis] = low;
        p->report->high[axis] = high;
        p->report->inner_low[axis] = n ? sample[n / 20] : low;
        p->report->inner_high[axis] = n ? sample[n - 1 - n / 20] : high;
    }
    free(sample);
    return 0;
}

static uint64_t spread_bits(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

/* 21 bits an axis. Coordinates go through t / (1 + |t|), t = 0 in the middle of the scene, so that far outliers do
   not coarsen it. */
static uint64_t morton(const fxs_pack_report *report, const float position[3])
{
    uint64_t code = 0;
    for (int i = 0; i < 3; i++) {
        double middle = (report->inner_low[i] + report->inner_high[i]) / 2;
        double half = (report->inner_high[i] - report->inner_low[i]) / 2;
        double t = (position[i] - middle) / (half > 1e-9 ? half : 1e-9);
        code |= spread_bits((uint64_t)((t / (1 + fabs(t)) + 1) * 1048575.5)) << i;
    }
    return code;
}

static int compare_keys(const void *a, const void *b)
{
    const order_key *x = a, *y = b;
    if (x->morton != y->morton)
        return x->morton < y->morton ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

static int find_order(packer *p)
{
    uint64_t count = p->info->count;
    uint32_t n = 0;
    order_key *keys = malloc(count * sizeof *keys);
    if (!keys)
        return fxs_fail(p->message, "out of memory for %llu Gaussians", (unsigned long long)count);
    for (uint64_t i = 0; i < count; i++)
        if (!isnan(p->positions[i][0]))
            keys[n++] = (order_key){morton(p->report, p->positions[i]), (uint32_t)i};
    free(p->positions);
    p->positions = 0;
    qsort(keys, n, sizeof *keys, compare_keys);
    p->slots = malloc(count * sizeof *p->slots);
    if (p->slots) {
        memset(p->slots, 255, count * sizeof *p->slots);
        for (uint32_t i = 0; i < n; i++)
            p->slots[keys[i].index] = i;
    }
    free(keys);
    p->report->packed = n;
    return p->slots ? 0 : fxs_fail(p->message, "out of memory for %llu Gaussians", (unsigned long long)count);
}

/* ---- Chunks ---------------------------------------------------------------------------------------------------- */

static void take_ranges(packer *p, uint64_t index, const fxs_gaussian *g)
{
    if (p->slots[index] != DROPPED)
        fxs_ranges_take(&p->ranges[p->slots[index] / FXS_CHUNK], g, p->info->sh_degree);
}

static int write_headers(packer *p)
{
    uint32_t chunks = (uint32_t)((p->report->packed + FXS_CHUNK - 1) / FXS_CHUNK);
    p->ranges = malloc(chunks * sizeof *p->ranges);
    if (!p->ranges)
        return fxs_fail(p->message, "out of memory");
    for (uint32_t i = 0; i < chunks; i++)
        fxs_ranges_clear(&p->ranges[i]);
    if (pass(p, 1, take_ranges))
        return -1;
    for (uint32_t i = 0; i < chunks; i++)
        fxs_encode_header(&p->chunks[i], &p->ranges[i]);
    return 0;
}

static void write_codes(packer *p, uint64_t index, const fxs_gaussian *g)
{
    uint32_t slot = p->slots[index];
    if (slot != DROPPED)
        fxs_encode(&p->chunks[slot / FXS_CHUNK], p->rows + (size_t)(slot / FXS_CHUNK) * p->chunk_bytes, slot % FXS_CHUNK, g, p->info->sh_degree,
                   &p->report->largest);
}

/* ---- Import ---------------------------------------------------------------------------------------------------- */

static int allocate_scene(packer *p, fxs_packed_scene *scene)
{
    size_t bytes = fxs_scene_bytes((uint32_t)p->report->packed, p->info->sh_degree, FXS_PROFILE_DEFAULT, 0);
    scene->allocation = calloc(1, bytes + 63);
    if (!scene->allocation)
        return fxs_fail(p->message, "out of memory: %zu bytes for the packed scene", bytes);
    scene->data = (void *)(((uintptr_t)scene->allocation + 63) / 64 * 64);
    scene->bytes = bytes;
    fxs_packed_header header = {FXS_PACKED_MAGIC, FXS_PACKED_VERSION, (uint32_t)p->report->packed, 0, 0,
                                (uint32_t)p->info->sh_degree, 0, 0, {0}, {0}, {0}, {0}, 0, 0, 0, 0, {0}};
    header.chunk_count = (header.count + FXS_CHUNK - 1) / FXS_CHUNK;
    header.chunk_bytes = p->chunk_bytes;
    header.flags = p->info->antialiased ? FXS_PACKED_ANTIALIASED : 0;
    for (int i = 0; i < 3; i++) {
        header.low_q32[i] = (int64_t)floor(ldexp(p->report->low[i], 32));
        header.high_q32[i] = (int64_t)ceil(ldexp(p->report->high[i], 32));
        header.inner_low_q32[i] = (int64_t)floor(ldexp(p->report->inner_low[i], 32));
        header.inner_high_q32[i] = (int64_t)ceil(ldexp(p->report->inner_high[i], 32));
    }
    memcpy(scene->data, &header, sizeof header);
    p->chunks = (fxs_chunk *)(void *)((unsigned char *)scene->data + sizeof header);
    p->rows = (unsigned char *)(p->chunks + header.chunk_count);
    return 0;
}

static int pack(packer *p, fxs_packed_scene *scene)
{
    if (p->info->count == 0 || p->info->count > FXS_MAX_COUNT)
        return fxs_fail(p->message, "%llu Gaussians: expected 1 to %u", (unsigned long long)p->info->count,
                        FXS_MAX_COUNT);
    p->positions = malloc((size_t)p->info->count * sizeof *p->positions);
    if (!p->positions)
        return fxs_fail(p->message, "out of memory for %llu Gaussians", (unsigned long long)p->info->count);
    if (pass(p, 0, take_position))
        return -1;
    for (uint64_t i = p->report->read; i < p->info->count; i++)
        p->positions[i][0] = NAN;
    if (find_bounds(p) || find_order(p))
        return -1;
    if (p->report->packed == 0)
        return fxs_fail(p->message, "none of the %llu Gaussians can be drawn", (unsigned long long)p->report->read);
    if (allocate_scene(p, scene) || write_headers(p) || pass(p, 2, write_codes))
        return -1;
    return 0;
}

int fxs_pack(fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene, fxs_pack_report *report,
             fxs_progress_fn *progress, void *argument, fxs_message *message)
{
    packer p = {file, info, report, progress, argument, message, 0, 0, 0, 0, 0,
                fxs_chunk_bytes(FXS_PROFILE_DEFAULT, info->sh_degree)};
    memset(scene, 0, sizeof *scene);
    memset(report, 0, sizeof *report);
    int result = pack(&p, scene);
    free(p.positions);
    free(p.slots);
    free(p.ranges);
    if (result)
        fxs_packed_scene_free(scene);
    return result;
}

void fxs_packed_scene_free(fxs_packed_scene *scene)
{
    free(scene->allocation);
    memset(scene, 0, sizeof *scene);
}
