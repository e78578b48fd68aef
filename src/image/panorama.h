/* Makes equirectangular panoramas from six pictures, the faces of a cube. Integer arithmetic gives the same bytes on
   every machine. */
#ifndef FXS_PANORAMA_H
#define FXS_PANORAMA_H

#include <fixsplat/camera.h>
#include <fixsplat/image.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_PANORAMA_FACES 6

/* Returns the side of a cube face's picture in pixels: 90 degrees plus overlapping margins. */
int fxs_panorama_face_size(int width);

/* Makes the camera of a cube face from the panorama's camera: faces 0 to 5 are ahead, right, behind, left, up, down. */
void fxs_panorama_face(const fxs_view *view, int face, int width, fxs_view *out);

/* Writes rows first to end - 1 of a panorama from its cube faces. The camera's z axis is in the middle, its y axis at
   the lower edge. Pictures are RGBA without padding. */
void fxs_panorama_rows(uint8_t *rgba, int width, int height, uint8_t *const faces[FXS_PANORAMA_FACES], int first,
                       int end);

/* Adds an XMP packet (GPano) to an encoded .jpg, by which viewers recognise it as a full sphere. Returns 0, or
   FXS_ERR_MEMORY with *jpg unchanged. */
int fxs_panorama_mark(fxs_encoded *jpg, int width, int height);

#ifdef __cplusplus
}
#endif

#endif
