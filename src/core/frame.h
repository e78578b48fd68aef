/* A frame from its memory to its pixels, for those that render more than one, or less: stereo.c, pick.c. */
#ifndef FXS_FRAME_H
#define FXS_FRAME_H

#include "parts.h"

/* Checks the arguments, then the memory. Targets may be null. Returns 0 or an FXS_ERR_*. */
int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_object *objects, uint32_t count,
                   const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets, void *memory,
                   size_t memory_bytes);

/* A second camera and its targets. Errors as fxs_frame_init. */
int fxs_frame_add_eye(fxs_frame *f, const fxs_camera *camera, const fxs_targets *targets);

/* Cuts up the memory and places the objects; where it does not hold every Gaussian, finds out how many splats each tile
   row has. Returns 0, FXS_ERR_MEMORY where they do not fit either (stats.memory.least has what would do),
   FXS_ERR_OBJECT, FXS_ERR_SCENE or FXS_ERR_STOPPED. */
int fxs_frame_begin(fxs_frame *f);

/* The band's splats, for each eye. Returns 0, FXS_ERR_SCENE or FXS_ERR_STOPPED. */
int fxs_frame_prepare(fxs_frame *f);

/* Lists the splats of f->eye, by f->depths, and draws the band into its targets. Returns 0, FXS_ERR_STOPPED or a
   back end's error. */
int fxs_frame_draw(fxs_frame *f);

/* Bytes of a frame of one eye or two; 0 where an argument is out of range. *memory may be null. */
size_t fxs_measure(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                   int32_t height, uint32_t eyes, fxs_frame_memory *memory);

/* The whole frame of f->eye, from its memory to its pixels. Returns 0, FXS_ERR_MEMORY, FXS_ERR_SCENE, FXS_ERR_OBJECT,
   FXS_ERR_STOPPED or a back end's error. */
int fxs_frame_render(fxs_frame *f);

#endif
