/* Slices: a tile row whose splats do not fit in the memory. */
#ifndef FXS_SLICES_H
#define FXS_SLICES_H

#include "frame.h"

/* Draws a band of one tile row whose splats do not fit in the memory. Returns 0, FXS_ERR_STOPPED, a back end's error,
   or FXS_ERR_SCENE, which is also the error if the scene changes meanwhile and yields more splats than Gaussians. */
int fxs_slices_draw(fxs_frame *f);

#endif
