/* A frame: project, shade, sort, bin, blend, resolve. */
#include "memory.h"
#include "stage.h"

#define BLOCK 16u                          /* chunks a job projects; its visible splats share a run of slots */
#define BLOCK_SLOTS (BLOCK * FXS_CHUNK)

typedef struct frame {
    const fxs_context *context;
    const fxs_scene *scene;
    const fxs_options *options;
    fxs_view view;
    fxs_stats stats;

    uint32_t blocks, tiles, entry_capacity;
    uint32_t parts;                        /* jobs that share the sort and the lists: one a thread */
    fxs_splat *splats;                     /* slot: block * BLOCK_SLOTS + rank among the block's visible ones */
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *indices;                     /* in the scene */
    uint32_t *block_counts;                /* visible splats of each block */
    fxs_key *keys, *spare_keys;            /* the depths lie in spare_keys until the sort */
    uint32_t (*histograms)[FXS_SORT_BUCKETS];   /* of each part */
    uint32_t *tile_counts;                 /* length of each tile's list */
    uint32_t *next;                        /* a row of tiles for each part of the keys: entries, then where they go */
    uint32_t *block_times, *tile_times;    /* nanoseconds of project, shade and bin; of blend and resolve */
    uint32_t *entries;

    uint32_t first_tile, last_tile;        /* of the run being blended */
    unsigned char *pixels;
    ptrdiff_t stride;
    uint64_t evaluated, blended;           /* fxs_count_pairs only */
} frame;

static uint64_t now(const fxs_context *context)
{
    return context->config.clock ? context->config.clock(context->config.clock_argument) : 0;
}

