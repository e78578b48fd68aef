/* Adds up what the Gaussians contribute to marked pixels of a picture. */
#ifndef FXS_WEIGH_H
#define FXS_WEIGH_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Adds a Gaussian's weights in the pixels of each label to sums[label_count * gaussian + label]. The weight of a
   Gaussian in a pixel is alpha times the transmittance before it, in Q15; the weights of a pixel and what is left of
   its transmittance add up to FXS_CLEAR_Q15. Gaussians behind 7/8 of a pixel's light are hidden: they get no weight
   there. `gaussian` counts the slots of all objects. labels[width * y + x] is the label of pixel (x, y); pixels with a
   label of label_count or more are left out. Renders the first eye of the request on the calling thread, without
   targets. `memory` (aligned to 64) has at least the size that fxs_request_bytes returns for the request. Sums do not
   depend on the kernels. Returns the errors of fxs_render. */
FXS_EXPERIMENTAL int fxs_weigh(const fxs_context *context, const fxs_request *request, const uint8_t *labels,
                               uint32_t label_count, uint64_t *sums, void *memory, size_t memory_bytes);

#ifdef __cplusplus
}
#endif

#endif
