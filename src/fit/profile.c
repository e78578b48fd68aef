/* Quantises the Gaussians of a fit as a packed scene does. Orders them, and computes the headers of chunks (256
 * Gaussians) and the palette from the exact parameters. At the end packs the Gaussians with these codes. */
#include "profile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include "src/gaussian/tilt.h"
#include "src/base/os_calls.h"
#include "src/base/try_internal.h"
#include "src/pack/order.h"
#include "model.h"
#include "quantise.h"

enum { JOBS = 64 };
#define FAINT_LOGIT (-2.708f)      /* logit of opacity 1/16, below which a Gaussian is faint */
#define FOG 0.1                    /* Faint Gaussians (fog) with at least this share of the total weight are ordered
                                      separately. */

static float *plane(float *planes, const fxs_fit_model *m, int which)
{
    return planes + (size_t)which * m->stride;
}

static void take(const fxs_fit_model *m, const float *planes, size_t i, fxs_gaussian *g)
{
    float values[FXS_FIT_PARAMETERS];
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        values[k] = planes[k * m->stride + i];
    memcpy(g, values, sizeof *g);
}

static double opacity_at(float logit)
{
    return (double)(1.0f / (1.0f + exp_e(fminf(-logit, 80.0f))));
}

static double weight_of(const fxs_gaussian *g)
{
    const float *s = g->scale, least_scale = fminf(fminf(s[0], s[1]), s[2]);
    return (double)exp_e(fmaxf(fminf(s[0] + s[1] + s[2] - least_scale, 40.0f), -40.0f)) * opacity_at(g->opacity);
}

/* Lists the Gaussians for sorting, with their positions. Faint ones (fog) are marked to be ordered separately if they
   have at least the share FOG of the total weight. Returns the number of drawable Gaussians. */
static size_t set_entries(fxs_order_entry *entries, const fxs_fit_model *m, int sh_degree)
{
    double faint = 0, all = 0;
    size_t count = 0;
    for (size_t i = 0; i < m->count; i++) {
        fxs_gaussian g;
        fxs_pack_dropped dropped;
        take(m, m->parameters, i, &g);
        memcpy(entries[i].position, g.position, sizeof g.position);
        entries[i].index = g.opacity < FAINT_LOGIT;
        if (!fxs_drawable(&g, sh_degree, &dropped)) {
            entries[i].position[0] = NAN;
            continue;
        }
        const double weight = weight_of(&g);
        all += weight;
        faint += entries[i].index ? weight : 0;
        count++;
    }
    for (size_t i = 0; i < m->count && faint < FOG * all; i++)
        entries[i].index = 0;
    return count;
}

static int order(fxs_fit_model *m, int sh_degree, const fxs_pack_options *options)
{
    fxs_order_entry *entries = malloc(m->count * sizeof *entries);
    fxs_fit_origin *origins = malloc(m->count * sizeof *origins);
    int error = entries && origins ? 0 : FXS_ERR_MEMORY;
    const size_t count = error ? 0 : set_entries(entries, m, sh_degree);
    if (!error)
        error = fxs_order(entries, (uint32_t)m->count, 0, options);
    for (size_t i = 0; i < count; i++)
        origins[i] = (fxs_fit_origin){entries[i].index, FXS_FIT_KEPT};
    free(entries);
    if (!error)
        error = fxs_fit_model_rebuild(m, origins, count, options->workers.run, options->workers.pool);
    free(origins);
    return error;
}

static size_t chunks_of(const fxs_fit_profile *p)
{
    return fxs_chunks_of(p->count);
}

static uint32_t entries_of(const fxs_fit_profile *p)
{
    return fxs_palette_entries_for(p->count, chunks_of(p), p->profile, p->sh_degree);
}

static float inverse_of(double step)
{
    return step > 0 ? (float)(1 / step) : 0;
}

static double own_step(double step, int bits, int wide)
{
    return step * ((1 << wide) - 1) / ((1 << bits) - 1);
}

