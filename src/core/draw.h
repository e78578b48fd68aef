/* Draws a band's tiles with the kernels sort, blend and resolve. */
#ifndef FXS_DRAW_H
#define FXS_DRAW_H

#include "frame.h"

/* Sorts the lists of macro tiles first_macro to last_macro, and draws their tiles with draw_tile. Returns 0 or
   FXS_ERR_STOPPED. */
int fxs_draw_macros(fxs_frame *f);

/* An fxs_tile_fn: blends the tile and writes its pixels. */
void fxs_draw_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* Empties a tile: sums 0, T = 1. */
void fxs_tile_clear(fxs_tile *tile);

#endif
