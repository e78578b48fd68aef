/* The box of what is seen of a scene, for a camera that frames it. */
#ifndef FXS_FRAMING_H
#define FXS_FRAMING_H

#include <stdint.h>

#include <fixsplat/gaussian.h>

#define FXS_SEEN_MOST 16384          /* Gaussians of a sample, at most */

/* A Gaussian of the sample. */
typedef struct fxs_seen {
    float position[3];
    float size;                      /* the root of the product of its two largest sigmas, scene units */
    float weight;                    /* its opacity; 0: not drawn */
} fxs_seen;

/* A Gaussian's place along a line. */
typedef struct fxs_seen_place {
    float x;
    uint32_t index;
} fxs_seen_place;

fxs_seen fxs_seen_of(const fxs_gaussian *gaussian);

/* Narrows or widens low..high, the middle 90 % of the centres, to the box of what is seen. `places` has room for 4
   `count`. `seen` is changed. Where nothing is seen the box stays. */
void fxs_seen_bounds(fxs_seen *seen, uint32_t count, fxs_seen_place *places, double low[3], double high[3]);

#endif
