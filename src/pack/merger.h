/* Working memory for merging a set of Gaussians. */
#ifndef FXS_MERGER_H
#define FXS_MERGER_H

#include <string.h>

#include <fixsplat/internal/packed.h>
#include "coarsen.h"

enum {
    MOST = FXS_MERGE_MOST,
    LANES = 8,
    NEAREST = 5,
    JOINED = 8,
    PLANES = 3,
    SH = 45,
    COMPARED = 12,         /* number of SH coefficients that count in merge errors: 9 of degree 1, 3 zeros as padding */
    CURVES = 2,
    WINDOW = 8,
    PAIRS = MOST * NEAREST + MOST * JOINED
};

/* Fields of a Gaussian in a merger. ROOT: square root of the determinant of the covariance, per coordinate plane.
   LOCAL: mean colour of the neighbourhood. SQUARE: squared length of the compared SH coefficients. CENTRE, WIDTH: of
   the opacity in time; WIDTH is squared. The OPACITY of a moving Gaussian is its mean over the span of time. */
enum { X, Y, Z, XX, YY, ZZ, XY, XZ, YZ, OPACITY, AREA, ROOT, COLOUR = ROOT + PLANES, LOCAL = COLOUR + 3,
       SQUARE = LOCAL + 3, CENTRE, WIDTH, FIELDS, ROW = (FIELDS + LANES - 1) / LANES * LANES };

#define OPACITY_MOST (0.99f - FXS_FAINTEST)   /* largest opacity of a merged Gaussian, unless an input is more opaque */
/* share of a pair's mutual occlusion that is subtracted from the merged mass (opacity times area) */
#define OVERLAP 0.3f
#define ALPHA_WEIGHT 0.06f /* weight of the squared error of alpha in a merge error; each colour channel has weight 1 */
/* share of a covariance's trace that is added to its variances when merge errors are computed */
#define THINNEST 1e-3f
#define LEAST 1e-30f
#define PI 3.14159265f

static const uint8_t first_axis[PLANES] = {X, X, Y}, second_axis[PLANES] = {Y, Z, Z};
static const uint8_t first_square[PLANES] = {XX, XX, YY}, second_square[PLANES] = {YY, ZZ, ZZ},
                     mixed[PLANES] = {XY, XZ, YZ};

typedef float lanes[LANES];

typedef struct group {
    lanes f[ROW];
} group;

/* Pair of Gaussians that may be merged. The pair is stale once either Gaussian was merged again. An age counts the
   merges of a Gaussian. */
typedef struct pair {
    float error;
    uint16_t a, b;
    uint16_t a_age, b_age;
} pair;

struct fxs_merger {
    uint32_t count, left;
    const fxs_coarse *from[MOST];
    float fields[MOST][ROW];
    float sh[MOST][SH];
    float compared[MOST][COMPARED];
    uint32_t sh_count;
    int moves, fades;
    fxs_way ways[MOST];                /* of moving Gaussians; CENTRE and WIDTH replace their centre and width */
    uint16_t order[MOST];
    float places[3][WINDOW + MOST + WINDOW];
    float distances[MOST][NEAREST];
    uint16_t into[MOST];               /* index of the Gaussian that absorbed this one, or its own index */
    uint16_t age[MOST];
    uint16_t nearest[MOST][NEAREST];
    uint8_t nearest_count[MOST];
    pair pairs[PAIRS];
    uint64_t heap[PAIRS];        /* min-heap of candidate pairs; key: bits of the merge error, then index of the pair */
    uint32_t pair_count, heap_count;
};

static inline float dot_of_sh(const float *a, const float *b)
{
    float products[COMPARED];
    for (int i = 0; i < COMPARED; i++)
        products[i] = a[i] * b[i];
    for (int i = 0; i < 4; i++)
        products[i] += products[4 + i] + products[8 + i];
    return (products[0] + products[1]) + (products[2] + products[3]);
}

static inline void compare_sh(fxs_merger *m, uint32_t i)
{
    for (uint32_t k = 0; k < 9 && m->sh_count; k++)
        m->compared[i][k] = m->sh[i][k];
    m->fields[i][SQUARE] = dot_of_sh(m->compared[i], m->compared[i]);
}

static inline uint32_t now(const fxs_merger *m, uint32_t i)
{
    while (m->into[i] != i)
        i = m->into[i];
    return i;
}

#endif
