/* Chooses the chunks of 256 Gaussians that a frame draws, from the level-of-detail trees of its objects. */
#ifndef FXS_CUT_H
#define FXS_CUT_H

#include "object.h"

typedef struct fxs_drawn {
    uint32_t chunk;                /* number of the chunk, counted over all objects */
    uint16_t share_q8;             /* share of the optical depth, 1 to 1024; 256: unchanged */
    uint16_t grow_q8;              /* growth of the sigmas, log2, 0 to 256 */
} fxs_drawn;

typedef struct fxs_cut {
    const fxs_object *objects;
    uint32_t object_count;
    const fxs_options *options;
    const fxs_camera *camera;
    const fxs_object_view *views;
    uint32_t room;
    void *memory;                  /* fxs_cut_bytes(room) bytes, aligned to 8 */

    fxs_drawn *drawn;              /* result, in `memory`: chunks in ascending order */
    uint32_t count;
    uint32_t missing;              /* result: number of chunks that are not loaded */
} fxs_cut;

/* Returns the largest number of chunks to draw. 0: draw all leaves, because the options set no limit. */
uint32_t fxs_cut_room(const fxs_object *objects, uint32_t count, const fxs_options *options);

uint64_t fxs_cut_bytes(uint32_t room);

/* Fills in the results. Returns 0 or FXS_ERR_SCENE. */
int fxs_cut_find(fxs_cut *cut);

static inline uint32_t fxs_cut_chunks(const fxs_scene *scene, int is_cut)
{
    return is_cut ? fxs_scene_chunks(scene) : scene->chunk_count;
}

#endif
