/* A frame: project, shade, sort, bin, blend, resolve. */
#include "frame.h"
#include "memory.h"

void fxs_run(const fxs_config *config, void (*job)(void *, uint32_t), void *argument, uint32_t jobs)
{
    if (config->run && jobs > 1) {
        config->run(config->pool, job, argument, jobs);
        return;
    }
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

/* ---- Stages ---------------------------------------------------------------------------------------------------- */

/* What of the first stages needs no other block, for up to FXS_BLOCK chunks, while their splats are in the cache.
   Their splats in the band lie from `slot` on, before end_slot. Returns their number or FXS_ERR_SCENE. */
static int32_t prepare_chunks(fxs_frame *f, uint32_t first, uint32_t end, uint32_t slot, uint32_t end_slot,
                              uint64_t *times)
{
    const fxs_kernels *kernels = &f->context->kernels;
    uint32_t starts[FXS_BLOCK + 1] = {slot};
    uint64_t start = fxs_now(f);
    for (uint32_t i = 0; i < end - first; i++) {
        int32_t count = fxs_band_project(f, first + i, starts[i], end_slot);
        if (count < 0)
            return count;
        starts[i + 1] = starts[i] + (uint32_t)count;
    }
    uint64_t projected = fxs_now(f);
    for (uint32_t i = 0; i < end - first; i++) {
        int error = kernels->shade(&f->view, f->scene, first + i, f->indices + starts[i], starts[i + 1] - starts[i],
                                   f->splats + starts[i]);
        if (error)
            return error;
    }
    uint64_t shaded = fxs_now(f);
    uint32_t count = starts[end - first] - slot;
    kernels->bin(&f->view, f->splats + slot, f->bounds + slot, count, f->boxes + slot);
    times[0] += projected - start;
    times[1] += shaded - projected;
    times[2] += fxs_now(f) - shaded;
    return (int32_t)count;
}

static void prepare_block(void *argument, uint32_t block)
{
    fxs_frame *f = argument;
    uint32_t first = fxs_block_start(f, block), end = fxs_block_start(f, block + 1), slot = f->block_slots[block];
    uint64_t *times = f->block_times + 3 * (size_t)block;
    memset(times, 0, 3 * sizeof *times);
    f->block_counts[block] = FXS_BLOCK_FAILED;
    for (; first < end; first += FXS_BLOCK) {
        int32_t count = prepare_chunks(f, first, first + FXS_BLOCK < end ? first + FXS_BLOCK : end, slot,
                                       f->block_slots[block + 1], times);
        if (count < 0)
            return;
        slot += (uint32_t)count;
    }
    f->block_counts[block] = slot - f->block_slots[block];
}

int fxs_frame_blocks(fxs_frame *f, void (*job)(void *frame, uint32_t block))
{
    fxs_frame_run(f, job, f->blocks);
    for (uint32_t block = 0; block < f->blocks; block++)
        if (f->block_counts[block] == FXS_BLOCK_FAILED)
            return FXS_ERR_SCENE;
    return 0;
}

/* Where a block's keys start: after those of the blocks before it. */
static void gather_part(void *argument, uint32_t part)
{
    fxs_frame *f = argument;
    const uint32_t *depths = (const uint32_t *)f->spare_keys;
    uint32_t first = fxs_part(f->blocks, f->parts, part), end = fxs_part(f->blocks, f->parts, part + 1), at = 0;
    for (uint32_t block = 0; block < first; block++)
        at += f->block_counts[block];
    for (uint32_t block = first; block < end; block++)
        for (uint32_t i = 0; i < f->block_counts[block]; i++) {
            uint32_t slot = f->block_slots[block] + i;
            f->keys[at++] = FXS_KEY(depths[slot], slot);
        }
}

void fxs_frame_sort(fxs_frame *f)
{
    uint64_t start = fxs_now(f);
    f->count = 0;
    for (uint32_t block = 0; block < f->blocks; block++)
        f->count += f->block_counts[block];
    fxs_frame_run(f, gather_part, f->parts);
    fxs_key *sorted = fxs_sort(&f->context->config, f->keys, f->spare_keys, f->count, f->histograms, f->parts);
    f->spare_keys = sorted == f->keys ? f->spare_keys : f->keys;
    f->keys = sorted;
    f->stats.nanoseconds[FXS_SORT] += fxs_now(f) - start;
}

/* Tiles of the picture above a tile row. */
static uint32_t tiles_above(const fxs_frame *f, int32_t row)
{
    return (uint32_t)(row * f->view.tiles_x);
}

/* A part of the sorted keys. Their boxes take the place of the spare keys. */
static fxs_sorted sorted_part(const fxs_frame *f, uint32_t part)
{
    uint32_t first = fxs_part(f->count, f->parts, part), end = fxs_part(f->count, f->parts, part + 1);
    return (fxs_sorted){f->keys + first, (fxs_box *)f->spare_keys + first, end - first};
}

static void count_part(void *argument, uint32_t part)
{
    fxs_frame *f = argument;
    fxs_sorted sorted = sorted_part(f, part);
    uint32_t *counts = f->next + (size_t)part * f->tiles;
    memset(counts, 0, f->tiles * sizeof *counts);
    fxs_bin_count(&f->view, f->splats, f->bounds, f->boxes, &sorted, counts);
}

static void bin_all(fxs_frame *f)
{
    fxs_frame_run(f, count_part, f->parts);
    memset(f->tile_counts, 0, f->tiles * sizeof *f->tile_counts);
    for (uint32_t part = 0; part < f->parts; part++)
        for (uint32_t tile = 0; tile < f->tiles; tile++)
            f->tile_counts[tile] += f->next[(size_t)part * f->tiles + tile];
    for (uint32_t tile = tiles_above(f, f->first_row); tile < tiles_above(f, f->end_row); tile++)
        f->stats.entries += f->tile_counts[tile];
}

static void fill_part(void *argument, uint32_t part)
{
    fxs_frame *f = argument;
    fxs_sorted sorted = sorted_part(f, part);
    fxs_bin_fill(&f->view, f->splats, f->bounds, &sorted, f->first_tile, f->last_tile,
                 f->next + (size_t)part * f->tiles, f->entries);
}

/* Lists as many tiles of the band as fit in `entries`, from first_tile on. A list is never longer than the number of
   slots, so one always fits. In a tile's list the parts follow each other, so it is in the order of the keys. */
static void bin_run(fxs_frame *f)
{
    uint32_t used = 0, tile = f->first_tile;
    for (; tile < tiles_above(f, f->end_row) && f->tile_counts[tile] <= f->entry_capacity - used; tile++)
        for (uint32_t part = 0; part < f->parts; part++) {
            uint32_t *next = &f->next[(size_t)part * f->tiles + tile], count = *next;
            *next = used;
            used += count;
        }
    f->last_tile = tile - 1;
    fxs_frame_run(f, fill_part, f->parts);
    f->stats.runs++;
}

/* The last part's entries end the list. */
static const uint32_t *list_of(const fxs_frame *f, uint32_t tile)
{
    return f->entries + f->next[(size_t)(f->parts - 1) * f->tiles + tile] - f->tile_counts[tile];
}

static void blend_tile(void *argument, uint32_t job)
{
    fxs_frame *f = argument;
    fxs_tile pixels;
    uint32_t tile = f->first_tile + job;
    int32_t x = (int32_t)tile % f->view.tiles_x * FXS_TILE, y = (int32_t)tile / f->view.tiles_x * FXS_TILE;
    ptrdiff_t pixel_bytes = fxs_pixel_bytes(f->options);
    uint64_t start = fxs_now(f);
    f->context->kernels.blend(&f->view, x, y, f->splats, list_of(f, tile), f->tile_counts[tile], &pixels);
    uint64_t blended = fxs_now(f);
    f->context->kernels.resolve(f->options, &pixels, fxs_min(FXS_TILE, f->view.width - x),
                                 fxs_min(FXS_TILE, f->view.height - y), f->pixels + y * f->stride + x * pixel_bytes,
                                 f->stride);
    f->tile_times[2 * tile] = blended - start;
    f->tile_times[2 * tile + 1] = fxs_now(f) - blended;
}

/* Has the back end draw the run. */
static int draw_run(fxs_frame *f)
{
    const uint64_t start = fxs_now(f);
    const fxs_config *config = &f->context->config;
    int listed = !config->draw_unlisted;
    const fxs_tile_run r = {
        config, &f->view, f->options, f->splats, f->bounds, f->keys, f->count,
        listed ? f->entries : 0, listed ? f->next + (size_t)(f->parts - 1) * f->tiles : 0,
        listed ? f->tile_counts : 0, f->first_tile, f->last_tile, f->pixels, f->stride};
    const int error = config->draw(config->draw_argument, &r);
    f->stats.nanoseconds[FXS_BLEND] += fxs_now(f) - start;
    return error;
}

/* Shares a wall time out to `columns` stages, as the jobs spent theirs: times has a row for each job. */
static void share_time(fxs_frame *f, uint64_t wall, const uint64_t *times, uint32_t jobs, uint32_t columns,
                       const enum fxs_stage *stages)
{
    uint64_t sums[3] = {0, 0, 0}, total = 0;
    for (uint32_t i = 0; i < jobs * columns; i++) {
        sums[i % columns] += times[i];
        total += times[i];
    }
    for (uint32_t c = 0; c < columns && total; c++)
        f->stats.nanoseconds[stages[c]] += wall * (sums[c] * 1024 / total) / 1024;
}

/* ---- Frame ----------------------------------------------------------------------------------------------------- */

static int check(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options, const void *memory)
{
    if (!scene || !camera || !options || !memory || options->sh_degree < 0 || options->sh_degree > 3 ||
        (options->cutoff != FXS_CUTOFF_MAHALANOBIS && options->cutoff != FXS_CUTOFF_SQUARE) ||
        (options->format != FXS_FORMAT_RGBA8 && options->format != FXS_FORMAT_RGBA8_COVERAGE &&
         options->format != FXS_FORMAT_RGB565))
        return FXS_ERR_ARGUMENT;
    return 0;
}

int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera,
                   const fxs_options *options, void *memory, size_t memory_bytes)
{
    int error = check(scene, camera, options, memory);
    memset(f, 0, sizeof *f);
    if (!error)
        error = fxs_view_init(&f->view, scene, camera, options);
    if (error)
        return error;
    f->context = context;
    f->scene = scene;
    f->options = options;
    f->stats.gaussians = scene->count;
    f->memory = memory;
    f->memory_bytes = memory_bytes;
    return (uintptr_t)memory % 64 ? FXS_ERR_MEMORY : 0;
}

