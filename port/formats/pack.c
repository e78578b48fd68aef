#include "pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../src/fixsplat.h"
#include "../../src/packed.h"

#define BATCH 1024
#define C0 0.28209479177387814
#define LOG2_E 1.4426950408889634
#define DROPPED UINT32_MAX
#define POSITION_LIMIT 134000000.0   /* just under 2^27 units */

typedef struct order_key {
    uint64_t morton;
    uint32_t index;                  /* in the file */
} order_key;

/* Ranges of a chunk's attributes, before its header can be written. */
typedef struct range {
    float low, high;
} range;

typedef struct chunk_ranges {
    range position[3], scale, colour[3];
    float sh[3];                     /* largest coefficient of each degree */
} chunk_ranges;

typedef struct packer {
    fxs_scene_file *file;
    const fxs_scene_file_info *info;
    fxs_pack_report *report;
    fxs_progress_fn *progress;
    void *argument;
    fxs_message *message;
    float (*positions)[3];           /* in file order; first x is NaN for a dropped Gaussian */
    uint32_t *slots;                 /* where Gaussian i of the file goes, or DROPPED */
    chunk_ranges *ranges;
    unsigned char *chunks;
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

static void take_position(packer *p, uint64_t index, const fxs_gaussian *g)
{
    p->report->read++;
    memcpy(p->positions[index], g->position, sizeof g->position);
    if (!drawable(g, p->info->sh_degree, &p->report->dropped))
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

/* ---- Ranges of each chunk -------------------------------------------------------------------------------------- */

static void widen(range *r, float x)
{
    r->low = x < r->low ? x : r->low;
    r->high = x > r->high ? x : r->high;
}

/* log2(sigma) */
static double log2_scale(const fxs_gaussian *g, int axis)
{
    return g->scale[axis] * LOG2_E;
}

static double base_colour(const fxs_gaussian *g, int channel)
{
    double colour = 0.5 + C0 * g->dc[channel];
    return colour < -60 ? -60 : colour > 60 ? 60 : colour;
}

static int degree_of(int coefficient)
{
    return coefficient < 3 ? 0 : coefficient < 8 ? 1 : 2;
}

static void take_ranges(packer *p, uint64_t index, const fxs_gaussian *g)
{
    if (p->slots[index] == DROPPED)
        return;
    chunk_ranges *r = &p->ranges[p->slots[index] / FXS_CHUNK];
    for (int i = 0; i < 3; i++) {
        widen(&r->position[i], g->position[i]);
        widen(&r->scale, (float)log2_scale(g, i));
        widen(&r->colour[i], (float)base_colour(g, i));
    }
    for (int k = 0; k < FXS_SH_COUNT(p->info->sh_degree); k++)
        for (int c = 0; c < 3; c++) {
            float *most = &r->sh[degree_of(k)];
            *most = fmaxf(*most, fabsf(g->sh[3 * k + c]));
        }
}

/* The smallest step, in units of 2^-q, with which `codes` + 1 codes reach from low over the whole range. */
static uint32_t step_for(double reach, int codes, int q)
{
    return (uint32_t)fmin(ceil(ldexp(reach, q) / codes), UINT32_MAX);
}

static void write_header(fxs_chunk *chunk, const chunk_ranges *r)
{
    double most = 0;
    memset(chunk, 0, sizeof *chunk);
    for (int i = 0; i < 3; i++)
        most = fmax(most, (double)r->position[i].high - r->position[i].low);
    while (ldexp(most, 32 - (int)chunk->step_shift) / 65535 > 4294967294.0)
        chunk->step_shift++;
    chunk->scale_q16 = (int32_t)ceil(ldexp(r->scale.high, 16));
    chunk->scale_step_q24 = step_for(ldexp(chunk->scale_q16, -16) - r->scale.low, 1023 * 1023, 24);
    for (int i = 0; i < 3; i++) {
        chunk->origin_q32[i] = (int64_t)floor(ldexp(r->position[i].low, 32));
        chunk->step_q32[i] = step_for(r->position[i].high - ldexp((double)chunk->origin_q32[i], -32), 65535,
                                      32 - (int)chunk->step_shift);
        chunk->colour_q16[i] = (int32_t)floor(ldexp(r->colour[i].low, 16));
        chunk->colour_step_q20[i] = step_for(r->colour[i].high - ldexp(chunk->colour_q16[i], -16), 255, 20);
        uint32_t step = step_for(r->sh[i], 127, 19);
        chunk->sh_step_q19[i] = step < 32767 ? step : 32767;
    }
}

static int write_headers(packer *p)
{
    uint32_t chunks = (uint32_t)((p->report->packed + FXS_CHUNK - 1) / FXS_CHUNK);
    p->ranges = malloc(chunks * sizeof *p->ranges);
    if (!p->ranges)
        return fxs_fail(p->message, "out of memory");
    const range none = {INFINITY, -INFINITY};
    for (uint32_t i = 0; i < chunks; i++)
        p->ranges[i] = (chunk_ranges){{none, none, none}, none, {none, none, none}, {0, 0, 0}};
    if (pass(p, 1, take_ranges))
        return -1;
    for (uint32_t i = 0; i < chunks; i++)
        write_header((fxs_chunk *)(void *)(p->chunks + (size_t)i * p->chunk_bytes), &p->ranges[i]);
    return 0;
}

/* ---- Codes ----------------------------------------------------------------------------------------------------- */

static void note_error(double *largest, double error)
{
    *largest = fmax(*largest, fabs(error));
}

/* round((x - low) / step) in 0..codes, and how far off that is. */
static uint32_t encode(double x, double low, double step, int codes, double *largest)
{
    double code = step > 0 ? floor((x - low) / step + 0.5) : 0;
    code = code < 0 ? 0 : code > codes ? codes : code;
    note_error(largest, low + code * step - x);
    return (uint32_t)code;
}

/* Nearest code with log2(sigma) = high - code^2 step. */
static uint32_t encode_scale(double x, double high, double step, double *largest)
{
    double code = step > 0 ? floor(sqrt(fmax(0, (high - x) / step))) : 0;
    double above = high - code * code * step - x, below = x - (high - (code + 1) * (code + 1) * step);
    code += code < 1023 && step > 0 && below < above;
    note_error(largest, high - code * code * step - x);
    return (uint32_t)fmin(code, 1023);
}

/* Smallest three: the largest component is left out, the others are in +-1/sqrt(2), 10 bits each. */
static uint32_t encode_rotation(const float rotation[4], double *largest_error)
{
    double q[4], decoded[4], norm = 0, rest = 0, dot = 0;
    int largest = 0;
    for (int i = 0; i < 4; i++) {
        norm += (double)rotation[i] * rotation[i];
        largest = fabsf(rotation[i]) > fabsf(rotation[largest]) ? i : largest;
    }
    norm = copysign(sqrt(norm), rotation[largest]);
    uint32_t word = (uint32_t)largest << 30;
    for (int i = 0, shift = 20; i < 4; i++) {
        q[i] = rotation[i] / norm;
        if (i == largest)
            continue;
        double code = floor((q[i] * 1.4142135623730951 + 1) * 511.5 + 0.5);
        code = code < 0 ? 0 : code > 1023 ? 1023 : code;
        decoded[i] = (code / 511.5 - 1) / 1.4142135623730951;
        rest += decoded[i] * decoded[i];
        word |= (uint32_t)code << shift;
        shift -= 10;
    }
    decoded[largest] = sqrt(fmax(0, 1 - rest));
    for (int i = 0; i < 4; i++)
        dot += q[i] * decoded[i];
    note_error(largest_error, 2 * acos(fmin(1, fabs(dot))) * 57.29577951308232);
    return word;
}

static uint32_t encode_colour(const fxs_gaussian *g, const fxs_chunk *chunk, fxs_pack_error *largest)
{
    double opacity = 1 / (1 + exp(-g->opacity)), colour_error = 0;
    uint32_t word = (uint32_t)floor(opacity * 255 + 0.5) << 24;
    note_error(&largest->opacity, (word >> 24) / 255.0 - opacity);
    for (int i = 0; i < 3; i++)
        word |= encode(base_colour(g, i), ldexp(chunk->colour_q16[i], -16), ldexp(chunk->colour_step_q20[i], -20), 255,
                       &colour_error) << 8 * i;
    note_error(&largest->dc, colour_error / C0);
    return word;
}

static int8_t encode_coefficient(double x, uint32_t step_q19, double *largest)
{
    double step = ldexp(step_q19, -19), code = step > 0 ? floor(x / step + 0.5) : 0;
    code = code < -127 ? -127 : code > 127 ? 127 : code;
    note_error(largest, code * step - x);
    return (int8_t)code;
}

static void write_codes(packer *p, uint64_t index, const fxs_gaussian *g)
{
    if (p->slots[index] == DROPPED)
        return;
    const uint32_t at = p->slots[index] % FXS_CHUNK;
    unsigned char *bytes = p->chunks + (size_t)(p->slots[index] / FXS_CHUNK) * p->chunk_bytes;
    const fxs_chunk *chunk = (const fxs_chunk *)(void *)bytes;
    uint16_t *position = (uint16_t *)(void *)(bytes + FXS_CHUNK_POSITION);
    uint32_t *rotation = (uint32_t *)(void *)(bytes + FXS_CHUNK_ROTATION), scale_word = 0;
    uint32_t *scale = (uint32_t *)(void *)(bytes + FXS_CHUNK_SCALE);
    uint32_t *colour = (uint32_t *)(void *)(bytes + FXS_CHUNK_COLOUR);
    int8_t *sh = (int8_t *)(bytes + FXS_CHUNK_SH);
    fxs_pack_error *largest = &p->report->largest;
    double scale_error = 0;
    for (int i = 0; i < 3; i++) {
        position[i * FXS_CHUNK + (int)at] = (uint16_t)encode(
            g->position[i], ldexp((double)chunk->origin_q32[i], -32),
            ldexp(chunk->step_q32[i], (int)chunk->step_shift - 32), 65535, &largest->position);
        scale_word |= encode_scale(log2_scale(g, i), ldexp(chunk->scale_q16, -16), ldexp(chunk->scale_step_q24, -24),
                                   &scale_error) << 10 * i;
    }
    note_error(&largest->scale, scale_error / LOG2_E);
    rotation[at] = encode_rotation(g->rotation, &largest->rotation);
    scale[at] = scale_word;
    colour[at] = encode_colour(g, chunk, largest);
    for (int k = 0; k < FXS_SH_COUNT(p->info->sh_degree); k++)
        for (int c = 0; c < 3; c++)
            sh[(3 * k + c) * FXS_CHUNK + (int)at] =
                encode_coefficient(g->sh[3 * k + c], chunk->sh_step_q19[degree_of(k)], &largest->sh);
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
    p->chunks = (unsigned char *)scene->data + sizeof header;
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
    packer p = {file, info, report, progress, argument, message, 0, 0, 0, 0, FXS_CHUNK_BYTES(info->sh_degree)};
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
