/* Lists the splats that touch each macro tile of 2x2 tiles, in two passes: count, then fill. */
#ifndef FXS_LISTER_H
#define FXS_LISTER_H

#include "frame.h"

/* Return the tile rows, and the tile columns, where a list may contain the splat. */
FXS_STAGE fxs_span fxs_bin_rows(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds);

FXS_STAGE fxs_span fxs_bin_columns(const fxs_stage_view *view, const fxs_bounds *bounds);

/* State of a job that makes the lists of splats for macro tiles (2x2 tiles) first_macro to last_macro. The first pass
   counts the keys (entries) of each list, and notes its results while space lasts. The second pass writes the keys. */
typedef struct fxs_lister {
    const fxs_stage_view *view;
    const fxs_splat *splats;
    const fxs_bounds *bounds;
    const fxs_box *boxes;
    const uint32_t *depths;
    void (*spans)(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row,
                  int32_t rows, fxs_span *spans);
    uint32_t (*note)(const fxs_stage_view *view, const fxs_box *boxes, uint32_t first, uint32_t count, uint32_t *macros,
                     uint32_t *listed);
    uint32_t first_macro, last_macro;
    uint32_t *next;                /* for each macro tile: number of keys; in the second pass, index of its next key */
    uint64_t *notes;
    uint32_t room, taken;          /* capacity for notes (results of the first pass for the second); number of notes
                                      taken, UINT32_MAX: overflow */
    uint32_t noted, from;
} fxs_lister;

/* First pass over `count` splats from index `first` on: increments next[m] for each splat that macro tile m (2x2 tiles)
   lists. */
void fxs_bin_count(fxs_lister *l, uint32_t first, uint32_t count);

/* Second pass over `count` splats from index `first` on: writes the key of each splat to keys[next[m]++] for each macro
   tile m that lists it. */
void fxs_bin_fill(fxs_lister *l, uint32_t first, uint32_t count, fxs_key *keys);

/* Second pass over the splats that the first pass noted: writes their keys, using the notes. */
void fxs_bin_fill_noted(fxs_lister *l, fxs_key *keys);

/* With the square cut-off, a splat may be in the list of a tile that its ellipse misses. Sets FXS_ENTRY_CUT_OFF in the
   entries of such splats. */
void fxs_mark_cut_off(const fxs_lister *l, uint32_t tile, uint32_t *entries, uint32_t count);

#endif
