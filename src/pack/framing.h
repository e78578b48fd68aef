/* Finds the box of the visible part of a scene, for a camera that frames the scene. */
#ifndef FXS_FRAMING_H
#define FXS_FRAMING_H

#include <stdint.h>

#include <fixsplat/scene.h>

#define FXS_SEEN_MOST 16384

typedef struct fxs_seen {
    float position[3];
    float size;                      /* geometric mean of the Gaussian's two largest sigmas, in scene units */
    float weight;                    /* opacity of the Gaussian; 0: never drawn */
} fxs_seen;

typedef struct fxs_seen_place {
    float x;
    uint32_t index;
} fxs_seen_place;

fxs_seen fxs_seen_of(const fxs_gaussian *gaussian);

/* Replaces low..high, the box of the middle 90 % of the centres, by the box of the visible part of the scene. `places`
   has room for 5 * count entries. Overwrites the weights of `seen`. Leaves the box unchanged if no Gaussian is
   visible. */
void fxs_seen_bounds(fxs_seen *seen, uint32_t count, fxs_seen_place *places, double low[3], double high[3]);

#endif
