/* Draws the tiles of a band of tile rows on the processor. */
#ifndef FXS_DRAW_H
#define FXS_DRAW_H

#include "frame.h"

/* Sorts the lists of splats of macro tiles (2x2 tiles) first_macro to last_macro, and draws their tiles. Returns 0 or
   FXS_ERR_STOPPED. */
int fxs_draw_macros(fxs_frame *f);

void fxs_draw_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* Clears a tile before blending: sets its colour sums to 0 and its transmittance to 1. */
void fxs_tile_clear(fxs_tile *tile);

#endif
