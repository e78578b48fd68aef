/* A frame: project, shade, sort, bin, blend, resolve. */
#include "chunk.h"
#include "frame.h"
#include "memory.h"

#define TIMED 4                    /* one macro tile of so many is timed, as a look at the clock takes a while */

/* ---- Stages ---------------------------------------------------------------------------------------------------- */

int32_t fxs_frame_project(fxs_frame *f, uint32_t number, uint32_t chunk, uint32_t slot, uint32_t end_slot)
{
    fxs_eye *eye = f->eye;
    const fxs_object_view *object = &eye->objects[number];
    uint32_t *indices = f->indices + slot;
    if (end_slot - slot < FXS_CHUNK)
        return FXS_ERR_SCENE;
    if (!fxs_band_has_chunk(f, chunk))
        return 0;
    int32_t count = f->eye_count > 1
                        ? fxs_eyes_project(f, number, chunk - object->first_chunk, slot)
                        : fxs_object_project(object, &f->context->kernels, chunk - object->first_chunk,
                                             eye->splats + slot, eye->bounds + slot, indices, eye->depths + slot);
    for (int32_t i = 0; i < count && object->first_chunk; i++)
        indices[i] += object->first_chunk * FXS_CHUNK;
    return count < 0 ? count : (int32_t)fxs_band_keep(f, chunk, slot, (uint32_t)count);
}

/* shade; both eyes have the first one's colours. */
int fxs_frame_shade(fxs_frame *f, uint32_t number, uint32_t chunk, uint32_t slot, uint32_t count)
{
    const fxs_object_view *object = &f->eye->objects[number];
    const int error = fxs_object_shade(object, &f->context->kernels, chunk - object->first_chunk, f->indices + slot,
                                       count, f->eye->splats + slot);
    for (uint32_t i = slot; i < slot + count && f->eye_count > 1; i++)
        memcpy(f->eyes[1].splats[i].colour_q13, f->eyes[0].splats[i].colour_q13, sizeof f->eyes[0].splats->colour_q13);
    return error;
}

void fxs_frame_bin(fxs_frame *f, uint32_t slot, uint32_t count)
{
    for (fxs_eye *eye = f->eye; eye < f->eye + f->eye_count; eye++) {
        f->context->kernels.bin(&eye->view, eye->splats + slot, eye->bounds + slot, count, eye->boxes + slot);
        if (f->eye_count > 1)
            fxs_eyes_hide(eye->bounds + slot, count, eye->boxes + slot);
    }
}

/* Begins to fetch a chunk's rows from byte `from` to before `end`, of as many as there are. */
static void fetch_rows(const fxs_frame *f, uint32_t number, uint32_t chunk, uint32_t from, uint32_t end)
{
    const fxs_object_view *object = &f->eye->objects[number];
    const unsigned char *rows = fxs_rows(&object->scene, chunk - object->first_chunk);
    for (; from < end && from < object->scene.chunk_bytes; from += 64)
        FXS_PREFETCH(rows + from);
    (void)rows;
}

/* What of the first stages needs no other block, for up to FXS_BLOCK chunks, while their splats are in the cache.
   Their splats in the band lie from `slot` on, before end_slot. Returns their number or FXS_ERR_SCENE. */
