/* Moves the camera of a viewer by drags, the wheel or keys. The camera turns about the pivot, a point straight ahead at
 * `distance` scene units. up: the scene's up vector, of any length. Angles are in radians. */
#ifndef FXS_MOTION_H
#define FXS_MOTION_H

#include <fixsplat/camera.h>

/* Turns the camera about the pivot (a point ahead), as if a drag turned the scene right and down. Stops before the view
   is parallel to `up`. */
void fxs_motion_orbit(fxs_view *view, double distance, const double up[3], double right, double down);

/* Turns the camera about its own centre, to the right and down. Stops before the view is parallel to `up`. */
void fxs_motion_look(fxs_view *view, const double up[3], double right, double down);

/* Moves the camera along its own axes by distances in scene units. */
void fxs_motion_fly(fxs_view *view, double right, double down, double forward);

/* Moves the camera sideways so that the pivot (a point ahead) shifts by `right` and `down` pixels in the picture. */
void fxs_motion_pan(fxs_view *view, double distance, double right, double down);

/* Multiplies the camera's distance to the pivot (a point ahead) by `factor`. In an orthographic view, multiplies the
   size of a pixel. */
void fxs_motion_zoom(fxs_view *view, double *distance, double factor);

/* Changes the size of the picture. Keeps the vertical field of view and the centre. */
void fxs_motion_fit(fxs_view *view, int width, int height);

#endif
