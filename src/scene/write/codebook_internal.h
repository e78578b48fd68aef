/* The codebooks of a .sog: 256 values for scalars, and a palette of SH vectors. */
#ifndef FXS_CODEBOOK_INTERNAL_H
#define FXS_CODEBOOK_INTERNAL_H

#include <fixsplat/scene.h>

#define FXS_BOOK 256

/* Learns 256 ascending values by Lloyd's quantiser, with weights e^(power value). Every input, however small its
   weight, has an entry within about 1/32 of the range. Returns 0, or -1 if memory ran out. */
int fxs_book_learn(float book[FXS_BOOK], const float *values, size_t count, double power);

/* Returns the index of the nearest entry. */
uint8_t fxs_book_find(const float book[FXS_BOOK], float value);

#define FXS_SH_PALETTE_MOST 65536u
#define FXS_SH_PALETTE_STRIDE 48     /* components of a vector; the first are coefficients in the order of
                                        fxs_gaussian */
#define FXS_SH_PALETTE_ONE 512       /* coefficients are multiples of 1/512, within +-8 */

typedef int16_t fxs_sh_palette_vector[FXS_SH_PALETTE_STRIDE];

/* Returns the maximum number of entries for `count` Gaussians, a power of two. */
uint32_t fxs_sh_palette_entries(uint32_t count);

/* Learns the palette of `count` vectors by k-means (Lloyd 1982) in integers, in two steps: the vectors are divided into
   up to 256 coarse clusters; each cluster then learns its share of the entries from its own vectors. labels[i]: entry
   of vector i. Returns 0 and `entries` vectors in `palette`; or -1 if memory ran out or `progress` stopped it. */
int fxs_sh_palette_learn(fxs_sh_palette_vector *palette, uint32_t entries, uint32_t *labels,
                         const fxs_sh_palette_vector *vectors, uint32_t count, fxs_progress_fn *progress,
                         void *argument);

#endif
