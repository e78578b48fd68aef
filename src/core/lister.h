/* Lists of macro tiles: which splats touch them. */
#ifndef FXS_LISTER_H
#define FXS_LISTER_H

#include "frame.h"

/* Tile rows that may list a splat. */
FXS_STAGE fxs_span fxs_bin_rows(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds);

/* Tile columns that may list a splat. */
fxs_span fxs_bin_columns(const fxs_view *view, const fxs_bounds *bounds);

/* Input of a job that makes the lists of macro tiles first_macro to last_macro. Arrays are indexed by slot, `next` by
   macro tile. The first pass counts the keys of each list; the second pass writes them. While space lasts, the first
   pass notes its results so that the second need not compute them again. */
typedef struct fxs_lister {
    const fxs_view *view;
    const fxs_splat *splats;
    const fxs_bounds *bounds;
    const fxs_box *boxes;
    const uint32_t *depths;        /* lists are sorted by these */
    void (*spans)(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row, int32_t rows,
                  fxs_span *spans);    /* `spans` and `note` as in fxs_kernels */
    uint32_t (*note)(const fxs_view *view, const fxs_box *boxes, uint32_t first, uint32_t count, uint32_t *macros,
                     uint32_t *listed);
    uint32_t first_macro, last_macro;
    uint32_t *next;                /* keys in each list; in the second pass, place of the next key */
    uint64_t *notes;
    uint32_t room, taken;          /* capacity for notes; notes taken, UINT32_MAX after an overflow */
    uint32_t noted, from;          /* the first `noted` notes cover all slots before `from` */
} fxs_lister;

/* First pass over `count` slots from `first` on: adds 1 to next[macro] for each list that gets a splat, and takes
   notes. */
void fxs_bin_count(fxs_lister *l, uint32_t first, uint32_t count);

/* Second pass: writes each key to keys[next[macro]], then adds 1 to next[macro]. */
void fxs_bin_fill(fxs_lister *l, uint32_t first, uint32_t count, fxs_key *keys);

/* Second pass for slots before `from`, from the notes. */
void fxs_bin_fill_noted(fxs_lister *l, fxs_key *keys);

/* Square cut-off only: sets FXS_ENTRY_CUT_OFF in the entries of a tile's list whose ellipse misses the tile. */
void fxs_mark_cut_off(const fxs_lister *l, uint32_t tile, uint32_t *entries, uint32_t count);

#endif
