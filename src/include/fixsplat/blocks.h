/* A part of a fit that is too large for one machine: the photographs and points of one block of space. */
#ifndef FXS_FIT_BLOCKS_H
#define FXS_FIT_BLOCKS_H

#include "photos.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_FIT_BLOCKS_MOST 4096

typedef struct fxs_fit_block {
    double low[3], high[3];        /* low <= place < high; outermost blocks reach to -INFINITY and INFINITY */
    fxs_photos photos;             /* arrays of its own; the pixels are those of the whole set */
    float extent;                  /* of the whole set, for fxs_fit_options */
} fxs_fit_block;

/* Block `number`, 1 to `blocks`, of space. It is halved where the points' median is (for an odd number of blocks where
   the shares are), along the axis on which the middle three quarters of them reach farthest, and each half again. The
   order of the points does not matter. Each place is in exactly one block.

   Its photographs, to fit and held out: those with a twentieth or more of the block's points in the picture, and those
   with one there that were taken from within the box of these points, widened on each side by a fifth of its longest.
   Its points: those in the widened box, and all that its photographs to fit have in the picture.

   fxs_fit_block_free frees it, before the whole set. Errors: FXS_ERR_ARGUMENT (the numbers), FXS_ERR_FILE where there
   is no point in the block or no photograph to fit, FXS_ERR_MEMORY. */
int fxs_fit_block_choose(const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_block *block,
                         fxs_message *message);
void fxs_fit_block_free(fxs_fit_block *block);

#ifdef __cplusplus
}
#endif

#endif
