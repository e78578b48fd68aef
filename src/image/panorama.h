/* Makes equirectangular panoramas from six pictures, the faces of a cube. A stereo panorama (omni-directional stereo)
   has upright strips, each with its own place of the eye on a circle. Integer arithmetic gives the same bytes on every
   machine. */
#ifndef FXS_PANORAMA_H
#define FXS_PANORAMA_H

#include <fixsplat/camera.h>
#include <fixsplat/image.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_PANORAMA_FACES 6
#define FXS_PANORAMA_STRIPS 128      /* of an eye. Neighbouring places are 1 / 41 of the eyes' distance apart */

/* A part of a cube face's picture, with its RGBA pixels; width 0: none. */
typedef struct fxs_panorama_part {
    const uint8_t *rgba;
    int x, y, width, height;
} fxs_panorama_part;

/* Makes the camera of a cube face from the panorama's camera: faces 0 to 5 are ahead, right, behind, left, up, down. */
void fxs_panorama_face(const fxs_view *view, int face, int width, fxs_view *out);

/* Finds the parts of the cube faces that a strip needs. Strip 0 of 1 is the whole panorama. */
void fxs_panorama_parts(int width, int height, int strip, int strips, fxs_panorama_part parts[FXS_PANORAMA_FACES]);

/* Moves a panorama's camera by `aside` scene units to the right, as seen by a viewer who looks to the middle of the
   strip. */
void fxs_panorama_aside(const fxs_view *view, int strip, int strips, double aside, fxs_view *out);

/* Writes rows first to end - 1 of a strip from its parts of the cube faces. The camera's z axis is in the middle of the
   panorama, its y axis at the lower edge. Pictures are RGBA without padding. */
void fxs_panorama_rows(uint8_t *rgba, int width, int height, const fxs_panorama_part parts[FXS_PANORAMA_FACES],
                       int strip, int strips, int first, int end);

/* Adds an XMP packet (GPano) to an encoded .jpg, by which viewers recognise it as a full sphere. Returns 0, or
   FXS_ERR_MEMORY with *jpg unchanged. */
int fxs_panorama_mark(fxs_encoded *jpg, int width, int height);

#ifdef __cplusplus
}
#endif

#endif
