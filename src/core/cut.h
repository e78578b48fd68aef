/* The cut through the trees of objects: which chunks a frame draws. */
#ifndef FXS_CUT_H
#define FXS_CUT_H

#include "object.h"

/* A chunk that is drawn. */
typedef struct fxs_drawn {
    uint32_t chunk;                /* of all objects */
    uint16_t share_q8;             /* of its optical depth: 256 leaves it as it is; 1 to 1024 */
    uint16_t grow_q8;              /* log2 by which its sigmas grow; 0 to 256 */
} fxs_drawn;

typedef struct fxs_cut {
    const fxs_object *objects;     /* checked */
    uint32_t object_count;
    const fxs_options *options;
    uint32_t eye_count;
    const fxs_camera *cameras[2];          /* of each eye, */
    const fxs_object_view *views[2];       /* and the objects as it sees them; their scenes are not read */
    uint32_t room;                 /* of fxs_cut_room */
    void *memory;                  /* of fxs_cut_bytes, aligned to 8 */

    /* What is found. */
    fxs_drawn *drawn;              /* in the memory, ascending */
    uint32_t count;
    uint32_t missing;              /* chunks that are not there */
} fxs_cut;

/* The most chunks that are drawn of checked objects; 0 where the options do not limit them, and all leaves are. */
uint32_t fxs_cut_room(const fxs_object *objects, uint32_t count, const fxs_options *options);

/* Bytes of fxs_cut.memory. */
uint64_t fxs_cut_bytes(uint32_t room);

/* Returns 0 or FXS_ERR_SCENE. */
int fxs_cut_find(fxs_cut *cut);

/* A scene's chunks as the numbers of all objects count them, where there is a cut or not. */
static inline uint32_t fxs_cut_chunks(const fxs_scene *scene, int is_cut)
{
    return is_cut ? fxs_scene_chunks(scene) : scene->chunk_count;
}

#endif
