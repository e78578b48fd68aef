/* Decodes the Gaussians of a packed scene to floats. docs/format.md has the formulas. */
#ifndef FXS_DECODE_H
#define FXS_DECODE_H

#include <fixsplat/scene.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>
#include "src/core/codes.h"
#include "src/gaussian/attributes.h"

/* Decodes the position and the coefficients of SH degree 0 of a Gaussian. */
static inline void fxs_decode_point(const fxs_chunk *chunk, const fxs_codes *codes, float position[3], float dc[3])
{
    for (int i = 0; i < 3; i++) {
        const int64_t steps = (int64_t)codes->position[i] * chunk->step_q32[i] << chunk->step_shift;
        position[i] = (float)((double)(chunk->origin_q32[i] + steps) * 0x1p-32);
        dc[i] = fxs_dc_of_colour(chunk->colour_q16[i] * 0x1p-16 +
                                 (double)fxs_colour_code(codes, i) * chunk->colour_step_q20[i] * 0x1p-20);
    }
}

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
