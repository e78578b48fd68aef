/* Decodes the Gaussians of a packed scene; formulas in docs/format.md. */
#ifndef FXS_DECODE_H
#define FXS_DECODE_H

#include <fixsplat/scene.h>
#include <fixsplat/internal/packed.h>

/* Decodes slot g of a chunk. The header is in this processor's byte order. From `scene`, only profile, degree and
   palette are used. */
void fxs_decode(const fxs_scene *scene, const fxs_chunk *chunk, const unsigned char *rows, uint32_t g,
                fxs_gaussian *out);

#endif
