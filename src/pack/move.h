/* Translates a whole packed scene. */
#ifndef FXS_MOVE_H
#define FXS_MOVE_H

/* Adds `by` to the positions of a packed scene in memory, including its tree and bounds. `by` is rounded to 2^-32
   units. The start view is not moved. Positions must stay within 2^28 units. The caller must recompute the
   checksums. */
void fxs_packed_move(void *data, const double by[3]);

/* The origin of a chunk, from its little-endian header. */
void fxs_packed_place(const void *header, double place[3]);

#endif
