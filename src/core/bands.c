/* Lays out a frame's memory and divides the frame into bands, ranges of tile rows. If the memory holds a splat
 * (projected Gaussian) for every Gaussian, one band covers the picture. Otherwise a first pass, the plan, counts the
 * splats of each tile row. A block is a range of chunks of 256 Gaussians. A slot is a place for one splat. */
#include "bands.h"
#include "draw.h"
#include "lister.h"
#include "lists.h"
#include "memory.h"
#include "prepare.h"
#include "targets.h"
#include "times.h"

#define JOBS 8u
#define KEYS 2u
#define SLOT_BYTES (sizeof(fxs_splat) + sizeof(fxs_bounds) + sizeof(fxs_box) + 2 * sizeof(uint32_t))
#define LIST_BYTES (2 * sizeof(fxs_key))       /* bytes of a key in a list of splats, and of the second key that sorting
                                                  needs */
#define SLICE_LEAST 128u
#define SLICE_MACRO_BYTES (FXS_MACRO * sizeof(fxs_tile) + (sizeof(fxs_trace) + 63) / 64 * 64)

/* Bump allocator for the arrays of a frame. If `rest` is null, it only adds up their sizes. */
typedef struct arena {
    unsigned char *rest;
    uint64_t used;
} arena;

static void *cut(arena *m, uint64_t bytes)
{
    void *part = m->rest;
    bytes = (bytes + 63) / 64 * 64;
    if (m->rest)
        m->rest += bytes;
    m->used += bytes;
    return part;
}

static uint64_t to_multiple_of_16(uint64_t x)
{
    return (x + 15) / 16 * 16;
}

/* Allocates the arrays that live for the whole frame. A frame that is divided into bands (ranges of tile rows) has
   fewer and larger blocks of Gaussians, because each block of a band needs 256 spare places for splats. */
static void lay_out_frame(fxs_frame *f, enum fxs_frame_mode mode)
{
    arena m = {f->memory, 0};
    const fxs_config *config = &f->context->config;
    const uint32_t chunks = f->chunk_count, tiles_y = (uint32_t)f->view.tiles_y;
    const int planned = mode != FXS_FRAME_WHOLE;
    f->mode = mode;
    f->parts = config->workers.run && config->workers.count > 1 ? config->workers.count : 1;
    const uint64_t blocks = f->parts > 1 ? JOBS * f->parts : 1;
    f->tiles = (uint32_t)f->view.tiles_x * tiles_y;
    f->macros = fxs_macros(f->view.tiles_x) * fxs_macros(f->view.tiles_y);
    f->block_chunks = FXS_BLOCK;
    while (planned && chunks > blocks * f->block_chunks)
        f->block_chunks *= 2;
    f->blocks = (chunks + f->block_chunks - 1) / f->block_chunks;

    f->views = cut(&m, f->object_count * sizeof *f->views);
    f->cut_memory = cut(&m, f->cut_room ? fxs_cut_bytes(f->cut_room, f->object_count, f->eyes) : 0);
    f->block_slots = cut(&m, (f->blocks + 1) * sizeof *f->block_slots);
    f->block_counts = cut(&m, f->blocks * sizeof *f->block_counts);
    f->block_times = cut(&m, (uint64_t)f->blocks * 3 * sizeof *f->block_times);
    f->animated = cut(&m, (uint64_t)f->blocks * f->animated_bytes);
    f->row_counts = cut(&m, planned ? (uint64_t)f->blocks * (tiles_y + 1) * sizeof *f->row_counts : 0);
    f->extents = cut(&m, planned ? (uint64_t)chunks * sizeof *f->extents : 0);
    f->histograms = cut(&m, config->draw_unlisted ? f->parts * sizeof *f->histograms : 0);
    uint64_t tiles_at = m.used;
    f->tile_counts = cut(&m, f->tiles * sizeof *f->tile_counts);
    f->tile_ends = cut(&m, f->tiles * sizeof *f->tile_ends);
    f->lengths = cut(&m, f->macros * sizeof *f->lengths);
    f->next = cut(&m, (uint64_t)f->parts * (f->macros + FXS_NEXT_MORE) * sizeof *f->next);
    f->macro_times = cut(&m, (uint64_t)f->macros * FXS_LAPS * sizeof *f->macro_times);
    f->stats.memory.tiles = (size_t)(m.used - tiles_at);
    f->fixed_bytes = m.used;
}

