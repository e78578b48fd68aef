/* Divides a fit that is too large for one machine: chooses the photographs and the first Gaussians of one block of
 * space, from the points of the reconstruction or from a coarse fit of the whole.
 * Not stable: may change with every version. */
#ifndef FXS_FIT_BLOCKS_H
#define FXS_FIT_BLOCKS_H

#include "photos.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_FIT_BLOCKS_MOST 4096

/* A short fit of the whole set, from which blocks go on; any number of threads may read it. */
typedef struct fxs_fit_coarse fxs_fit_coarse;

typedef struct fxs_fit_block {
    uint32_t number, blocks;
    double low[3], high[3];        /* low <= place < high. Without a coarse fit outermost blocks reach to -INFINITY and
                                      INFINITY */
    fxs_photos photos;             /* has its own arrays */
    float extent;                  /* extent of the whole set, for fxs_fit_options */
    const fxs_fit_coarse *coarse;  /* null: none */
    uint32_t *gaussians;           /* indices of its Gaussians that the block begins with, ascending */
    size_t gaussian_count;
    int owns_pixels;               /* 0: the pixels are those of another set */
} fxs_fit_block;

/* Chooses block `number`, 1 to `blocks`, of a set in memory. Space is divided in two at the median of the points (for an
   odd number of blocks, at the place in proportion to the blocks on each side), along the axis on which the middle three
   quarters of the points are widest, and each part again. The order of the points does not matter. Each place is in
   exactly one block.

   The block gets a photograph, to fit or held out, that shows a twentieth or more of the points in the block, or that
   shows one of them and was taken within their widened box: the box of these points without the outermost 64th on each
   side, extended there by a fifth of its longest side. It gets the points in the widened box, and all points that its
   photographs to fit show.

   The pixels stay those of the whole set. fxs_fit_block_free frees the block and must be called before the whole set is
   freed. Errors: FXS_ERR_ARGUMENT (the numbers), FXS_ERR_FILE where the block has no point or no photograph to fit,
   FXS_ERR_MEMORY. */
FXS_API int fxs_fit_block_choose(const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_block *block,
                                 fxs_message *message);

/* The same for a set of files: cameras and points are read, but only the photographs that the block gets. `coarse` may
   be null. With it the centres of its Gaussians are the points, and the block gets Gaussians in the place of points; all
   blocks together end two widths of the box of all cameras outside of that box, and `number` may be 0: the coarse fit's
   Gaussians outside of all blocks, low and high being those of all blocks together, and no photograph. The coarse fit
   must stay until the block is freed. Where the cameras state an angle and no size, as Blender's, the choice takes
   their photographs for square. Errors: those of fxs_photos_read and above, FXS_ERR_FILE where the coarse fit is of
   other photographs, and FXS_ERR_UNSUPPORTED where the cameras state neither: those of Bundler, and RealityCapture's
   .csv. */
FXS_API int fxs_fit_block_read(const char *path, const fxs_photos_options *options, const fxs_fit_coarse *coarse,
                               uint32_t number, uint32_t blocks, fxs_fit_block *block, fxs_message *message);
FXS_API void fxs_fit_block_free(fxs_fit_block *block);

/* Reads a saved fit (fxs_fit_save) of all photographs, of any size. fxs_fit_coarse_free frees *coarse, which is null
   after an error: as of fxs_fit_resume, but for other photographs. */
FXS_API int fxs_fit_coarse_read(fxs_fit_coarse **coarse, const char *path, fxs_message *message);
FXS_API void fxs_fit_coarse_free(fxs_fit_coarse *coarse);     /* null is allowed */
FXS_API uint32_t fxs_fit_coarse_steps(const fxs_fit_coarse *coarse);
FXS_API uint64_t fxs_fit_coarse_number(const fxs_fit_coarse *coarse);   /* a checksum of the file */

/* Begins the fit of a block from 1 on: at the step at which the coarse fit ended, with its Gaussians, Adam's moments,
   extent and exposures, which stay as they are. options->block, blocks and coarse are to be those of the block. Errors:
   those of fxs_fit_create, and FXS_ERR_ARGUMENT where options->steps are no more than the coarse fit's. */
FXS_API int fxs_fit_create_block(fxs_fit **fit, const fxs_fit_coarse *coarse, const fxs_fit_block *block,
                                 const fxs_fit_options *options, fxs_message *message);

/* The Gaussians of the coarse fit that the block has, for fxs_scene_file_open_gaussians; valid as long as both. */
FXS_API void fxs_fit_block_gaussians(const fxs_fit_block *block, fxs_gaussian_source *gaussians);

#ifdef __cplusplus
}
#endif

#endif