int fxs_frame_prepare(fxs_frame *f, void (*prepare_job)(void *frame, uint32_t block))
{
    static const enum fxs_stage stages[] = {FXS_PROJECT, FXS_SHADE, FXS_BIN};
    uint64_t start = fxs_now(f);
    int error = fxs_frame_blocks(f, prepare_job);
    if (error)
        return error;
    share_time(f, fxs_now(f) - start, f->block_times, f->blocks, 3, stages);
    fxs_frame_sort(f);
    f->stats.visible += f->planned ? 0 : f->count;
    return 0;
}

static void blend_run(fxs_frame *f, void (*tile_job)(void *, uint32_t))
{
    static const enum fxs_stage stages[] = {FXS_BLEND, FXS_RESOLVE};
    uint64_t start = fxs_now(f);
    uint32_t jobs = f->last_tile - f->first_tile + 1;
    fxs_frame_run(f, tile_job, jobs);
    share_time(f, fxs_now(f) - start, f->tile_times + 2 * (size_t)f->first_tile, jobs, 2, stages);
}

/* Lists the band's splats by tile, and has the tiles blended by a job each, or, where that is null, by the back end.
   Returns 0 or the back end's error. */
static int draw(fxs_frame *f, void (*tile_job)(void *, uint32_t))
{
    const int listed = tile_job || !f->context->config.draw_unlisted;
    const uint32_t end_tile = tiles_above(f, f->end_row);
    int error = 0;
    uint64_t start = fxs_now(f);
    if (listed)
        bin_all(f);
    for (f->first_tile = tiles_above(f, f->first_row); f->first_tile < end_tile && !error;
         f->first_tile = f->last_tile + 1) {
        f->last_tile = end_tile - 1;
        if (listed)
            bin_run(f);
        f->stats.nanoseconds[FXS_BIN] += fxs_now(f) - start;
        if (tile_job)
            blend_run(f, tile_job);
        else
            error = draw_run(f);
        start = fxs_now(f);
    }
    return error;
}

