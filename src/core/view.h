/* Prepares a camera for the stages of a frame. */
#ifndef FXS_VIEW_H
#define FXS_VIEW_H

#include <fixsplat/internal/stage.h>

/* Prepares a camera in world space for the stages of a frame. Returns 0, FXS_ERR_CAMERA or FXS_ERR_SIZE. */
int fxs_view_init(fxs_stage_view *view, const fxs_camera *camera, const fxs_options *options);

/* Prepares a camera in the space of an object that is already checked. Returns 0, or FXS_ERR_OBJECT if the object is
   too far away. */
int fxs_view_of_object(fxs_stage_view *view, const fxs_stage_view *world, const fxs_camera *camera,
                       const fxs_object *object);

/* A camera may be a window of a larger picture. Sets the view's edges to the edges of that picture. */
FXS_STAGE void fxs_view_of_whole(fxs_stage_view *view, const fxs_camera *camera);

/* Sets the view's edges to those of a window of its picture, with a margin for the dilation of veils. */
void fxs_view_of_window(fxs_stage_view *view, const int32_t first[2], const int32_t size[2]);

/* Returns true if the matrix m is a right-handed rotation, within a tolerance of 2^-10. */
FXS_STAGE int fxs_is_rotation(const int32_t m_q30[9]);

/* Returns element i of m^T v, the vector v turned back by the rotation m. |v| < 2^61. */
FXS_STAGE int64_t fxs_turned_back(const int32_t m_q30[9], const int64_t v[3], int i);

#endif
