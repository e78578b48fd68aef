/* A step of the fit: project, bin, blend, loss, back, update. */
#include "stepper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "span.h"

enum { JOB = 4096 };               /* Gaussians of a job */
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
    block splats, keys, counts, entries, sums, planes, tiles, gaussian_sums, scratch;

    /* of the step at work */
    fxs_fit_model *model;
    const fxs_fit_camera *camera;
    const fxs_fit_step_options *options;
    const fxs_fit_photograph *photograph;
    fxs_fit_adam adam;
    fxs_fit_loss loss[3];
    uint32_t tile_count, visible;
    size_t entry_count;
};

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

static void *room(block *b, size_t bytes)
{
    if (bytes > b->bytes) {
        free(b->memory);
        b->bytes = 0;
        if (posix_memalign(&b->memory, 64, bytes + bytes / 4))
            return b->memory = NULL;
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
    block *blocks[] = {&s->splats, &s->keys, &s->counts, &s->entries, &s->sums, &s->planes, &s->tiles,
                       &s->gaussian_sums, &s->scratch};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        free(blocks[i]->memory);
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

/* ---- project ----------------------------------------------------------------------------------------------------- */

static uint32_t gaussian_jobs(const fxs_fit_stepper *s)
{
    return (uint32_t)((s->model->stride + JOB - 1) / JOB);
}

static size_t job_count(const fxs_fit_stepper *s, uint32_t job)
{
    const size_t left = s->model->stride - (size_t)job * JOB;
    return left < JOB ? left : JOB;
}

static void project_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    s->stages->project(s->camera, s->options->sh_degree, s->model->parameters, s->model->stride, (size_t)job * JOB,
                       job_count(s, job), s->splats.memory);
}

/* ---- bin --------------------------------------------------------------------------------------------------------- */

typedef struct key {
    uint32_t depth, splat;
} key;

/* Radix sort, stable, of 11 bits a pass; depths are above 0, so their bits are in order. */
static void sort_keys(key *keys, key *spare, size_t count)
{
    for (int shift = 0; shift < 33; shift += 11) {
        size_t starts[2049] = {0};
        for (size_t i = 0; i < count; i++)
            starts[(keys[i].depth >> shift & 2047) + 1]++;
        for (int i = 0; i < 2048; i++)
            starts[i + 1] += starts[i];
        for (size_t i = 0; i < count; i++)
            spare[starts[keys[i].depth >> shift & 2047]++] = keys[i];
        key *swap = keys;
        keys = spare;
        spare = swap;
    }
}

/* Keys of what is seen, and the slots of its sums. */
static void take_visible(fxs_fit_stepper *s, key *keys)
{
    fxs_fit_splat *splats = s->splats.memory;
    size_t slots = 0;
    s->visible = 0;
    for (size_t i = 0; i < s->model->count; i++)
        if (splats[i].depth > 0) {
            memcpy(&keys[s->visible].depth, &splats[i].depth, 4);
            keys[s->visible++].splat = (uint32_t)i;
            splats[i].slot = (uint32_t)slots;
            slots += splats[i].tiles;
        }
    s->entry_count = slots;
}

/* starts[t] becomes the first entry of tile t. */
static void count_entries(fxs_fit_stepper *s, uint32_t *starts)
{
    const fxs_fit_splat *splats = s->splats.memory;
    memset(starts, 0, (s->tile_count + 1) * sizeof *starts);
    for (size_t i = 0; i < s->model->count; i++) {
        if (!(splats[i].depth > 0))
            continue;
        const fxs_fit_span rows = fxs_fit_rows(s->camera, &splats[i]);
        for (int32_t y = rows.first; y < rows.end; y++) {
            const fxs_fit_span columns = fxs_fit_columns(s->camera, &splats[i], y);
            for (int32_t x = columns.first; x < columns.end; x++)
                starts[y * s->camera->tiles_x + x + 1]++;
        }
    }
    for (uint32_t t = 0; t < s->tile_count; t++)
        starts[t + 1] += starts[t];
}

static void fill_entries(fxs_fit_stepper *s, const key *keys, uint32_t *starts, fxs_fit_entry *entries)
{
    const fxs_fit_splat *splats = s->splats.memory;
    for (uint32_t k = 0; k < s->visible; k++) {
        const fxs_fit_splat *splat = &splats[keys[k].splat];
        const fxs_fit_span rows = fxs_fit_rows(s->camera, splat);
        uint32_t slot = splat->slot;
        for (int32_t y = rows.first; y < rows.end; y++) {
            const fxs_fit_span columns = fxs_fit_columns(s->camera, splat, y);
            for (int32_t x = columns.first; x < columns.end; x++)
                entries[starts[y * s->camera->tiles_x + x]++] = (fxs_fit_entry){keys[k].splat, slot++};
        }
    }
}

/* counts: the first entry of each tile, then how many each needed. */
static int bin(fxs_fit_stepper *s)
{
    key *keys = room(&s->keys, 2 * s->model->stride * sizeof *keys);
    uint32_t *starts = room(&s->counts, (2 * s->tile_count + 1) * sizeof *starts);
    if (!keys || !starts)
        return FXS_ERR_MEMORY;
    take_visible(s, keys);
    sort_keys(keys, keys + s->model->stride, s->visible);
    count_entries(s, starts);
    fxs_fit_entry *entries = room(&s->entries, (s->entry_count + 1) * sizeof *entries);
    if (!entries || !room(&s->sums, (s->entry_count + 1) * FXS_FIT_SUMS * sizeof(float)))
        return FXS_ERR_MEMORY;
    fill_entries(s, keys + s->model->stride, starts, entries);
    memmove(starts + 1, starts, s->tile_count * sizeof *starts);    /* each is the next one's start by now */
    starts[0] = 0;
    return 0;
}

/* ---- blend ------------------------------------------------------------------------------------------------------- */

static void tile_place(const fxs_fit_stepper *s, uint32_t tile, int32_t *left, int32_t *top)
{
    *left = (int32_t)(tile % (uint32_t)s->camera->tiles_x) * FXS_FIT_TILE;
    *top = (int32_t)(tile / (uint32_t)s->camera->tiles_x) * FXS_FIT_TILE;
}

static int32_t least_of(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static void put_tile(const fxs_fit_stepper *s, uint32_t tile, const fxs_fit_tile *pixels)
{
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    const int32_t columns = least_of(FXS_FIT_TILE, s->camera->width - left);
    const int32_t rows = least_of(FXS_FIT_TILE, s->camera->height - top);
    for (int c = 0; c < 3; c++)
        for (int32_t y = 0; y < rows; y++) {
            const float *from = pixels->colour[c] + y * FXS_FIT_TILE, *t = pixels->transmittance + y * FXS_FIT_TILE;
            float *to = s->loss[c].picture.first + (top + y) * s->loss[c].picture.stride + left;
            for (int32_t x = 0; x < columns; x++)
                to[x] = from[x] + t[x] * s->options->background[c];
        }
}

static void blend_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    uint32_t *starts = s->counts.memory, *needed = starts + s->tile_count + 1;
    fxs_fit_tile pixels;
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    needed[tile] = s->stages->blend(s->splats.memory, (fxs_fit_entry *)s->entries.memory + starts[tile],
                                    starts[tile + 1] - starts[tile], left, top, &pixels);
    put_tile(s, tile, &pixels);
}

/* ---- loss -------------------------------------------------------------------------------------------------------- */

enum { PLANES = 3 + FXS_FIT_ROWS + FXS_FIT_DERIVATIVES, ROWS_A_JOB = 16 };

static fxs_fit_plane plane_of(float *memory, int which, int32_t width, int32_t height)
{
    const ptrdiff_t stride = (width + 2 * FXS_FIT_MARGIN + FXS_FIT_TILE + 15) & ~15;
    return (fxs_fit_plane){memory + which * stride * (height + 2 * FXS_FIT_MARGIN) + FXS_FIT_MARGIN * stride +
                               FXS_FIT_MARGIN, stride};
}

/* The margins are 0, and stay so. */
static int make_planes(fxs_fit_stepper *s)
{
    const int32_t width = s->camera->width, height = s->camera->height;
    const size_t stride = (size_t)(width + 2 * FXS_FIT_MARGIN + FXS_FIT_TILE + 15) & ~(size_t)15;
    const size_t bytes = 3 * PLANES * stride * (size_t)(height + 2 * FXS_FIT_MARGIN) * sizeof(float) + 64;
    float *memory = room(&s->planes, bytes);
    if (!memory || !room(&s->scratch, 64 * 4 * (stride + FXS_FIT_MARGIN) * sizeof(float)))
        return FXS_ERR_MEMORY;
    memset(memory, 0, bytes);
    for (int c = 0; c < 3; c++) {
        fxs_fit_plane planes[PLANES];
        for (int i = 0; i < PLANES; i++)
            planes[i] = plane_of(memory, c * PLANES + i, width, height);
        fxs_fit_loss *l = &s->loss[c];
        l->picture = planes[0];
        l->gradient = planes[1];
        l->values = planes[2];
        memcpy(l->rows, planes + 3, sizeof l->rows);
        memcpy(l->derivatives, planes + 3 + FXS_FIT_ROWS, sizeof l->derivatives);
        l->width = width;
        l->height = height;
        l->step = 3;
        l->pitch = 3 * width;
        l->photograph = s->photograph ? s->photograph->pixels + c : NULL;
    }
    return 0;
}

static void for_rows(fxs_fit_stepper *s, uint32_t job, void (*work)(const fxs_fit_stepper *, const fxs_fit_loss *, int32_t))
{
    const int32_t jobs = (s->camera->height + ROWS_A_JOB - 1) / ROWS_A_JOB, first = (int32_t)job % jobs * ROWS_A_JOB;
    const int32_t end = least_of(first + ROWS_A_JOB, s->camera->height);
    for (int32_t row = first; row < end; row++)
        work(s, &s->loss[(int32_t)job / jobs], row);
}

enum { WIDEST = 16384 + 3 * FXS_FIT_MARGIN };

static void rows_work(const fxs_fit_stepper *s, const fxs_fit_loss *loss, int32_t row)
{
    float scratch[4 * WIDEST];
    s->stages->loss_rows(loss, row, scratch);
}

static void derivatives_work(const fxs_fit_stepper *s, const fxs_fit_loss *loss, int32_t row)
{
    s->stages->loss_derivatives(loss, row);
}

static void back_rows_work(const fxs_fit_stepper *s, const fxs_fit_loss *loss, int32_t row)
{
    s->stages->loss_back_rows(loss, row);
}

static void gradient_work(const fxs_fit_stepper *s, const fxs_fit_loss *loss, int32_t row)
{
    float scratch[4 * WIDEST];
    s->stages->loss_gradient(loss, row, scratch);
}

static void rows_job(void *s, uint32_t job) { for_rows(s, job, rows_work); }
static void derivatives_job(void *s, uint32_t job) { for_rows(s, job, derivatives_work); }
static void back_rows_job(void *s, uint32_t job) { for_rows(s, job, back_rows_work); }
static void gradient_job(void *s, uint32_t job) { for_rows(s, job, gradient_work); }

static void find_loss(fxs_fit_stepper *s)
{
    const uint32_t jobs = 3 * (uint32_t)((s->camera->height + ROWS_A_JOB - 1) / ROWS_A_JOB);
    run(s, rows_job, jobs);
    run(s, derivatives_job, jobs);
    run(s, back_rows_job, jobs);
    run(s, gradient_job, jobs);
}

/* Sums in doubles, row by row: for the report alone. */
static void report_loss(const fxs_fit_stepper *s, fxs_fit_report *report)
{
    const int32_t width = s->camera->width, height = s->camera->height;
    report->absolute = report->dissimilar = 0;
    for (int c = 0; c < 3; c++)
        for (int32_t y = 0; y < height; y++) {
            const fxs_fit_loss *l = &s->loss[c];
            const float *a = l->picture.first + y * l->picture.stride, *v = l->values.first + y * l->values.stride;
            for (int32_t x = 0; x < width; x++) {
                report->absolute += fabs((double)(a[x] - (float)l->photograph[y * l->pitch + x * l->step] / 255.0f));
                report->dissimilar += 1 - (double)v[x];
            }
        }
    report->absolute /= 3.0 * width * height;
    report->dissimilar /= 3.0 * width * height;
}

/* ---- back -------------------------------------------------------------------------------------------------------- */

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
            for (int32_t x = 0; x < columns; x++) {
                g->colour[c][y * FXS_FIT_TILE + x] = from[x];
                g->whole[y * FXS_FIT_TILE + x] += from[x] * picture[x];
            }
        }
}

