/* Divides a fit that is too large for one machine into blocks of space. Chooses the photographs and the initial
 * Gaussians of one block, from the points of the reconstruction or from a coarse fit of the whole.
 */
#ifndef FXS_FIT_BLOCKS_H
#define FXS_FIT_BLOCKS_H

#include <fixsplat/fit.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_FIT_BLOCKS_MOST 4096

/* A short fit of all photographs, which the fits of single blocks of space continue. Any number of threads may read
   it. */
typedef struct fxs_fit_coarse fxs_fit_coarse;

typedef struct fxs_fit_block {
    uint32_t number, blocks;
    double low[3], high[3];        /* bounds of the block: low <= position < high. Without a coarse fit of the whole,
                                      the outermost blocks extend to -INFINITY and INFINITY */
    fxs_photos photos;             /* the block's photographs and points, in arrays of its own */
    float extent;                  /* extent of the whole scene, for fxs_fit_options */
    const fxs_fit_coarse *coarse;  /* null: none */
    uint32_t *gaussians;           /* ascending indices of the Gaussians that the block takes from the coarse fit of the
                                      whole */
    size_t gaussian_count;
    int owns_pixels;               /* 0: the photographs' pixels belong to another set, which frees them */
} fxs_fit_block;

/* Chooses block `number`, 1 to `blocks`, of a set of photographs in memory. Space is cut in two at the median
   coordinate of the points (for an odd number of blocks, in proportion to the blocks on each side). The cut is along
   the axis on which the middle three quarters of the points are widest. Each part is cut again in the same way, until
   each block has its part. The order of the points does not matter. Every place is in exactly one block.

   A block's widened box is the bounding box of its points without the outermost 64th of them on each side, extended on
   each side by a fifth of its longest side. The block gets each photograph, to fit or held out, that shows at least a
   twentieth of the points in the block. From inside the widened box, a photograph needs to show only a single point of
   the block. The block gets the points in the widened box, and all points that its photographs to fit show.

   The block uses the pixels of `whole`. fxs_fit_block_free frees the block; call it before `whole` is freed. Errors:
   FXS_ERR_ARGUMENT (`number`, `blocks`), FXS_ERR_FILE if the block has no point or no photograph to fit,
   FXS_ERR_MEMORY. */
int fxs_fit_block_choose(const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_block *block,
                                 fxs_message *message);

/* Chooses a block as fxs_fit_block_choose, for a set of photographs in files. Reads all cameras and points, but only
   the photographs that the block gets. `coarse`, a coarse fit of the whole, may be null; else it must stay until the
   block is freed. With a coarse fit:
   - The centres of its Gaussians replace the points, and the block gets Gaussians instead of points.
   - All blocks together extend beyond the bounding box of all cameras by twice the longest side of that box, in every
     direction.
   - `number` may be 0, which selects the coarse fit's Gaussians outside of all blocks. The fields low and high of
     `block` are then the bounds of all blocks together, and the block has no photograph.
   If the file of cameras states an angle of view and no picture size, as Blender's, the choice assumes square
   photographs. Errors: as fxs_photos_read and fxs_fit_block_choose, FXS_ERR_FILE if the coarse fit belongs to other
   photographs, and FXS_ERR_UNSUPPORTED if the file states no angle and no size (Bundler, and RealityCapture's .csv). */
int fxs_fit_block_read(const char *path, const fxs_photos_options *options, const fxs_fit_coarse *coarse,
                               uint32_t number, uint32_t blocks, fxs_fit_block *block, fxs_message *message);
void fxs_fit_block_free(fxs_fit_block *block);

/* Reads a coarse fit: a saved fit (fxs_fit_save) of all photographs, of any size. fxs_fit_coarse_free frees *coarse,
   which is null after an error. Errors are as for fxs_fit_resume, except that the photographs are not checked. */
int fxs_fit_coarse_read(fxs_fit_coarse **coarse, const char *path, fxs_message *message);
void fxs_fit_coarse_free(fxs_fit_coarse *coarse);     /* Frees a coarse fit; null is allowed. */
uint32_t fxs_fit_coarse_steps(const fxs_fit_coarse *coarse);
uint64_t fxs_fit_coarse_number(const fxs_fit_coarse *coarse);   /* Returns a checksum that identifies the file of a
                                                                   coarse fit. */

/* Begins the fit of a block with a number of 1 or more, at the step where the coarse fit of the whole ended. Takes the
   coarse fit's Gaussians in the block, Adam moments and extent, and its exposures, which stay fixed. options->block,
   options->blocks and options->coarse must match `block` and `coarse`. Errors: as fxs_fit_create, and FXS_ERR_ARGUMENT
   unless options->steps exceeds the coarse fit's steps. */
int fxs_fit_create_block(fxs_fit **fit, const fxs_fit_coarse *coarse, const fxs_fit_block *block,
                                 const fxs_fit_options *options, fxs_message *message);

/* Returns the Gaussians that a block takes from a coarse fit, for fxs_scene_file_open_gaussians. They are valid until
   the block or the coarse fit is freed. */
void fxs_fit_block_gaussians(const fxs_fit_block *block, fxs_gaussian_source *gaussians);

#ifdef __cplusplus
}
#endif

#endif
