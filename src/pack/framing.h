/* Finds the box of the visible part of a scene, for a camera that frames it. */
#ifndef FXS_FRAMING_H
#define FXS_FRAMING_H

#include <stdint.h>

#include <fixsplat/scene.h>

#define FXS_SEEN_MOST 16384          /* capacity of a sample, Gaussians */

/* A Gaussian of the sample. */
typedef struct fxs_seen {
    float position[3];
    float size;                      /* root of the product of the two largest sigmas, scene units */
    float weight;                    /* opacity; 0: not drawn */
} fxs_seen;

/* Sort entry of a Gaussian: its coordinate on an axis, or its distance, and its index. */
typedef struct fxs_seen_place {
    float x;
    uint32_t index;
} fxs_seen_place;

fxs_seen fxs_seen_of(const fxs_gaussian *gaussian);

/* On entry, low..high is the box of the middle 90 % of the centres; on return, the box of the visible part. `places`:
   space for 5 * count places. Overwrites the weights of `seen`. If no Gaussian is visible, the box is unchanged. */
void fxs_seen_bounds(fxs_seen *seen, uint32_t count, fxs_seen_place *places, double low[3], double high[3]);

#endif