static void back_job(void *argument, uint32_t tile)
{
    const fxs_fit_stepper *s = argument;
    const uint32_t *starts = s->counts.memory, *needed = starts + s->tile_count + 1;
    const fxs_fit_entry *entries = (const fxs_fit_entry *)s->entries.memory + starts[tile];
    float (*sums)[FXS_FIT_SUMS] = s->sums.memory;
    fxs_fit_tile_gradient g;
    int32_t left, top;
    tile_place(s, tile, &left, &top);
    take_gradient(s, tile, &g);
    s->stages->back(s->splats.memory, entries, needed[tile], left, top, &g, sums);
    for (uint32_t e = needed[tile]; e < starts[tile + 1] - starts[tile]; e++)
        memset(sums[entries[e].slot], 0, sizeof *sums);
}

/* ---- update ------------------------------------------------------------------------------------------------------ */

/* A Gaussian's sums over its tiles, in their order. */
static void gather(const fxs_fit_stepper *s, size_t first, size_t count)
{
    const fxs_fit_splat *splats = s->splats.memory;
    const float (*sums)[FXS_FIT_SUMS] = s->sums.memory;
    float *out = s->gaussian_sums.memory;
    const size_t stride = s->model->stride;
    for (size_t i = first; i < first + count; i++) {
        const fxs_fit_splat *splat = &splats[i];
        float total[FXS_FIT_SUMS] = {0};
        const int seen = i < s->model->count && splat->depth > 0;
        const uint32_t tiles = seen ? splat->tiles : 0;
        for (uint32_t t = 0; t < tiles; t++)
            for (int k = 0; k < FXS_FIT_SUMS; k++)
                total[k] += sums[splat->slot + t][k];
        for (int k = 0; k < FXS_FIT_SUMS; k++)
            out[(size_t)k * stride + i] = total[k];
        s->model->views[i] += (float)seen;
    }
}

