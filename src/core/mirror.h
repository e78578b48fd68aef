/* Keeps a part of a scene on a device: a mirror. The device has a pool with places for rows and headers of chunks (256
 * Gaussians each). The caller's scene has the rows of some chunks in memory (fxs_scene.places). Frames draw the chunks
 * on the device, and the mirror tells which chunks to upload next. It calls no graphics API.
 *
 *     fxs_mirror_init(mirror, scene, fxs_mirror_room(...), memory)
 *     for each frame:
 *         fxs_mirror_take(&request, objects, turn, of, copies)     replaces scenes by mirrors
 *         find the cut
 *         for each of fxs_mirror_step(mirror, bytes, &places)      copy header and rows to the device (fxs_mirror_fill)
 *         draw
 *
 * The step may come before the cut; it then uploads what the last frame lacked, and this frame draws it. The scene's
 * first step uploads its coarsest chunks.
 *
 * The picture is that of the processor with the same chunks in memory. A chunk that is uploaded takes no place of a
 * chunk that frames from `since` on draw. */
#ifndef FXS_MIRROR_H
#define FXS_MIRROR_H

#include "pool_places.h"

typedef struct fxs_mirror {
    fxs_scene scene;               /* must be first: the caller's scene, with `places` of the device */
    const fxs_scene *from;         /* the caller's scene */
    fxs_want want;                 /* the caller's callback */
    fxs_places pool;
    uint32_t used;                 /* number of places that were used at least once */
    uint32_t *wanted;              /* chunks that the cut lacks; fxs_mirror_step replaces them by places to upload */
    uint32_t wanted_count, since;
} fxs_mirror;

/* Returns the bytes of a place in the device's pool: rows and header. */
uint64_t fxs_mirror_place_bytes(const fxs_scene *scene);

/* Returns the bytes of memory that a mirror of `room` places takes besides the struct. */
uint64_t fxs_mirror_bytes(const fxs_scene *scene, uint32_t room);

/* Returns 1 if only a part of one of the request's scenes is in memory. */
int fxs_mirror_is_asked(const fxs_request *request);

/* Returns the usual size in bytes of the pools of a request's scenes in parts, at least `bytes`: for two pictures and
   the coarsest chunks, or without a budget for the whole scene. */
uint64_t fxs_mirror_usual_bytes(const fxs_request *request, uint64_t bytes);

/* Chooses the number of places of a pool of `bytes` bytes (0: 256 MiB), which takes at most half of `limit` bytes of
   device memory (0: no limit). Returns 0 and a message if the pool is smaller than FXS_PLACES_LEAST places. */
uint32_t fxs_mirror_room(const fxs_scene *scene, uint64_t bytes, uint64_t limit, fxs_message *why);

/* Returns how many bytes a frame may upload, if `bytes` were set (0: 8 MiB): at least a place. */
uint64_t fxs_mirror_upload_bytes(const fxs_scene *scene, uint64_t bytes);

/* Makes a mirror of a scene, with an empty pool of `room` places (fxs_places_room). `memory` is aligned to 4. The
   scene's address and `memory` must stay valid. */
void fxs_mirror_init(fxs_mirror *m, const fxs_scene *scene, uint32_t room, void *memory);

/* Begins turn `turn`, larger from frame to frame. Chunks that were drawn in turn `since` or later are not evicted. A
   second call for the same turn, by another object of the scene, changes nothing. */
void fxs_mirror_begin(fxs_mirror *m, uint32_t turn, uint32_t since, const fxs_want *want);

/* Replaces the scenes in parts of a request by their mirrors, begins turn `turn` of these, and evicts no chunk that the
   turn before drew. `objects` has room for the request's objects. of(copies, i) returns the mirror of object i, null
   for a whole scene. Returns FXS_ERR_ARGUMENT if a scene in parts has no mirror, or another scene has one. */
typedef fxs_mirror *fxs_mirror_of_fn(const void *copies, uint32_t i);
int fxs_mirror_take(fxs_request *request, fxs_object *objects, uint32_t turn, fxs_mirror_of_fn *of, const void *copies);

/* Callback fxs_options.want for scenes of mirrors. Tells the caller's callback of each chunk if it is in memory. */
void fxs_mirror_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

/* Chooses chunks to upload, of at most `bytes` bytes with headers, and gives them places: first the chunks that the cut
   lacks, in the order of the cut, so a coarse chunk comes before its children; then the coarsest chunks of the scene.
   Skips chunks that are not in memory, and ends early if no chunk may be evicted. Returns the number of *places, whose
   chunks fxs_mirror_chunk returns. */
uint32_t fxs_mirror_step(fxs_mirror *m, uint64_t bytes, const uint32_t **places);

/* Copies the headers of the chunks of `places`, then their rows, to staging memory: fxs_mirror_place_bytes each. */
void fxs_mirror_fill(const fxs_mirror *m, const uint32_t *places, uint32_t count, void *to);

/* Returns the number of places, from the first of `count`, that follow one another in a buffer of `part_chunks` places:
   one copy uploads their rows. */
uint32_t fxs_mirror_run(const uint32_t *places, uint32_t count, uint32_t part_chunks);

/* Empties the pool. */
void fxs_mirror_forget(fxs_mirror *m);

/* Returns a scene without a tree that has the layout of the pool. */
fxs_scene fxs_mirror_pool(const fxs_mirror *m);

/* Returns how many buffers of `part_chunks` places the pool has. */
static inline uint32_t fxs_mirror_parts(const fxs_mirror *m, uint32_t part_chunks)
{
    return (m->pool.room - 1) / part_chunks + 1;
}

static inline uint32_t fxs_mirror_chunk(const fxs_mirror *m, uint32_t place)
{
    return m->pool.list[place].chunk;
}

#endif
