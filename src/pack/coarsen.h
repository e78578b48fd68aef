/* Merges neighbouring Gaussians of a small set down to a given number. The pair with the smallest error is merged
   first. */
#ifndef FXS_COARSEN_H
#define FXS_COARSEN_H

#include <stdint.h>

#include <fixsplat/scene.h>

enum { FXS_MERGE_MOST = 512 };

/* Smallest alpha that the renderer draws. */
#define FXS_FAINTEST (1 / 255.5f)

typedef struct fxs_coarse {
    fxs_gaussian gaussian;
    float covariance[6];               /* covariance matrix: xx, yy, zz, xy, xz, yz */
    float area;                 /* area of the Gaussian: sqrt(a^2 b^2 + a^2 c^2 + b^2 c^2), a, b, c: the axes' sigmas */
    float opacity;
} fxs_coarse;

/* Returns the opacity of a Gaussian that counts in merging. Alpha below FXS_FAINTEST is not drawn, which lowers the
   integral of a Gaussian like a lower opacity. */
static inline float fxs_coarse_drawn(const fxs_coarse *coarse)
{
    return coarse->opacity > FXS_FAINTEST ? coarse->opacity - FXS_FAINTEST : 0;
}

/* Copies a Gaussian and computes its covariance, area and opacity. */
void fxs_coarse_set(fxs_coarse *coarse, const fxs_gaussian *gaussian);

/* How a coarse Gaussian of a moving scene moves and fades. A unit of time is the `reach` of the set that is merged
   (ways.c); u is 0 in its middle. */
typedef struct fxs_way {
    float drift[3][3];                 /* coefficients of u, u^2, u^3 of x, y, z */
    float turn[4];                     /* coefficients of u of the quaternion that rotates it */
    float centre, width;               /* of its opacity in the span of the set, e^-((u - centre) / width)^2 */
    float mean;                        /* mean of the opacity over the span, as a share of its largest */
} fxs_way;

/* Returns the mean of the opacity that a way without `mean` has, as a share of its largest. */
double fxs_way_share(const fxs_way *way);

typedef struct fxs_merge_error {
    double error;                      /* sum of the squared picture errors of all merges, colours^2 units^2 */
    double size;                  /* sum over all merges: squared picture error times the area of the merged Gaussian */
} fxs_merge_error;

typedef struct fxs_merger fxs_merger;

#define FXS_COARSEN(isa) FXS_COARSEN_OF(isa)
#define FXS_COARSEN_OF(isa) void fxs_coarsen_##isa(fxs_merger *m, uint32_t most, fxs_merge_error *sums)

/* Returns the size in bytes of a merger, the working memory for merging. Each thread needs its own merger, with
   malloc's alignment. */
size_t fxs_merger_bytes(void);

void fxs_merge_begin(fxs_merger *merger, int sh_degree);

/* Adds Gaussians to the set to be merged. The Gaussians must stay valid until fxs_merge_end. */
void fxs_merge_add(fxs_merger *merger, const fxs_coarse *gaussians, uint32_t count);

/* Adds moving Gaussians, with their ways. If not `fades`, the opacity of a Gaussian is its mean over the span. A set
   has only moving or only still Gaussians. */
void fxs_merge_add_moving(fxs_merger *merger, const fxs_coarse *gaussians, const fxs_way *ways, uint32_t count,
                          int fades);

/* Merges the set of added Gaussians down to at most `most`, writes the merged Gaussians to `out` and returns their
   number. `out` must not overlap the added Gaussians. */
uint32_t fxs_merge_end(fxs_merger *merger, uint32_t most, fxs_coarse *out, fxs_merge_error *error);

/* Writes, for each added Gaussian in order, the index in `out` of the merged Gaussian that absorbed it. Call after
   fxs_merge_end. */
void fxs_merge_into(const fxs_merger *merger, uint16_t *into);

/* Writes the ways of the merged Gaussians, in the order of `out`. Call after fxs_merge_end. */
void fxs_merge_ways(const fxs_merger *merger, fxs_way *ways);

void fxs_coarse_axes(fxs_gaussian *gaussian, const float covariance[6]);

#endif
