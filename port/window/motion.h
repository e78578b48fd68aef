/* Moves a view by a drag, the wheel or a key. `distance`: from the camera's centre to the pivot, the point ahead about
   which it turns, scene units, above 0. `up`: up in the scene, of any length. Angles are in radians. */
#ifndef FXS_MOTION_H
#define FXS_MOTION_H

#include <fixsplat/camera_file.h>

/* Turns the camera about the pivot, as if a drag to the right and down by these angles turned the scene. It stops short
   of looking along `up`. */
void fxs_motion_orbit(fxs_file_view *view, double distance, const double up[3], double right, double down);

/* Turns the camera in place, to the right and down, with the same limit. */
void fxs_motion_look(fxs_file_view *view, const double up[3], double right, double down);

/* Moves the camera along its own axes, scene units. */
void fxs_motion_fly(fxs_file_view *view, double right, double down, double forward);

/* Moves the camera so that the pivot shifts by this many pixels of the view. */
void fxs_motion_pan(fxs_file_view *view, double distance, double right, double down);

/* Multiplies the distance by `factor`; the pivot stays. In an orthographic view, the size of a pixel is multiplied. */
void fxs_motion_zoom(fxs_file_view *view, double *distance, double factor);

/* Changes the size of the view; its vertical field of view and its middle stay. */
void fxs_motion_fit(fxs_file_view *view, int width, int height);

#endif