static void find_steps(const fxs_fit_profile *p, fxs_fit_chunk *to, const fxs_chunk *c)
{
    const double base = 0.28209479177387814, top = ldexp(1, 2 - 2 * (int)c->opacity_law) - 1 / 255.0;
    for (int i = 0; i < 3; i++) {
        const double step = (double)((uint64_t)c->step_q32[i] << c->step_shift) * 0x1p-32;
        const double colour_step = c->colour_step_q20[i] * 0x1p-20 / base, sh_step = c->sh_step_q19[i] * 0x1p-19;
        to->low[i] = (float)((double)c->origin_q32[i] * 0x1p-32);
        to->step[i] = (float)step;
        to->inverse[i] = inverse_of(own_step(step, p->grid.position_bits, 16));
        to->colour[i] = (float)((c->colour_q16[i] * 0x1p-16 - 0.5) / base);
        to->colour_step[i] = (float)colour_step;
        to->colour_inverse[i] = inverse_of(own_step(colour_step, p->grid.colour_bits[i], 9));
        to->sh_step[i] = (float)sh_step;
        to->sh_inverse[i] = inverse_of(sh_step);
    }
    to->scale = (float)(c->scale_q16 * 0x1p-16);
    to->scale_step = (float)(c->scale_step_q24 * 0x1p-24);
    to->scale_inverse = inverse_of(c->scale_step_q24 * 0x1p-24);
    to->opacity_range = c->opacity_law ? (float)top : 0;
    to->opacity_inverse = c->opacity_law ? (float)(1 / top) : 0;
}

/* Swaps axis k (0 or 1) of a Gaussian with the next axis, by a quarter turn about the remaining axis. Its quaternion is
   multiplied by the quaternion 1 + k for axis 0, or 1 + i for axis 1, and normalised. Adam's moments rotate too. */
static void swap_axes(const fxs_fit_model *m, size_t i, int k)
{
    float *planes[] = {m->masters, m->means, m->squares};
    for (int n = 0; n < 3; n++) {
        float *a = plane(planes[n], m, FXS_FIT_SCALE + k) + i, *b = plane(planes[n], m, FXS_FIT_SCALE + k + 1) + i;
        float *q[4];
        const float scale = *a, by = n < 2 ? 0.707106781f : 0.5f, minus = n < 2 ? -1 : 1;
        *a = *b;
        *b = scale;
        for (int part = 0; part < 4; part++)
            q[part] = plane(planes[n], m, FXS_FIT_ROTATION + part) + i;
        const float w = *q[0], x = *q[1], y = *q[2], z = *q[3];
        *q[0] = by * (w + minus * (k ? x : z));
        *q[1] = by * (x + (k ? w : y));
        *q[2] = by * (k ? y + z : y + minus * x);
        *q[3] = by * (k ? z + minus * y : z + w);
    }
}

static void order_axes(const fxs_fit_model *m, size_t i)
{
    const float *s = m->masters + FXS_FIT_SCALE * m->stride + i;
    for (int pass = 0; pass < 3; pass++) {
        const size_t k = pass == 1;
        if (s[k * m->stride] < s[(k + 1) * m->stride])
            swap_axes(m, i, (int)k);
    }
}

typedef struct coding {
    fxs_fit_profile *profile;
    const fxs_fit_model *model;
    fxs_sh_item *items;
} coding;

static void code_header(const coding *c, size_t chunk)
{
    const fxs_fit_profile *p = c->profile;
    const fxs_scene_file_info info = {.sh_degree = p->sh_degree};
    fxs_chunk_ranges ranges;
    fxs_ranges_clear(&ranges);
    for (size_t i = chunk * FXS_CHUNK; i < (chunk + 1) * FXS_CHUNK && i < p->count; i++) {
        fxs_gaussian g;
        if (p->palette)              /* The axes of a Gaussian may change order only with a palette. Only then does the
                                        engine (CPU or GPU) receive the exact parameters again. */
            order_axes(c->model, i);
        take(c->model, c->model->masters, i, &g);
        const double opacity = opacity_at(g.opacity);
        fxs_hold_scales(&g);
        fxs_ranges_take(&ranges, &g, opacity, p->sh_degree);
        if (c->items)
            fxs_sh_item_set(&c->items[i], &g, opacity, p->sh_degree);
    }
    fxs_encode_header(&p->chunks[chunk], &ranges, &info);
    find_steps(p, &p->steps[chunk], &p->chunks[chunk]);
}

