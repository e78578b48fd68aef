/* Makes a step of the fit on the CPU. Sums have a fixed order, so results do not depend on the number of threads. The
 * stage `bin` sorts the visible splats by depth (radix sort, 3 digits of 11 bits) and appends them to the tiles'
 * lists. */
#include "stepper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "src/fit/stages/exposure.h"
#include "src/fit/stages/pose.h"
#include "src/fit/stages/fit_surface.h"

enum { JOB = 4096 };               /* number of Gaussians in a job for the thread pool */
enum { PROJECT, BIN, BLEND, LOSS, BACK, UPDATE };

typedef struct block {
    void *memory;
    size_t bytes;
} block;

struct fxs_fit_stepper {
    const fxs_fit_stages *stages;
    fxs_run_fn *run;
    void *pool;
    uint32_t threads;
    fxs_clock_fn *clock;
    block splats, jobs, keys, counts, histograms, tiles, entries, sums, planes, rows, reduced, reduced_mask, gathered,
        by_pose, by_surface;

    fxs_fit_model *model;
    const fxs_fit_camera *camera;
    const fxs_fit_step_options *options;
    const uint8_t *photograph;     /* pixels of the photograph at the camera's size */
    const uint8_t *errors_of;
    const uint8_t *mask;           /* mask of the photograph at the camera's size, or null */
    float *errors, *weights;
    fxs_fit_camera posed[FXS_FIT_BATCH];
    const fxs_fit_camera *cameras[FXS_FIT_BATCH];
    uint32_t batch, view;
    float factors[FXS_FIT_GAIN];
    float by_gain[FXS_FIT_BATCH][FXS_FIT_GAIN];
    fxs_fit_adam adam;
    fxs_fit_loss loss[3];
    int plane_count;
    uint32_t tile_count, visible;
    size_t entry_count;
    int digit;
};

static void *room(block *b, size_t bytes)
{
    if (bytes > b->bytes) {
        fxs_aligned_free(b->memory);
        b->bytes = 0;
        b->memory = fxs_aligned_allocate(bytes + bytes / 4);
        if (!b->memory)
            return NULL;
        b->bytes = bytes + bytes / 4;
    }
    return b->memory;
}

fxs_fit_stepper *fxs_fit_stepper_create(const fxs_fit_stages *stages, fxs_run_fn *run, void *pool, uint32_t threads,
                                  fxs_clock_fn *clock)
{
    fxs_fit_stepper *s = calloc(1, sizeof *s);
    if (s) {
        s->stages = stages;
        s->run = run;
        s->pool = pool;
        s->threads = run && threads ? threads : 1;
        s->clock = clock;
    }
    return s;
}

void fxs_fit_stepper_free(fxs_fit_stepper *s)
{
    if (!s)
        return;
    block *blocks[] = {&s->splats, &s->jobs, &s->keys, &s->counts, &s->histograms, &s->tiles, &s->entries, &s->sums,
                       &s->planes, &s->rows, &s->reduced, &s->reduced_mask, &s->gathered, &s->by_pose,
                       &s->by_surface};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_aligned_free(blocks[i]->memory);
    free(s);
}

typedef void job_fn(void *step, uint32_t i);

static void run(fxs_fit_stepper *s, job_fn *job, uint32_t jobs)
{
    if (s->run && jobs > 1)
        s->run(s->pool, job, s, jobs);
    else
        for (uint32_t i = 0; i < jobs; i++)
            job(s, i);
}

static uint32_t gaussian_jobs(const fxs_fit_stepper *s)
{
    return (uint32_t)((s->model->stride + JOB - 1) / JOB);
}

static size_t job_count(const fxs_fit_stepper *s, uint32_t job)
{
    const size_t left = s->model->stride - (size_t)job * JOB;
    return left < JOB ? left : JOB;
}

/* Numbers of visible splats and of tile list entries, first of each job, later summed over all jobs before it. */
typedef struct seen {
    uint32_t splats;
    size_t entries;
} seen;

static size_t job_end(const fxs_fit_stepper *s, uint32_t job)
{
    const size_t first = (size_t)job * JOB, end = first + job_count(s, job);
    return s->model->count < first ? first : s->model->count < end ? s->model->count : end;
}

static void project_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    fxs_fit_splat *splats = s->splats.memory;
    seen *found = (seen *)s->jobs.memory + job;
    s->stages->project(s->camera, s->options->sh_degree, s->model->parameters, s->model->stride, (size_t)job * JOB,
                       job_count(s, job), splats);
    for (size_t i = job_end(s, job); i < (size_t)job * JOB + job_count(s, job); i++)
        splats[i].depth = 0;
    *found = (seen){0, 0};
    for (size_t i = (size_t)job * JOB; i < job_end(s, job); i++)
        if (splats[i].depth > 0) {
            found->splats++;
            found->entries += (size_t)splats[i].tiles;
        }
}

typedef struct key {
    uint32_t depth, splat, slot, tiles;
} key;

enum { DIGITS = 3, DIGIT_BITS = 11, DIGIT_VALUES = 1 << DIGIT_BITS };

static uint32_t range_start(const fxs_fit_stepper *s, uint32_t range)
{
    return (uint32_t)((uint64_t)s->visible * range / s->threads);
}

static void add_jobs(fxs_fit_stepper *s)
{
    seen *found = s->jobs.memory;
    s->visible = 0;
    s->entry_count = 0;
    for (uint32_t job = 0; job < gaussian_jobs(s); job++) {
        const seen own = found[job];
        found[job] = (seen){s->visible, s->entry_count};
        s->visible += own.splats;
        s->entry_count += own.entries;
    }
}

