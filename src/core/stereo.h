/* Renders stereo pairs. */
#ifndef FXS_STEREO_H
#define FXS_STEREO_H

#include "frame.h"

/* Renders both eyes of an initialised frame. Returns 0 or an FXS_ERR_*. */
int fxs_stereo_render(fxs_frame *f, const fxs_request *request);

#endif
