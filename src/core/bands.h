/* Divides a frame into bands: ranges of tile rows that are drawn in turn, to limit the memory. */
#ifndef FXS_BANDS_H
#define FXS_BANDS_H

#include "frame.h"

/* Returns the bytes of memory in which a frame is drawn in one band, possibly above SIZE_MAX. */
uint64_t fxs_bands_measure(fxs_frame *f);

/* Sets the frame's mode to FXS_FRAME_WHOLE if the memory has a place for a splat of every Gaussian, otherwise to
   FXS_FRAME_PLAN. Returns 0, or FXS_ERR_MEMORY if the memory is too small for any camera. */
int fxs_bands_init(fxs_frame *f);

/* Returns true if a tile row with too many splats for the memory can be drawn in slices, some splats at a time. Slices
   support no depths, ids and occluder. */
int fxs_bands_can_slice(const fxs_frame *f);

/* Counts the splats of each tile row, to divide the frame into bands. Returns 0, FXS_ERR_SCENE, FXS_ERR_STOPPED or
   FXS_ERR_MEMORY. */
int fxs_bands_plan(fxs_frame *f);

int fxs_band_next(fxs_frame *f);

/* Counts by tile row the `count` splats that are stored from index `slot` on. `place` is the index of their chunk (256
   Gaussians) among the drawn chunks. */
void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t place, uint32_t slot, uint32_t count);

int fxs_band_has_chunk(const fxs_frame *f, uint32_t place);

/* Of the `count` splats that are stored from index `slot` on, keeps only the splats that touch the current band of tile
   rows. Returns the number of splats kept. */
uint32_t fxs_band_keep(fxs_frame *f, uint32_t place, uint32_t slot, uint32_t count);

#endif