/* Writes the sort keys of visible splats, and the tiles that they touch. Depths are positive floats, so their bits sort
   as integers. */
static void cover_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    fxs_fit_splat *splats = s->splats.memory;
    seen before = ((const seen *)s->jobs.memory)[job];
    key *keys = s->keys.memory;
    for (size_t i = (size_t)job * JOB; i < job_end(s, job); i++)
        if (splats[i].depth > 0) {
            key *k = &keys[before.splats++];
            memcpy(&k->depth, &splats[i].depth, sizeof k->depth);
            k->splat = (uint32_t)i;
            k->slot = splats[i].slot = (uint32_t)before.entries;
            k->tiles = (uint32_t)splats[i].tiles;
            before.entries += k->tiles;
        }
    s->stages->cover(s->camera, splats, (size_t)job * JOB, job_count(s, job), s->tiles.memory);
}

static const key *keys_from(const fxs_fit_stepper *s)
{
    return (const key *)s->keys.memory + (size_t)(s->digit % 2) * s->model->stride;
}

static uint32_t digit_of(const fxs_fit_stepper *s, const key *k)
{
    return k->depth >> s->digit * DIGIT_BITS & (DIGIT_VALUES - 1);
}

static void count_digits_job(void *argument, uint32_t range)
{
    const fxs_fit_stepper *s = argument;
    uint32_t *counts = (uint32_t *)s->histograms.memory + (size_t)range * DIGIT_VALUES;
    const key *keys = keys_from(s);
    memset(counts, 0, DIGIT_VALUES * sizeof *counts);
    for (uint32_t k = range_start(s, range); k < range_start(s, range + 1); k++)
        counts[digit_of(s, &keys[k])]++;
}

static void move_digits_job(void *argument, uint32_t range)
{
    const fxs_fit_stepper *s = argument;
    uint32_t *starts = (uint32_t *)s->histograms.memory + (size_t)range * DIGIT_VALUES;
    const key *keys = keys_from(s);
    key *to = (key *)s->keys.memory + (size_t)((s->digit + 1) % 2) * s->model->stride;
    for (uint32_t k = range_start(s, range); k < range_start(s, range + 1); k++)
        to[starts[digit_of(s, &keys[k])]++] = keys[k];
}

/* Prepares a counting sort by a digit or a tile, with a range of keys for each thread. Replaces the count of each value
   in each range by the place of its first key. Keys go by value, then by range. */
static void add_ranges(fxs_fit_stepper *s, size_t values, uint32_t *starts)
{
    uint32_t *counts = s->histograms.memory, sum = 0;
    for (size_t v = 0; v < values; v++) {
        if (starts)
            starts[v] = sum;
        for (uint32_t range = 0; range < s->threads; range++) {
            const uint32_t own = counts[range * values + v];
            counts[range * values + v] = sum;
            sum += own;
        }
    }
    if (starts)
        starts[values] = sum;
}

/* Sorts splats by depth, by a stable radix sort. The result is in the second half of `keys`. */
static void sort_keys(fxs_fit_stepper *s)
{
    for (s->digit = 0; s->digit < DIGITS; s->digit++) {
        run(s, count_digits_job, s->threads);
        add_ranges(s, DIGIT_VALUES, NULL);
        run(s, move_digits_job, s->threads);
    }
}

enum { AHEAD = 8 };
static void prefetch_tiles(const fxs_fit_stepper *s, const key *keys, uint32_t k)
{
    const key *later = &keys[k + AHEAD < s->visible ? k + AHEAD : k];
    __builtin_prefetch((const uint32_t *)s->tiles.memory + later->slot);
}

static void count_entries_job(void *argument, uint32_t range)
{
    const fxs_fit_stepper *s = argument;
    const key *keys = keys_from(s);
    uint32_t *counts = (uint32_t *)s->histograms.memory + (size_t)range * s->tile_count;
    memset(counts, 0, s->tile_count * sizeof *counts);
    for (uint32_t k = range_start(s, range); k < range_start(s, range + 1); k++) {
        const uint32_t *tiles = (const uint32_t *)s->tiles.memory + keys[k].slot;
        prefetch_tiles(s, keys, k);
        for (uint32_t i = 0; i < keys[k].tiles; i++)
            counts[tiles[i]]++;
    }
}

static void fill_entries_job(void *argument, uint32_t range)
{
    const fxs_fit_stepper *s = argument;
    const key *keys = keys_from(s);
    uint32_t *starts = (uint32_t *)s->histograms.memory + (size_t)range * s->tile_count;
    fxs_fit_entry *entries = s->entries.memory;
    for (uint32_t k = range_start(s, range); k < range_start(s, range + 1); k++) {
        const uint32_t *tiles = (const uint32_t *)s->tiles.memory + keys[k].slot;
        prefetch_tiles(s, keys, k);
        for (uint32_t i = 0; i < keys[k].tiles; i++)
            entries[starts[tiles[i]]++] = (fxs_fit_entry){keys[k].splat, keys[k].slot + i, 0};
    }
}

/* Allocates memory for the tiles' splat lists. `counts` holds the start of each tile's list, then the number of its
   entries up to the last that changes a pixel. */
