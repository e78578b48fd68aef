/* The CUDA back end: keeps scenes on a GPU and renders frames of them, with the same bytes as fxs_render. It keeps no
   global state. A renderer (fxs_cuda) belongs to one thread at a time and to the device it was created on, and does not
   disturb other users of the device. Functions return 0 or an FXS_ERR_*, with a message in `why` unless it is null:
   FXS_ERR_DEVICE if the driver or the device is missing, failed or was lost; FXS_ERR_MEMORY if device memory, or the
   limit max_memory, is too small. */
#ifndef FXS_CUDA_H
#define FXS_CUDA_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_CUDA_BATCH 64          /* largest number of frames in one call of fxs_cuda_render */

typedef struct fxs_cuda fxs_cuda;

/* Device memory of a CUDA renderer by use, in bytes. A slot is the set of buffers of one frame in flight. */
typedef struct fxs_cuda_memory {
    uint64_t scenes;               /* packed scenes; of a scene that does not fit, the part on the device; pools of
                                      scenes in parts */
    uint64_t splats;               /* per slot: 46 bytes a Gaussian, 108 a chunk, 448 an object; with a budget or a
                                      detail also 6.3 MB, 18 bytes for each chunk and node of the scenes, 312 an
                                      object */
    uint64_t tiles;                /* per slot: 136 bytes a tile, 8.5 KB */
    uint64_t entries;              /* per slot: capacity of the tile lists, 8 bytes an entry. It grows after a frame
                                      whose lists did not fit, if max_memory allows */
    uint64_t pixels;               /* targets of fxs_cuda_render_host; per slot also the targets that are in pinned host
                                      memory */
    uint64_t total;                /* sum of the five */
} fxs_cuda_memory;

/* The timed stages of a CUDA frame. Long tile lists are sorted and blended by separate kernels, in parallel with the
   sort and blend stages. Frames in several slots run concurrently, so the sum of their stage times exceeds the elapsed
   time. */
enum fxs_cuda_stage {
    FXS_CUDA_PROJECT,              /* projects the Gaussians, computes their colours, and finds the lengths of the
                                      tiles' lists */
    FXS_CUDA_BIN,                  /* fills the tiles' lists with Gaussians */
    FXS_CUDA_SORT,                 /* sorts the tiles' lists by depth, except for long lists */
    FXS_CUDA_BLEND,                /* blends the tiles and writes the pixels, until the long lists are finished too */
    FXS_CUDA_STAGES
};

typedef struct fxs_cuda_stats {
    uint32_t gaussians;            /* number of Gaussians, summed over all frames of the batch, like `visible` and
                                      `entries` */
    uint32_t visible;
    uint64_t entries;
    float milliseconds[FXS_CUDA_STAGES];   /* time of each stage, summed over the last frame of each slot (frame in
                                              flight). 0 unless fxs_cuda_time switched timing on */
    float device_milliseconds;     /* device time from the start of the first frame to the end of the last frame's blend
                                      stage. 0 unless fxs_cuda_time switched timing on */
    fxs_cuda_memory memory;
    uint32_t missing;              /* number of wanted chunks (256 Gaussians each) of scenes in parts that were not on
                                      the device, summed over all frames; once for two eyes. 0: the pictures are
                                      complete */
    uint32_t unused;               /* 0: room for a field of a later version */
} fxs_cuda_stats;

/* One frame to render; the fields are the arguments of fxs_render. The frames of a call have the same options. A frame
   shows moving scenes at another time than the options' by the times of its objects (fxs_object.time_q32). */
typedef struct fxs_cuda_frame {
    fxs_camera camera;
    const fxs_object *objects;     /* the frame's objects (placed scenes); only fxs_cuda_render itself reads the
                                      array */
    uint32_t count;
    fxs_targets targets;           /* output pictures: in device memory, or in pinned host memory (cudaHostAlloc), to
                                      which they are copied. Addresses and strides are multiples of a pixel's bytes */
} fxs_cuda_frame;

/* Writes the name of a CUDA device, cut to `size` bytes with the final 0. Errors: FXS_ERR_DEVICE. */
FXS_EXPERIMENTAL int fxs_cuda_name(int device, char *name, size_t size, fxs_message *why);

/* Opens CUDA device number `device` and creates a renderer. `max_memory` is a limit of device memory in bytes; 0: all
   of it. Scenes that do not fit besides the frames' buffers are kept partly on the device, with a full copy in pinned
   host memory. `slots` is the number of frames in flight, 1 to 16, each with its own buffers. While a scene is partly
   on the device, only one frame is in flight. *out is null after an error: FXS_ERR_ARGUMENT, FXS_ERR_DEVICE,
   FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED if the device has too little shared memory. */
