/* Working memory of a merger: a set of Gaussians, their candidate pairs, and a heap of the pairs' errors. */
#ifndef FXS_MERGER_H
#define FXS_MERGER_H

#include <string.h>

#include <fixsplat/internal/packed.h>
#include "coarsen.h"

enum {
    MOST = FXS_MERGE_MOST,
    LANES = 8,                         /* pairs per call of find_errors */
    NEAREST = 5,                       /* candidates per Gaussian */
    JOINED = 8,                        /* most candidates of a merged Gaussian */
    PLANES = 3,
    SH = 45,                           /* coefficients */
    COMPARED = 12,                     /* SH coefficients that count in errors: 9 of degree 1, 3 zeros */
    CURVES = 2,                        /* Morton curves along which candidates are searched */
    WINDOW = 8,                        /* neighbours on the curve, on each side of a Gaussian, that are compared */
    PAIRS = MOST * NEAREST + MOST * JOINED   /* capacity: pairs of the whole run */
};

/* Fields of a Gaussian: position, covariance, opacity (fxs_coarse_drawn), area; per plane, the root of the
   determinant of the covariance with THINNEST added; the colour of degree 0; LOCAL, the mean colour of its
   surroundings; SQUARE, the squared length of its compared SH. */
enum { X, Y, Z, XX, YY, ZZ, XY, XZ, YZ, OPACITY, AREA, ROOT, COLOUR = ROOT + PLANES, LOCAL = COLOUR + 3,
       SQUARE = LOCAL + 3, FIELDS, ROW = (FIELDS + LANES - 1) / LANES * LANES };

#define OPACITY_MOST (0.99f - FXS_FAINTEST)    /* cap of a merged opacity, unless an input is more opaque */
#define OVERLAP 0.3f                   /* share of a pair's mutual occlusion that is taken off the merged mass */
#define ALPHA_WEIGHT 0.06f             /* weight of the squared error of alpha; that of a colour is 1 */
#define THINNEST 1e-3f                 /* share of a covariance's trace that errors add to variances */
#define LEAST 1e-30f
#define PI 3.14159265f

/* The axes of each plane, and the fields of its covariance. */
static const uint8_t first_axis[PLANES] = {X, X, Y}, second_axis[PLANES] = {Y, Z, Z};
static const uint8_t first_square[PLANES] = {XX, XX, YY}, second_square[PLANES] = {YY, ZZ, ZZ},
                     mixed[PLANES] = {XY, XZ, YZ};

typedef float lanes[LANES];

/* LANES Gaussians, field by field. */
typedef struct group {
    lanes f[ROW];
} group;

/* Candidates for a merge. The pair is stale if a_age or b_age differs from the Gaussian's present age. */
typedef struct pair {
    float error;
    uint16_t a, b;                     /* a < b */
    uint16_t a_age, b_age;
} pair;

struct fxs_merger {
    uint32_t count, left;
    const fxs_coarse *from[MOST];
    float fields[MOST][ROW];
    float sh[MOST][SH];                /* coefficients times the basis of degree 0 */
    float compared[MOST][COMPARED];    /* the first COMPARED of sh */
    uint32_t sh_count;                 /* number of coefficients of the set's degree; the others are 0 */
    uint16_t order[MOST];              /* the Gaussians in their order along a curve */
    float places[3][WINDOW + MOST + WINDOW];   /* positions in that order; padding: infinity */
    float distances[MOST][NEAREST];    /* squared distances of the candidates */
    uint16_t into[MOST];               /* per Gaussian: itself, or the Gaussian it was merged into */
    uint16_t age[MOST];                /* per Gaussian: number of merges */
    uint16_t nearest[MOST][NEAREST];   /* candidates, nearest first */
    uint8_t nearest_count[MOST];
    pair pairs[PAIRS];
    uint64_t heap[PAIRS];              /* min-heap; key: bits of the error, then pair number */
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