static int make_room(fxs_fit_stepper *s)
{
    const size_t values = s->tile_count > DIGIT_VALUES ? s->tile_count : DIGIT_VALUES, entries = s->entry_count + 1;
    return s->entry_count < UINT32_MAX && room(&s->keys, 2 * s->model->stride * sizeof(key)) &&
                   room(&s->counts, (2 * (size_t)s->tile_count + 1) * sizeof(uint32_t)) &&
                   room(&s->histograms, s->threads * values * sizeof(uint32_t)) &&
                   room(&s->tiles, entries * sizeof(uint32_t)) &&
                   room(&s->entries, entries * sizeof(fxs_fit_entry))
               ? 0
               : FXS_ERR_MEMORY;
}

static int bin(fxs_fit_stepper *s)
{
    add_jobs(s);
    if (make_room(s))
        return FXS_ERR_MEMORY;
    run(s, cover_job, gaussian_jobs(s));
    sort_keys(s);
    run(s, count_entries_job, s->threads);
    add_ranges(s, s->tile_count, s->counts.memory);
    run(s, fill_entries_job, s->threads);
    return 0;
}

static void tile_place(const fxs_fit_stepper *s, uint32_t tile, int32_t *left, int32_t *top)
{
    *left = (int32_t)(tile % (uint32_t)s->camera->tiles_x) * FXS_FIT_TILE;
    *top = (int32_t)(tile / (uint32_t)s->camera->tiles_x) * FXS_FIT_TILE;
}

static int32_t least_of(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* Returns the initial transmittance of pixels: 1 in a fitting step. Other pictures start with 16, so that more splats
   count before a pixel is opaque. */
static float light_of(const fxs_fit_stepper *s)
{
    return s->photograph ? 1 : 16;
}

static int has_exposure(const fxs_fit_stepper *s)
{
    return s->photograph && s->model->gains;
}

static void expose(const fxs_fit_stepper *s, int32_t left, int32_t top, int32_t columns, int32_t rows)
{
    for (int32_t y = top; y < top + rows; y++)
        for (int32_t x = left; x < left + columns; x++) {
            float *to[3], colour[3];
            for (int c = 0; c < 3; c++) {
                to[c] = s->loss[c].picture.first + y * s->loss[c].picture.stride + x;
                colour[c] = *to[c];
            }
            for (int c = 0; c < 3; c++)
                *to[c] = exposed(s->factors, colour, c);
        }
}

static void put_tile(const fxs_fit_stepper *s, uint32_t tile, const fxs_fit_tile *pixels)
{
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    const int32_t columns = least_of(FXS_FIT_TILE, s->camera->width - left);
    const int32_t rows = least_of(FXS_FIT_TILE, s->camera->height - top);
    const float share = 1 / light_of(s);
    for (int c = 0; c < 3; c++)
        for (int32_t y = 0; y < rows; y++) {
            float *to = s->loss[c].picture.first + (top + y) * s->loss[c].picture.stride + left;
            for (int32_t x = 0; x < columns; x++) {
                const int at = FXS_FIT_AT(x, y);
                to[x] = (pixels->colour[c][at] + pixels->transmittance[at] * s->options->background[c]) * share;
            }
        }
    if (has_exposure(s))
        expose(s, left, top, columns, rows);
}

static void blend_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    uint32_t *starts = s->counts.memory, *needed = starts + s->tile_count + 1;
    fxs_fit_tile pixels;
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    needed[tile] = s->stages->blend(s->splats.memory, (fxs_fit_entry *)s->entries.memory + starts[tile],
                                    starts[tile + 1] - starts[tile], left, top, light_of(s), &pixels);
    put_tile(s, tile, &pixels);
}

enum { PLANES = 1 + FXS_FIT_ROWS + FXS_FIT_DERIVATIVES, ROWS_A_JOB = 16 };

/* Allocates the planes of pixels for picture, loss and gradient, with margins of zeros. The gradient reuses a plane of
   row sums. */
static int make_planes(fxs_fit_stepper *s)
{
    const int32_t width = s->camera->width, height = s->camera->height;
    const ptrdiff_t stride = (width + 2 * FXS_FIT_MARGIN + FXS_FIT_TILE + 15) & ~15;
    const ptrdiff_t size = stride * (height + 2 * FXS_FIT_MARGIN);
    const int count = s->photograph ? PLANES : 1;
    const size_t bytes = 3 * (size_t)count * (size_t)size * sizeof(float);
    const int is_new = s->loss[0].width != width || s->loss[0].height != height || s->plane_count != count;
    float *rows = room(&s->rows, (6 + FXS_FIT_GAIN) * (size_t)height * sizeof *rows), *first = room(&s->planes, bytes);
    s->loss[0].width = 0;
    s->plane_count = count;
    if (!first || !rows)
        return FXS_ERR_MEMORY;
    if (is_new)
        memset(first, 0, bytes);
    first += FXS_FIT_MARGIN * stride + FXS_FIT_MARGIN;
    for (int c = 0; c < 3; c++) {
        fxs_fit_plane planes[PLANES] = {{0}};
        fxs_fit_loss *l = &s->loss[c];
        for (int i = 0; i < count; i++, first += size)
            planes[i] = (fxs_fit_plane){first, stride};
        l->picture = planes[0];
        memcpy(l->rows, planes + 1, sizeof l->rows);
        memcpy(l->derivatives, planes + 1 + FXS_FIT_ROWS, sizeof l->derivatives);
        l->gradient = l->rows[FXS_FIT_DERIVATIVES];
        l->absolute = rows + 2 * c * height;
        l->dissimilar = l->absolute + height;
        l->width = width;
        l->height = height;
        l->step = 3;
        l->pitch = 3 * width;
        l->photograph = s->photograph ? s->photograph + c : NULL;
        l->mask = s->photograph ? s->mask : NULL;
        l->has_exposure = has_exposure(s);
    }
    return 0;
}