FXS_EXPERIMENTAL int fxs_cuda_create(fxs_cuda **out, int device, uint64_t max_memory, uint32_t slots, fxs_message *why);

/* Waits for unfinished work and frees the CUDA renderer with all its scenes; `cuda` may be null. */
FXS_EXPERIMENTAL void fxs_cuda_destroy(fxs_cuda *cuda);

/* Copies a packed scene to the device, where it stays until fxs_cuda_forget. If not all of its rows (the Gaussians'
   codes) fit, they are also copied to pinned host memory, and the device reads the missing rows from there. The scene
   is identified by the address of its fxs_scene; a scene that is already on the device is not copied again.
   fxs_cuda_render uploads missing scenes itself. A scene in parts gets an empty pool (fxs_cuda_stream). Errors:
   FXS_ERR_ARGUMENT, FXS_ERR_MEMORY, FXS_ERR_DEVICE. */
FXS_EXPERIMENTAL int fxs_cuda_upload(fxs_cuda *cuda, const fxs_scene *scene, fxs_message *why);

/* Drops the device's copy of a scene. Call it before the fxs_scene, or the bytes that it points to, change or are
   freed. With the last scene the memory of frames is freed too. */
FXS_EXPERIMENTAL void fxs_cuda_forget(fxs_cuda *cuda, const fxs_scene *scene);

/* Switches the timing of stages on or off. Timing records a CUDA event after each stage of a frame. */
FXS_EXPERIMENTAL void fxs_cuda_time(fxs_cuda *cuda, int on);

/* Switches stereo on or off. On: frames 0 and 1 of a batch, 2 and 3, and so on, are the two eyes of one request. The
   eyes of a request have the same objects, and with a budget or a detail they draw the same chunks. */
FXS_EXPERIMENTAL void fxs_cuda_stereo(fxs_cuda *cuda, int on);

/* Settings of scenes in parts (fxs_scene.places is not null, as in a pager's scene), from the next frame on.
   `pool_bytes` is the size of the pool on the device for a scene's chunks (256 Gaussians each), at least 16 chunks; 0
   (initial value): 256 MiB. It is capped at the scene's size, and at half of max_memory or of the device's memory. A
   pool that grows begins empty; a pool never shrinks. `upload_bytes` is the most bytes that a call of fxs_cuda_render
   uploads to all pools together, at least one chunk; 0: 8 MiB. The call first copies chunks that earlier frames wanted
   and that are in memory now to pinned memory; the least recently drawn chunks on the device make room. Frames in
   flight keep their chunks. A frame draws the nearest ancestors that are on the device, as fxs_render does with the
   same chunks in memory. options.want tells, as in fxs_render, if a wanted chunk is in memory. */
FXS_EXPERIMENTAL void fxs_cuda_stream(fxs_cuda *cuda, uint64_t pool_bytes, uint64_t upload_bytes);

/* Starts 1 to FXS_CUDA_BATCH frames after the work already on `stream` (a cudaStream_t; null: the default stream), and
   makes the stream wait for the frames. The frames' targets (output pictures) must not overlap. Work that is put on the
   stream afterwards finds complete pictures; the host need not wait. Frames whose tile lists do not fit are finished on
   the device, more slowly, and later frames get larger lists. fxs_cuda_render may be called again, on any stream,
   without fxs_cuda_finish: two calls are in flight, and a third waits on the host until the first has ended. Memory
   that grows also waits for frames in flight. `options` are copied; options->stop is called before each frame. Errors:
   as fxs_render, FXS_ERR_DEVICE. After an error, no frame of this call is in flight. */
FXS_EXPERIMENTAL int fxs_cuda_render(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count,
                                     const fxs_options *options,
                            void *stream, fxs_message *why);

/* Waits for the frames that fxs_cuda_render started, and reports errors of all frames since the last call. `stats` (of
   the last call of fxs_cuda_render) may be null. Errors: FXS_ERR_ARGUMENT if no frame was started, FXS_ERR_MEMORY,
   FXS_ERR_DEVICE, FXS_ERR_SCENE if a chunk's header is out of range because the scene's bytes had changed before the
   upload. The pixels are undefined after an error. */
FXS_EXPERIMENTAL int fxs_cuda_finish(fxs_cuda *cuda, fxs_cuda_stats *stats, fxs_message *why);

/* Renders frames and waits for them. The targets (output pictures) may be in any host memory, as for fxs_render. */
FXS_EXPERIMENTAL int fxs_cuda_render_host(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count,
                                 const fxs_options *options, fxs_cuda_stats *stats, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
