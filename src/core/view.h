/* Prepares a camera for the stages of a frame. */
#ifndef FXS_VIEW_H
#define FXS_VIEW_H

#include <fixsplat/internal/stage.h>

/* Prepares the camera in world space. Returns 0, FXS_ERR_CAMERA or FXS_ERR_SIZE. */
int fxs_view_init(fxs_stage_view *view, const fxs_camera *camera, const fxs_options *options);

/* Prepares the camera in the space of a checked object. Returns 0, or FXS_ERR_OBJECT if the object is too far away. */
int fxs_view_of_object(fxs_stage_view *view, const fxs_stage_view *world, const fxs_camera *camera,
                       const fxs_object *object);

/* Sets a view's edges to those of the whole picture that the camera is a window of. */
FXS_STAGE void fxs_view_of_whole(fxs_stage_view *view, const fxs_camera *camera);

/* Returns true if the matrix is a right-handed rotation, within 2^-10. */
FXS_STAGE int fxs_is_rotation(const int32_t m_q30[9]);

/* Returns row i of m^T v; |v| < 2^61. */
FXS_STAGE int64_t fxs_turned_back(const int32_t m_q30[9], const int64_t v[3], int i);

#endif
