/* A chunk of a scene with a tree as a camera sees it, and how a node fades into its children: what the cut goes by
 * (cut.c), on the processor and on a device. */
#ifndef FXS_SIGHT_H
#define FXS_SIGHT_H

#include "chunk.h"
#include "cut.h"

#define FXS_SWELL_SEEN_Q8 1024     /* log2 by which the mass of a node grows that is seen from afar, at most, */
#define FXS_SWELL_OF_SIGMA 4       /* and what share of it its sigmas take, inverse */
#define FXS_FADE_MOST_Q8 128       /* keys over which nodes fade, at most; and sizes beyond the detail that is wanted */

typedef struct fxs_sight {
    int32_t key_q8;                /* what opening the node removes; of a leaf 0 */
    int32_t room_q8;               /* log2 of the node's size beyond the detail that is wanted; of a leaf 0 */
    int32_t swell_q8;              /* log2 by which its mass grows: 0 to FXS_SWELL_SEEN_Q8; of a leaf 0 */
} fxs_sight;

/* The last key is that of the first node that there was no room for, or of the last one where all are opened. Nodes fade
   whose keys are above it by less than the width. */
typedef struct fxs_fading {
    int32_t last_key_q8, width_q8;
} fxs_fading;

/* The chunk as the nearest of one or two eyes sees it, whose views are in the space of its object. Growth does not
   count: so a node is seen wherever one below it is, and as what grows is smaller than a pixel, little is missed.
   Returns 1, or 0 where no eye sees it, or FXS_ERR_SCENE. */
FXS_STAGE int fxs_see(fxs_sight *out, const fxs_view *views, uint32_t eyes, const fxs_scene *scene, uint32_t chunk,
                      uint32_t detail_q8);

/* Neither the key nor the room of a chunk is above its parent's. */
static inline void fxs_see_below(fxs_sight *sight, const fxs_sight *parent)
{
    sight->key_q8 = fxs_min(sight->key_q8, parent->key_q8);
    sight->room_q8 = fxs_min(sight->room_q8, parent->room_q8);
}

static inline int fxs_is_openable(const fxs_sight *sight)
{
    return sight->room_q8 > 0;
}

/* Chunks that an opened node takes from those to be drawn, but for those that fade by the budget: itself, unless it
   fades by the detail. */
static inline uint32_t fxs_drawn_no_more(const fxs_sight *sight)
{
    return sight->room_q8 >= FXS_FADE_MOST_Q8;
}

/* How far an opened node has faded into its children: 0 to 256. */
static inline uint32_t fxs_faded_q8(const fxs_sight *sight, fxs_fading fading)
{
    const int32_t by_room_q8 = fxs_clamp(sight->room_q8, 0, FXS_FADE_MOST_Q8) * 256 / FXS_FADE_MOST_Q8;
    const int32_t above_q8 = fxs_clamp(sight->key_q8 - fading.last_key_q8, 0, fading.width_q8);
    return (uint32_t)(fading.width_q8 ? fxs_min(by_room_q8, above_q8 * 256 / fading.width_q8) : by_room_q8);
}

/* What is drawn of a chunk. Of the swell of a node's mass, optical depths take one half and areas the other, so sigmas
   a quarter: what is opaque takes no more. */
FXS_STAGE fxs_drawn fxs_drawn_of(uint32_t chunk, uint32_t share_q8, int32_t swell_q8);

#endif
