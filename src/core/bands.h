/* Bands: tile rows drawn one after the other in a limited memory. */
#ifndef FXS_BANDS_H
#define FXS_BANDS_H

#include "frame.h"

/* Returns the bytes of a frame; the result may exceed SIZE_MAX. Fills in stats.memory. */
uint64_t fxs_bands_measure(fxs_frame *f);

/* Lays out the memory and sets the mode: FXS_FRAME_WHOLE if the memory has a slot for every Gaussian, otherwise
   FXS_FRAME_PLAN. Returns 0, or FXS_ERR_MEMORY if the memory is below the minimum for any view. */
int fxs_bands_init(fxs_frame *f);

/* True if the frame can be drawn in slices. Slices keep only colours, so a frame with depths, ids or an occluder
   cannot. */
int fxs_bands_can_slice(const fxs_frame *f);

/* Projects the Gaussians to count the splats of each tile row. Returns 0, FXS_ERR_SCENE, FXS_ERR_STOPPED, or
   FXS_ERR_MEMORY if a tile row does not fit and slices are not possible. */
int fxs_bands_plan(fxs_frame *f);

/* Advances to the next band: as many tile rows as fit in the memory, from end_row on. Returns 0 after the last band. */
int fxs_band_next(fxs_frame *f);

/* Plan: counts, by tile row, the `count` splats from `slot` on. `place` is their chunk's place in the list of drawn
   chunks. */
void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t place, uint32_t slot, uint32_t count);

int fxs_band_has_chunk(const fxs_frame *f, uint32_t place);

/* Compacts `count` splats from `slot` on to those that touch the band. Returns how many remain. */
uint32_t fxs_band_keep(fxs_frame *f, uint32_t place, uint32_t slot, uint32_t count);

#endif
