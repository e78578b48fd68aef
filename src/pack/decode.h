/* Decodes the Gaussians of a packed scene, as docs/format.md describes. */
#ifndef FXS_DECODE_H
#define FXS_DECODE_H

#include <fixsplat/gaussian.h>
#include <fixsplat/packed.h>

/* The Gaussian of slot g of a chunk with this header, in this processor's byte order, and these rows. Of the scene only
   the profile, the degree and the palette are read. */
void fxs_decode(const fxs_scene *scene, const fxs_chunk *chunk, const unsigned char *rows, uint32_t g,
                fxs_gaussian *out);

#endif
