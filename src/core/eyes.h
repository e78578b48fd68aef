/* project for a pair of eyes. */
#ifndef FXS_EYES_H
#define FXS_EYES_H

#include "frame.h"

/* Projects a chunk of an object for both eyes, from `slot` on; share_q8 and grow_q8 as in fxs_object_project. A
   Gaussian that either eye sees takes the same slot in both. In an eye that does not see it, it has the depth from the
   other eye. Returns the number of slots taken, at most 256, or FXS_ERR_SCENE. */
int32_t fxs_eyes_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t share_q8, uint32_t grow_q8,
                         uint32_t slot);

/* After bin: removes from all tiles the splats that the eye does not see. */
void fxs_eyes_hide(const fxs_bounds *bounds, uint32_t count, fxs_box *boxes);

#endif
