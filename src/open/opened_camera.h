/* The first view of an opened scene. */
#ifndef FXS_OPENED_CAMERA_H
#define FXS_OPENED_CAMERA_H

#include <fixsplat/renderer.h>

/* Chooses a view of an opened scene that is wholly in memory, as fxs_first_view does, with the box and the up direction
   of the scene. */
int fxs_opened_first_view(const fxs_opened *opened, const fxs_picture *picture, fxs_view *view, fxs_message *message);

#endif