static int32_t prepare_chunks(fxs_frame *f, uint32_t first, uint32_t end, uint32_t slot, uint32_t end_slot,
                              uint64_t *times)
{
    uint32_t starts[FXS_BLOCK + 1] = {slot}, objects[FXS_BLOCK];
    uint64_t start = fxs_now(f);
    for (uint32_t i = 0; i < end - first; i++) {
        objects[i] = i ? objects[i] : fxs_frame_object(f, first);
        if (first + i + 1 < end) {
            objects[i + 1] = fxs_frame_object(f, first + i + 1);
            fetch_rows(f, objects[i + 1], first + i + 1, 0, FXS_ROW_SH);
        }
        int32_t count = fxs_frame_project(f, objects[i], first + i, starts[i], end_slot);
        if (count < 0)
            return count;
        starts[i + 1] = starts[i] + (uint32_t)count;
    }
    uint64_t projected = fxs_now(f);
    for (uint32_t i = 0; i < end - first; i++) {
        if (first + i + 1 < end && starts[i + 2] > starts[i + 1])
            fetch_rows(f, objects[i + 1], first + i + 1, FXS_ROW_SH, UINT32_MAX);
        int error = fxs_frame_shade(f, objects[i], first + i, starts[i], starts[i + 1] - starts[i]);
        if (error)
            return error;
    }
    uint64_t shaded = fxs_now(f);
    fxs_frame_bin(f, slot, starts[end - first] - slot);
    times[0] += projected - start;
    times[1] += shaded - projected;
    times[2] += fxs_now(f) - shaded;
    return (int32_t)(starts[end - first] - slot);
}

/* Counts the splats of a block by tile row; one chunk's slots are enough for that. Returns their number or
   FXS_ERR_SCENE. */
static int32_t plan_chunks(fxs_frame *f, uint32_t block, uint32_t first, uint32_t end, uint32_t slot)
{
    uint32_t all = 0;
    for (uint32_t chunk = first; chunk < end; chunk++) {
        const int32_t count = fxs_frame_project(f, fxs_frame_object(f, chunk), chunk, slot, slot + FXS_CHUNK);
        if (count < 0)
            return count;
        fxs_band_count(f, block, chunk, slot, (uint32_t)count);
        all += (uint32_t)count;
    }
    return (int32_t)all;
}

static void prepare_block(void *argument, uint32_t block)
{
    fxs_frame *f = argument;
    uint32_t end = fxs_block_start(f, block + 1), slot = f->block_slots[block], taken = 0;
    uint64_t *times = f->block_times + 3 * (size_t)block;
    memset(times, 0, 3 * sizeof *times);
    f->block_counts[block] = FXS_BLOCK_FAILED;
    for (uint32_t first = fxs_block_start(f, block); first < end; first += FXS_BLOCK) {
        const uint32_t last = end - first < FXS_BLOCK ? end : first + FXS_BLOCK;
        int32_t count = f->planning ? plan_chunks(f, block, first, last, slot)
                                    : prepare_chunks(f, first, last, slot + taken, f->block_slots[block + 1], times);
        if (count < 0)
            return;
        taken += (uint32_t)count;
    }
    f->block_counts[block] = taken;
}

/* Returns 0, or FXS_ERR_SCENE where a block failed. */
static int run_blocks(fxs_frame *f)
{
    fxs_frame_run(f, prepare_block, f->blocks);
    for (uint32_t block = 0; block < f->blocks; block++)
        if (f->block_counts[block] == FXS_BLOCK_FAILED)
            return FXS_ERR_SCENE;
    return 0;
}

/* ---- Drawing --------------------------------------------------------------------------------------------------- */

/* Adds the time since the last lap to `which` of the macro tile's times, if it is timed. */
static void lap(const fxs_frame *f, fxs_laps *laps, int which)
{
    if (!laps->times)
        return;
    const uint64_t now = fxs_now(f);
    laps->times[which] += now - laps->start;
    laps->start = now;
}

static void blend_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    fxs_tile pixels;
    int32_t x, y;
    fxs_tile_origin(f, tile, &x, &y);
    if (fxs_targets_traced(f->eye->targets))
        fxs_trace_tile(f, list, x, y, &pixels, 0);
    else if (!list->count)
        fxs_tile_clear(&pixels);
    else
        f->context->kernels.blend(&f->eye->view, x, y, f->eye->splats, list->entries, list->count, &pixels);
    lap(f, laps, FXS_BLENDED);
    fxs_resolve_targets(f, &pixels, x, y);
}

