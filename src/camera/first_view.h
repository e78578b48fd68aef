/* Chooses a first view of a scene by scoring small pictures. */
#ifndef FXS_FIRST_VIEW_H
#define FXS_FIRST_VIEW_H

#include <fixsplat/camera.h>

typedef struct fxs_first_choice {
    double up[3];                    /* unit vector */
    double from[3];                  /* direction from the middle of the box to the camera */
    double part;                     /* distance to the camera as a fraction, 0.5 to 1; 0: the camera is in the middle
                                        of the box */
    double low[3], high[3];          /* box that the view shows: of the scene, of its core, or around a place inside */
} fxs_first_choice;

/* Chooses a first view of objects in the box low..high, for a field of view of 50 degrees and an aspect of 3:2. `up` is
   the scene's up direction; null or 0: unknown. Kernels and threads do not change the result. Errors: FXS_ERR_ARGUMENT,
   FXS_ERR_SCENE, FXS_ERR_OBJECT, FXS_ERR_MEMORY. */
int fxs_first_view_choose(fxs_first_choice *first, const fxs_context *context, const fxs_object *objects,
                          uint32_t count, const double low[3], const double high[3], const double up[3],
                          fxs_message *message);

int fxs_first_view_make(const fxs_first_choice *first, double fov, int width, int height, fxs_view *view,
                        fxs_message *message);

#endif
