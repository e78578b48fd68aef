/* Chooses the chunks of 256 Gaussians that a frame draws, from the level-of-detail trees of its objects. */
#ifndef FXS_CUT_H
#define FXS_CUT_H

#include "object.h"

typedef struct fxs_drawn {
    uint32_t chunk;                /* number of the chunk, counted over all objects */
    uint16_t share_q8;             /* factor of the Gaussians' optical depth, 1 to 1024; 256: unchanged */
    uint16_t grow_q8;              /* log2 of the growth of the Gaussians' sigmas, 0 to 256 */
    fxs_moment moment;             /* of a chunk of a moving scene */
} fxs_drawn;

typedef struct fxs_cut {
    const fxs_object *objects;
    uint32_t object_count;
    const fxs_options *options;
    const fxs_camera *cameras;     /* cameras of all eyes; the eyes share the cut */
    uint32_t eyes;
    const fxs_object_view *views;  /* objects in the space of any eye; only first_chunk is read */
    uint32_t room;
    void *memory;                  /* scratch memory of fxs_cut_bytes bytes, aligned to 8 */

    fxs_drawn *drawn;              /* result, in `memory`: chunks to draw, in ascending order */
    uint32_t count;
    uint32_t missing;              /* result: number of needed chunks that are not loaded */
} fxs_cut;

/* Returns the largest number of chunks (256 Gaussians each) to draw. Returns 0 if the options set no limit and no scene
   moves; then all leaves of the trees are drawn. */
uint32_t fxs_cut_room(const fxs_object *objects, uint32_t count, const fxs_options *options);

uint64_t fxs_cut_bytes(uint32_t room, uint32_t object_count, uint32_t eyes);

/* Fills in the views that decide the cut, `eyes` per object. Returns the errors of fxs_object_view_init. */
int fxs_cut_views(const fxs_cut *cut, fxs_stage_view *views);

/* Chooses the chunks to draw and sets the results in *cut. Returns 0, FXS_ERR_SCENE or the errors of fxs_cut_views. */
int fxs_cut_find(fxs_cut *cut);

static inline uint32_t fxs_cut_chunks(const fxs_scene *scene, int is_cut)
{
    return is_cut ? fxs_scene_chunks(scene) : scene->chunk_count;
}

#endif