static void for_rows(const fxs_fit_stepper *s, uint32_t job, void (*work)(const fxs_fit_loss *, int32_t))
{
    const int32_t jobs = (s->camera->height + ROWS_A_JOB - 1) / ROWS_A_JOB, first = (int32_t)job % jobs * ROWS_A_JOB;
    const int32_t end = least_of(first + ROWS_A_JOB, s->camera->height);
    for (int32_t row = first; row < end; row++)
        work(&s->loss[(int32_t)job / jobs], row);
}

static void rows_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    for_rows(s, job, s->stages->loss_rows);
}

static void derivatives_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    for_rows(s, job, s->stages->loss_derivatives);
}

static void backward_rows_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    for_rows(s, job, s->stages->loss_backward_rows);
}

static void gradient_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    for_rows(s, job, s->stages->loss_gradient);
}

static void find_loss(fxs_fit_stepper *s)
{
    const uint32_t jobs = 3 * (uint32_t)((s->camera->height + ROWS_A_JOB - 1) / ROWS_A_JOB);
    run(s, rows_job, jobs);
    run(s, derivatives_job, jobs);
    run(s, backward_rows_job, jobs);
    run(s, gradient_job, jobs);
}

void fxs_fit_add_loss(const float *rows, const fxs_fit_camera *camera, uint32_t batch, fxs_fit_report *report)
{
    const double values = 3.0 * camera->width * camera->height * batch;
    for (int c = 0; c < 3; c++, rows += 2 * camera->height)
        for (int32_t y = 0; y < camera->height; y++) {
            report->absolute += (double)rows[y] / values;
            report->dissimilar += (double)rows[camera->height + y] / values;
        }
}

static void pass_exposure(const fxs_fit_stepper *s, fxs_fit_tile_gradient *g)
{
    for (int i = 0; i < FXS_FIT_PIXELS; i++) {
        const float gradient[3] = {g->colour[0][i], g->colour[1][i], g->colour[2][i]};
        for (int c = 0; c < 3; c++)
            g->colour[c][i] = gradient_before(s->factors, gradient, c);
    }
}

static void take_gradient(const fxs_fit_stepper *s, uint32_t tile, fxs_fit_tile_gradient *g)
{
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    const int32_t columns = least_of(FXS_FIT_TILE, s->camera->width - left);
    const int32_t rows = least_of(FXS_FIT_TILE, s->camera->height - top);
    memset(g, 0, sizeof *g);
    for (int c = 0; c < 3; c++)
        for (int32_t y = 0; y < rows; y++) {
            const fxs_fit_loss *l = &s->loss[c];
            const float *from = l->gradient.first + (top + y) * l->gradient.stride + left;
            const float *picture = l->picture.first + (top + y) * l->picture.stride + left;
            const float constant = has_exposure(s) ? s->factors[9 + c] : 0;
            for (int32_t x = 0; x < columns; x++) {
                g->colour[c][FXS_FIT_AT(x, y)] = from[x];
                g->whole[FXS_FIT_AT(x, y)] += from[x] * (picture[x] - constant);
            }
        }
    if (has_exposure(s))
        pass_exposure(s, g);
}

static void pass_back(const fxs_fit_stepper *s, uint32_t tile, const fxs_fit_tile_gradient *g)
{
    const uint32_t *starts = s->counts.memory, needed = starts[s->tile_count + 1 + tile];
    const fxs_fit_entry *entries = (const fxs_fit_entry *)s->entries.memory + starts[tile];
    float (*sums)[FXS_FIT_SUMS] = s->sums.memory;
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    s->stages->backward(s->splats.memory, entries, needed, left, top, g, sums);
    for (uint32_t e = needed; e < starts[tile + 1] - starts[tile]; e++)
        memset(sums[entries[e].slot], 0, sizeof *sums);
}

static void backward_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    fxs_fit_tile_gradient g;
    take_gradient(s, tile, &g);
    pass_back(s, tile, &g);
}

/* Sums the gradients of Gaussians over their tiles. Adds `views` to the number of views that saw them. */
static void gather(const fxs_fit_stepper *s, size_t first, size_t count, float (*out)[FXS_FIT_PART], float views)
{
    const fxs_fit_splat *splats = (const fxs_fit_splat *)s->splats.memory + first;
    for (size_t i = 0; i < count; i++) {
        float total[FXS_FIT_SUMS] = {0};
        if (splats[i].depth > 0) {
            const float (*sums)[FXS_FIT_SUMS] = (const float(*)[FXS_FIT_SUMS])s->sums.memory + splats[i].slot;
            for (uint32_t t = 0; t < (uint32_t)splats[i].tiles; t++)
                for (int k = 0; k < FXS_FIT_SUMS; k++)
                    total[k] += sums[t][k];
            s->model->views[first + i] += views;
        }
        for (int k = 0; k < FXS_FIT_SUMS; k++)
            out[k][i] = total[k];
    }
}

static float *gathered_of(const fxs_fit_stepper *s, uint32_t view, int sum)
{
    return (float *)s->gathered.memory + (view * FXS_FIT_SUMS + (size_t)sum) * s->model->stride;
}

static float *surface_sums_of(const fxs_fit_stepper *s, uint32_t view)
{
    return s->options->by_surface > 0 ? (float *)s->by_surface.memory + 3 * view * s->model->stride : NULL;
}

/* Returns true if the gradient sums of a view are gathered before a later pass over tiles overwrites them. */
static int is_gathered(const fxs_fit_stepper *s)
{
    return s->batch > 1 || s->options->by_surface > 0;
}

