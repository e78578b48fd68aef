/* Equirectangular panoramas from six square pictures of cube faces. Integers only, so the bytes are the same
   everywhere. */
#ifndef FXS_PANORAMA_H
#define FXS_PANORAMA_H

#include <fixsplat/camera.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_PANORAMA_FACES 6

/* The width and height of a face for a panorama of this width: 90 degrees plus margins that overlap the neighbours. */
int fxs_panorama_face_size(int width);

/* Makes the view of a face around a view: 0 to 5 are ahead, right, behind, left, up, down. Keeps the view's near
   plane. */
void fxs_panorama_face(const fxs_file_view *view, int face, int width, fxs_file_view *out);

/* Writes rows first to end - 1 of a panorama of width x height pixels. The view's z axis is in the middle, its y
   axis at the lower edge. All pictures are RGBA without gaps. `faces`: pictures of the views of fxs_panorama_face. */
void fxs_panorama_rows(uint8_t *rgba, int width, int height, uint8_t *const faces[FXS_PANORAMA_FACES], int first,
                       int end);

#ifdef __cplusplus
}
#endif

#endif