static void update_job(void *argument, uint32_t job)
{
    const fxs_fit_stepper *s = argument;
    const fxs_fit_model *m = s->model;
    const size_t first = (size_t)job * JOB, count = job_count(s, job);
    gather(s, first, count);
    for (size_t at = first; at < first + count; at += FXS_FIT_CHUNK) {
        const size_t left = first + count - at, some = left < FXS_FIT_CHUNK ? left : FXS_FIT_CHUNK;
        s->stages->update(s->camera, s->options->sh_degree, &s->adam, m->parameters,
                          m->masters ? m->masters : m->parameters, m->means, m->squares, m->stride, at, some,
                          s->gaussian_sums.memory, m->by_centre);
        if (m->masters)
            s->stages->quantise(m->grid, m->masters, m->parameters, m->stride, at, some);
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

/* The gradient is that of the sum over pixels and channels; Adam's epsilon is meant for their mean. */
static void set_adam(fxs_fit_stepper *s)
{
    double beta1 = 1, beta2 = 1;
    for (uint32_t i = 0; i < s->options->number && (beta1 > 0 || beta2 > 1e-12); i++) {
        beta1 *= 0.9;
        beta2 *= 0.999;
    }
    for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
        s->adam.rate[i] = (float)(s->options->rate[i] / (1 - beta1));
    s->adam.correction = (float)(1 / (1 - beta2));
    s->adam.epsilon = 3e-15f * (float)s->camera->width * (float)s->camera->height;
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

static uint64_t now(const fxs_fit_stepper *s)
{
    return s->clock ? s->clock(NULL) : 0;
}

static int draw(fxs_fit_stepper *s, fxs_fit_report *report)
{
    s->tile_count = (uint32_t)(s->camera->tiles_x * s->camera->tiles_y);
    if (!room(&s->splats, s->model->stride * sizeof(fxs_fit_splat)) || make_planes(s))
        return FXS_ERR_MEMORY;
    const uint64_t start = now(s);
    run(s, project_job, gaussian_jobs(s));
    const uint64_t projected = now(s);
    if (bin(s))
        return FXS_ERR_MEMORY;
    const uint64_t binned = now(s);
    run(s, blend_job, s->tile_count);
    report->nanoseconds[PROJECT] = projected - start;
    report->nanoseconds[BIN] = binned - projected;
    report->nanoseconds[BLEND] = now(s) - binned;
    report->entries = s->entry_count;
    report->visible = s->visible;
    return 0;
}

int fxs_fit_draw(fxs_fit_stepper *s, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3])
{
    fxs_fit_report report;
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

int fxs_fit_stepper_step(fxs_fit_stepper *s, fxs_fit_model *model, const fxs_fit_photograph *photograph,
                    const fxs_fit_step_options *options, fxs_fit_report *report)
{
    s->model = model;
    s->camera = &photograph->camera;
    s->options = options;
    s->photograph = photograph;
    if (draw(s, report) || !room(&s->gaussian_sums, FXS_FIT_SUMS * model->stride * sizeof(float)))
        return FXS_ERR_MEMORY;
    const uint64_t drawn = now(s);
    find_loss(s);
    const uint64_t compared = now(s);
    run(s, back_job, s->tile_count);
    const uint64_t passed_back = now(s);
    set_adam(s);
    run(s, update_job, gaussian_jobs(s));
    report->nanoseconds[LOSS] = compared - drawn;
    report->nanoseconds[BACK] = passed_back - compared;
    report->nanoseconds[UPDATE] = now(s) - passed_back;
    report_loss(s, report);
    return 0;
}
