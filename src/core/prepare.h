/* Runs the stages project, shade and bin for a band (some rows of tiles). */
#ifndef FXS_PREPARE_H
#define FXS_PREPARE_H

#include "frame.h"

#define FXS_BLOCK 16u
#define FXS_BLOCK_FAILED UINT32_MAX   /* value in fxs_frame.block_counts of a block of chunks that had an error */

/* Run one stage: project and shade for a chunk (256 Gaussians), bin for any splats. `place` is the index of the chunk
   among the drawn chunks. fxs_prepare_animate moves a chunk of a moving scene to the frame's moment, in the memory of a
   block; of other scenes it does nothing. fxs_prepare_project calls it, and fxs_prepare_shade reads the chunk that is
   in that memory. fxs_prepare_project returns the number of splats stored from index `slot` on, or FXS_ERR_SCENE. */
int fxs_prepare_animate(fxs_frame *f, uint32_t object, uint32_t place, uint32_t block);
int32_t fxs_prepare_project(fxs_frame *f, uint32_t object, uint32_t place, uint32_t slot, uint32_t end_slot,
                            uint32_t block);
int fxs_prepare_shade(fxs_frame *f, uint32_t object, uint32_t place, uint32_t slot, uint32_t count, uint32_t block);
void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count);

/* Runs the stages project, shade and bin on all blocks of chunks. In the mode FXS_FRAME_PLAN, which only counts splats,
   runs only project. Returns 0, FXS_ERR_STOPPED or FXS_ERR_SCENE. */
int fxs_prepare_blocks(fxs_frame *f);

int fxs_prepare_band(fxs_frame *f);

#endif
