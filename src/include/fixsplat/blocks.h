/* Divides a fit that is too large for one machine: chooses the photographs and points of one block of space.
 * Not stable: may change with every version. */
#ifndef FXS_FIT_BLOCKS_H
#define FXS_FIT_BLOCKS_H

#include "photos.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_FIT_BLOCKS_MOST 4096

typedef struct fxs_fit_block {
    double low[3], high[3];        /* low <= place < high; outermost blocks reach to -INFINITY and INFINITY */
    fxs_photos photos;             /* has its own arrays, but shares the pixels of the whole set */
    float extent;                  /* extent of the whole set, for fxs_fit_options */
} fxs_fit_block;

/* Chooses block `number`, 1 to `blocks`. Space is divided in two at the median of the points (for an odd number of
   blocks, at the place in proportion to the blocks on each side), along the axis on which the middle three quarters of
   the points are widest, and each part again. The order of the points does not matter. Each place is in exactly one
   block.

   The block gets a photograph, to fit or held out, that shows a twentieth or more of the points in the block, or that
   shows one of them and was taken within their widened box: the box of these points, extended on each side by a fifth
   of its longest side. It gets the points in the widened box, and all points that its photographs to fit show.

   fxs_fit_block_free frees it and must be called before the whole set is freed. Errors: FXS_ERR_ARGUMENT (the numbers),
   FXS_ERR_FILE where the block has no point or no photograph to fit, FXS_ERR_MEMORY. */
FXS_API int fxs_fit_block_choose(const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_block *block,
                                 fxs_message *message);
FXS_API void fxs_fit_block_free(fxs_fit_block *block);

#ifdef __cplusplus
}
#endif

#endif
