/* More functions on cameras in double precision, for the library's ports and the command. */
#ifndef FXS_INTERNAL_VIEW_MORE_H
#define FXS_INTERNAL_VIEW_MORE_H

#include <fixsplat/camera.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns a near plane for a scene in the box low..high: a hundredth of half the box's diagonal, at most 0.2 units; 0.2
   for an empty box. */
FXS_EXPERIMENTAL double fxs_near_of_box(const double low[3], const double high[3]);

/* Estimates a scene's up direction from `count` views (cameras), each `stride` bytes after the one before. It is the
   mean of the cameras' up vectors, corrected by least squares to be perpendicular to the cameras' right vectors, since
   cameras pitch but rarely roll. `up` has the length 1. Returns 1, or 0 if the up vectors cancel each other: the length
   of their mean is 0.1 or less. */
FXS_EXPERIMENTAL int fxs_views_up(const fxs_view *views, size_t count, size_t stride, double up[3]);

/* Estimates a scene's up direction from one view that is not rolled, such as a start view. Candidates are the
   directions along the scene's axes (both ways) whose component along the picture's right vector is below a thousandth.
   The result is the candidate nearest to the picture's up vector; without candidates, the up vector itself. */
FXS_EXPERIMENTAL void fxs_view_up(const fxs_view *view, double up[3]);

/* Returns the tangent of the angle that the box low..high reaches to the left or right of a view (axis 0), or up or
   down (axis 1). Returns 0 if the camera stands within or before the box. */
FXS_EXPERIMENTAL double fxs_view_reach(const fxs_view *view, const double low[3], const double high[3], int axis);

/* Returns the tangent of the angle that a scene's visible part reaches to the left or right of a start view, at most
   16/9 of the view's vertical tangent. Returns 0 if the camera stands within the part, as in a room. `data`: the open
   packed scene. */
FXS_EXPERIMENTAL double fxs_start_reach(const fxs_view *start, const void *data);

/* Rolls a camera until `up` points up in its picture; position and direction stay. Returns 1; returns 0 and leaves the
   camera unchanged if it looks along `up`. */
FXS_EXPERIMENTAL int fxs_view_level(fxs_view *view, const double up[3]);

/* Turns a camera about an axis through `middle` by an angle in radians, as if the scene turned the opposite way. */
FXS_EXPERIMENTAL void fxs_view_orbit(fxs_view *view, const double middle[3], const double axis[3], double angle);

#ifdef __cplusplus
}
#endif

#endif