/* Allocates the arrays of a band (some rows of tiles) with places for `slots` splats. The lists of splats get the rest
   of the memory, up to KEYS keys per splat and 16 per tile. Returns the bytes of the whole frame. */
static uint64_t lay_out_band(fxs_frame *f, uint64_t slots)
{
    arena m = {f->memory ? f->memory + f->fixed_bytes : 0, f->fixed_bytes};
    slots = to_multiple_of_16(slots);
    f->pixels = cut(&m, f->slice_macros * FXS_MACRO * sizeof *f->pixels);
    f->nothing = cut(&m, f->slice_macros * sizeof *f->nothing);
    f->splats = cut(&m, slots * sizeof *f->splats);
    f->bounds = cut(&m, slots * sizeof *f->bounds);
    f->boxes = cut(&m, slots * sizeof *f->boxes);
    f->depths = cut(&m, slots * sizeof *f->depths);
    f->indices = cut(&m, slots * sizeof *f->indices);
    uint64_t wanted = KEYS * slots + 16 * (uint64_t)f->tiles, rest = (f->memory_bytes - m.used) / LIST_BYTES;
    wanted = wanted < UINT32_MAX ? wanted : UINT32_MAX;
    f->key_capacity = (uint32_t)(wanted < rest ? wanted : rest) / 16 * 16;
    f->keys = cut(&m, f->key_capacity * (uint64_t)sizeof *f->keys);
    f->spare = cut(&m, f->key_capacity * (uint64_t)sizeof *f->spare);

    fxs_frame_memory *sizes = &f->stats.memory;
    sizes->entries = f->key_capacity * sizeof *f->keys;
    sizes->keys = f->key_capacity * sizeof *f->spare +
                  (f->context->config.draw_unlisted ? f->parts * sizeof *f->histograms : 0);
    sizes->total = (size_t)m.used;
    sizes->splats = sizes->total - sizes->keys - sizes->tiles - sizes->entries;
    return m.used;
}

static uint64_t bytes_for(const fxs_frame *f, uint64_t slots, uint64_t keys_a_slot)
{
    return slots > FXS_MAX_SLOTS ? UINT64_MAX
           : f->fixed_bytes +
             to_multiple_of_16(slots) * (SLOT_BYTES + keys_a_slot * LIST_BYTES);
}

/* Memory for one list key per splat suffices, because no list of splats is longer than the number of splats. */
static uint64_t bytes_for_all(const fxs_frame *f)
{
    return bytes_for(f, (uint64_t)f->chunk_count * FXS_CHUNK, 1);
}

static uint64_t bytes_for_plan(const fxs_frame *f)
{
    return bytes_for(f, (uint64_t)f->blocks * FXS_CHUNK, 1);
}