static size_t changed_end(const fxs_fit_stepper *s, uint32_t job)
{
    const size_t end = (size_t)job * JOB + job_count(s, job);
    const size_t changed = s->options->changed / FXS_FIT_GROUP * FXS_FIT_GROUP;
    return s->options->changed && changed < end ? changed : end;
}

static void gather_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    const size_t end = changed_end(s, job);
    for (size_t first = (size_t)job * JOB; first < end; first += FXS_FIT_PART) {
        float sums[FXS_FIT_SUMS][FXS_FIT_PART];
        const size_t count = end - first < FXS_FIT_PART ? end - first : FXS_FIT_PART;
        gather(s, first, count, sums, 1);
        for (int k = 0; k < FXS_FIT_SUMS; k++)
            memcpy(gathered_of(s, s->view, k) + first, sums[k], count * sizeof(float));
    }
}

static void take_gathered(const fxs_fit_stepper *s, size_t first, size_t count,
                          float (*out)[FXS_FIT_SUMS][FXS_FIT_PART])
{
    for (uint32_t v = 0; v < s->batch; v++)
        for (int k = 0; k < FXS_FIT_SUMS; k++)
            memcpy(out[v][k], gathered_of(s, v, k) + first, count * sizeof(float));
}

static int moves_poses(const fxs_fit_stepper *s)
{
    return s->model->poses && s->options->pose_rate > 0;
}

static size_t part_count(const fxs_fit_stepper *s)
{
    return (s->model->stride + FXS_FIT_PART - 1) / FXS_FIT_PART;
}

static float *by_pose_of(const fxs_fit_stepper *s, uint32_t view, int k)
{
    return (float *)s->by_pose.memory + (view * FXS_FIT_POSE + (size_t)k) * part_count(s);
}

static void pass_to_poses(const fxs_fit_stepper *s, size_t first, size_t count,
                          float (*sums)[FXS_FIT_SUMS][FXS_FIT_PART])
{
    float out[FXS_FIT_POSE];
    for (uint32_t v = 0; v < s->batch; v++) {
        s->stages->pose(s->cameras[v], s->options->sh_degree, s->model->parameters, s->model->stride, first, count,
                        sums[v][0], out);
        for (int k = 0; k < FXS_FIT_POSE; k++)
            by_pose_of(s, v, k)[first / FXS_FIT_PART] = out[k];
    }
}

static void update_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    const fxs_fit_model *m = s->model;
    float *masters = m->masters ? m->masters : m->parameters;
    const size_t end = changed_end(s, job);
    for (size_t first = (size_t)job * JOB; first < end; first += FXS_FIT_PART) {
        float sums[FXS_FIT_BATCH][FXS_FIT_SUMS][FXS_FIT_PART];
        const size_t count = end - first < FXS_FIT_PART ? end - first : FXS_FIT_PART;
        if (is_gathered(s))
            take_gathered(s, first, count, sums);
        else
            gather(s, first, count, sums[0], 1);
        if (moves_poses(s))
            pass_to_poses(s, first, count, sums);
        s->stages->update(s->cameras, s->batch, s->options->sh_degree, &s->adam, m->parameters, masters, m->means,
                          m->squares, m->stride, first, count, sums[0][0], surface_sums_of(s, 0), m->by_centre);
        if (s->options->noise.amount > 0)
            s->stages->noise(&s->options->noise, masters, m->stride, first, count);
        if (m->cameras && s->options->smooths)
            s->stages->smooth(m->cameras, s->options->smooths, masters, m->stride, first, count);
        if (m->masters)
            s->stages->quantise(m->grid, masters, m->parameters, m->stride, first, count);
    }
}

static void quantise_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    const fxs_fit_model *m = s->model;
    s->stages->quantise(m->grid, m->masters, m->parameters, m->stride, (size_t)job * JOB, job_count(s, job));
}

void fxs_fit_quantise(fxs_fit_stepper *s, fxs_fit_model *model)
{
    s->model = model;
    run(s, quantise_job, gaussian_jobs(s));
}

void fxs_fit_set_adam(fxs_fit_adam *adam, const fxs_fit_step_options *options, const fxs_fit_photograph *photographs,
                      uint32_t batch, size_t gaussians)
{
    double beta1 = 1, beta2 = 1;
    float numbers = 0;
    for (uint32_t i = 0; i < options->number && (beta1 > 1e-20 || beta2 > 1e-12); i++) {
        beta1 *= 0.9;
        beta2 *= 0.999;
    }
    for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
        adam->rate[i] = (float)(options->rate[i] / (1 - beta1));
    for (uint32_t v = 0; v < batch; v++)
        numbers += 3 * (float)photographs[v].camera.width * (float)photographs[v].camera.height;
    adam->correction = (float)(1 / (1 - beta2));
    adam->epsilon = 1e-15f * numbers;
    adam->is_depth = options->is_depth;
    adam->far = options->far;
    adam->by_opacity = options->by_opacity * numbers / (float)gaussians;
    adam->by_scale = options->by_scale * numbers / (3 * (float)gaussians);
    adam->by_flat = options->by_flat * numbers / (float)gaussians;
}

static float sum_numbers(const float *numbers, size_t step, size_t count, double divisor)
{
    double parts[GAIN_PARTS];
    for (size_t i = 0; i < GAIN_PARTS; i++)
        parts[i] = gain_part(numbers, step, count, i);
    return gain_sum(parts, divisor);
}

/* Returns the summand of sum k for a pixel. Sums of an affine exposure are of the gradient, others of picture and
   photograph. */