static void draw_macro(void *argument, uint32_t job)
{
    fxs_frame *f = argument;
    const fxs_lister l = fxs_lister_of(f, 0);
    const uint32_t macro = f->first_macro + job, length = f->lengths[macro];
    uint32_t *entries = fxs_list_room(f, macro), tile;
    uint64_t *times = f->macro_times + FXS_LAPS * (size_t)macro;
    memset(times, 0, FXS_LAPS * sizeof *times);
    fxs_laps laps = {job % TIMED ? 0 : fxs_now(f), job % TIMED ? 0 : times};
    const fxs_key *keys = fxs_list_sort(f, macro);
    lap(f, &laps, FXS_SORTED);
    for (int32_t i = 0; i < FXS_MACRO * FXS_MACRO; i++)
        if (fxs_tile_of(f, macro, i, &tile) && (f->only_tile == FXS_NOTHING || f->only_tile == tile)) {
            f->tile_counts[tile] = f->context->kernels.list(keys, length, (uint32_t)i, entries);
            if (l.view->square)
                fxs_mark_far(&l, tile, entries, f->tile_counts[tile]);
            if (length)
                lap(f, &laps, FXS_LISTED_TILES);
            f->draw_tile(f, tile, &(fxs_list){entries, f->tile_counts[tile]}, &laps);
            if (length)
                lap(f, &laps, FXS_RESOLVED);
        }
    if (!length)                   /* fewer looks at the clock, which take a while */
        lap(f, &laps, FXS_RESOLVED);
}

/* Shares a wall time out to `columns` stages, as the jobs spent theirs: times has a row for each job. */
static void share_time(fxs_frame *f, uint64_t wall, const uint64_t *times, uint32_t jobs, uint32_t columns,
                       const enum fxs_stage *stages)
{
    uint64_t sums[FXS_LAPS] = {0}, total = 0;
    for (uint32_t i = 0; i < jobs * columns; i++) {
        sums[i % columns] += times[i];
        total += times[i];
    }
    for (uint32_t c = 0; c < columns && total; c++)
        f->stats.nanoseconds[stages[c]] += wall * (sums[c] * 1024 / total) / 1024;
}

/* ---- Frame ----------------------------------------------------------------------------------------------------- */

/* Counts the chunks of the objects, and checks what needs no camera. */
static int take_objects(fxs_frame *f, const fxs_object *objects, uint32_t count)
{
    uint64_t chunks = 0, gaussians = 0;
    int error = count > FXS_MAX_OBJECTS ? FXS_ERR_OBJECT : 0;
    f->objects = objects;
    f->object_count = count;
    for (uint32_t i = 0; i < count && !error; i++) {
        error = fxs_object_check(&objects[i]);
        chunks += error ? 0 : objects[i].scene->chunk_count;
        gaussians += error ? 0 : objects[i].scene->count;
    }
    if (!error && chunks > FXS_MAX_COUNT / FXS_CHUNK)
        error = FXS_ERR_OBJECT;
    f->chunk_count = (uint32_t)chunks;
    f->stats.gaussians = (uint32_t)gaussians;
    return error;
}

static int check(const fxs_context *context, const fxs_object *objects, uint32_t count, const fxs_camera *camera,
                 const fxs_options *options, const void *memory)
{
    return !context || (!objects && count) || !camera || !options || !memory || options->sh_degree < 0 ||
           options->sh_degree > 3 ||
           (options->cutoff != FXS_CUTOFF_MAHALANOBIS && options->cutoff != FXS_CUTOFF_SQUARE)
               ? FXS_ERR_ARGUMENT : 0;
}

static int eye_init(fxs_eye *eye, const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets)
{
    eye->camera = *camera;
    eye->targets = targets;
    const int error = fxs_view_init(&eye->view, camera, options);
    return error || !targets ? error : fxs_targets_check(targets, camera->width, camera->height);
}

