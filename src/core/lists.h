/* Lists of a band: counted, filled, sorted. */
#ifndef FXS_LISTS_H
#define FXS_LISTS_H

#include "lister.h"

#define FXS_NEXT_MORE 4u           /* numbers per part in fxs_frame.next, after the macro tiles' counters */

/* The lister for one part of the blocks, which is one job. */
fxs_lister fxs_lister_of(const fxs_frame *f, uint32_t part);

/* Sets first_macro and last_macro to the macro tiles of the band, and counts the keys of their lists. */
void fxs_lists_count(fxs_frame *f);

/* After fxs_lists_count: true if the lists of each single row of macro tiles fit in the memory. */
int fxs_lists_rows_fit(const fxs_frame *f);

/* Makes the lists of macro tiles from first_macro to before `end`, as many as fit in `keys`, and sets last_macro. One
   list always fits, because it is at most as long as the number of slots. For a back end, the macro tiles are whole
   rows, or part of one row. */
void fxs_lists_fill(fxs_frame *f, uint32_t end);

/* For a macro tile, fxs_list_of returns the unsorted list. fxs_list_sort sorts the list and returns it. fxs_list_room
   returns scratch space for as many keys as the list has. */
const fxs_key *fxs_list_of(const fxs_frame *f, uint32_t macro);
const fxs_key *fxs_list_sort(const fxs_frame *f, uint32_t macro);
uint32_t *fxs_list_room(const fxs_frame *f, uint32_t macro);

/* Sets *tile to the picture's number of tile i (0 to 3, row by row) of a macro tile. Returns 0 if that tile is not
   drawn: outside the picture, the band or a slice's columns, or not the picked tile. */
int fxs_tile_of(const fxs_frame *f, uint32_t macro, int32_t i, uint32_t *tile);

#endif