static void headers_job(void *argument, uint32_t job)
{
    const coding *c = argument;
    for (size_t chunk = job; chunk < chunks_of(c->profile); chunk += JOBS)
        code_header(c, chunk);
}

static uint32_t record_bytes(const fxs_fit_profile *p)
{
    return fxs_sh_bytes(p->profile, p->sh_degree);
}

static void sh_job(void *argument, uint32_t job)
{
    const coding *c = argument;
    const fxs_fit_profile *p = c->profile;
    fxs_sh_loss loss = {0, 0};
    for (size_t chunk = job; chunk < chunks_of(p); chunk += JOBS) {
        const size_t first = chunk * FXS_CHUNK, left = p->count - first, count = left < FXS_CHUNK ? left : FXS_CHUNK;
        fxs_palette_code_chunk(p->palette, c->items + first, (uint32_t)count, p->chunks[chunk].sh_mean,
                               p->records + first * record_bytes(p), record_bytes(p), &loss);
        for (size_t i = first; i < first + count; i++) {
            float sh[45];
            fxs_palette_decode(p->palette, p->chunks[chunk].sh_mean, p->records + i * record_bytes(p), sh);
            for (int k = 0; k < 45; k++)
                plane(c->model->parameters, c->model, FXS_FIT_SH + k)[i] = sh[k];
        }
    }
}

static fxs_sh_item *sample_of(const coding *c, uint32_t count)
{
    fxs_sh_item *sample = calloc(fxs_palette_sample(count), sizeof *sample);
    for (uint32_t chunk = 0; sample && chunk < chunks_of(c->profile); chunk++) {
        const uint32_t at = fxs_palette_sample_at(count, chunk), first = chunk * FXS_CHUNK, left = count - first;
        if (at != FXS_NOT_SAMPLED)
            memcpy(sample + at, c->items + first, (left < FXS_CHUNK ? left : FXS_CHUNK) * sizeof *sample);
    }
    return sample;
}

static int code_sh(coding *c, const fxs_pack_options *options, fxs_message *message)
{
    fxs_palette *p = c->profile->palette;
    const uint32_t count = (uint32_t)c->profile->count;
    const int all_sampled = fxs_palette_sample(count) >= count;
    fxs_sh_item *sample = all_sampled ? c->items : sample_of(c, count);
    if (!sample)
        return fxs_fail_memory(message, "a fit", fxs_palette_sample(count) * sizeof *sample);
    const int error = p->entries ? fxs_palette_refine(p, sample, count, options, message)
                                 : fxs_palette_learn(p, entries_of(c->profile), sample, count, options, message);
    if (!all_sampled)
        free(sample);
    if (!error)
        options->workers.run(options->workers.pool, sh_job, c, JOBS);
    return error;
}

int fxs_fit_profile_code(fxs_fit_profile *p, fxs_fit_model *m, const fxs_pack_options *options, fxs_message *message)
{
    coding c = {p, m, p->palette ? malloc(p->count * sizeof *c.items) : NULL};
    if (p->palette && !c.items)
        return fxs_fail_memory(message, "a fit", p->count * sizeof *c.items);
    options->workers.run(options->workers.pool, headers_job, &c, JOBS);
    const int error = p->palette ? code_sh(&c, options, message) : 0;
    free(c.items);
    return error;
}