int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_object *objects, uint32_t count,
                   const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets, void *memory,
                   size_t memory_bytes)
{
    memset(f, 0, sizeof *f);
    int error = check(context, objects, count, camera, options, memory);
    error = error ? error : take_objects(f, objects, count);
    error = error ? error : eye_init(&f->eyes[0], camera, options, targets);
    if (error)
        return error;
    f->context = context;
    f->options = options;
    f->memory = memory;
    f->memory_bytes = memory_bytes;
    f->eye = f->eyes;
    f->eye_count = 1;
    f->draw_tile = context->config.draw ? 0 : blend_tile;
    f->only_tile = FXS_NOTHING;
    return (uintptr_t)memory % 64 ? FXS_ERR_MEMORY : 0;
}

int fxs_frame_add_eye(fxs_frame *f, const fxs_camera *camera, const fxs_targets *targets)
{
    f->eye_count = 2;
    return eye_init(&f->eyes[1], camera, f->options, targets);
}

size_t fxs_frame_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                       int32_t height, fxs_frame_memory *memory)
{
    return fxs_measure(context, objects, count, width, height, 1, memory);
}

size_t fxs_measure(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                   int32_t height, uint32_t eyes, fxs_frame_memory *memory)
{
    fxs_frame f;
    memset(&f, 0, sizeof f);
    if (!context || (!objects && count) || width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE ||
        take_objects(&f, objects, count))
        return 0;
    f.context = context;
    f.eye = f.eyes;
    f.eye_count = eyes;
    f.eyes[0].view.tiles_x = (width + FXS_TILE - 1) / FXS_TILE;
    f.eyes[0].view.tiles_y = (height + FXS_TILE - 1) / FXS_TILE;
    if (fxs_frame_measure(&f) > SIZE_MAX)
        return 0;
    if (memory)
        *memory = f.stats.memory;
    return f.stats.memory.total;
}

/* Each object as each eye sees it. */
static int place_objects(fxs_frame *f)
{
    uint32_t first_chunk = 0;
    for (uint32_t i = 0; i < f->object_count; i++) {
        for (fxs_eye *eye = f->eye; eye < f->eye + f->eye_count; eye++) {
            const int error = fxs_object_view_init(&eye->objects[i], &eye->view, &eye->camera, &f->objects[i]);
            if (error)
                return error;
            eye->objects[i].first_chunk = first_chunk;
        }
        first_chunk += f->objects[i].scene->chunk_count;
    }
    return 0;
}

/* Counts the splats of each tile row. *least: the memory that the frame takes, more than before where no row can be
   sliced. Returns 0 or FXS_ERR_SCENE. */
static int plan(fxs_frame *f, uint64_t *least)
{
    fxs_bands_begin_plan(f);
    f->planning = 1;
    const int error = run_blocks(f);
    f->planning = 0;
    const uint64_t rows = error ? 0 : fxs_bands_end_plan(f);
    *least = error || f->can_slice ? *least : rows;
    f->stats.memory.rows = rows < SIZE_MAX ? (size_t)rows : SIZE_MAX;
    return error;
}

int fxs_frame_begin(fxs_frame *f)
{
    uint64_t least = fxs_bands_init(f);
    int error = f->memory_bytes < least ? 0 : place_objects(f);
    f->can_slice = f->draw_tile ? f->draw_tile == blend_tile && !fxs_targets_traced(f->eye->targets)
                                : f->context->config.draw_blended;
    if (!error && f->planned && f->memory_bytes >= least)
        error = plan(f, &least);
    if (f->planned)
        f->stats.memory.least = least < SIZE_MAX ? (size_t)least : SIZE_MAX;
    return error ? error : f->memory_bytes < least ? FXS_ERR_MEMORY : 0;
}

int fxs_frame_prepare(fxs_frame *f)
{
    static const enum fxs_stage stages[] = {FXS_PROJECT, FXS_SHADE, FXS_BIN};
    uint64_t start = fxs_now(f);
    int error = run_blocks(f);
    f->depths = f->eye->depths;
    if (error)
        return error;
    share_time(f, fxs_now(f) - start, f->block_times, f->blocks, 3, stages);
    f->count = 0;
    for (uint32_t block = 0; block < f->blocks; block++)
        f->count += f->block_counts[block];
    f->stats.visible += f->planned ? 0 : f->count;
    return 0;
}

