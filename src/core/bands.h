/* Divides a frame into bands: ranges of tile rows that are drawn in turn, to limit the memory. */
#ifndef FXS_BANDS_H
#define FXS_BANDS_H

#include "frame.h"

/* Returns the bytes of a frame, possibly above SIZE_MAX. */
uint64_t fxs_bands_measure(fxs_frame *f);

/* Sets the mode to FXS_FRAME_WHOLE if the memory has a slot for every Gaussian, otherwise to FXS_FRAME_PLAN. Returns 0,
   or FXS_ERR_MEMORY if the memory is too small for any view. */
int fxs_bands_init(fxs_frame *f);

/* Returns true if the frame can be drawn in slices, without depths, ids and an occluder. */
int fxs_bands_can_slice(const fxs_frame *f);

/* Counts the splats of each tile row. Returns 0, FXS_ERR_SCENE, FXS_ERR_STOPPED or FXS_ERR_MEMORY. */
int fxs_bands_plan(fxs_frame *f);

int fxs_band_next(fxs_frame *f);

/* Counts `count` splats from `slot` on by tile row. `place` is the index of their chunk among the drawn chunks. */
void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t place, uint32_t slot, uint32_t count);

int fxs_band_has_chunk(const fxs_frame *f, uint32_t place);

/* Keeps those of `count` splats from `slot` on that touch the band. Returns the number kept. */
uint32_t fxs_band_keep(fxs_frame *f, uint32_t place, uint32_t slot, uint32_t count);

#endif