static void set_grid(fxs_fit_profile *p)
{
    const int small = p->profile == FXS_PROFILE_SMALL;
    p->grid = (fxs_fit_grid){small ? 11 : 16, {small ? 7 : 10, small ? 7 : 10, small ? 6 : 9},
                             FXS_ROTATION_BITS(p->profile), FXS_AXIS_BITS_LEAST(p->profile),
                             FXS_AXIS_BITS_MOST(p->profile),
                             {small ? 7 : 9, small ? 7 : 9, small ? 6 : 9},
                             p->profile == FXS_PROFILE_DEFAULT ? p->sh_degree : 0, p->steps};
}

void fxs_fit_profile_free(fxs_fit_profile *p)
{
    fxs_aligned_free(p->chunks);
    free(p->steps);
    free(p->palette);
    free(p->records);
    memset(p, 0, sizeof *p);
}

void fxs_fit_profile_end(fxs_fit_profile *p, fxs_fit_model *m)
{
    fxs_fit_profile_free(p);
    fxs_aligned_free(m->parameters);
    m->parameters = m->masters;
    m->masters = NULL;
    m->grid = NULL;
}

static void *aligned(size_t bytes)
{
    void *memory = fxs_aligned_allocate(bytes);
    return memory ? memset(memory, 0, bytes) : NULL;
}

int fxs_fit_profile_allocate(fxs_fit_profile *p, fxs_fit_model *m, enum fxs_profile which, int sh_degree)
{
    const int has_palette = fxs_palette_stages(which, sh_degree) > 0;
    const size_t bytes = FXS_FIT_PARAMETERS * m->stride * sizeof *m->masters;
    memset(p, 0, sizeof *p);
    p->profile = which;
    p->sh_degree = sh_degree;
    p->count = m->count;
    p->chunks = aligned(chunks_of(p) * sizeof *p->chunks);
    p->steps = calloc(chunks_of(p), sizeof *p->steps);
    p->palette = has_palette ? calloc(1, sizeof *p->palette) : NULL;
    p->records = has_palette ? calloc(p->count, record_bytes(p)) : NULL;
    m->masters = fxs_aligned_allocate(bytes);
    if (!m->masters || !p->chunks || !p->steps || (has_palette && (!p->palette || !p->records))) {
        fxs_aligned_free(m->masters);
        m->masters = NULL;
        fxs_fit_profile_free(p);
        return FXS_ERR_MEMORY;
    }
    if (p->palette) {
        p->palette->profile = which;
        p->palette->sh_degree = sh_degree;
    }
    set_grid(p);
    memcpy(m->masters, m->parameters, bytes);
    m->grid = &p->grid;
    return 0;
}

int fxs_fit_profile_begin(fxs_fit_profile *p, fxs_fit_model *m, int sh_degree, const fxs_pack_options *options,
                          fxs_message *message)
{
    int error = order(m, sh_degree, options);
    if (!error)
        error = fxs_fit_profile_allocate(p, m, options->profile, sh_degree);
    for (size_t i = 0; i < m->count && !error; i++)
        order_axes(m, i);
    if (error)
        return fxs_fail_memory(message, "a fit", m->count * FXS_FIT_PARAMETERS * sizeof(float));
    error = fxs_fit_profile_code(p, m, options, message);
    if (error)
        fxs_fit_profile_end(p, m);
    return error;
}

typedef struct packing {
    const fxs_fit_profile *profile;
    const fxs_fit_model *model;
} packing;

static void put_bands(const fxs_fit_profile *p, const fxs_fit_chunk *chunk, const float *sh, unsigned char *to)
{
    for (int degree = 1; degree <= p->sh_degree; degree++)
        for (int k = 3 * FXS_SH_COUNT(degree - 1); k < 3 * FXS_SH_COUNT(degree); k++) {
            whole code;
            (void)quantise_band(chunk, degree, sh[k], &code);
            to[k] = (unsigned char)code;
        }
}

