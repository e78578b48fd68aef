/* Passes runs of consecutive tiles with their lists of splats to a back end. A back end without lists receives all
 * splats of the band, sorted by depth. A macro tile is 2x2 tiles. */
#include "lister.h"
#include "lists.h"
#include "runs.h"
#include "sort.h"

static void gather_part(void *argument, uint32_t part)
{
    fxs_frame *f = argument;
    uint32_t first = fxs_part(f->blocks, f->parts, part), end = fxs_part(f->blocks, f->parts, part + 1), at = 0;
    for (uint32_t block = 0; block < first; block++)
        at += f->block_counts[block];
    for (uint32_t block = first; block < end; block++)
        for (uint32_t i = 0; i < f->block_counts[block]; i++) {
            uint32_t slot = f->block_slots[block] + i;
            f->keys[at++] = FXS_KEY(f->depths[slot], slot);
        }
}

static const fxs_key *sort_all(fxs_frame *f)
{
    const uint64_t start = fxs_now(f);
    fxs_frame_run(f, gather_part, f->parts);
    const fxs_key *sorted = fxs_sort(&f->context->config, f->keys, f->spare, f->count, f->histograms, f->parts);
    f->stats.nanoseconds[FXS_SORT] += fxs_now(f) - start;
    return sorted;
}

static void order_macro(void *argument, uint32_t job)
{
    fxs_frame *f = argument;
    const uint32_t macro = f->first_macro + job, length = f->lengths[macro];
    const fxs_key *list = fxs_list_sort(f, macro);
    uint32_t tile;
    for (int32_t i = 0; i < FXS_MACRO * FXS_MACRO; i++)
        if (fxs_tile_of(f, macro, i, &tile))
            for (uint32_t k = 0; k < length; k++)
                f->tile_counts[tile] += (uint32_t)list[k] >> i & 1;
}

/* Makes the lists of splats of the tiles in a macro tile (2x2 tiles). Must not write beyond the ends of these lists,
   where other jobs write. */
static void list_macro(void *argument, uint32_t job)
{
    fxs_frame *f = argument;
    const fxs_lister l = fxs_lister_of(f, 0);
    const uint32_t macro = f->first_macro + job, length = f->lengths[macro];
    const fxs_key *keys = fxs_list_of(f, macro);
    uint32_t tile;
    for (int32_t i = 0; i < FXS_MACRO * FXS_MACRO; i++) {
        if (!fxs_tile_of(f, macro, i, &tile) || tile < f->first_tile || tile > f->last_tile)
            continue;
        uint32_t *first = (uint32_t *)(void *)f->spare + f->tile_ends[tile] - f->tile_counts[tile], *to = first;
        for (uint32_t k = 0; k < length; k++)
            if ((uint32_t)keys[k] >> i & 1)
                *to++ = FXS_LISTED_SLOT(keys[k]);
        if (l.view->cutoff == FXS_CUTOFF_SQUARE)
            fxs_mark_cut_off(&l, tile, first, f->tile_counts[tile]);
    }
}

static int draw_run(fxs_frame *f, const fxs_key *visible, const fxs_tile *blended)
{
    const fxs_config *config = &f->context->config;
    const uint64_t start = fxs_now(f);
    const int listed = !visible && !blended;
    const fxs_tile_run r = {config, &f->view, f->options, f->splats, f->bounds, f->depths, visible, f->count,
                            listed ? (const uint32_t *)(const void *)f->spare : 0, listed ? f->tile_ends : 0,
                            listed ? f->tile_counts : 0, f->first_tile, f->last_tile, blended, f->targets,
                            f->indices, f->views, f->object_count};
    const int error = fxs_frame_stopped(f) ? FXS_ERR_STOPPED : config->draw(config->draw_argument, &r);
    f->stats.nanoseconds[FXS_BLEND] += fxs_now(f) - start;
    return error;
}

/* Passes tiles first to last to the back end in runs of tiles. The lists of a run must fit in the array `spare`; the
   list of one tile always fits. */
static int draw_tiles(fxs_frame *f, uint32_t first, uint32_t last)
{
    int error = 0;
    for (f->first_tile = first; f->first_tile <= last && !error; f->first_tile = f->last_tile + 1) {
        const uint64_t start = fxs_now(f), room = 2 * (uint64_t)f->key_capacity;
        uint64_t used = 0;
        uint32_t tile = f->first_tile;
        for (; tile <= last && used + f->tile_counts[tile] <= room; tile++) {
            used += f->tile_counts[tile];
            f->tile_ends[tile] = (uint32_t)used;
        }
        f->last_tile = tile - 1;
        fxs_frame_run(f, list_macro, f->last_macro - f->first_macro + 1);
        f->stats.nanoseconds[FXS_BIN] += fxs_now(f) - start;
        error = draw_run(f, 0, 0);
        f->stats.runs++;
    }
    return error;
}

int fxs_runs_draw(fxs_frame *f)
{
    const uint64_t start = fxs_now(f);
    const int32_t across = (int32_t)fxs_macros(f->view.tiles_x), tiles_x = f->view.tiles_x;
    const int32_t first = (int32_t)f->first_macro % across * FXS_MACRO;
    const int32_t last = fxs_min(((int32_t)f->last_macro % across + 1) * FXS_MACRO, tiles_x) - 1;
    const int32_t row = (int32_t)f->first_macro / across * FXS_MACRO;
    const int32_t first_row = row > f->first_row ? row : f->first_row;
    const int32_t end_row = fxs_min(((int32_t)f->last_macro / across + 1) * FXS_MACRO, f->end_row);
    int error = 0;
    fxs_frame_run(f, order_macro, f->last_macro - f->first_macro + 1);
    f->stats.nanoseconds[FXS_SORT] += fxs_now(f) - start;
    if (last - first + 1 == tiles_x)
        return draw_tiles(f, fxs_tiles_above(f, first_row), fxs_tiles_above(f, end_row) - 1);
    for (int32_t r = first_row; r < end_row && !error; r++)
        error = draw_tiles(f, fxs_tiles_above(f, r) + (uint32_t)first, fxs_tiles_above(f, r) + (uint32_t)last);
    return error;
}

int fxs_runs_draw_unlisted(fxs_frame *f)
{
    f->first_tile = fxs_tiles_above(f, f->first_row);
    f->last_tile = fxs_tiles_above(f, f->end_row) - 1;
    return draw_run(f, sort_all(f), 0);
}

int fxs_runs_draw_blended(fxs_frame *f)
{
    return draw_run(f, 0, f->pixels);
}

int fxs_runs_unlisted(const fxs_frame *f)
{
    return !f->draw_tile && f->context->config.draw_unlisted;
}

int fxs_runs_by_rows(const fxs_frame *f)
{
    return !f->draw_tile && f->context->config.draw_blended && f->end_row - f->first_row > 1 && !fxs_lists_rows_fit(f);
}

/* Draws each tile row with its own lists of splats. Lists for only part of a row of macro tiles (2x2 tiles) would mix
   two tile rows. */
int fxs_runs_draw_rows(fxs_frame *f)
{
    const int32_t first = f->first_row, end = f->end_row;
    int error = 0;
    for (int32_t row = first; row < end && !error; row++) {
        f->first_row = row;
        f->end_row = row + 1;
        error = fxs_frame_draw(f);
    }
    f->first_row = first;
    f->end_row = end;
    return error;
}
