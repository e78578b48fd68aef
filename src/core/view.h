/* A camera made ready for the stages. */
#ifndef FXS_VIEW_H
#define FXS_VIEW_H

#include <fixsplat/stage.h>

/* The camera in the world. Returns 0 or FXS_ERR_CAMERA, FXS_ERR_SIZE. */
int fxs_view_init(fxs_view *view, const fxs_camera *camera, const fxs_options *options);

/* The same camera in the space of an object that was checked. Returns 0, or FXS_ERR_OBJECT where it is too far away. */
int fxs_view_of_object(fxs_view *view, const fxs_view *world, const fxs_camera *camera, const fxs_object *object);

/* Makes the edges of a view those of the whole picture, of which the camera's is a window, with nothing hidden. */
FXS_STAGE void fxs_view_of_whole(fxs_view *view, const fxs_camera *camera);

/* Rows of length 1 and at right angles, within 2^-10, and right-handed: row0 x row1 = row2. */
FXS_STAGE int fxs_is_rotation(const int32_t m_q30[9]);

/* Row i of the transpose of m times v; |v| below 2^61. */
FXS_STAGE int64_t fxs_turned_back(const int32_t m_q30[9], const int64_t v[3], int i);

#endif