static float gain_number(const fxs_fit_stepper *s, int k, int32_t row, int32_t x)
{
    const fxs_fit_loss *l = &s->loss[k % 3];
    const ptrdiff_t at = row * l->picture.stride + x, pixel = (ptrdiff_t)row * l->width + x;
    if (s->model->gains->is_affine)
        return k < 9 ? l->gradient.first[at] * s->loss[k / 3].picture.first[at] : l->gradient.first[at];
    if (l->mask && !l->mask[pixel])
        return 0;
    return gain_summand(k, l->picture.first[at], (float)l->photograph[pixel * l->step] / 255.0f);
}

static void gain_rows_job(void *argument, uint32_t row)
{
    const fxs_fit_stepper *s = argument;
    const int32_t height = s->camera->height;
    float *out = (float *)s->rows.memory + 6 * height + row;
    for (int k = 0; k < FXS_FIT_GAIN; k++, out += height) {
        float sums[16] = {0};
        const int32_t width = gain_needs(s->model->gains->is_affine, k) ? s->camera->width : 0;
        for (int32_t x = 0; x < width; x++)
            sums[x % 16] += gain_number(s, k, (int32_t)row, x);
        for (int half = 8; half; half /= 2)
            for (int i = 0; i < half; i++)
                sums[i] += sums[i + half];
        *out = sums[0];
    }
}

void fxs_fit_sum_gains(const float *rows, const fxs_fit_camera *camera, float by_gain[FXS_FIT_GAIN])
{
    const double values = 3.0 * camera->width * camera->height;
    const size_t height = (size_t)camera->height;
    for (size_t k = 0; k < FXS_FIT_GAIN; k++)
        by_gain[k] = sum_numbers(rows + k * height, 1, height, values);
}

static void sum_by_gain(fxs_fit_stepper *s)
{
    run(s, gain_rows_job, (uint32_t)s->camera->height);
    fxs_fit_sum_gains((const float *)s->rows.memory + 6 * s->camera->height, s->camera, s->by_gain[s->view]);
}

void fxs_fit_move_gains(const fxs_fit_gains *gains, const fxs_fit_photograph *photographs, uint32_t batch,
                        float (*by_gain)[FXS_FIT_GAIN], const fxs_fit_step_options *options)
{
    float moved[FXS_FIT_GAIN][FXS_FIT_BASIS] = {{0}};
    for (uint32_t v = 0; v < batch; v++)
        gain_step(&gains->of[photographs[v].number], gains->is_affine, by_gain[v], options->gain_rate,
                  options->gain_decay, moved);
    for (uint32_t i = 0; i < gains->count; i++)
        gain_project(&gains->of[i], gains->is_affine, moved);
}

void fxs_fit_move_pose(const fxs_fit_poses *poses, const fxs_fit_photograph *photograph, const float *parts,
                       size_t count, float rate)
{
    const double values = 3.0 * photograph->camera.width * photograph->camera.height;
    float sums[FXS_FIT_POSE];
    for (size_t k = 0; k < FXS_FIT_POSE; k++)
        sums[k] = sum_numbers(parts + k * count, 1, count, values);
    pose_step(&poses->of[photograph->number], &photograph->camera, sums, rate);
}

static uint64_t now(const fxs_fit_stepper *s)
{
    return s->clock ? s->clock(NULL) : 0;
}

static int draw(fxs_fit_stepper *s, fxs_fit_report *report)
{
    s->tile_count = (uint32_t)(s->camera->tiles_x * s->camera->tiles_y);
    if (!room(&s->splats, s->model->stride * sizeof(fxs_fit_splat)) ||
        !room(&s->jobs, gaussian_jobs(s) * sizeof(seen)) || make_planes(s))
        return FXS_ERR_MEMORY;
    const uint64_t start = now(s);
    run(s, project_job, gaussian_jobs(s));
    const uint64_t projected = now(s);
    if (bin(s))
        return FXS_ERR_MEMORY;
    const uint64_t binned = now(s);
    run(s, blend_job, s->tile_count);
    report->nanoseconds[PROJECT] += projected - start;
    report->nanoseconds[BIN] += binned - projected;
    report->nanoseconds[BLEND] += now(s) - binned;
    report->entries += s->entry_count;
    report->visible += s->visible;
    return 0;
}

int fxs_fit_draw(fxs_fit_stepper *s, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3])
{
    fxs_fit_report report = {0};
    fxs_fit_model copy = *model;
    s->model = &copy;
    s->camera = camera;
    s->options = options;
    s->photograph = NULL;
    const int error = draw(s, &report);
    for (int c = 0; c < 3; c++)
        planes[c] = s->loss[c].picture;
    return error;
}

/* Sets a tile's pixel gradients to squared colour differences from the photograph, in red, and to 1 in green. The
   backward pass then distributes them over splats by their blending weights. Pixels that the mask ignores have 0. */
static void take_error(const fxs_fit_stepper *s, uint32_t tile, fxs_fit_tile_gradient *g)
{
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    const int32_t columns = least_of(FXS_FIT_TILE, s->camera->width - left);
    const int32_t rows = least_of(FXS_FIT_TILE, s->camera->height - top);
    memset(g, 0, sizeof *g);
    for (int32_t y = 0; y < rows; y++)
        for (int32_t x = 0; x < 3 * columns; x++) {
            const fxs_fit_plane *picture = &s->loss[x % 3].picture;
            const ptrdiff_t row = top + y, column = left + x / 3;
            if (s->mask && !s->mask[row * s->camera->width + column])
                continue;
            const float a = picture->first[row * picture->stride + column];
            const float b = (float)s->errors_of[3 * (row * s->camera->width + column) + x % 3] * (1 / 255.0f);
            g->colour[0][FXS_FIT_AT(x / 3, y)] += (a - b) * (a - b);
            g->colour[1][FXS_FIT_AT(x / 3, y)] = 1;
        }
}