static uint64_t smaller(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t bytes_for_slices(const fxs_frame *f)
{
    return bytes_for(f, FXS_CHUNK + SLICE_LEAST, 1) + SLICE_MACRO_BYTES;
}

static uint32_t slice_macros(const fxs_frame *f)
{
    const uint64_t more = (f->memory_bytes - bytes_for_slices(f)) / 4 / SLICE_MACRO_BYTES;
    return (uint32_t)smaller(1 + more, fxs_macros(f->view.tiles_x));
}

static uint64_t least_bytes(const fxs_frame *f)
{
    const uint64_t plan = bytes_for_plan(f), slices = bytes_for_slices(f);
    return plan > slices ? plan : slices;
}

uint64_t fxs_bands_measure(fxs_frame *f)
{
    f->memory_bytes = UINT64_MAX;
    lay_out_frame(f, FXS_FRAME_PLAN);
    const uint64_t least = least_bytes(f);
    lay_out_frame(f, FXS_FRAME_WHOLE);
    const uint64_t all = lay_out_band(f, (uint64_t)f->chunk_count * FXS_CHUNK);
    f->stats.memory.least = (size_t)smaller(smaller(least, bytes_for_all(f)), SIZE_MAX);
    return all;
}

static fxs_row_counts *row_counts_of(const fxs_frame *f, uint32_t block)
{
    return f->row_counts + (size_t)block * (uint32_t)(f->view.tiles_y + 1);
}

static void widen(fxs_span *a, fxs_span b)
{
    a->first = fxs_min(a->first, b.first);
    a->last = -fxs_min(-a->last, -b.last);
}

void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t place, uint32_t first, uint32_t count)
{
    fxs_row_counts *counts = row_counts_of(f, block);
    fxs_extent e = {{f->view.tiles_y, -1}, {f->view.tiles_x, -1}, UINT32_MAX, 0};
    for (uint32_t slot = first; slot < first + count; slot++) {
        const fxs_span rows = fxs_bin_rows(&f->view, &f->splats[slot], &f->bounds[slot]);
        counts[rows.first + 1].started++;
        counts[rows.last + 1].ended++;
        widen(&e.rows, rows);
        widen(&e.columns, fxs_bin_columns(&f->view, &f->bounds[slot]));
        e.nearest = f->depths[slot] < e.nearest ? f->depths[slot] : e.nearest;
        e.farthest = f->depths[slot] > e.farthest ? f->depths[slot] : e.farthest;
    }
    f->extents[place] = e;
}

static void sum_rows(fxs_frame *f, uint32_t block)
{
    fxs_row_counts *counts = row_counts_of(f, block);
    for (int32_t row = 0; row < f->view.tiles_y; row++) {
        counts[row + 1].started += counts[row].started;
        counts[row + 1].ended += counts[row].ended;
    }
}

/* Returns how many slots (places for splats) a block of Gaussians needs in tile rows first_row to end_row - 1. This
   includes 256 spare slots for one chunk of Gaussians. */
static uint32_t block_slots(const fxs_frame *f, uint32_t block, int32_t first_row, int32_t end_row)
{
    uint32_t most = (fxs_block_start(f, block + 1) - fxs_block_start(f, block)) * FXS_CHUNK;
    if (f->mode == FXS_FRAME_WHOLE)
        return most;
    const fxs_row_counts *counts = row_counts_of(f, block);
    return (uint32_t)smaller(most, counts[end_row].started - counts[first_row].ended + FXS_CHUNK);
}

static uint64_t band_bytes(const fxs_frame *f, int32_t first_row, int32_t end_row, uint64_t keys_a_slot)
{
    uint64_t slots = 0;
    for (uint32_t block = 0; block < f->blocks; block++)
        slots += block_slots(f, block, first_row, end_row);
    return bytes_for(f, slots, keys_a_slot);
}

static void begin_plan(fxs_frame *f)
{
    lay_out_band(f, (uint64_t)f->blocks * FXS_CHUNK);
    for (uint32_t block = 0; block < f->blocks; block++) {
        f->block_slots[block] = block * FXS_CHUNK;
        memset(row_counts_of(f, block), 0, (uint32_t)(f->view.tiles_y + 1) * sizeof *f->row_counts);
    }
}

static uint64_t end_plan(fxs_frame *f)
{
    uint64_t most = 0;
    for (uint32_t block = 0; block < f->blocks; block++) {
        sum_rows(f, block);
        f->stats.visible += f->block_counts[block];
    }
    for (int32_t row = 0; row < f->view.tiles_y; row++) {
        const uint64_t bytes = band_bytes(f, row, row + 1, 1);
        most = bytes > most ? bytes : most;
    }
    return smaller(most, f->bytes_for_all);
}

int fxs_bands_can_slice(const fxs_frame *f)
{
    return (f->draw_tile ? f->draw_tile == fxs_draw_tile : f->context->config.draw_blended) &&
           !fxs_targets_traced(f->targets);
}

