/* Camera motion: what a drag, the wheel or a key does to a view. `distance`: from the camera's centre to the pivot, the
   point ahead that it turns about, scene units, above 0. `up`: up in the scene, of any length. Angles are radians. */
#ifndef FXS_MOTION_H
#define FXS_MOTION_H

#include <fixsplat/camera_file.h>

/* Turns the camera about the pivot, as if a drag to the right and down by these angles turned the scene. It stops short
   of looking along `up`. */
void fxs_motion_orbit(fxs_file_view *view, double distance, const double up[3], double right, double down);

/* Turns the camera in place, to the right and down; it stops likewise. */
void fxs_motion_look(fxs_file_view *view, const double up[3], double right, double down);

/* Moves the camera along its own axes, scene units. */
void fxs_motion_fly(fxs_file_view *view, double right, double down, double forward);

/* Moves the camera so that the pivot shifts by so many of the view's pixels. */
void fxs_motion_pan(fxs_file_view *view, double distance, double right, double down);

/* Makes the distance `factor` times as long; the pivot stays. Of an orthographic view, what a pixel shows instead. */
void fxs_motion_zoom(fxs_file_view *view, double *distance, double factor);

/* Gives the view another size; what it shows from top to bottom stays, and the middle. */
void fxs_motion_fit(fxs_file_view *view, int width, int height);

#endif
