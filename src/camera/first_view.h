/* Chooses where to look at a scene from that comes without cameras, by looking at small pictures of it. */
#ifndef FXS_FIRST_VIEW_H
#define FXS_FIRST_VIEW_H

#include <fixsplat/camera_file.h>

typedef struct fxs_first_choice {
    double up[3];                    /* of length 1 */
    double from[3];                  /* the direction from the middle of the box to the camera, looking back along it */
    double part;                     /* of the distance from which the whole box is seen, 0.5 to 1; 0: in its middle */
    double low[3], high[3];          /* the box: that of the scene, or of its core, or about a place within it */
} fxs_first_choice;

/* Chooses for objects that are seen in the box low..high. `up` is what is up there, of any length; null or 0: it is
   found. The choice is the same whatever kernels and threads the context has, and is made for a field of view of 50
   degrees and a picture of 3:2. Errors: FXS_ERR_ARGUMENT, FXS_ERR_SCENE, FXS_ERR_OBJECT, FXS_ERR_MEMORY. */
int fxs_first_view_choose(fxs_first_choice *first, const fxs_context *context, const fxs_object *objects,
                          uint32_t count, const double low[3], const double high[3], const double up[3],
                          fxs_message *message);

/* Makes the view that was chosen. Errors are those of fxs_view_look_at. */
int fxs_first_view_make(const fxs_first_choice *first, double fov, int width, int height, fxs_file_view *view,
                        fxs_message *message);

#endif