void fxs_run(const fxs_config *config, void (*job)(void *, uint32_t), void *argument, uint32_t jobs)
{
    if (config->run && jobs > 1) {
        config->run(config->pool, job, argument, jobs);
        return;
    }
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

static void run(const frame *f, void (*job)(void *, uint32_t), uint32_t jobs)
{
    fxs_run(&f->context->config, job, (void *)f, jobs);
}

/* ---- Memory ---------------------------------------------------------------------------------------------------- */

/* A block of memory being cut up, or, where it is null, only measured. */
typedef struct arena {
    unsigned char *rest;
    uint64_t used;
} arena;

/* Cuts `bytes` off the front, rounded up to 64. */
static void *cut(arena *m, uint64_t bytes)
{
    void *part = m->rest;
    bytes = (bytes + 63) / 64 * 64;
    if (m->rest)
        m->rest += bytes;
    m->used += bytes;
    return part;
}

/* Returns the bytes of all, which may be more than a size_t holds. */
static uint64_t lay_out(frame *f, const fxs_context *context, const fxs_scene *scene, int32_t width, int32_t height,
                        unsigned char *block, fxs_frame_memory *sizes)
{
    arena m = {block, 0};
    f->parts = context->config.run && context->config.threads > 1 ? context->config.threads : 1;
    f->blocks = (scene->chunk_count + BLOCK - 1) / BLOCK;
    f->tiles = (uint32_t)((width + FXS_TILE - 1) / FXS_TILE * ((height + FXS_TILE - 1) / FXS_TILE));
    uint64_t slots = (uint64_t)f->blocks * BLOCK_SLOTS, capacity = 4 * slots + 64 * (uint64_t)f->tiles;
    f->entry_capacity = capacity > UINT32_MAX ? UINT32_MAX : (uint32_t)capacity;

    f->splats = cut(&m, slots * sizeof *f->splats);
    f->bounds = cut(&m, slots * sizeof *f->bounds);
    f->boxes = cut(&m, slots * sizeof *f->boxes);
    f->indices = cut(&m, slots * sizeof *f->indices);
    f->block_counts = cut(&m, f->blocks * sizeof *f->block_counts);
    f->block_times = cut(&m, (uint64_t)f->blocks * 3 * sizeof *f->block_times);
    uint64_t splats = m.used;
    f->keys = cut(&m, slots * sizeof *f->keys);
    f->spare_keys = cut(&m, slots * sizeof *f->spare_keys);
    f->histograms = cut(&m, f->parts * sizeof *f->histograms);
    uint64_t keys = m.used;
    f->tile_counts = cut(&m, f->tiles * sizeof *f->tile_counts);
    f->next = cut(&m, (uint64_t)f->parts * f->tiles * sizeof *f->next);
    f->tile_times = cut(&m, (uint64_t)f->tiles * 2 * sizeof *f->tile_times);
    uint64_t tiles = m.used;
    f->entries = cut(&m, f->entry_capacity * (uint64_t)sizeof *f->entries);

    *sizes = (fxs_frame_memory){(size_t)splats, (size_t)(keys - splats), (size_t)(tiles - keys),
                                (size_t)(m.used - tiles), (size_t)m.used};
    return m.used;
}

size_t fxs_frame_bytes(const fxs_context *context, const fxs_scene *scene, int32_t width, int32_t height,
                       fxs_frame_memory *memory)
{
    frame f;
    fxs_frame_memory sizes;
    if (!context || !scene || width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE)
        return 0;
    if (lay_out(&f, context, scene, width, height, 0, &sizes) > SIZE_MAX)
        return 0;
    if (memory)
        *memory = sizes;
    return sizes.total;
}

/* ---- Stages ---------------------------------------------------------------------------------------------------- */

static void project_block(frame *f, uint32_t block)
{
    uint32_t count = 0, *depths = (uint32_t *)f->spare_keys;
    for (uint32_t c = block * BLOCK; c < (block + 1) * BLOCK && c < f->scene->chunk_count; c++) {
        size_t slot = (size_t)block * BLOCK_SLOTS + count;
        count += f->context->kernels.project(&f->view, f->scene, c, f->splats + slot, f->bounds + slot,
                                             f->indices + slot, depths + slot);
    }
    f->block_counts[block] = count;
}

static void shade_block(frame *f, uint32_t block)
{
    size_t first = (size_t)block * BLOCK_SLOTS, end = first + f->block_counts[block];
    while (first < end) {
        size_t last = first + 1;
        uint32_t chunk = f->indices[first] / FXS_CHUNK;
        while (last < end && f->indices[last] / FXS_CHUNK == chunk)
            last++;
        f->context->kernels.shade(&f->view, f->scene, chunk, f->indices + first, (uint32_t)(last - first),
                                  f->splats + first);
        first = last;
    }
}

/* What of the first stages needs no other block, while its splats are in the cache. */
static void prepare_block(void *argument, uint32_t block)
{
    frame *f = argument;
    size_t slot = (size_t)block * BLOCK_SLOTS;
    uint32_t *times = f->block_times + 3 * (size_t)block;
    uint64_t start = now(f->context);
    project_block(f, block);
    uint64_t projected = now(f->context);
    shade_block(f, block);
    uint64_t shaded = now(f->context);
    f->context->kernels.bin(&f->view, f->splats + slot, f->bounds + slot, f->block_counts[block], f->boxes + slot);
    times[0] = (uint32_t)(projected - start);
    times[1] = (uint32_t)(shaded - projected);
    times[2] = (uint32_t)(now(f->context) - shaded);
}

/* Where a block's keys start: after those of the blocks before it. */
static void gather_part(void *argument, uint32_t part)
{
    frame *f = argument;
    const uint32_t *depths = (const uint32_t *)f->spare_keys;
    uint32_t first = fxs_part(f->blocks, f->parts, part), end = fxs_part(f->blocks, f->parts, part + 1), at = 0;
    for (uint32_t block = 0; block < first; block++)
        at += f->block_counts[block];
    for (uint32_t block = first; block < end; block++)
        for (uint32_t i = 0; i < f->block_counts[block]; i++) {
            uint32_t slot = block * BLOCK_SLOTS + i;
            f->keys[at++] = FXS_KEY(depths[slot], slot);
        }
}

static void sort_all(frame *f)
{
    for (uint32_t block = 0; block < f->blocks; block++)
        f->stats.visible += f->block_counts[block];
    run(f, gather_part, f->parts);
    fxs_key *sorted = fxs_sort(&f->context->config, f->keys, f->spare_keys, f->stats.visible, f->histograms, f->parts);
    f->spare_keys = sorted == f->keys ? f->spare_keys : f->keys;
    f->keys = sorted;
}

/* A part of the sorted keys. Their boxes take the place of the spare keys. */
static fxs_sorted sorted_part(const frame *f, uint32_t part)
{
    uint32_t first = fxs_part(f->stats.visible, f->parts, part), end = fxs_part(f->stats.visible, f->parts, part + 1);
    return (fxs_sorted){f->keys + first, (fxs_box *)f->spare_keys + first, end - first};
}

static void count_part(void *argument, uint32_t part)
{
    frame *f = argument;
    fxs_sorted sorted = sorted_part(f, part);
    uint32_t *counts = f->next + (size_t)part * f->tiles;
    memset(counts, 0, f->tiles * sizeof *counts);
    fxs_bin_count(&f->view, f->splats, f->bounds, f->boxes, &sorted, counts);
}

static void bin_all(frame *f)
{
    run(f, count_part, f->parts);
    memset(f->tile_counts, 0, f->tiles * sizeof *f->tile_counts);
    for (uint32_t part = 0; part < f->parts; part++)
        for (uint32_t tile = 0; tile < f->tiles; tile++)
            f->tile_counts[tile] += f->next[(size_t)part * f->tiles + tile];
    for (uint32_t tile = 0; tile < f->tiles; tile++)
        f->stats.entries += f->tile_counts[tile];
}

static void fill_part(void *argument, uint32_t part)
{
    frame *f = argument;
    fxs_sorted sorted = sorted_part(f, part);
    fxs_bin_fill(&f->view, f->splats, f->bounds, &sorted, f->first_tile, f->last_tile,
                 f->next + (size_t)part * f->tiles, f->entries);
}

/* Lists as many tiles as fit in `entries`, from first_tile on. A list is never longer than the number of slots, so
   one always fits. In a tile's list the parts follow each other, so it is in the order of the keys. */
static void bin_run(frame *f)
{
    uint32_t used = 0, tile = f->first_tile;
    for (; tile < f->tiles && f->tile_counts[tile] <= f->entry_capacity - used; tile++)
        for (uint32_t part = 0; part < f->parts; part++) {
            uint32_t *next = &f->next[(size_t)part * f->tiles + tile], count = *next;
            *next = used;
            used += count;
        }
    f->last_tile = tile - 1;
    run(f, fill_part, f->parts);
    f->stats.runs++;
}

/* The last part's entries end the list. */
static const uint32_t *list_of(const frame *f, uint32_t tile)
{
    return f->entries + f->next[(size_t)(f->parts - 1) * f->tiles + tile] - f->tile_counts[tile];
}

static void blend_tile(void *argument, uint32_t job)
{
    frame *f = argument;
    fxs_tile pixels;
    uint32_t tile = f->first_tile + job;
    int32_t x = (int32_t)tile % f->view.tiles_x * FXS_TILE, y = (int32_t)tile / f->view.tiles_x * FXS_TILE;
    ptrdiff_t pixel_bytes = f->options->format == FXS_FORMAT_RGB565 ? 2 : 4;
    uint64_t start = now(f->context);
    f->context->kernels.blend(&f->view, x, y, f->splats, list_of(f, tile), f->tile_counts[tile], &pixels);
    uint64_t blended = now(f->context);
    f->context->kernels.resolve(f->options, &pixels, fxs_min(FXS_TILE, f->view.width - x),
                                 fxs_min(FXS_TILE, f->view.height - y), f->pixels + y * f->stride + x * pixel_bytes,
                                 f->stride);
    f->tile_times[2 * tile] = (uint32_t)(blended - start);
    f->tile_times[2 * tile + 1] = (uint32_t)(now(f->context) - blended);
}

/* Has the back end draw the run. */
static int draw_run(const frame *f)
{
    const fxs_config *config = &f->context->config;
    int listed = !config->draw_unlisted;
    const fxs_tile_run r = {
        config, &f->view, f->options, f->splats, f->bounds, f->keys, f->stats.visible,
        listed ? f->entries : 0, listed ? f->next + (size_t)(f->parts - 1) * f->tiles : 0,
        listed ? f->tile_counts : 0, f->first_tile, f->last_tile, f->pixels, f->stride};
    return config->draw(config->draw_argument, &r);
}

/* Shares a wall time out to `columns` stages, as the jobs spent theirs: times has a row for each job. */
static void share_time(frame *f, uint64_t wall, const uint32_t *times, uint32_t jobs, uint32_t columns,
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

static int frame_init(frame *f, const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera,
                      const fxs_options *options, void *memory, size_t memory_bytes)
{
    fxs_frame_memory sizes;
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
    if ((uintptr_t)memory % 64 || lay_out(f, context, scene, camera->width, camera->height, 0, &sizes) > memory_bytes)
        return FXS_ERR_MEMORY;
    lay_out(f, context, scene, camera->width, camera->height, memory, &sizes);
    return 0;
}

static void prepare(frame *f)
{
    static const enum fxs_stage stages[] = {FXS_PROJECT, FXS_SHADE, FXS_BIN};
    uint64_t start = now(f->context);
    run(f, prepare_block, f->blocks);
    uint64_t prepared = now(f->context);
    sort_all(f);
    uint64_t sorted = now(f->context);
    if (!f->context->config.draw_unlisted)
        bin_all(f);
    share_time(f, prepared - start, f->block_times, f->blocks, 3, stages);
    f->stats.nanoseconds[FXS_SORT] += sorted - prepared;
    f->stats.nanoseconds[FXS_BIN] += now(f->context) - sorted;
}

static void blend_runs(frame *f, void (*job)(void *, uint32_t))
{
    static const enum fxs_stage stages[] = {FXS_BLEND, FXS_RESOLVE};
    for (f->first_tile = 0; f->first_tile < f->tiles; f->first_tile = f->last_tile + 1) {
        uint64_t start = now(f->context);
        bin_run(f);
        uint64_t listed = now(f->context);
        uint32_t jobs = f->last_tile - f->first_tile + 1;
        run(f, job, jobs);
        f->stats.nanoseconds[FXS_BIN] += listed - start;
        share_time(f, now(f->context) - listed, f->tile_times + 2 * (size_t)f->first_tile, jobs, 2, stages);
    }
}

/* The same by the back end. Returns 0 or its error. */
static int draw_runs(frame *f)
{
    int error = 0;
    for (f->first_tile = 0; f->first_tile < f->tiles && !error; f->first_tile = f->last_tile + 1) {
        uint64_t start = now(f->context);
        f->last_tile = f->tiles - 1;
        if (!f->context->config.draw_unlisted)
            bin_run(f);
        uint64_t listed = now(f->context);
        error = draw_run(f);
        f->stats.nanoseconds[FXS_BIN] += listed - start;
        f->stats.nanoseconds[FXS_BLEND] += now(f->context) - listed;
    }
    return error;
}

int fxs_render(const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
               void *memory, size_t memory_bytes, void *pixels, ptrdiff_t stride, fxs_stats *stats)
{
    frame f;
    if (!context || (!pixels && !context->config.draw))
        return FXS_ERR_ARGUMENT;
    int error = frame_init(&f, context, scene, camera, options, memory, memory_bytes);
    if (error)
        return error;
    f.pixels = pixels;
    f.stride = stride;
    uint64_t start = now(context);
    prepare(&f);
    if (context->config.draw)
        error = draw_runs(&f);
    else
        blend_runs(&f, blend_tile);
    f.stats.frame_nanoseconds = now(context) - start;
    if (stats)
        *stats = f.stats;
    return error;
}

static void count_tile(void *argument, uint32_t job)
{
    frame *f = argument;
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
    frame f;
    fxs_context context;
    fxs_init(&context, 0);
    if (!evaluated || !blended)
        return FXS_ERR_ARGUMENT;
    int error = frame_init(&f, &context, scene, camera, options, memory, memory_bytes);
    if (error)
        return error;
    prepare(&f);
    blend_runs(&f, count_tile);
    *evaluated = f.evaluated;
    *blended = f.blended;
    return 0;
}