static void draw_macros(fxs_frame *f)
{
    static const enum fxs_stage stages[FXS_LAPS] = {FXS_SORT, FXS_BIN, FXS_BLEND, FXS_RESOLVE};
    const uint64_t start = fxs_now(f);
    const uint32_t jobs = f->last_macro - f->first_macro + 1;
    fxs_frame_run(f, draw_macro, jobs);
    f->stats.runs++;
    share_time(f, fxs_now(f) - start, f->macro_times + FXS_LAPS * (size_t)f->first_macro, jobs, FXS_LAPS, stages);
}

static int draw_listed(fxs_frame *f)
{
    uint64_t start = fxs_now(f);
    int error = 0;
    fxs_lists_count(f);
    for (uint32_t end = f->last_macro + 1; f->first_macro < end && !error; f->first_macro = f->last_macro + 1) {
        fxs_lists_fill(f, end);
        f->stats.nanoseconds[FXS_BIN] += fxs_now(f) - start;
        if (f->draw_tile)
            draw_macros(f);
        else
            error = fxs_draw_lists(f);
        start = fxs_now(f);
    }
    for (uint32_t tile = fxs_tiles_above(f, f->first_row); tile < fxs_tiles_above(f, f->end_row); tile++)
        f->stats.entries += f->tile_counts[tile];
    return error;
}

int fxs_frame_draw(fxs_frame *f)
{
    if (f->draw_tile || !f->context->config.draw_unlisted)
        return draw_listed(f);
    return fxs_draw_unlisted(f);
}

int fxs_frame_render(fxs_frame *f)
{
    uint64_t start = fxs_now(f);
    int error = fxs_frame_begin(f);
    f->end_row = 0;
    f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
    while (!error && f->end_row < f->eye->view.tiles_y) {
        fxs_band_next(f);
        if (f->sliced)
            error = fxs_slices_draw(f);
        else if (!(error = fxs_frame_prepare(f)))
            error = fxs_frame_draw(f);
    }
    f->stats.frame_nanoseconds += fxs_now(f) - start;
    return error;
}

int fxs_render(const fxs_context *context, const fxs_object *objects, uint32_t count, const fxs_camera *camera,
               const fxs_options *options, const fxs_targets *targets, void *memory, size_t memory_bytes,
               fxs_stats *stats)
{
    fxs_frame f;
    if (stats)
        memset(stats, 0, sizeof *stats);
    int error = fxs_targets_missing(context, targets);
    if (!error)
        error = fxs_frame_init(&f, context, objects, count, camera, options, targets, memory, memory_bytes);
    if (error)
        return error;
    error = fxs_frame_render(&f);
    if (stats)
        *stats = f.stats;
    return error;
}

static void count_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    fxs_tile pixels;
    int32_t x, y;
    (void)laps;
    fxs_tile_origin(f, tile, &x, &y);
    fxs_blend_count(&f->eye->view, x, y, f->eye->splats, list->entries, list->count, &pixels, &f->evaluated,
                    &f->blended);
}

int fxs_count_pairs(const fxs_object *objects, uint32_t count, const fxs_camera *camera, const fxs_options *options,
                    void *memory, size_t memory_bytes, uint64_t *evaluated, uint64_t *blended)
{
    fxs_frame f;
    fxs_context context;
    fxs_init(&context, 0);
    if (!evaluated || !blended)
        return FXS_ERR_ARGUMENT;
    int error = fxs_frame_init(&f, &context, objects, count, camera, options, 0, memory, memory_bytes);
    if (error)
        return error;
    f.draw_tile = count_tile;
    error = fxs_frame_render(&f);
    *evaluated = f.evaluated;
    *blended = f.blended;
    return error;
}
