/* Cameras in doubles, and how they become the renderer's integers.
 *
 * Nothing here is kept between calls, so several threads may call these at the same time. */
#ifndef FXS_CAMERA_H
#define FXS_CAMERA_H

#include "fixsplat.h"
#include "camera_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a camera of `width` x `height` pixels at `eye` that looks towards `target`, both in scene units. `up` is any
   vector that points up in the picture, and `fov` the vertical field of view in degrees, 1 to 170. The near plane is
   the renderer's default. Returns 0, or FXS_ERR_ARGUMENT and a message where there is no such camera. */
int fxs_view_look_at(fxs_file_view *view, const double eye[3], const double target[3], const double up[3], double fov,
                     int width, int height, fxs_message *message);

/* The near plane for a scene in the box low..high: a hundredth of half the box's diagonal, at most 0.2 units. */
double fxs_near_of_box(const double low[3], const double high[3]);

/* Makes a camera that sees the box low..high (say, the inner bounds of fxs_pack_report) whole, and no smaller than that
   takes. It looks from in front and a little above, and its near plane is fxs_near_of_box. Errors as above. */
int fxs_view_frame_box(fxs_file_view *view, const double low[3], const double high[3], const double up[3], double fov,
                       int width, int height, fxs_message *message);

/* Changes the size of the picture: fx and fy are scaled by new width / old width, and the principal point comes to the
   centre. */
void fxs_view_resize(fxs_file_view *view, int width, int height);

/* Gives a camera a field of view by the tangents of its sides, as headsets state them: left, right, up, down, with left
   < right and down < up; left and down are negative but for a picture beside the axis. Pixels need not be square then.
   Returns 0, or FXS_ERR_ARGUMENT and a message where they are not so, or not within +-64. */
int fxs_view_set_tangents(fxs_file_view *view, const double tangents[4], fxs_message *message);

/* Turns the camera about an axis through `middle` by an angle in radians, as if the scene were turned the other way. */
void fxs_view_orbit(fxs_file_view *view, const double middle[3], const double axis[3], double angle);

/* The camera on a smooth way through `count` keys, 1 or more, at `at` = 0 to count - 1: key i at i, and the same time
   between any two. Positions, rotations (as quaternions, the shorter way round), the logarithms of focal lengths and
   near planes, and principal points are Catmull-Rom splines. Size, name and projection are those of the key before. */
void fxs_view_between(const fxs_file_view *keys, long count, double at, fxs_file_view *view);

/* Rounds a camera to the renderer's integers. Returns 0, or FXS_ERR_CAMERA and a message where it is out of the
   renderer's range. */
int fxs_camera_from_view(fxs_camera *camera, const fxs_file_view *view, fxs_message *message);

/* Makes a camera of `width` x `height` pixels of the two matrices that OpenGL programs have, 16 numbers by columns (as
   glUniformMatrix4fv takes them, not transposed), for column vectors: eye = view_matrix * world, clip = projection *
   eye. The axes of the eye are OpenGL's, x right, y up, looking along -z; depths in clip space are -1 to 1 from near to
   far, and y points up. The world is the scene's, in its units. The view may not scale, shear or mirror (rotation
   orthonormal within 1e-3). The projection is of glFrustum's kind or of glOrtho's, centred or not. Its near plane, above
   0, becomes the camera's; its far plane may be at infinity in perspective, and is not kept. Mirrored pictures, skew and
   depths from far to near are refused; depths of 0 to 1 cannot be told from a near plane at half the distance. Errors as
   fxs_camera_from_view, and FXS_ERR_SIZE where width or height is outside 1..FXS_MAX_SIZE. */
int fxs_camera_from_matrices(fxs_camera *camera, const double view_matrix[16], const double projection[16], int width,
                             int height, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
