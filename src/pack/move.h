/* Translates a whole packed scene in place. */
#ifndef FXS_MOVE_H
#define FXS_MOVE_H

/* Adds `by`, rounded to 2^-32 units, to the positions, tree and bounds of a packed scene in memory. The start view
   is not moved. Positions must stay within 2^28 units. The caller must recompute the checksums. */
void fxs_packed_move(void *data, const double by[3]);

/* Reads the origin of a chunk (256 Gaussians) from its little-endian header. */
void fxs_packed_place(const void *header, double place[3]);

#endif
