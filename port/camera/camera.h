/* Cameras in doubles, and how they become the renderer's integers. */
#ifndef FXS_CAMERA_H
#define FXS_CAMERA_H

#include "../../src/fixsplat.h"
#include "camera_file.h"
#include "../files/message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A view of `width` x `height` pixels from `eye` towards `target`, its near plane the default. `up`: any vector that
   points up in the picture. `fov`: vertical field of view, degrees. Returns 0, or -1 and a message where the arguments leave no view. */
int fxs_view_look_at(fxs_file_view *view, const double eye[3], const double target[3], const double up[3], double fov,
                     int width, int height, fxs_message *message);

/* The near plane for a scene in the box low..high: a hundredth of half its diagonal, at most 0.2. */
double fxs_near_of_box(const double low[3], const double high[3]);

/* A view that holds the box low..high (say, the inner bounds of fxs_pack_report) whole and no smaller than that takes,
   from in front and a little above; its near plane is that of the box. */
int fxs_view_frame_box(fxs_file_view *view, const double low[3], const double high[3], const double up[3], double fov,
                       int width, int height, fxs_message *message);

/* The same view at another size: fx and fy scaled by new width / old width, the principal point in the centre. */
void fxs_view_resize(fxs_file_view *view, int width, int height);

/* Turns a view about an axis through `middle` by an angle in radians, as if the scene were turned the other way. */
void fxs_view_orbit(fxs_file_view *view, const double middle[3], const double axis[3], double angle);

/* Rounds a view to the renderer's camera. Returns 0, or -1 and a message where it is out of the renderer's range. */
int fxs_camera_from_view(fxs_camera *camera, const fxs_file_view *view, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
