/* Learns the codebooks of a .sog file: 256 values for scalars, and a palette of SH vectors. */
#ifndef FXS_CODEBOOK_INTERNAL_H
#define FXS_CODEBOOK_INTERNAL_H

#include <fixsplat/scene.h>

#define FXS_BOOK 256

/* Learns a codebook: 256 ascending values, by Lloyd's quantiser with weights e^(power * value). Every value has an
   entry within about 1/32 of the range. Returns 0, or -1 if memory ran out. */
int fxs_book_learn(float book[FXS_BOOK], const float *values, size_t count, double power);

uint8_t fxs_book_find(const float book[FXS_BOOK], float value);

#define FXS_SH_PALETTE_MOST 65536u
/* length of a palette vector: 45 SH coefficients in the order of fxs_gaussian, then padding */
#define FXS_SH_PALETTE_STRIDE 48
#define FXS_SH_PALETTE_ONE 512       /* fixed-point 1: SH coefficients are multiples of 1/512, within +-8 */

typedef int16_t fxs_sh_palette_vector[FXS_SH_PALETTE_STRIDE];

/* Returns the largest number of SH palette entries for `count` Gaussians. */
uint32_t fxs_sh_palette_entries(uint32_t count);

/* Learns a palette of SH vectors by k-means (Lloyd 1982) in integers. Up to 256 coarse clusters each learn a share of
   the entries. labels[i] becomes the entry of vector i. Returns 0, or -1 if memory ran out or `progress` cancelled. */
int fxs_sh_palette_learn(fxs_sh_palette_vector *palette, uint32_t entries, uint32_t *labels,
                         const fxs_sh_palette_vector *vectors, uint32_t count, const fxs_progress *progress);

#endif
