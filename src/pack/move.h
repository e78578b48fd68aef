/* Moves a packed scene as a whole. */
#ifndef FXS_MOVE_H
#define FXS_MOVE_H

/* Adds to the positions of a packed scene in memory, its tree's and its bounds, in units that are rounded to 2^-32; the
   start view stays. All must stay within 2^28 units. Checksums must be set again. */
void fxs_packed_move(void *data, const double by[3]);

/* The place of a chunk, by its header. */
void fxs_packed_place(const void *header, double place[3]);

#endif
