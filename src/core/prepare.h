/* The stages project, shade and bin of a band, block by block. */
#ifndef FXS_PREPARE_H
#define FXS_PREPARE_H

#include "frame.h"

#define FXS_BLOCK 16u              /* chunks that go through project, shade and bin together */
#define FXS_BLOCK_FAILED UINT32_MAX   /* scene damaged or changed */

/* Stages project and shade for one chunk of an object, with its splats from `slot` on, and bin for any slots. `place`
   is the chunk's place in the list of drawn chunks; `chunk` is its number among all objects' chunks.
   fxs_prepare_project drops splats outside the band and returns the number of splats left, or FXS_ERR_SCENE. It also
   returns FXS_ERR_SCENE if fewer than 256 slots are free before end_slot, because then the scene has changed since the
   plan. fxs_prepare_shade returns 0 or FXS_ERR_SCENE. */
int32_t fxs_prepare_project(fxs_frame *f, uint32_t object, uint32_t place, uint32_t slot, uint32_t end_slot);
int fxs_prepare_shade(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot, uint32_t count);
void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count);

/* Runs the three stages on all blocks; a plan runs only project. Returns 0, FXS_ERR_STOPPED, or FXS_ERR_SCENE if a
   block failed. */
int fxs_prepare_blocks(fxs_frame *f);

/* fxs_prepare_blocks for a band; also counts its splats and measures the time. */
int fxs_prepare_band(fxs_frame *f);

#endif