static void put_record(const void *argument, uint32_t i, unsigned char record[FXS_RECORD_BYTES])
{
    const packing *of = argument;
    const fxs_fit_profile *p = of->profile;
    const fxs_fit_chunk *chunk = &p->steps[i / FXS_CHUNK];
    const fxs_encoder encoder = {p->profile, p->sh_degree};
    float values[FXS_FIT_PARAMETERS], rounded[FXS_FIT_PARAMETERS];
    whole found[FXS_FIT_SH];
    uint32_t codes[FXS_FIT_SH];
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        values[k] = of->model->masters[k * of->model->stride + i];
    quantise_shape(&p->grid, chunk, values, rounded, 1, found);
    for (int k = 0; k < FXS_FIT_SH; k++)
        codes[k] = (uint32_t)found[k];
    const uint32_t rotation = fxs_tilt_word(codes[7], codes[8], codes[9], (int32_t)codes[6], p->grid.rotation_bits);
    const fxs_row_codes all = {{codes[0], codes[1], codes[2]}, {codes[3], codes[4], codes[5]},
                           rotation ? rotation : codes[10] ? 0 : FXS_NOT_EMPTY, {codes[11], codes[12], codes[13]},
                           codes[10]};
    unsigned char *sh = fxs_put_codes(&encoder, &all, record);
    if (p->palette)
        memcpy(sh, p->records + (size_t)i * record_bytes(p), record_bytes(p));
    else
        put_bands(p, chunk, values + FXS_FIT_SH, sh);
}

int fxs_fit_profile_pack(const fxs_fit_profile *p, const fxs_fit_model *m, const fxs_gaussian_source *gaussians,
                         fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                         fxs_message *message)
{
    const packing of = {p, m};
    const fxs_coded coded = {p->chunks, p->palette, put_record, &of};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    memset(scene, 0, sizeof *scene);
    FXS_TRY(fxs_scene_file_open_gaussians("fit", gaussians, NULL, &file, &info, message));
    const int error = fxs_pack_coded(file, &info, p->chunks ? &coded : NULL, scene, report, options, message);
    fxs_scene_file_close(file);
    return error;
}

/* Converts headers and palette between this processor's byte order and little-endian. */
static void turn(fxs_fit_profile *p)
{
    fxs_palette *palette = p->palette;
    for (size_t chunk = 0; chunk < chunks_of(p); chunk++)
        fxs_chunk_turn(&p->chunks[chunk]);
    if (!palette)
        return;
    fxs_little_endian(palette, 0, offsetof(fxs_palette, vectors) / 4, 4);
    fxs_little_endian(palette->vectors, 0, sizeof palette->vectors / 2, 2);
    fxs_little_endian(palette->squares, 0, sizeof palette->squares / 4, 4);
    fxs_little_endian(palette->groups, 0, sizeof palette->groups / 2, 2);
    fxs_little_endian(palette->group_squares, 0, sizeof palette->group_squares / 4, 4);
}

int fxs_fit_profile_walk(fxs_fit_profile *p, fxs_fit_model *m, fxs_fit_visit_fn *masters, fxs_fit_visit_fn *others,
                         void *argument)
{
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        FXS_TRY(masters(argument, m->masters + k * m->stride, m->count * sizeof *m->masters));
    turn(p);
    int error = others(argument, p->chunks, chunks_of(p) * sizeof *p->chunks);
    if (!error && p->palette)
        error = others(argument, p->palette, sizeof *p->palette);
    if (!error && p->palette)
        error = others(argument, p->records, p->count * record_bytes(p));
    turn(p);
    return error;
}

int fxs_fit_profile_restore(fxs_fit_profile *p, fxs_fit_model *m)
{
    if (p->palette && !(p->palette->profile == p->profile && p->palette->sh_degree == p->sh_degree &&
                        fxs_palette_restore(p->palette, entries_of(p))))
        return FXS_ERR_FILE;
    for (size_t chunk = 0; chunk < chunks_of(p); chunk++) {
        if (!fxs_chunk_valid(&p->chunks[chunk]))
            return FXS_ERR_FILE;
        find_steps(p, &p->steps[chunk], &p->chunks[chunk]);
    }
    m->grid = &p->grid;
    return 0;
}
