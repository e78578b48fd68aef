/* Equirectangular pictures: all around a point, from six square pictures of a cube's faces. Integers only, so the same
   bytes everywhere. */
#ifndef FXS_PANORAMA_H
#define FXS_PANORAMA_H

#include <fixsplat/camera_file.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_PANORAMA_FACES 6

/* The width and height of the faces for a panorama of so many pixels across: each shows 90 degrees, and a margin in
   which it is blended with its neighbours. */
int fxs_panorama_face_size(int width);

/* Face 0 to 5 of a panorama around a view's centre: ahead, right, behind, left, up, down of it. The near plane is the
   view's. */
void fxs_panorama_face(const fxs_file_view *view, int face, int width, fxs_file_view *out);

/* Writes rows first to end - 1 of a panorama of width x height pixels; the view's z axis is in its middle, its y axis
   at the lower edge. All are RGBA without gaps; `faces`: pictures of fxs_panorama_face. */
void fxs_panorama_rows(uint8_t *rgba, int width, int height, uint8_t *const faces[FXS_PANORAMA_FACES], int first,
                       int end);

#ifdef __cplusplus
}
#endif

#endif
