/* Draws macro tiles (2x2 tiles) on the processor: sorts each list of splats, blends the splats and writes the
 * pixels. */
#include "draw.h"
#include "lister.h"
#include "lists.h"
#include "memory.h"
#include "targets.h"
#include "tile_rates.h"
#include "times.h"
#include "trace.h"

#define TIMED 4                    /* one macro tile in 4 is timed, because reading the clock is slow */

void fxs_draw_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    fxs_tile pixels;
    int32_t x, y;
    fxs_tile_origin(f, tile, &x, &y);
    if (fxs_targets_traced(f->targets))
        fxs_trace_tile(f, list, x, y, 0, &pixels, 0);
    else if (!list->count)
        fxs_tile_clear(&pixels);
    else
        f->context->config.kernels->blend(&f->view, x, y, f->splats, list->entries, list->count, &pixels);
    fxs_lap(f, laps, FXS_BLENDED);
    fxs_resolve_targets(f, &pixels, x, y);
}

static void draw_samples(fxs_frame *f, uint32_t macro, int shift, const fxs_list *list, fxs_laps *laps)
{
    const uint32_t across = fxs_macros(f->view.tiles_x);
    fxs_tile samples;
    uint32_t tile, length = list->count;
    fxs_trace_tile(f, list, (int32_t)(macro % across) * FXS_RATE_PIXELS, (int32_t)(macro / across) * FXS_RATE_PIXELS,
                   shift, &samples, 0);
    fxs_lap(f, laps, FXS_BLENDED);
    for (int32_t i = 0; i < FXS_MACRO * FXS_MACRO; i++)
        if (fxs_tile_of(f, macro, i, &tile)) {
            int32_t x, y;
            fxs_tile_origin(f, tile, &x, &y);
            fxs_rate_resolve(f, &samples, shift, (i / FXS_MACRO * FXS_TILE + i % FXS_MACRO) * FXS_TILE >> shift, 1, x,
                             y);
            f->tile_counts[tile] = length;         /* the first tile counts the list */
            length = 0;
        }
    fxs_lap(f, laps, FXS_RESOLVED);
}

/* Returns log2 of the rate at which a macro tile is drawn. Slices draw all pixels and then share them. */
static int shift_of(const fxs_frame *f, uint32_t macro)
{
    const int32_t across = (int32_t)fxs_macros(f->view.tiles_x);
    return f->draw_tile == fxs_draw_tile && f->lengths[macro]
               ? fxs_rate_shift(&f->targets->rates, f->view.width, f->view.height,
                                (int32_t)macro % across * FXS_RATE_PIXELS, (int32_t)macro / across * FXS_RATE_PIXELS)
               : 0;
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
    fxs_lap(f, &laps, FXS_SORTED);
    const int shift = shift_of(f, macro);
    for (uint32_t k = 0; k < length && shift; k++)
        entries[k] = FXS_LISTED_SLOT(keys[k]);
    if (shift) {
        fxs_lap(f, &laps, FXS_LISTED_TILES);
        draw_samples(f, macro, shift, &(fxs_list){entries, length}, &laps);
        return;
    }
    for (int32_t i = 0; i < FXS_MACRO * FXS_MACRO; i++)
        if (fxs_tile_of(f, macro, i, &tile)) {
            f->tile_counts[tile] = f->context->config.kernels->list(keys, length, (uint32_t)i, entries);
            if (l.view->cutoff == FXS_CUTOFF_SQUARE)
                fxs_mark_cut_off(&l, tile, entries, f->tile_counts[tile]);
            if (length)
                fxs_lap(f, &laps, FXS_LISTED_TILES);
            f->draw_tile(f, tile, &(fxs_list){entries, f->tile_counts[tile]}, &laps);
            if (length)
                fxs_lap(f, &laps, FXS_RESOLVED);
        }
    if (!length)
        fxs_lap(f, &laps, FXS_RESOLVED);
}

int fxs_draw_macros(fxs_frame *f)
{
    static const enum fxs_stage stages[FXS_LAPS] = {FXS_SORT, FXS_BIN, FXS_BLEND, FXS_RESOLVE};
    const uint64_t start = fxs_now(f);
    const uint32_t jobs = f->last_macro - f->first_macro + 1;
    fxs_frame_run(f, draw_macro, jobs);
    f->stats.runs++;
    fxs_share_time(f, start, f->macro_times + FXS_LAPS * (size_t)f->first_macro, jobs, FXS_LAPS, stages);
    return f->stopped ? FXS_ERR_STOPPED : 0;
}
