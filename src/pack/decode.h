/* Decodes the Gaussians of a packed scene to floats. docs/format.md has the formulas. */
#ifndef FXS_DECODE_H
#define FXS_DECODE_H

#include <fixsplat/scene.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>

/* Decodes Gaussian g of a chunk, g < 256. The chunk's header must be in native byte order. Only the profile, the SH
   degree and the palette of `scene` are used. */
void fxs_decode(const fxs_scene *scene, const fxs_chunk *chunk, const unsigned char *rows, uint32_t g,
                fxs_gaussian *out);

/* Decodes the motion of Gaussian g of a chunk of a moving scene. Moves *out, which fxs_decode filled in, to the time of
   its largest opacity. */
void fxs_decode_motion(const fxs_motion_rows *rows_of_motion, const fxs_motion_header *header,
                       const fxs_chunk_motion *chunk_motion, const fxs_chunk *chunk, const unsigned char *rows,
                       uint32_t g, fxs_gaussian *out, fxs_motion *motion);

#endif
