/* Runs the stages project, shade and bin for a band of tile rows. */
#ifndef FXS_PREPARE_H
#define FXS_PREPARE_H

#include "frame.h"

#define FXS_BLOCK 16u
#define FXS_BLOCK_FAILED UINT32_MAX   /* error code in fxs_frame.block_counts */

/* Run the stages project and shade for a chunk, and bin for any slots. `place` is the index of the chunk among the
   drawn chunks; `chunk` is its number, counted over all objects. fxs_prepare_project returns the number of splats
   stored from `slot` on, or FXS_ERR_SCENE. */
int32_t fxs_prepare_project(fxs_frame *f, uint32_t object, uint32_t place, uint32_t slot, uint32_t end_slot);
int fxs_prepare_shade(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot, uint32_t count);
void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count);

/* Runs the stages on all blocks of chunks, or only project for a plan. Returns 0, FXS_ERR_STOPPED or FXS_ERR_SCENE. */
int fxs_prepare_blocks(fxs_frame *f);

int fxs_prepare_band(fxs_frame *f);

#endif
