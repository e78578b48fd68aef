/* The loops of packing that kernels/pack has for instruction sets. All versions give the same results. */
#ifndef FXS_PACK_STAGE_H
#define FXS_PACK_STAGE_H

#include "coarsen.h"
#include "encode.h"

/* FXS_TO_PACK: a build that packs scenes without levels of detail, and has nobody to read what packing loses. */
#ifdef FXS_TO_PACK
enum { FXS_BUILDS_TREES = 0, FXS_MEASURES_LOSS = 0 };
#else
enum { FXS_BUILDS_TREES = 1, FXS_MEASURES_LOSS = 1 };
#endif

typedef struct fxs_pack_stages {
    const char *name;
    /* Puts e^x, as fxs_exp has it, in the place of each x. */
    void (*exponentials)(double *x, uint32_t count);
    /* fxs_ranges_take, fxs_encode */
    void (*take_ranges)(fxs_chunk_ranges *ranges, const fxs_gaussian *gaussian, double opacity, int sh_degree);
    void (*encode)(const fxs_encoder *encoder, const fxs_chunk *chunk, const fxs_gaussian *gaussian, double opacity,
                   unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss);
    /* Finds signed entries whose sum is near a vector, an index for each stage; the vector becomes what is left. */
    void (*find)(const fxs_palette *palette, fxs_sh_vector vector, uint8_t indices[FXS_PALETTE_STAGES]);
    /* The signed index of the nearest of `count` vectors, at most 16. There are as many as the next multiple of 8. */
    uint32_t (*nearest)(const fxs_sh_vector *vectors, const int32_t *squares, uint32_t count,
                        const fxs_sh_vector vector);
    /* Merges a set of more than `most` Gaussians until that many are left, and adds to the errors. Null where no trees
       are built. */
    void (*coarsen)(fxs_merger *merger, uint32_t most, fxs_merge_error *sums);
    /* fxs_palette_code_chunk */
    void (*code_chunk)(const fxs_palette *palette, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                       unsigned char *records, size_t stride, fxs_sh_loss *loss);
} fxs_pack_stages;

/* The fastest stages for the instruction sets in `cpu` (enum fxs_cpu) that this processor has. */
const fxs_pack_stages *fxs_pack_stages_choose(unsigned cpu);
extern const fxs_pack_stages fxs_pack_stages_c;

#endif
