/* SH as the sum of one entry of each of several palettes: residual vector quantisation (Juang and Gray 1982), each
 * palette learned by k-means (Lloyd 1982) on what the ones before it leave. The same on every machine. */
#ifndef FXS_PALETTE_H
#define FXS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

#include "../../src/packed.h"
#include "message.h"
#include "pack.h"

/* Coefficients as an entry of a packed palette has them: red, green, blue of 16, the last of each 0. */
typedef float fxs_sh_vector[FXS_PALETTE_STRIDE];

typedef struct fxs_palette {
    uint32_t stages, entries, step_q19;
    int8_t codes[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES][FXS_PALETTE_STRIDE];
    float values[FXS_PALETTE_STAGES][FXS_PALETTE_STRIDE][FXS_PALETTE_ENTRIES];   /* codes * step, a row a coefficient */
    float squares[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];   /* |entry|^2; beyond the last entry, infinite */
    float products[FXS_PALETTE_STAGES][FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES][FXS_PALETTE_ENTRIES];
} fxs_palette;                     /* [t][s][i][j], s < t: entry i of stage s times entry j of stage t */

/* Entries of a stage that are worth their bytes in a scene of `count` Gaussians. */
uint32_t fxs_palette_entries_for(uint64_t count);

/* Learns from `count` vectors, at least 1, which are overwritten. options->run is not null; options->progress is given 0
   to 1. Returns 0, or -1 and a message: out of memory, or stopped. */
int fxs_palette_learn(fxs_palette *palette, uint32_t stages, uint32_t entries, fxs_sh_vector *vectors, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message);

/* Finds entries whose sum is near a vector, an index for each stage; the vector becomes what is left. */
void fxs_palette_find(const fxs_palette *palette, fxs_sh_vector vector, uint8_t indices[FXS_PALETTE_STAGES]);

#endif
