/* Counts, fills and sorts the lists of splats of macro tiles (2x2 tiles each). */
#ifndef FXS_LISTS_H
#define FXS_LISTS_H

#include "lister.h"

#define FXS_NEXT_MORE 4u

fxs_lister fxs_lister_of(const fxs_frame *f, uint32_t part);

void fxs_lists_count(fxs_frame *f);

/* Returns true if the memory holds the lists of splats of any one row of macro tiles (2x2 tiles). Call fxs_lists_count
   first. */
int fxs_lists_rows_fit(const fxs_frame *f);

/* Fills as many lists of splats as fit in the memory, at least one. Begins with macro tile first_macro and ends before
   macro tile `end`. Sets last_macro to the last macro tile with a filled list. For a back end, the macro tiles are
   whole rows or part of one row. */
void fxs_lists_fill(fxs_frame *f, uint32_t end);

/* fxs_list_of returns the unsorted list of splats of a macro tile (2x2 tiles). fxs_list_sort sorts and returns the
   list. fxs_list_room returns scratch space for as many keys as the list has. */
const fxs_key *fxs_list_of(const fxs_frame *f, uint32_t macro);
const fxs_key *fxs_list_sort(const fxs_frame *f, uint32_t macro);
uint32_t *fxs_list_room(const fxs_frame *f, uint32_t macro);

/* Sets *tile to the number of tile i of a macro tile (2x2 tiles), i from 0 to 3, row by row. Returns 0 if that tile is
   not drawn. */
int fxs_tile_of(const fxs_frame *f, uint32_t macro, int32_t i, uint32_t *tile);

#endif
