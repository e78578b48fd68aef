/* Decides how a camera sees a chunk of 256 Gaussians, and how a node of the level-of-detail tree fades into its
 * children. */
#ifndef FXS_SIGHT_H
#define FXS_SIGHT_H

#include "chunk.h"
#include "cut.h"

#define FXS_SWELL_SEEN_Q8 1024     /* largest growth of a distant node's mass, log2, Q8 */
#define FXS_SWELL_OF_SIGMA 4       /* growth of the mass / growth of each sigma, in log2 */
#define FXS_FADE_MOST_Q8 128       /* widest range of keys or sizes over which nodes fade */

typedef struct fxs_sight {
    int32_t key_q8;                /* gain of replacing the node by its children; 0: leaf */
    int32_t room_q8;               /* log2(size of the node / wanted detail); 0: leaf */
    int32_t swell_q8;              /* log2 of the growth of the node's mass, 0 to FXS_SWELL_SEEN_Q8 */
} fxs_sight;

/* Nodes fade with keys above last_key_q8 by less than width_q8. last_key_q8 is the key of the first node beyond the
   budget, or of the last node. */
typedef struct fxs_fading {
    int32_t last_key_q8, width_q8;
} fxs_fading;

/* The view is in the object's space. Visibility ignores growth, so a node is visible whenever a descendant is. Returns
   1, 0 if the chunk is out of view, or FXS_ERR_SCENE. */
FXS_STAGE int fxs_see(fxs_sight *out, const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk,
                      uint32_t detail_q8);

static inline void fxs_see_below(fxs_sight *sight, const fxs_sight *parent)
{
    sight->key_q8 = fxs_min(sight->key_q8, parent->key_q8);
    sight->room_q8 = fxs_min(sight->room_q8, parent->room_q8);
}

static inline int fxs_is_openable(const fxs_sight *sight)
{
    return sight->room_q8 > 0;
}

/* Returns 1 if an opened node is no longer drawn, 0 if it fades by the wanted detail. */
static inline uint32_t fxs_drawn_no_more(const fxs_sight *sight)
{
    return sight->room_q8 >= FXS_FADE_MOST_Q8;
}

/* Returns how far an opened node has faded into its children, 0 to 256. */
static inline uint32_t fxs_faded_q8(const fxs_sight *sight, fxs_fading fading)
{
    const int32_t by_room_q8 = fxs_clamp(sight->room_q8, 0, FXS_FADE_MOST_Q8) * 256 / FXS_FADE_MOST_Q8;
    const int32_t above_q8 = fxs_clamp(sight->key_q8 - fading.last_key_q8, 0, fading.width_q8);
    return (uint32_t)(fading.width_q8 ? fxs_min(by_room_q8, above_q8 * 256 / fading.width_q8) : by_room_q8);
}

/* Half the growth of a node's mass goes to the optical depth, and a quarter to each sigma. */
FXS_STAGE fxs_drawn fxs_drawn_of(uint32_t chunk, uint32_t share_q8, int32_t swell_q8);

#endif
