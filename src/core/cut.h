/* The cut through the trees of objects: which chunks a frame draws. */
#ifndef FXS_CUT_H
#define FXS_CUT_H

#include "object.h"

/* A chunk to draw. */
typedef struct fxs_drawn {
    uint32_t chunk;                /* number among the chunks of all objects */
    uint16_t share_q8;             /* share of its optical depth: 1 to 1024, 256 = unchanged */
    uint16_t grow_q8;              /* growth of its sigmas, log2: 0 to 256 */
} fxs_drawn;

typedef struct fxs_cut {
    const fxs_object *objects;     /* already checked */
    uint32_t object_count;
    const fxs_options *options;
    const fxs_camera *camera;
    const fxs_object_view *views;  /* objects as the camera sees them; their scenes are not read */
    uint32_t room;                 /* from fxs_cut_room */
    void *memory;                  /* fxs_cut_bytes(room) bytes, aligned to 8 */

    /* Results. */
    fxs_drawn *drawn;              /* in `memory`, ascending */
    uint32_t count;
    uint32_t missing;              /* chunks that are not loaded */
} fxs_cut;

/* Maximum number of drawn chunks of checked objects. 0: no cut, all leaves are drawn, because the options do not limit
   them. */
uint32_t fxs_cut_room(const fxs_object *objects, uint32_t count, const fxs_options *options);

/* Bytes of fxs_cut.memory. */
uint64_t fxs_cut_bytes(uint32_t room);

/* Finds the cut. Returns 0 or FXS_ERR_SCENE. */
int fxs_cut_find(fxs_cut *cut);

/* Chunks that a scene takes in the numbering of all objects, with or without a cut. */
static inline uint32_t fxs_cut_chunks(const fxs_scene *scene, int is_cut)
{
    return is_cut ? fxs_scene_chunks(scene) : scene->chunk_count;
}

#endif
