/* Debug view of the levels of detail. */
#ifndef FXS_SHOW_H
#define FXS_SHOW_H

#include "frame.h"

/* Replaces the colours of a chunk's splats by the colour of its tree level, times their brightness, (r + 2 g + b) / 4.
   `chunk` counts from the object's first chunk. */
void fxs_show_level(const fxs_object_view *object, uint32_t chunk, fxs_splat *splats, uint32_t count);

#endif
