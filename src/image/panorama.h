/* Equirectangular panoramas from six square pictures of the faces of a cube. Integers only, so the bytes are the same
   everywhere. */
#ifndef FXS_PANORAMA_H
#define FXS_PANORAMA_H

#include <fixsplat/camera_file.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_PANORAMA_FACES 6

/* The width and height of the faces for a panorama of this width: each shows 90 degrees, and a margin that is blended
   with its neighbours. */
int fxs_panorama_face_size(int width);

/* Makes the view of face 0 to 5 of a panorama around a view: ahead, right, behind, left, up, down. The near plane is
   the view's. */
void fxs_panorama_face(const fxs_file_view *view, int face, int width, fxs_file_view *out);

/* Writes rows first to end - 1 of a panorama of width x height pixels; the view's z axis is in its middle, its y axis
   at the lower edge. All pictures are RGBA without gaps; `faces` are those of the views of fxs_panorama_face. */
void fxs_panorama_rows(uint8_t *rgba, int width, int height, uint8_t *const faces[FXS_PANORAMA_FACES], int first,
                       int end);

#ifdef __cplusplus
}
#endif

#endif
