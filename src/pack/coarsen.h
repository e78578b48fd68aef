/* Merges neighbouring Gaussians of a small set, greedily by the least error, until few enough are left. */
#ifndef FXS_COARSEN_H
#define FXS_COARSEN_H

#include <stdint.h>

#include <fixsplat/gaussian.h>

enum { FXS_MERGE_MOST = 512 };         /* the most Gaussians of a set */

/* The alpha below which nothing is drawn. */
#define FXS_FAINTEST (1 / 255.5f)

/* A Gaussian with what merging reads of it. */
typedef struct fxs_coarse {
    fxs_gaussian gaussian;
    float covariance[6];               /* xx, yy, zz, xy, xz, yz */
    float area;                        /* root of the sum of the squared areas that it has along three axes, sigmas^2 */
    float opacity;                     /* 0 to 1 */
} fxs_coarse;

/* What its opacity counts for: a Gaussian is drawn as far out as its alpha is FXS_FAINTEST, and up to there its
   integral is that of opacity - FXS_FAINTEST without an end. */
static inline float fxs_coarse_drawn(const fxs_coarse *coarse)
{
    return coarse->opacity > FXS_FAINTEST ? coarse->opacity - FXS_FAINTEST : 0;
}

/* Fills in a Gaussian as it comes from a file or from the codes of a packed scene. */
void fxs_coarse_set(fxs_coarse *coarse, const fxs_gaussian *gaussian);

/* What the mergers of a set changed. */
typedef struct fxs_merge_error {
    double error;                      /* sum of the squared errors, colours^2 units^2 */
    double size;                       /* sum of these times the squared size of what was merged, units^2 */
} fxs_merge_error;

typedef struct fxs_merger fxs_merger;

/* The stage coarsen of pack_stage.h for an instruction set. */
#define FXS_COARSEN(isa) FXS_COARSEN_OF(isa)
#define FXS_COARSEN_OF(isa) void fxs_coarsen_##isa(fxs_merger *m, uint32_t most, fxs_merge_error *sums)

/* Bytes of a merger, which is working memory for one thread, aligned as by malloc. */
size_t fxs_merger_bytes(void);

/* Begins a set. */
void fxs_merge_begin(fxs_merger *merger, int sh_degree);

/* Adds Gaussians to the set, which stay where they are until the end. */
void fxs_merge_add(fxs_merger *merger, const fxs_coarse *gaussians, uint32_t count);

/* Merges the set to at most `most` Gaussians, writes them to `out`, which is no part of what was added, and returns
   their number. */
uint32_t fxs_merge_end(fxs_merger *merger, uint32_t most, fxs_coarse *out, fxs_merge_error *error);

/* Of each Gaussian that was added, in that order, writes the place in `out` of what it was merged into. */
void fxs_merge_into(const fxs_merger *merger, uint16_t *into);

/* Sets the rotation and the scales of a Gaussian with that covariance. */
void fxs_coarse_axes(fxs_gaussian *gaussian, const float covariance[6]);

#endif