static int render(fxs_frame *f, void (*tile_job)(void *, uint32_t))
{
    uint64_t start = fxs_now(f);
    int error = fxs_bands_init(f);
    f->end_row = 0;
    f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
    while (!error && f->end_row < f->view.tiles_y) {
        fxs_band_next(f);
        if (!tile_job && f->context->config.draw_unlisted && f->end_row < f->view.tiles_y)
            return FXS_ERR_UNSUPPORTED;    /* it draws whole frames */
        error = fxs_frame_prepare(f, prepare_block);
        if (!error)
            error = draw(f, tile_job);
    }
    f->stats.frame_nanoseconds += fxs_now(f) - start;
    return error;
}

/* Null: the back end draws. */
static void (*tile_job_of(const fxs_frame *f))(void *, uint32_t)
{
    return f->context->config.draw ? 0 : blend_tile;
}

int fxs_frame_draw(fxs_frame *f)
{
    return draw(f, tile_job_of(f));
}

int fxs_frame_render(fxs_frame *f)
{
    return render(f, tile_job_of(f));
}

int fxs_render(const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
               void *memory, size_t memory_bytes, void *pixels, ptrdiff_t stride, fxs_stats *stats)
{
    fxs_frame f;
    if (!context || (!pixels && !context->config.draw))
        return FXS_ERR_ARGUMENT;
    int error = fxs_frame_init(&f, context, scene, camera, options, memory, memory_bytes);
    if (!error && pixels && !fxs_stride_valid(camera, options, stride))
        error = FXS_ERR_ARGUMENT;
    if (error)
        return error;
    f.pixels = pixels;
    f.stride = stride;
    error = fxs_frame_render(&f);
    if (stats)
        *stats = f.stats;
    return error;
}

static void count_tile(void *argument, uint32_t job)
{
    fxs_frame *f = argument;
    fxs_tile pixels;
    uint32_t tile = f->first_tile + job;
    int32_t x = (int32_t)tile % f->view.tiles_x * FXS_TILE, y = (int32_t)tile / f->view.tiles_x * FXS_TILE;
    f->tile_times[2 * tile] = f->tile_times[2 * tile + 1] = 0;
    fxs_blend_count(&f->view, x, y, f->splats, list_of(f, tile), f->tile_counts[tile], &pixels, &f->evaluated,
                    &f->blended);
}

int fxs_count_pairs(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options, void *memory,
                    size_t memory_bytes, uint64_t *evaluated, uint64_t *blended)
{
    fxs_frame f;
    fxs_context context;
    fxs_init(&context, 0);
    if (!evaluated || !blended)
        return FXS_ERR_ARGUMENT;
    int error = fxs_frame_init(&f, &context, scene, camera, options, memory, memory_bytes);
    if (error)
        return error;
    error = render(&f, count_tile);
    *evaluated = f.evaluated;
    *blended = f.blended;
    return error;
}
