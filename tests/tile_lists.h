/* Computes the lists of the splats (projected Gaussians) of all tiles with the renderer's plain C functions. */
#ifndef TILE_LISTS_H
#define TILE_LISTS_H

#include <stdlib.h>

#include "src/core/lister.h"

/* Lists of the splats (projected Gaussians) of each tile. The list of tile t has counts[t] entries. Its last
   entry is entries[ends[t] - 1]. */
typedef struct tile_lists {
    uint32_t *counts, *ends, *entries;
} tile_lists;

/* Makes the lists of all tiles for `count` splats (projected Gaussians). Each list is sorted by `depths`. */
static tile_lists tile_lists_new(const fxs_stage_view *view, const fxs_splat *splats, const fxs_bounds *bounds,
                                 const fxs_box *boxes, const uint32_t *depths, uint32_t count)
{
    const uint32_t tiles = (uint32_t)(view->tiles_x * view->tiles_y), across = fxs_macros(view->tiles_x);
    const uint32_t macros = across * fxs_macros(view->tiles_y);
    uint32_t *next = calloc(macros, sizeof *next), *lengths = calloc(macros, sizeof *lengths), total = 0;
    fxs_lister l = {.view = view, .splats = splats, .bounds = bounds, .boxes = boxes, .depths = depths,
                    .spans = fxs_spans_c, .note = fxs_note_c, .last_macro = macros - 1, .next = lengths};
    fxs_bin_count(&l, 0, count);
    for (uint32_t macro = 0; macro < macros; total += lengths[macro++])
        next[macro] = total;
    fxs_key *keys = malloc((total + 1) * sizeof *keys), *spare = malloc((total + 1) * sizeof *spare);
    tile_lists lists = {calloc(tiles, 4), calloc(tiles, 4), malloc(4 * ((size_t)total + 1) * sizeof(uint32_t))};
    l.next = next;
    fxs_bin_fill(&l, 0, count, keys);
    for (uint32_t macro = 0; macro < macros; macro++)
        fxs_sort_c(keys + next[macro] - lengths[macro], spare, lengths[macro]);
    total = 0;
    for (uint32_t tile = 0; tile < tiles; tile++) {
        const uint32_t column = tile % (uint32_t)view->tiles_x, row = tile / (uint32_t)view->tiles_x;
        const uint32_t macro = row / FXS_MACRO * across + column / FXS_MACRO;
        lists.counts[tile] = fxs_list_c(keys + next[macro] - lengths[macro], lengths[macro],
                                        row % FXS_MACRO * 2 + column % FXS_MACRO, lists.entries + total);
        if (view->cutoff == FXS_CUTOFF_SQUARE)
            fxs_mark_cut_off(&l, tile, lists.entries + total, lists.counts[tile]);
        lists.ends[tile] = total += lists.counts[tile];
    }
    free(next);
    free(lengths);
    free(keys);
    free(spare);
    return lists;
}

static void tile_lists_free(tile_lists *lists)
{
    free(lists->counts);
    free(lists->ends);
    free(lists->entries);
}

#endif
