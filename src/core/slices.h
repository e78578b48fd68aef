/* Draws a tile row with more splats than the memory holds. */
#ifndef FXS_SLICES_H
#define FXS_SLICES_H

#include "frame.h"

/* Draws a band of one tile row in slices, some of its splats at a time. Returns 0, FXS_ERR_STOPPED, FXS_ERR_SCENE or a
   back end's error. */
int fxs_slices_draw(fxs_frame *f);

#endif
