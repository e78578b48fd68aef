/* Renders stereo pairs. */
#ifndef FXS_STEREO_H
#define FXS_STEREO_H

#include "frame.h"

int fxs_stereo_render(fxs_frame *f, const fxs_request *request);

#endif
