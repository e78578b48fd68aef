/* Renders stereo pairs. */
#ifndef FXS_STEREO_H
#define FXS_STEREO_H

#include "frame.h"

/* Returns FXS_ERR_SIZE if the pictures of two eyes differ in size or projection, FXS_ERR_TARGET if their targets
   overlap, or 0. */
int fxs_stereo_check(const fxs_request *request);

int fxs_stereo_render(fxs_frame *f, const fxs_request *request);

#endif
