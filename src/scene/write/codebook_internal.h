/* The codebooks of a .sog: values to which numbers are rounded, and a palette of SH. */
#ifndef FXS_CODEBOOK_INTERNAL_H
#define FXS_CODEBOOK_INTERNAL_H

#include <fixsplat/scene_file.h>

#define FXS_BOOK 256

/* Finds 256 ascending values near to these, by Lloyd's quantiser, with weights e^(power value). However small its weight,
   each of these has one of the 256 within about a 32nd of their range. Returns 0, or -1: out of memory. */
int fxs_book_learn(float book[FXS_BOOK], const float *values, size_t count, double power);

/* The index of the nearest value of a codebook. */
uint8_t fxs_book_find(const float book[FXS_BOOK], float value);

#define FXS_SH_PALETTE_MOST 65536u
#define FXS_SH_PALETTE_STRIDE 48     /* numbers of a vector; the first ones are coefficients as in fxs_gaussian */
#define FXS_SH_PALETTE_ONE 512       /* coefficients are multiples of 1 / this, within +-8 */

typedef int16_t fxs_sh_palette_vector[FXS_SH_PALETTE_STRIDE];

/* The most entries for this many Gaussians, a power of two. */
uint32_t fxs_sh_palette_entries(uint32_t count);

/* Learns the palette of `count` vectors by k-means (Lloyd 1982) in two steps, in integers: the vectors are divided into
   up to 256 coarse clusters, and each cluster learns its share of the entries from its own vectors. labels[i] is the
   entry of vector i. Returns 0 and `entries` vectors in `palette`; or -1: out of memory, or stopped. */
int fxs_sh_palette_learn(fxs_sh_palette_vector *palette, uint32_t entries, uint32_t *labels,
                         const fxs_sh_palette_vector *vectors, uint32_t count, fxs_progress_fn *progress,
                         void *argument);

#endif