static void error_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    fxs_fit_tile_gradient g;
    take_error(s, tile, &g);
    pass_back(s, tile, &g);
}

static void gather_error_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    const size_t end = (size_t)job * JOB + job_count(s, job);
    for (size_t first = (size_t)job * JOB; first < end; first += FXS_FIT_PART) {
        float sums[FXS_FIT_SUMS][FXS_FIT_PART];
        const size_t count = end - first < FXS_FIT_PART ? end - first : FXS_FIT_PART;
        gather(s, first, count, sums, 1);
        memcpy(s->errors + first, sums[FXS_FIT_RED], count * sizeof(float));
        if (s->weights)
            memcpy(s->weights + first, sums[FXS_FIT_GREEN], count * sizeof(float));
    }
}

int fxs_fit_find_errors(fxs_fit_stepper *s, fxs_fit_model *model, const fxs_fit_photograph *photograph,
                        const fxs_fit_step_options *options, float *errors, float *weights)
{
    fxs_fit_report report = {0};
    s->model = model;
    s->camera = &photograph->camera;
    s->options = options;
    s->photograph = NULL;
    s->errors_of = photograph->pixels;
    s->mask = photograph->mask;
    s->errors = errors;
    s->weights = weights;
    if (draw(s, &report) || !room(&s->sums, (s->entry_count + 1) * FXS_FIT_SUMS * sizeof(float)))
        return FXS_ERR_MEMORY;
    run(s, error_job, s->tile_count);
    run(s, gather_error_job, gaussian_jobs(s));
    return 0;
}

static void average_down(const fxs_fit_photograph *from, uint8_t *pixels)
{
    const int divisor = from->divisor, all_of_them = divisor * divisor;
    for (int y = 0; y < from->camera.height; y++)
        for (int x = 0; x < 3 * from->camera.width; x++) {
            const uint8_t *first = from->pixels + (ptrdiff_t)y * divisor * 3 * from->width + x / 3 * 3 * divisor +
                                   x % 3;
            int sum = all_of_them / 2;
            for (int k = 0; k < all_of_them; k++)
                sum += first[(ptrdiff_t)(k / divisor) * 3 * from->width + k % divisor * 3];
            *pixels++ = (uint8_t)(sum / all_of_them);
        }
}

static void reduce_mask(const fxs_fit_photograph *from, uint8_t *out)
{
    const int divisor = from->divisor;
    for (int y = 0; y < from->camera.height; y++)
        for (int x = 0; x < from->camera.width; x++) {
            const uint8_t *first = from->mask + (ptrdiff_t)y * divisor * from->width + x * divisor;
            int counts = 1;
            for (int k = 0; k < divisor * divisor; k++)
                counts &= first[(ptrdiff_t)(k / divisor) * from->width + k % divisor] != 0;
            *out++ = (uint8_t)counts;
        }
}

fxs_fit_camera fxs_fit_camera_of(const fxs_fit_model *model, const fxs_fit_photograph *photograph)
{
    fxs_fit_camera camera = photograph->camera;
    if (model->poses)
        pose_camera(&camera, &model->poses->of[photograph->number]);
    return camera;
}

void fxs_fit_factors_of(const fxs_fit_model *model, const fxs_fit_photograph *photograph, float factors[FXS_FIT_GAIN])
{
    const fxs_fit_gains *gains = model->gains;
    for (int k = 0; k < FXS_FIT_GAIN && !gains; k++)
        factors[k] = gain_neutral(1, k);
    if (gains)
        gain_factors(&gains->of[photograph->number], gains->is_affine, factors);
}

static int choose_view(fxs_fit_stepper *s, const fxs_fit_photograph *photograph, uint32_t view)
{
    const fxs_fit_camera *c = &s->posed[view];
    s->view = view;
    s->posed[view] = fxs_fit_camera_of(s->model, photograph);
    s->camera = s->cameras[view] = c;
    s->photograph = photograph->pixels;
    s->mask = photograph->mask;
    fxs_fit_factors_of(s->model, photograph, s->factors);
    if (photograph->divisor > 1) {
        if (!room(&s->reduced, 3 * (size_t)c->width * (size_t)c->height))
            return FXS_ERR_MEMORY;
        average_down(photograph, s->reduced.memory);
        s->photograph = s->reduced.memory;
    }
    if (photograph->divisor > 1 && photograph->mask) {
        if (!room(&s->reduced_mask, (size_t)c->width * (size_t)c->height))
            return FXS_ERR_MEMORY;
        reduce_mask(photograph, s->reduced_mask.memory);
        s->mask = s->reduced_mask.memory;
    }
    return 0;
}

static void planes_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    s->stages->planes(s->camera, s->model->parameters, s->model->stride, (size_t)job * JOB, job_count(s, job),
                      s->splats.memory);
}

static fxs_fit_plane depth_plane_of(const fxs_fit_stepper *s, int k)
{
    return k < 3 ? s->loss[k].picture : s->loss[0].derivatives[0];
}

