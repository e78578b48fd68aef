/* Decides how a camera sees a chunk of 256 Gaussians, and how a node of the level-of-detail tree fades into its
 * children. */
#ifndef FXS_SIGHT_H
#define FXS_SIGHT_H

#include "chunk.h"
#include "cut.h"

#define FXS_SWELL_SEEN_Q8 1024     /* log2 of the largest growth of a distant node's mass (optical depth times area),
                                      Q8 */
#define FXS_SWELL_OF_SIGMA 4       /* log2 of the growth of a node's mass (optical depth times area), divided by log2 of
                                      each sigma's growth */
#define FXS_FADE_MOST_Q8 128       /* widest range, in log2, of keys or sizes over which tree nodes fade into their
                                      children */

typedef struct fxs_sight {
    int32_t key_q8;                /* log2 of the gain of replacing the node by its children; 0: leaf */
    int32_t room_q8;               /* log2(size of the node / wanted detail); 0: leaf */
    int32_t swell_q8;              /* log2 of the growth of the node's mass (optical depth times area), 0 to
                                      FXS_SWELL_SEEN_Q8 */
} fxs_sight;

/* Tree nodes fade into their children if their keys are above last_key_q8 by less than width_q8. last_key_q8 is the key
   of the first node that exceeds the budget of drawn chunks, or of the last node. */
typedef struct fxs_fading {
    int32_t last_key_q8, width_q8;
} fxs_fading;

/* Decides whether any of `eyes` cameras, given in the object's space, sees a chunk. Fills in *out as the camera that
   gives the largest key sees the chunk. A node is visible whenever a descendant is, because visibility ignores the
   growth of distant nodes. Returns 1 for visible, 0 for not visible, or FXS_ERR_SCENE. */
FXS_STAGE int fxs_see(fxs_sight *out, const fxs_stage_view *views, uint32_t eyes, const fxs_scene *scene,
                      uint32_t chunk, uint32_t detail_q8);

static inline void fxs_see_below(fxs_sight *sight, const fxs_sight *parent)
{
    sight->key_q8 = fxs_min(sight->key_q8, parent->key_q8);
    sight->room_q8 = fxs_min(sight->room_q8, parent->room_q8);
}

static inline int fxs_is_openable(const fxs_sight *sight)
{
    return sight->room_q8 > 0;
}

/* Returns 1 if a tree node that is replaced by its children is no longer drawn. Returns 0 if it still fades, because
   its size is close to the wanted detail. */
static inline uint32_t fxs_drawn_no_more(const fxs_sight *sight)
{
    return sight->room_q8 >= FXS_FADE_MOST_Q8;
}

/* Returns how far a tree node has faded into its children, 0 to 256. At 256 only the children are drawn. */
static inline uint32_t fxs_faded_q8(const fxs_sight *sight, fxs_fading fading)
{
    const int32_t by_room_q8 = fxs_clamp(sight->room_q8, 0, FXS_FADE_MOST_Q8) * 256 / FXS_FADE_MOST_Q8;
    const int32_t above_q8 = fxs_clamp(sight->key_q8 - fading.last_key_q8, 0, fading.width_q8);
    return (uint32_t)(fading.width_q8 ? fxs_min(by_room_q8, above_q8 * 256 / fading.width_q8) : by_room_q8);
}

/* Describes how to draw a chunk. Half of swell_q8, log2 of the growth of a node's mass (optical depth times area), goes
   to the optical depth, and a quarter to each sigma. */
FXS_STAGE fxs_drawn fxs_drawn_of(uint32_t chunk, uint32_t share_q8, int32_t swell_q8);

#endif
