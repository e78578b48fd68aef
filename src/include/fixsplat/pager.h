/* Renders a packed scene with levels of detail (packed.h, version 4) of which a pool of memory holds a part: headers,
 * palette and tree are read at once, rows as frames want them. The bytes come from a file, from a server or from
 * functions of the caller.
 *
 *     fxs_pager_open_file("city.fxs", NULL, &pager, &message);
 *     fxs_object_init(&object, fxs_pager_scene(pager));
 *     options.want = fxs_pager_want, options.want_argument = pager;
 *     for each frame: fxs_render(...); fxs_pager_turn(pager, &state, &message);
 *
 * A thread of the pager reads what frames wanted, what is needed most first, and checks each chunk's checksum. A frame
 * never waits for it: what is not there yet is drawn by the nearest coarser chunk that is. What has come is drawn from
 * the next turn on; where the pool is full, it takes the place of what was drawn longest ago. The coarsest chunks stay.
 * When the camera stands still and the pool has room for what it sees, a frame has fxs_stats.missing 0 after a while,
 * and then the very bytes of a frame of the whole scene.
 *
 * Frames with the pager's scene, fxs_pager_want and fxs_pager_turn are for one thread at a time. A back end that copies
 * scenes to a device cannot draw it.
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

/* Where the bytes come from. The pager calls `read` and `close`, one call at a time; `read` first on the thread that
   opens it, then on its own. */
typedef struct fxs_pager_source {
    uint64_t size;                 /* of the whole scene, bytes */
    /* Copies the `size` bytes at `offset`, which lie within the scene, to `out`, in whatever time that takes. Returns
       0, or an FXS_ERR_* and a message. */
    int (*read)(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message);
    /* Called on another thread when the pager is closed: a read that is under way is to end soon, with an error, and so
       is every later one. May be null; then fxs_pager_close waits for it. */
    void (*cancel)(void *argument);
    void (*close)(void *argument); /* called once, when nothing more is read; may be null */
    void *argument;                /* first argument of the functions */
    size_t gap;                    /* bytes between two wanted chunks that are rather read in vain than left out: some
                                      262144 where each read has to be asked of a server, 0 for a file */
} fxs_pager_source;

/* All 0 is a default. */
typedef struct fxs_pager_options {
    size_t pool_bytes;             /* for rows; 0: 256 MiB. 16 chunks at least, never more than the scene has */
    /* Called on the pager's thread when something has come that a turn would take; must return soon. May be null. */
    void (*arrived)(void *argument);
    void *arrived_argument;
} fxs_pager_options;

typedef struct fxs_pager fxs_pager;

/* Opens a scene; `name` is for messages. The source is closed also after an error. *pager is null then. Errors:
   FXS_ERR_FILE where the bytes are damaged or no scene with levels of detail, FXS_ERR_VERSION, FXS_ERR_MEMORY,
   FXS_ERR_ARGUMENT, and those of `read`. */
FXS_API int fxs_pager_open(const char *name, const fxs_pager_source *source, const fxs_pager_options *options,
                           fxs_pager **pager, fxs_message *message);

/* The same for a file, or what an address that begins with http:// or https:// names: fxs_pager_file or
   fxs_pager_url. */
FXS_API int fxs_pager_open_file(const char *path, const fxs_pager_options *options, fxs_pager **pager,
                                fxs_message *message);

/* A source that reads a file. A file that is written to while it is open is an error from then on. */
FXS_API int fxs_pager_file(const char *path, fxs_pager_source *source, fxs_message *message);

/* Whether a path is such an address. */
FXS_API int fxs_pager_is_url(const char *path);

/* A source that asks a server for ranges of bytes (RFC 9110, section 14) by libcurl, which is loaded when it is first
   used. A server that ignores ranges, changes the file meanwhile or answers anything else is an error. Errors:
   FXS_ERR_FILE; FXS_ERR_UNSUPPORTED without libcurl. */
FXS_API int fxs_pager_url(const char *url, fxs_pager_source *source, fxs_message *message);

/* The scene, for fxs_object_init; it stays where it is, and changes in fxs_pager_turn alone. */
FXS_API const fxs_scene *fxs_pager_scene(const fxs_pager *pager);

/* The first bytes of the scene, those before its rows: its header, for fxs_view_of_start and the like. */
FXS_API const void *fxs_pager_head(const fxs_pager *pager);

/* Chunks that its pool holds at most; 0 of a null pager. */
FXS_API uint32_t fxs_pager_room(const fxs_pager *pager);

/* An fxs_want_fn: options.want of its frames, with the pager as want_argument. */
FXS_API void fxs_pager_want(void *pager, const fxs_scene *scene, uint32_t chunk, int there);

typedef struct fxs_pager_state {
    uint32_t chunks;               /* of the scene, with those of its tree */
    uint32_t room;                 /* of these, how many the pool holds at most, */
    uint32_t there;                /* and holds now */
    uint32_t arrived;              /* since the last turn */
    uint32_t coming;               /* wanted, and still to be read */
    uint32_t no_room;              /* wanted, but the pool is full of what the same frames drew */
    uint32_t lost;                 /* that could not be read in three attempts, or are damaged */
    uint64_t bytes_read;
    size_t memory;                 /* of the pager, bytes */
} fxs_pager_state;

/* To be called between frames: takes what has come, makes room, and has the pager's thread go on with what the frames
   since the last turn wanted; where there was none, with what it was at. *state may be null. Returns 0; or where chunks
   are lost, or the source fails again and again, the last error and its message. Frames may go on without what is
   missing: the source is asked anew, after a pause, and once it is back also for what was lost. */
FXS_API int fxs_pager_turn(fxs_pager *pager, fxs_pager_state *state, fxs_message *message);

/* Waits until nothing more can be read before the next turn, or the source fails again and again; at most so many
   nanoseconds. Returns whether that is so. */
FXS_API int fxs_pager_wait(fxs_pager *pager, uint64_t nanoseconds);

/* Closes the source and frees the pager, which may be null. */
FXS_API void fxs_pager_close(fxs_pager *pager);

#ifdef __cplusplus
}
#endif

#endif
