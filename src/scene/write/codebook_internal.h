/* What a .sog says once for many Gaussians: values that numbers are rounded to, and the SH of a palette. */
#ifndef FXS_CODEBOOK_INTERNAL_H
#define FXS_CODEBOOK_INTERNAL_H

#include <fixsplat/scene_file.h>

#define FXS_BOOK 256

/* Finds 256 values, in their order, that these are near to: Lloyd's quantiser. Returns 0, or -1: out of memory. */
int fxs_book_learn(float book[FXS_BOOK], const float *values, size_t count);

/* The nearest of a book. */
uint8_t fxs_book_find(const float book[FXS_BOOK], float value);

#define FXS_SH_PALETTE_MOST 65536u
#define FXS_SH_PALETTE_STRIDE 48     /* of a vector; the coefficients of an fxs_gaussian first */
#define FXS_SH_PALETTE_ONE 512       /* they are whole multiples of 1 / this, within +-8 */

typedef int16_t fxs_sh_palette_vector[FXS_SH_PALETTE_STRIDE];

/* The most entries for so many Gaussians: a power of two. */
uint32_t fxs_sh_palette_entries(uint32_t count);

/* Learns the palette of `count` vectors by k-means (Lloyd 1982) in two steps, in integers: the vectors are shared out
   among some 256 coarse clusters, and each of these finds its share of the entries among its own. labels[i] is the
   entry of vector i. Returns 0 and the `entries` vectors in palette; or -1: out of memory, or stopped. */
int fxs_sh_palette_learn(fxs_sh_palette_vector *palette, uint32_t entries, uint32_t *labels,
                         const fxs_sh_palette_vector *vectors, uint32_t count, fxs_progress_fn *progress,
                         void *argument);

#endif
