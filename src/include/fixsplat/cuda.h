/* The CUDA back end: scenes on a GPU, and frames of them with the same bytes as fxs_render.
 *
 * It keeps no global state. A renderer belongs to one thread at a time and to the device it was created on, and does
 * not disturb other users of the device. Functions return 0 or an FXS_ERR_*, with a message in `why` unless it is null:
 * FXS_ERR_DEVICE if the driver or the device is missing, failed or was lost; FXS_ERR_MEMORY if device memory, or the
 * limit max_memory, is too small. */
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
    uint64_t scenes;               /* packed scenes; of a scene that does not fit, the part on the device */
    uint64_t splats;               /* per slot: 46 bytes a Gaussian, 100 a chunk, 424 an object; with a budget or a
                                      detail also 6.3 MB, 18 bytes for each chunk and node of the scenes, 312 an
                                      object */
    uint64_t tiles;                /* per slot: 136 bytes a tile, 8.5 KB */
    uint64_t entries;              /* per slot: capacity of the tile lists, 8 bytes an entry */
    uint64_t pixels;               /* targets of fxs_cuda_render_host; per slot also the targets that are in pinned host
                                      memory */
    uint64_t total;                /* sum of the five */
} fxs_cuda_memory;

/* The timed stages. Long tile lists are sorted and blended by separate kernels, in parallel with the sort and blend
   stages. Frames in several slots run concurrently, so the sum of their stage times exceeds the elapsed time. */
enum fxs_cuda_stage {
    FXS_CUDA_PROJECT,              /* project, shade and the lengths of the tiles' lists */
    FXS_CUDA_BIN,                  /* fills the tiles' lists */
    FXS_CUDA_SORT,                 /* sort, except for long lists */
    FXS_CUDA_BLEND,                /* blend and resolve, until the long lists are finished too */
    FXS_CUDA_STAGES
};

typedef struct fxs_cuda_stats {
    uint32_t gaussians;            /* sums over all frames of the batch (also visible and entries) */
    uint32_t visible;
    uint64_t entries;
    float milliseconds[FXS_CUDA_STAGES];   /* with fxs_cuda_time: sum over the last frame of each slot; else 0 */
    float device_milliseconds;     /* with fxs_cuda_time: from the start of the first frame to the end of the last
                                      frame's blend; else 0. Includes the host's work if a frame was rendered again,
                                      because its tile lists did not fit */
    fxs_cuda_memory memory;
} fxs_cuda_stats;

/* A frame, with the arguments of fxs_render. */
typedef struct fxs_cuda_frame {
    fxs_camera camera;
    const fxs_object *objects;     /* read by fxs_cuda_render only */
    uint32_t count;
    fxs_targets targets;           /* in device memory, or in pinned host memory (cudaHostAlloc), to which they are
                                      copied; pixels and strides are multiples of a pixel's bytes */
} fxs_cuda_frame;

/* The name of a device, cut to `size` bytes with the final 0. Errors: FXS_ERR_DEVICE. */
FXS_EXPERIMENTAL int fxs_cuda_name(int device, char *name, size_t size, fxs_message *why);

/* Opens device `device`. `max_memory`: most bytes of device memory; 0: all of it. Scenes that do not fit besides the
   frames' buffers are kept partly on the device, with a full copy in pinned host memory. `slots`: 1 to 16 frames in
   flight, each with its own buffers; only one frame at a time while a scene is partly on the device. *out is null after
   an error: FXS_ERR_ARGUMENT, FXS_ERR_DEVICE, FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED if the device has too little shared
   memory. */
FXS_EXPERIMENTAL int fxs_cuda_create(fxs_cuda **out, int device, uint64_t max_memory, uint32_t slots, fxs_message *why);

/* Waits for unfinished work and frees everything; `cuda` may be null. */
FXS_EXPERIMENTAL void fxs_cuda_destroy(fxs_cuda *cuda);

/* Copies a packed scene to the device until it is forgotten. If not all of its rows fit, they are also copied to pinned
   host memory, and the device reads the missing rows from there. The scene is identified by the address of its
   fxs_scene; a scene that is already on the device is not copied again. fxs_cuda_render uploads missing scenes itself.
   Errors: FXS_ERR_ARGUMENT, FXS_ERR_MEMORY, FXS_ERR_DEVICE. */
FXS_EXPERIMENTAL int fxs_cuda_upload(fxs_cuda *cuda, const fxs_scene *scene, fxs_message *why);

/* Drops a scene's copy. Call it before the fxs_scene, or the bytes that it points to, change or are freed. With the
   last scene the memory of frames is freed too. */
FXS_EXPERIMENTAL void fxs_cuda_forget(fxs_cuda *cuda, const fxs_scene *scene);

/* Switches stage timing on or off. Timing records a CUDA event after each stage. */
FXS_EXPERIMENTAL void fxs_cuda_time(fxs_cuda *cuda, int on);

/* Starts 1 to FXS_CUDA_BATCH frames after the work already on `stream` (a cudaStream_t; null: the default stream), and
   makes the stream wait for them. The frames' targets must not overlap. The pixels are complete once fxs_cuda_finish
   has returned 0; call fxs_cuda_finish before any other function. `options` are copied; options->stop is called before
   each frame. Errors: as fxs_render, FXS_ERR_UNSUPPORTED for a scene with `places`, FXS_ERR_DEVICE; no frame is then in
   flight. */
FXS_EXPERIMENTAL int fxs_cuda_render(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count,
                                     const fxs_options *options,
                            void *stream, fxs_message *why);

/* Waits for the frames of fxs_cuda_render. Frames whose tile lists did not fit are rendered again with more memory.
   *stats may be null. Errors: FXS_ERR_ARGUMENT without frames in flight, FXS_ERR_MEMORY, FXS_ERR_DEVICE,
   FXS_ERR_STOPPED, FXS_ERR_SCENE if a chunk's header is out of range because the scene's bytes had changed before the
   upload. Pixels are then undefined. */
FXS_EXPERIMENTAL int fxs_cuda_finish(fxs_cuda *cuda, fxs_cuda_stats *stats, fxs_message *why);

/* Renders, finishes and copies, for targets in any host memory, as fxs_render takes them. */
FXS_EXPERIMENTAL int fxs_cuda_render_host(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count,
                                 const fxs_options *options, fxs_cuda_stats *stats, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