int fxs_bands_plan(fxs_frame *f)
{
    fxs_frame_memory *sizes = &f->stats.memory;
    begin_plan(f);
    const int error = fxs_prepare_blocks(f);
    if (error)
        return error;
    const uint64_t rows = end_plan(f);
    sizes->rows = (size_t)smaller(rows, SIZE_MAX);
    if (!fxs_bands_can_slice(f) && sizes->rows > sizes->least)
        sizes->least = sizes->rows;
    f->mode = FXS_FRAME_BAND;
    return f->memory_bytes < sizes->least ? FXS_ERR_MEMORY : 0;
}

int fxs_bands_init(fxs_frame *f)
{
    f->end_row = 0;
    f->slice_macros = 0;
    lay_out_frame(f, FXS_FRAME_WHOLE);
    f->bytes_for_all = bytes_for_all(f);
    if (f->memory_bytes >= f->bytes_for_all)
        return 0;
    lay_out_frame(f, FXS_FRAME_PLAN);
    const uint64_t least = smaller(least_bytes(f), f->bytes_for_all);
    f->stats.memory.least = (size_t)smaller(least, SIZE_MAX);
    return f->memory_bytes < least ? FXS_ERR_MEMORY : 0;
}

static void lay_out_slices(fxs_frame *f)
{
    f->slice_macros = slice_macros(f);
    const uint64_t fixed = f->fixed_bytes + f->slice_macros * SLICE_MACRO_BYTES;
    const uint64_t slots = (f->memory_bytes - fixed) / (SLOT_BYTES + LIST_BYTES) / 16 * 16;
    f->slice_room = (uint32_t)smaller(slots, FXS_MAX_SLOTS) - FXS_CHUNK;
    lay_out_band(f, f->slice_room + FXS_CHUNK);
}

static void lay_out_rows(fxs_frame *f)
{
    uint32_t slots = 0;
    while (f->end_row < f->view.tiles_y && band_bytes(f, f->first_row, f->end_row + 1, KEYS) <= f->memory_bytes)
        f->end_row++;
    for (uint32_t block = 0; block < f->blocks; block++) {
        f->block_slots[block] = slots;
        slots += block_slots(f, block, f->first_row, f->end_row);
    }
    f->block_slots[f->blocks] = slots;
    lay_out_band(f, slots);
}

int fxs_band_next(fxs_frame *f)
{
    const fxs_stage_view *view = &f->view;
    if (f->end_row == view->tiles_y)
        return 0;
    f->first_row = f->end_row;
    f->end_row = f->mode == FXS_FRAME_WHOLE ? view->tiles_y : f->first_row + 1;
    f->first_column = 0;
    f->end_column = view->tiles_x;
    f->slice_macros = 0;
    if (f->mode != FXS_FRAME_WHOLE)
        f->mode = band_bytes(f, f->first_row, f->end_row, 1) > f->memory_bytes ? FXS_FRAME_SLICES : FXS_FRAME_BAND;
    f->stats.bands++;
    if (f->mode == FXS_FRAME_SLICES)
        lay_out_slices(f);
    else
        lay_out_rows(f);
    return 1;
}

static int is_whole(const fxs_frame *f, uint32_t place)
{
    return f->mode < FXS_FRAME_BAND ||
           (f->extents[place].rows.first >= f->first_row && f->extents[place].rows.last < f->end_row);
}

int fxs_band_has_chunk(const fxs_frame *f, uint32_t place)
{
    return f->mode < FXS_FRAME_BAND ||
           (f->extents[place].rows.last >= f->first_row && f->extents[place].rows.first < f->end_row);
}

uint32_t fxs_band_keep(fxs_frame *f, uint32_t place, uint32_t first_slot, uint32_t count)
{
    uint32_t to = first_slot;
    if (is_whole(f, place))
        return count;
    for (uint32_t slot = first_slot; slot < first_slot + count; slot++) {
        fxs_span rows = fxs_bin_rows(&f->view, &f->splats[slot], &f->bounds[slot]);
        if (rows.last < f->first_row || rows.first >= f->end_row)
            continue;
        fxs_frame_move(f, to++, slot);
    }
    return to - first_slot;
}
