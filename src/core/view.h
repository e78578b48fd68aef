/* Prepares a camera for the stages. */
#ifndef FXS_VIEW_H
#define FXS_VIEW_H

#include <fixsplat/stage.h>

/* The camera in world space. Returns 0, FXS_ERR_CAMERA or FXS_ERR_SIZE. */
int fxs_view_init(fxs_view *view, const fxs_camera *camera, const fxs_options *options);

/* The camera in the space of a checked object. Returns 0, or FXS_ERR_OBJECT if the object is too far away. */
int fxs_view_of_object(fxs_view *view, const fxs_view *world, const fxs_camera *camera, const fxs_object *object);

/* Sets a view's edges to those of the whole picture that the camera is a window of. */
FXS_STAGE void fxs_view_of_whole(fxs_view *view, const fxs_camera *camera);

/* True if the rows have length 1 and are perpendicular, within 2^-10, and right-handed: row0 x row1 = row2. */
FXS_STAGE int fxs_is_rotation(const int32_t m_q30[9]);

/* Row i of m^T v; |v| < 2^61. */
FXS_STAGE int64_t fxs_turned_back(const int32_t m_q30[9], const int64_t v[3], int i);

#endif
