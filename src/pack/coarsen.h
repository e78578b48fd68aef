/* Merges neighbouring Gaussians of a small set, greedily by smallest error, down to a given number. */
#ifndef FXS_COARSEN_H
#define FXS_COARSEN_H

#include <stdint.h>

#include <fixsplat/scene.h>

enum { FXS_MERGE_MOST = 512 };         /* capacity of a set, Gaussians */

/* Smallest alpha that is drawn. */
#define FXS_FAINTEST (1 / 255.5f)

/* A Gaussian with quantities that merging needs. */
typedef struct fxs_coarse {
    fxs_gaussian gaussian;
    float covariance[6];               /* xx, yy, zz, xy, xz, yz */
    float area;                        /* root of the sum of its squared areas along three axes, sigmas^2 */
    float opacity;                     /* 0 to 1 */
} fxs_coarse;

/* Effective opacity: a Gaussian is drawn out to alpha = FXS_FAINTEST. The integral of its alpha up to this limit equals
   that of an unbounded Gaussian of opacity - FXS_FAINTEST. */
static inline float fxs_coarse_drawn(const fxs_coarse *coarse)
{
    return coarse->opacity > FXS_FAINTEST ? coarse->opacity - FXS_FAINTEST : 0;
}

/* Fills in `coarse` from a Gaussian. */
void fxs_coarse_set(fxs_coarse *coarse, const fxs_gaussian *gaussian);

/* Sums over all merges of a set. */
typedef struct fxs_merge_error {
    double error;                      /* sum of the squared errors, colours^2 units^2 */
    double size;                       /* sum of squared error * squared size of the merged Gaussian, units^2 */
} fxs_merge_error;

typedef struct fxs_merger fxs_merger;

/* Declares the stage coarsen of pack_stage.h for an instruction set. */
#define FXS_COARSEN(isa) FXS_COARSEN_OF(isa)
#define FXS_COARSEN_OF(isa) void fxs_coarsen_##isa(fxs_merger *m, uint32_t most, fxs_merge_error *sums)

/* Bytes of a merger: working memory for one thread, aligned as malloc aligns. */
size_t fxs_merger_bytes(void);

/* Begins a set. */
void fxs_merge_begin(fxs_merger *merger, int sh_degree);

/* Adds Gaussians to the set. They must stay valid until fxs_merge_end. */
void fxs_merge_add(fxs_merger *merger, const fxs_coarse *gaussians, uint32_t count);

/* Merges the set down to at most `most` Gaussians. Writes them to `out`, which must not overlap the Gaussians that
   were added, and returns their number. */
uint32_t fxs_merge_end(fxs_merger *merger, uint32_t most, fxs_coarse *out, fxs_merge_error *error);

/* After fxs_merge_end: writes, for each added Gaussian in order, the index in `out` of the Gaussian it was merged
   into. */
void fxs_merge_into(const fxs_merger *merger, uint16_t *into);

/* Sets rotation and scales from a covariance. */
void fxs_coarse_axes(fxs_gaussian *gaussian, const float covariance[6]);

#endif
