/* Table of the inner loops of packing. All instruction sets give equal results. */
#ifndef FXS_PACK_STAGE_H
#define FXS_PACK_STAGE_H

#include "coarsen.h"
#include "encode.h"

/* With FXS_TO_PACK, the build is small: it packs without levels of detail and without measuring losses. */
#ifdef FXS_TO_PACK
enum { FXS_BUILDS_TREES = 0, FXS_MEASURES_LOSS = 0 };
#else
enum { FXS_BUILDS_TREES = 1, FXS_MEASURES_LOSS = 1 };
#endif

typedef struct fxs_pack_stages {
    const char *name;
    /* Replaces each x by fxs_exp(x). */
    void (*exponentials)(double *x, uint32_t count);
    /* These functions have the contracts of fxs_ranges_take and fxs_encode in encode.h. */
    void (*take_ranges)(fxs_chunk_ranges *ranges, const fxs_gaussian *gaussian, double opacity, int sh_degree);
    void (*encode)(const fxs_encoder *encoder, const fxs_chunk *chunk, const fxs_gaussian *gaussian, double opacity,
                   unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss);
    /* Finds one signed entry per palette stage, so that the sum of the entries is near an SH vector. Subtracts the sum
       from the vector. */
    void (*find)(const fxs_palette *palette, fxs_sh_vector vector, uint8_t indices[FXS_PALETTE_STAGES]);
    /* Returns the index, with a sign, of the nearest of `count` SH vectors, count 1 to 16. The arrays are padded to a
       multiple of 8. */
    uint32_t (*nearest)(const fxs_sh_vector *vectors, const int32_t *squares, uint32_t count,
                        const fxs_sh_vector vector);
    /* Merges a set of more than `most` Gaussians down to `most` and adds the merge errors to `sums`. Null in builds
       without level-of-detail trees. */
    void (*coarsen)(fxs_merger *merger, uint32_t most, fxs_merge_error *sums);
    /* This function has the contract of fxs_palette_code_chunk in palette.h. */
    void (*code_chunk)(const fxs_palette *palette, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                       unsigned char *records, size_t stride, fxs_sh_loss *loss);
} fxs_pack_stages;

/* Returns the fastest table of functions that uses only instruction sets of `cpu` (enum fxs_cpu) that this processor
   supports. */
const fxs_pack_stages *fxs_pack_stages_choose(unsigned cpu);
extern const fxs_pack_stages fxs_pack_stages_c;

#endif
