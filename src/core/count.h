/* Counts the pairs of a pixel and a Gaussian that the blend stage evaluates, for statistics. */
#ifndef FXS_COUNT_H
#define FXS_COUNT_H

#include <fixsplat/internal/stage.h>

/* Counts the work of the blend stage for the first eye of a request, in pairs of a pixel and a Gaussian. Renders the
   frame with the plain C stages on one thread, without an occluder. A pair is evaluated if the Gaussian is in the list
   of the pixel's tile and may touch the pixel's row, and the pixel is not opaque yet. Pixels beyond the picture's edge
   count too. An evaluated pair is blended if the pixel is within the cut-off and alpha is at least 1/255. Returns the
   errors of fxs_render. */
int fxs_count_pairs(const fxs_request *request, void *memory, size_t memory_bytes, uint64_t *evaluated,
                            uint64_t *blended);

/* Blends a tile like fxs_blend_c. Also counts the evaluated and blended pairs of a pixel and a Gaussian: adds them to
   *evaluated and *blended. */
void fxs_blend_count(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                             const uint32_t *entries, uint32_t count, fxs_tile *tile, uint64_t *evaluated,
                             uint64_t *blended);

#endif
