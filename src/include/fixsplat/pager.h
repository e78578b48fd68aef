/* Streams a packed scene with levels of detail (internal/packed.h, version 6): a pool in memory holds a part of the
 * scene's rows. Headers, palette and tree are read when the scene is opened, rows when frames want them. The bytes come
 * from a file, a server or callbacks.
 *
 *     fxs_pager_open_file("city.fxs", NULL, &pager, &message);
 *     fxs_object_init(&object, fxs_pager_scene(pager));
 *     options.want = (fxs_want){fxs_pager_want, pager};
 *     for each frame: fxs_render(...); fxs_pager_turn(pager, &state, &message);
 *
 * A reader thread loads the chunks that frames wanted, most important first, and verifies each chunk's checksum. Frames
 * never wait for the reader thread: in place of a missing chunk, its nearest ancestor in the pool is drawn, which is
 * coarser. Loaded chunks are used from the next turn on; a full pool evicts the least recently drawn chunks. The
 * coarsest chunks stay. If the camera stands still and the pool has room for the view, fxs_stats.missing falls to 0,
 * and the frame then has the same bytes as a frame of the whole scene.
 *
 * Only one thread at a time may render the pager's scene and call fxs_pager_want and fxs_pager_turn. A back end without
 * FXS_CAN_PART cannot draw the pager's scene. The back ends gles-compute (gl.h), vulkan (vulkan.h) and cuda (cuda.h)
 * have a pool of their own on the device, to which each frame copies chunks of the pager's pool.
 *
 * Functions return 0, or an FXS_ERR_* and a message. New in version 1.0. */
#ifndef FXS_PAGER_H
#define FXS_PAGER_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The source of a pager's bytes, such as a file or a server. The pager calls `read` and `close`, one call at a time.
   The first calls of `read` come on the thread that opens the pager, later ones on the pager's thread. */
typedef struct fxs_pager_source {
    uint64_t size;                 /* size of the whole scene, bytes */
    /* Reads a part of the scene: copies the `size` bytes at `offset`, which lie within the scene, to `out`. It may
       block. Returns 0, or an FXS_ERR_* and a message. */
    int (*read)(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message);
    /* Cancels reads; called from another thread when the pager is closed. A read in progress, and every later one,
       should end soon with an error. The pointer may be null; then fxs_pager_close waits for the read. */
    void (*cancel)(void *argument);
    void (*close)(void *argument); /* frees the source: called once, after the last read; may be null */
    void *argument;                /* first argument of read, cancel and close */
    size_t gap;                    /* largest gap between two wanted chunks, in bytes, that is read too, so that one
                                      request gets both chunks. About 262144 suits a server, 0 a file */
} fxs_pager_source;

/* Options of a pager. A field of 0 stands for its default. */
typedef struct fxs_pager_options {
    uint32_t size;
    size_t pool_bytes;             /* size of the pool, the memory for loaded chunks; 0: 256 MiB. At least 16 chunks;
                                      capped at the scene's size */
    /* Called on the pager's thread when newly loaded chunks wait for fxs_pager_turn; must return soon. May be null. */
    void (*arrived)(void *argument);
    void *arrived_argument;
} fxs_pager_options;
FXS_INIT(fxs_pager_options)

typedef struct fxs_pager fxs_pager;

/* Opens a scene for streaming; `name` is for messages. The source is closed also after an error, and *pager is then
   null. Errors: FXS_ERR_FILE if the bytes are damaged or not a scene with levels of detail, FXS_ERR_VERSION,
   FXS_ERR_MEMORY, FXS_ERR_ARGUMENT, and the errors of the source's `read`. */
FXS_API int fxs_pager_open(const char *name, const fxs_pager_source *source, const fxs_pager_options *options,
                           fxs_pager **pager, fxs_message *message);

/* Opens a pager for a file, or for an address that begins with http:// or https://, like fxs_pager_open with the source
   of fxs_pager_file or fxs_pager_url. */
FXS_API int fxs_pager_open_file(const char *path, const fxs_pager_options *options, fxs_pager **pager,
                                fxs_message *message);

/* Returns the pager's scene, for fxs_object_init. Its address stays the same; its content changes only in
   fxs_pager_turn. */
FXS_API const fxs_scene *fxs_pager_scene(const fxs_pager *pager);

/* Tells the pager which chunks a frame wants: a function for the rendering option `want`, with the pager as
   want_argument. */
FXS_API void fxs_pager_want(void *pager, const fxs_scene *scene, uint32_t chunk, int there);

typedef struct fxs_pager_state {
    uint32_t chunks;               /* number of chunks (256 Gaussians each) of the scene, including its tree */
    uint32_t room;                 /* capacity of the pool in memory, chunks */
    uint32_t there;                /* number of chunks in the pool */
    uint32_t arrived;              /* number of chunks loaded since the last fxs_pager_turn */
    uint32_t coming;               /* number of wanted chunks that are still to be read */
    uint32_t no_room;              /* number of wanted chunks without room: the pool is full of chunks that the same
                                      frames drew */
    uint32_t lost;                 /* number of chunks that failed to load three times, or are damaged */
    uint64_t bytes_read;
    size_t memory;                 /* memory that the pager takes, bytes */
} fxs_pager_state;

/* Updates the scene between frames: takes the loaded chunks into the scene, evicts others, and queues the chunks that
   frames wanted since the last call. Without frames since then, the queue stays. *state may be null. Returns 0. If
   chunks are lost, or the source fails repeatedly, returns the last error and its message; frames can go on with
   coarser chunks. A failing source is retried after a pause; once it works again, lost chunks are requested again
   too. */
FXS_API int fxs_pager_turn(fxs_pager *pager, fxs_pager_state *state, fxs_message *message);

/* Waits, for at most `nanoseconds`, until the pager can read nothing more before the next fxs_pager_turn, or its source
   fails repeatedly. Returns 1, or 0 at the timeout. */
FXS_API int fxs_pager_wait(fxs_pager *pager, uint64_t nanoseconds);

/* Closes the source of a pager and frees the pager; null is allowed. */
FXS_API void fxs_pager_close(fxs_pager *pager);

#ifdef __cplusplus
}
#endif

#endif
