/* Keeps a part of a scene on a device: a mirror. The device has a pool with places for rows and headers of chunks (256
 * Gaussians each). The caller's scene has the rows of some chunks in memory (fxs_scene.places). Frames draw the chunks
 * on the device, and the mirror tells which chunks to upload next. It calls no graphics API.
 *
 *     fxs_mirror_init(mirror, scene, room, memory)
 *     for each frame:
 *         fxs_mirror_begin(mirror, turn, bytes, &options.want)
 *         find the cut, for an object of the scene &mirror->scene, with the option `want` fxs_mirror_want
 *         while (fxs_mirror_next(mirror, &upload))             copy to the device, after the copies of earlier frames
 *         draw
 *
 * The chunks of the cut are on the device, and no upload takes their places in this frame or the next. So a frame in
 * flight is not disturbed, if its draw and its uploads reach the device in order. */
#ifndef FXS_MIRROR_H
#define FXS_MIRROR_H

#include "pool_places.h"

typedef struct fxs_mirror {
    fxs_scene scene;               /* must be first: the caller's scene, with `places` of the device */
    const fxs_scene *from;         /* the caller's scene */
    fxs_want want;                 /* the caller's callback */
    fxs_places pool;
    uint32_t used;                 /* number of places that were used at least once */
    uint32_t *wanted, wanted_count, wanted_next, kept_next;
    uint32_t left;                 /* number of chunks that may still be uploaded in this turn */
} fxs_mirror;

/* A chunk to upload: 128 bytes of its header, and chunk_bytes bytes of its rows. */
typedef struct fxs_mirror_upload {
    uint32_t chunk, place;
    const unsigned char *header, *rows;
} fxs_mirror_upload;

/* Returns the bytes of a place in the device's pool: rows and header. */
uint64_t fxs_mirror_place_bytes(const fxs_scene *scene);

/* Returns the bytes of memory that a mirror of `room` places takes besides the struct. */
uint64_t fxs_mirror_bytes(const fxs_scene *scene, uint32_t room);

/* Makes a mirror of a scene, with an empty pool of `room` places (fxs_places_room). `memory` is aligned to 4. The
   scene's address and `memory` must stay valid. */
void fxs_mirror_init(fxs_mirror *m, const fxs_scene *scene, uint32_t room, void *memory);

/* Begins turn `turn` (larger from frame to frame), in which at most `bytes` bytes are uploaded, but at least one chunk.
   A second call for the same turn, by another object of the scene, changes nothing. */
void fxs_mirror_begin(fxs_mirror *m, uint32_t turn, uint64_t bytes, const fxs_want *want);

/* Callback fxs_options.want for scenes of mirrors. Tells the caller's callback of each chunk if it is in memory. */
void fxs_mirror_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

/* Finds the next chunk to upload, and gives it a place: first the chunks that the cut lacks, in the order of the cut,
   so a coarse chunk comes before its children; then the coarsest chunks of the scene. Chunks that are not in memory are
   skipped. Returns 0 if nothing is left or the pool is full of chunks that this turn and the last drew. */
int fxs_mirror_next(fxs_mirror *m, fxs_mirror_upload *upload);

#endif