/* Blends planes of splats instead of colours, and writes the depth map that they give. */
static void blend_planes_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    const uint32_t *starts = s->counts.memory;
    fxs_fit_tile pixels;
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    s->stages->blend(s->splats.memory, (fxs_fit_entry *)s->entries.memory + starts[tile],
                     starts[s->tile_count + 1 + tile], left, top, 1, &pixels);
    for (int32_t y = top; y < top + FXS_FIT_TILE && y < s->camera->height; y++)
        for (int32_t x = left; x < left + FXS_FIT_TILE && x < s->camera->width; x++) {
            const int at = FXS_FIT_AT(x - left, y - top);
            const float planes[3] = {pixels.colour[0][at], pixels.colour[1][at], pixels.colour[2][at]};
            float numbers[4];
            depth_numbers(s->camera, (float)x, (float)y, planes, pixels.transmittance[at], numbers);
            for (int k = 0; k < 4; k++)
                depth_plane_of(s, k).first[y * s->loss[0].picture.stride + x] = numbers[k];
        }
}

static void depths_job(void *argument, uint32_t row)
{
    const fxs_fit_stepper *s = argument;
    const fxs_fit_plane out[3] = {s->loss[0].gradient, s->loss[1].gradient, s->loss[2].gradient};
    const fxs_fit_plane planes[4] = {depth_plane_of(s, 0), depth_plane_of(s, 1), depth_plane_of(s, 2),
                                     depth_plane_of(s, 3)};
    s->stages->depths(s->camera, planes, (int32_t)row, s->options->is_depth, 3 * s->options->by_surface, out);
}

static void backward_surface_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    fxs_fit_tile_gradient g;
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    memset(&g, 0, sizeof g);
    for (int c = 0; c < 3; c++)
        for (int32_t y = top; y < top + FXS_FIT_TILE && y < s->camera->height; y++)
            for (int32_t x = left; x < left + FXS_FIT_TILE && x < s->camera->width; x++)
                g.colour[c][FXS_FIT_AT(x - left, y - top)] =
                    s->loss[c].gradient.first[y * s->loss[c].gradient.stride + x];
    pass_back(s, tile, &g);
}

static void gather_surface_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    const size_t end = changed_end(s, job);
    for (size_t first = (size_t)job * JOB; first < end; first += FXS_FIT_PART) {
        float sums[FXS_FIT_SUMS][FXS_FIT_PART];
        const size_t count = end - first < FXS_FIT_PART ? end - first : FXS_FIT_PART;
        gather(s, first, count, sums, 0);
        for (size_t k = 0; k < 3; k++)
            memcpy(surface_sums_of(s, s->view) + k * s->model->stride + first, sums[FXS_FIT_RED + k],
                   count * sizeof(float));
    }
}

/* Finds the gradient by the planes of Gaussians: blends the planes to depths, compares them, and sums the results by
   blending weights. Replaces the splats' colours and their gradient sums. */
static void pass_surface(fxs_fit_stepper *s)
{
    run(s, planes_job, gaussian_jobs(s));
    run(s, blend_planes_job, s->tile_count);
    run(s, depths_job, (uint32_t)s->camera->height);
    run(s, backward_surface_job, s->tile_count);
    run(s, gather_surface_job, gaussian_jobs(s));
}

static int pass(fxs_fit_stepper *s, fxs_fit_report *report)
{
    if (draw(s, report) || !room(&s->sums, (s->entry_count + 1) * FXS_FIT_SUMS * sizeof(float)))
        return FXS_ERR_MEMORY;
    const uint64_t drawn = now(s);
    find_loss(s);
    if (s->model->gains && s->options->gain_rate > 0)
        sum_by_gain(s);
    const uint64_t compared = now(s);
    run(s, backward_job, s->tile_count);
    if (is_gathered(s))
        run(s, gather_job, gaussian_jobs(s));
    if (s->options->by_surface > 0)
        pass_surface(s);
    fxs_fit_add_loss(s->rows.memory, s->camera, s->batch, report);
    report->nanoseconds[LOSS] += compared - drawn;
    report->nanoseconds[BACK] += now(s) - compared;
    return 0;
}

int fxs_fit_stepper_step(fxs_fit_stepper *s, fxs_fit_model *model, const fxs_fit_photograph *photographs,
                         uint32_t batch, const fxs_fit_step_options *options, fxs_fit_report *report)
{
    s->model = model;
    s->options = options;
    s->batch = batch;
    memset(report, 0, sizeof *report);
    if (options->by_surface > 0 && !room(&s->by_surface, 3 * (size_t)batch * model->stride * sizeof(float)))
        return FXS_ERR_MEMORY;
    if (is_gathered(s) && !room(&s->gathered, batch * FXS_FIT_SUMS * model->stride * sizeof(float)))
        return FXS_ERR_MEMORY;
    if (moves_poses(s) && !room(&s->by_pose, batch * FXS_FIT_POSE * part_count(s) * sizeof(float)))
        return FXS_ERR_MEMORY;
    for (uint32_t v = 0; v < batch; v++)
        if (choose_view(s, &photographs[v], v) || pass(s, report))
            return FXS_ERR_MEMORY;
    const uint64_t passed_back = now(s);
    fxs_fit_set_adam(&s->adam, options, photographs, batch, model->count);
    run(s, update_job, gaussian_jobs(s));
    if (model->gains && options->gain_rate > 0)
        fxs_fit_move_gains(model->gains, photographs, batch, s->by_gain, options);
    for (uint32_t v = 0; v < batch && moves_poses(s); v++)
        fxs_fit_move_pose(model->poses, &photographs[v], by_pose_of(s, v, 0), part_count(s), options->pose_rate);
    report->nanoseconds[UPDATE] = now(s) - passed_back;
    report->gaussians = model->count;
    return 0;
}
