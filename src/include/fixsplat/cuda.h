/* The CUDA back end: scenes on a GPU, and frames of them with the same bytes as fxs_render.
 *
 * No global state; a renderer belongs to one thread at a time and to the device it was created on, whose other users
 * it does not disturb. Functions return 0 or an FXS_ERR_*, and then, where `why` is not null, why: FXS_ERR_DEVICE where
 * the driver or the device is missing, failed or was lost, FXS_ERR_MEMORY where memory, as it is or as max_memory
 * allows, is too small. */
#ifndef FXS_CUDA_H
#define FXS_CUDA_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_CUDA_BATCH 64          /* most frames of one fxs_cuda_render */

typedef struct fxs_cuda fxs_cuda;

/* Device memory of a renderer, bytes. */
typedef struct fxs_cuda_memory {
    uint64_t scenes;               /* the packed scenes; of those that do not fit what is on the device */
    uint64_t splats;               /* for each slot: 46 bytes a Gaussian, 100 a chunk, 456 an object; with a budget or a
                                      detail 6.3 MB, 18 bytes for each chunk and node there is, 312 an object
                                      and eye; of two eyes that share, the right one's slot has none of that */
    uint64_t tiles;                /* for each slot: 136 bytes a tile, 8.5 KB */
    uint64_t entries;              /* for each slot: 8 bytes a tile list entry there is room for */
    uint64_t pixels;               /* of fxs_cuda_render_host; for each slot: of targets in pinned host memory */
    uint64_t total;                /* the five above */
} fxs_cuda_memory;

/* The stages whose times are taken. Long lists are sorted and blended by kernels of their own, beside the last two.
   Frames in several slots are under way at the same time, so that the times of their stages add up to more than
   passes. */
enum fxs_cuda_stage {
    FXS_CUDA_PROJECT,              /* project, shade and the lengths of the tiles' lists */
    FXS_CUDA_BIN,                  /* the lists */
    FXS_CUDA_SORT,                 /* sort, but of long lists */
    FXS_CUDA_BLEND,                /* blend and resolve, until the long lists are done too */
    FXS_CUDA_STAGES
};

typedef struct fxs_cuda_stats {
    uint32_t gaussians;            /* in all objects, of all frames together; so too the next two */
    uint32_t visible;              /* of two eyes that share, those that either sees */
    uint64_t entries;
    float milliseconds[FXS_CUDA_STAGES];   /* after fxs_cuda_time, of the last frame in each slot, together; else 0 */
    fxs_cuda_memory memory;
} fxs_cuda_stats;

/* A frame as fxs_render takes it. */
typedef struct fxs_cuda_frame {
    fxs_camera camera;
    const fxs_object *objects;     /* read by fxs_cuda_render only */
    uint32_t count;
    fxs_targets targets;           /* in device memory or in pinned host memory (cudaHostAlloc), to which they are
                                      copied; pixels and strides are multiples of a pixel's bytes */
} fxs_cuda_frame;

/* How many devices there are; 0 where there is no driver. */
FXS_API int fxs_cuda_devices(void);

/* The name of a device, cut to `size` bytes with the final 0. Errors: FXS_ERR_DEVICE. */
FXS_API int fxs_cuda_name(int device, char *name, size_t size, fxs_message *why);

/* Opens device `device`. `max_memory`: most bytes of device memory, 0 for no limit of its own. Scenes that do not fit
   beside the frames are there in part, and as a copy in pinned host memory. `slots`: 1 to 16 frames under way at a
   time, each with buffers of its own; one at a time while a scene is there in part. *out is null after an
   error: FXS_ERR_ARGUMENT, FXS_ERR_DEVICE, FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED where the device has too little shared
   memory. */
FXS_API int fxs_cuda_create(fxs_cuda **out, int device, uint64_t max_memory, uint32_t slots, fxs_message *why);

/* Waits for what is under way and gives everything back; `cuda` may be null. */
FXS_API void fxs_cuda_destroy(fxs_cuda *cuda);

/* Copies a packed scene to the device, where it stays until it is forgotten; the most that the device allows, and the
   rest to pinned host memory. A scene is known by the address of its
   fxs_scene; one that is there already is not copied again. fxs_cuda_render does this for scenes that are not there.
   Errors: FXS_ERR_ARGUMENT, FXS_ERR_MEMORY, FXS_ERR_DEVICE. */
FXS_API int fxs_cuda_upload(fxs_cuda *cuda, const fxs_scene *scene, fxs_message *why);

/* Drops a scene's copy. To be called before the fxs_scene, or the bytes that it points to, change or go away. With the
   last scene the memory of frames is given back too. */
FXS_API void fxs_cuda_forget(fxs_cuda *cuda, const fxs_scene *scene);

/* Sets whether the times of stages are taken, which costs an event between any two. */
FXS_API void fxs_cuda_time(fxs_cuda *cuda, int on);

/* The device's time for the frames of the last fxs_cuda_finish, in milliseconds: from the start of the first one to the
   end of the last one's blend; 0 without fxs_cuda_time or after an error. With a frame that was rendered again it has
   the host's time between. */
FXS_API float fxs_cuda_milliseconds(const fxs_cuda *cuda);

/* Sets whether frames 0 and 1 of the calls that follow, 2 and 3, and so on, are the left and the right eye of a viewer
   and share colours and order: as fxs_render renders two eyes that are not exact, with the same bytes. Gaussians are
   then projected for both at once. `count` is even, and the frames of two eyes have the same objects (the same pointer
   and count), pictures of one size and projection, and targets that do not overlap where one is written; otherwise
   fxs_cuda_render and fxs_cuda_render_host return FXS_ERR_ARGUMENT, FXS_ERR_SIZE or FXS_ERR_TARGET, and no frame is
   under way. Two eyes are in two slots; options.stop is asked once for both. While a scene is there in part, one pair
   is under way at a time. Errors: FXS_ERR_ARGUMENT, also of a renderer of one slot. */
FXS_API int fxs_cuda_share_eyes(fxs_cuda *cuda, int on, fxs_message *why);

/* Starts 1 to FXS_CUDA_BATCH frames, whose targets must not overlap, behind the work of `stream` (a cudaStream_t; null:
   the default one), and lets the stream wait for them. The pixels are there once fxs_cuda_finish has returned 0, which
   must come before the next call of any other function. `options` are copied; their stop is asked before each frame.
   Errors as fxs_render's, FXS_ERR_UNSUPPORTED of a scene with places, and FXS_ERR_DEVICE: no frame is under way
   then. */
FXS_API int fxs_cuda_render(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                            void *stream, fxs_message *why);

/* Waits for the frames of fxs_cuda_render. Frames whose tile lists did not fit are rendered again, in more memory.
   *stats may be null. Errors: FXS_ERR_ARGUMENT where none are under way, FXS_ERR_MEMORY, FXS_ERR_DEVICE, FXS_ERR_SCENE
   where a chunk's header is out of range: the scene's bytes had changed before they were uploaded; FXS_ERR_STOPPED.
   Pixels are undefined then. */
FXS_API int fxs_cuda_finish(fxs_cuda *cuda, fxs_cuda_stats *stats, fxs_message *why);

/* Render, finish and copy, for targets in any host memory: as fxs_render takes them. */
FXS_API int fxs_cuda_render_host(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count,
                                 const fxs_options *options, fxs_cuda_stats *stats, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
