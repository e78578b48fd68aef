/* Blends tiles with depths and ids. */
#ifndef FXS_TRACE_H
#define FXS_TRACE_H

#include "frame.h"

/* Blends the list of splats of the tile at pixel (x, y), and writes the tile's depths and ids. If `shift`, log2 of the
   rate, is above 0: of the macro tile at pixel (x, y), with a sample for each block of pixels. If slots[256] is not
   null, it receives for each sample the index of the splat with the largest weight, or FXS_NOTHING. */
void fxs_trace_tile(const fxs_frame *f, const fxs_list *list, int32_t x, int32_t y, int shift, fxs_tile *samples,
                    uint32_t *slots);

/* Returns the id of a Gaussian by its number, counted over all objects. *object caches the last object found. */
fxs_id fxs_id_of(const fxs_object_view *objects, uint32_t count, uint32_t index, const fxs_object_view **object);

#endif
