/* A frame: project, shade, sort, bin, blend, resolve. */
#include "frame.h"
#include "memory.h"

#define TIMED 4                    /* one macro tile of so many is timed, as a look at the clock takes a while */

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
    if (fxs_frame_stopped(f))
        return;
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
   sliced. Returns 0, FXS_ERR_SCENE or FXS_ERR_STOPPED. */
static int plan(fxs_frame *f, uint64_t *least)
{
    fxs_bands_begin_plan(f);
    f->planning = 1;
    const int error = fxs_prepare_blocks(f);
    f->planning = 0;
    const uint64_t rows = error ? 0 : fxs_bands_end_plan(f);
    *least = error || f->can_slice || rows < *least ? *least : rows;
    f->stats.memory.rows = rows < SIZE_MAX ? (size_t)rows : SIZE_MAX;
    return error;
}

int fxs_frame_begin(fxs_frame *f)
{
    uint64_t least = fxs_bands_init(f);
    int error = f->memory_bytes < least ? 0 : place_objects(f);
    f->can_slice = (f->draw_tile ? f->draw_tile == blend_tile : f->context->config.draw_blended) &&
                   !(f->eye->targets && fxs_targets_traced(f->eye->targets));
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
    int error = fxs_prepare_blocks(f);
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

/* Returns 0 or FXS_ERR_STOPPED. */
static int draw_macros(fxs_frame *f)
{
    static const enum fxs_stage stages[FXS_LAPS] = {FXS_SORT, FXS_BIN, FXS_BLEND, FXS_RESOLVE};
    const uint64_t start = fxs_now(f);
    const uint32_t jobs = f->last_macro - f->first_macro + 1;
    fxs_frame_run(f, draw_macro, jobs);
    f->stats.runs++;
    share_time(f, fxs_now(f) - start, f->macro_times + FXS_LAPS * (size_t)f->first_macro, jobs, FXS_LAPS, stages);
    return f->stopped ? FXS_ERR_STOPPED : 0;
}

static int draw_listed(fxs_frame *f);

/* One tile row after the other: where the lists of a row of macro tiles do not fit, what does is two rows high. */
static int draw_rows(fxs_frame *f)
{
    const int32_t first = f->first_row, end = f->end_row;
    int error = 0;
    for (int32_t row = first; row < end && !error; row++) {
        f->first_row = row;
        f->end_row = row + 1;
        error = draw_listed(f);
    }
    f->first_row = first;
    f->end_row = end;
    return error;
}

static int draw_listed(fxs_frame *f)
{
    uint64_t start = fxs_now(f);
    int error = 0;
    fxs_lists_count(f);
    if (!f->draw_tile && f->context->config.draw_blended && f->end_row - f->first_row > 1 && !fxs_lists_rows_fit(f))
        return draw_rows(f);
    for (uint32_t end = f->last_macro + 1; f->first_macro < end && !error; f->first_macro = f->last_macro + 1) {
        fxs_lists_fill(f, end);
        f->stats.nanoseconds[FXS_BIN] += fxs_now(f) - start;
        error = f->draw_tile ? draw_macros(f) : fxs_draw_lists(f);
        start = fxs_now(f);
    }
    for (uint32_t tile = fxs_tiles_above(f, f->first_row); tile < fxs_tiles_above(f, f->end_row); tile++)
        f->stats.entries += f->tile_counts[tile];
    return error;
}

/* Goes on with a tile of a slice: `trace` of nothing goes on where `blend` begins. */
static void blend_on(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    const int32_t column = (int32_t)tile % f->eye->view.tiles_x - f->first_column;
    fxs_trace *nothing = &f->nothing[column / FXS_MACRO];      /* kernels write to it all the same */
    int32_t x, y;
    nothing->which = 0;
    fxs_tile_origin(f, tile, &x, &y);
    for (uint32_t first = 0; first < list->count; first += INT16_MAX) {
        const uint32_t left = list->count - first, count = left < INT16_MAX ? left : INT16_MAX;
        f->context->kernels.trace(&f->eye->view, x, y, f->eye->splats, list->entries + first, 0, 0, count,
                                  &f->pixels[column], nothing);
    }
    lap(f, laps, FXS_BLENDED);
}

/* The tiles of the columns, once they are blended. Returns 0 or a back end's error. */
static int hand_over(fxs_frame *f)
{
    const uint32_t above = fxs_tiles_above(f, f->first_row);
    f->first_tile = above + (uint32_t)f->first_column;
    f->last_tile = above + (uint32_t)f->end_column - 1;
    if (f->context->config.draw)
        return fxs_draw_blended(f);
    for (uint32_t tile = f->first_tile; tile <= f->last_tile; tile++) {
        int32_t x, y;
        fxs_tile_origin(f, tile, &x, &y);
        fxs_resolve_targets(f, &f->pixels[tile - f->first_tile], x, y);
    }
    return 0;
}

/* Every slice of the columns. */
static int draw_columns(fxs_frame *f)
{
    fxs_slice s = {.room = f->slice_room, .more = 1};
    for (int32_t i = 0; i < f->end_column - f->first_column; i++)
        fxs_tile_clear(&f->pixels[i]);
    while (s.more) {
        const uint64_t start = fxs_now(f);
        int error = fxs_slice_next(f, &s);
        f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
        if (!error)
            error = draw_listed(f);
        if (error)
            return error;
        f->stats.slices++;
    }
    return hand_over(f);
}

/* A band of one tile row whose splats do not fit. */
static int draw_sliced(fxs_frame *f)
{
    const int32_t step = (int32_t)f->slice_macros * FXS_MACRO, tiles_x = f->eye->view.tiles_x;
    void (*const draw_tile)(fxs_frame *, uint32_t, const fxs_list *, fxs_laps *) = f->draw_tile;
    int error = 0;
    f->depths = f->eye->depths;
    f->draw_tile = blend_on;
    for (f->first_column = 0; f->first_column < tiles_x && !error; f->first_column = f->end_column) {
        f->end_column = fxs_min(f->first_column + step, tiles_x);
        error = draw_columns(f);
    }
    f->draw_tile = draw_tile;
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
            error = draw_sliced(f);
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
