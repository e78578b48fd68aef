/* What a merger of a set of Gaussians holds. */
#ifndef FXS_MERGER_H
#define FXS_MERGER_H

#include <string.h>

#include <fixsplat/packed.h>
#include "coarsen.h"

enum {
    MOST = FXS_MERGE_MOST,
    LANES = 8,                         /* pairs whose errors are found at once */
    NEAREST = 5,                       /* candidates of a Gaussian, */
    JOINED = 8,                        /* and with how many what was merged is compared */
    PLANES = 3,
    SH = 45,                           /* coefficients */
    COMPARED = 12,                     /* those that count in errors: degree 1, and zeros */
    CURVES = 2,                        /* along which candidates are looked for, */
    WINDOW = 8,                        /* so far on each side */
    PAIRS = MOST * NEAREST + MOST * JOINED   /* all that are ever compared */
};

/* What is known of a Gaussian: its covariance, the roots of the determinants in each plane of that with THINNEST, and
   its colour of degree 0, that of what surrounds it, and the squared length of its SH that are compared. */
enum { X, Y, Z, XX, YY, ZZ, XY, XZ, YZ, OPACITY, AREA, ROOT, COLOUR = ROOT + PLANES, LOCAL = COLOUR + 3,
       SQUARE = LOCAL + 3, FIELDS, ROW = (FIELDS + LANES - 1) / LANES * LANES };

#define OPACITY_MOST (0.99f - FXS_FAINTEST)    /* of what was merged, or that of the more opaque of two */
#define OVERLAP 0.3f                   /* share of what two hide of each other that does not count */
#define ALPHA_WEIGHT 0.06f             /* of the squared error of alpha by itself, against that of a colour */
#define THINNEST 1e-3f                 /* share of the trace that is added to variances where errors are computed */
#define LEAST 1e-30f
#define PI 3.14159265f

/* The axes of each plane, and its part of a covariance. */
static const uint8_t first_axis[PLANES] = {X, X, Y}, second_axis[PLANES] = {Y, Z, Z};
static const uint8_t first_square[PLANES] = {XX, XX, YY}, second_square[PLANES] = {YY, ZZ, ZZ},
                     mixed[PLANES] = {XY, XZ, YZ};

typedef float lanes[LANES];

/* LANES Gaussians. */
typedef struct group {
    lanes f[ROW];
} group;

/* Two that may be merged. It no longer counts where either has changed since. */
typedef struct pair {
    float error;
    uint16_t a, b;                     /* a < b */
    uint16_t a_age, b_age;
} pair;

struct fxs_merger {
    uint32_t count, left;
    const fxs_coarse *from[MOST];
    float fields[MOST][ROW];
    float sh[MOST][SH];                /* times the basis of degree 0 */
    float compared[MOST][COMPARED];    /* the first of them */
    uint32_t sh_count;                 /* of them that may be other than 0 */
    uint16_t order[MOST];              /* along a curve, */
    float places[3][WINDOW + MOST + WINDOW];   /* and where they are */
    float distances[MOST][NEAREST];    /* of the candidates, squared */
    uint16_t into[MOST];               /* itself, or what it was merged into */
    uint16_t age[MOST];                /* how often it was merged */
    uint16_t nearest[MOST][NEAREST];   /* candidates */
    uint8_t nearest_count[MOST];
    pair pairs[PAIRS];
    uint64_t heap[PAIRS];              /* the bits of the error, then the number of the pair: the least first */
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
