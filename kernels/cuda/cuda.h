/* The CUDA back end: a scene on a GPU, and frames of it with the same bytes as fxs_render.
 *
 * No global state; a renderer belongs to one thread at a time and to the device it was created on, whose other users
 * it does not disturb. Functions return 0 or an FXS_ERR_*, and then, where `failure` is not null, why: FXS_ERR_DEVICE
 * where the driver or the device is missing, failed or was lost, FXS_ERR_MEMORY where device memory, as it is or as
 * max_memory allows, is too small. */
#ifndef FXS_CUDA_H
#define FXS_CUDA_H

#include "../../src/fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_CUDA_BATCH 64          /* most frames of one fxs_cuda_render */

typedef struct fxs_cuda fxs_cuda;

typedef struct fxs_cuda_failure {
    const char *text;              /* one line, static */
    uint64_t bytes_needed;         /* of device memory, where that is what is missing; else 0 */
} fxs_cuda_failure;

/* Device memory of a renderer, bytes. */
typedef struct fxs_cuda_memory {
    uint64_t scene;                /* the packed scene as it is */
    uint64_t splats;               /* for each slot: 46 bytes a Gaussian, 80 a chunk */
    uint64_t tiles;                /* for each slot: 136 bytes a tile */
    uint64_t entries;              /* for each slot: 8 bytes a tile list entry there is room for */
    uint64_t pixels;               /* of fxs_cuda_render_host */
    uint64_t total;                /* the five above */
} fxs_cuda_memory;

/* project and shade, and the lengths of the lists; the lists; sort, blend and resolve. */
enum fxs_cuda_stage { FXS_CUDA_PROJECT, FXS_CUDA_BIN, FXS_CUDA_BLEND, FXS_CUDA_STAGES };

typedef struct fxs_cuda_stats {
    uint32_t visible;              /* of the last frame */
    uint64_t entries;
    float milliseconds[FXS_CUDA_STAGES];   /* of the last frame rendered in its slot, after fxs_cuda_time; else 0 */
    fxs_cuda_memory memory;
} fxs_cuda_stats;

typedef struct fxs_cuda_frame {
    fxs_camera camera;
    void *pixels;                  /* height rows of width pixels, aligned to a pixel's bytes, in device memory or in
                                      pinned host memory (cudaHostAlloc), which the device writes by itself */
    ptrdiff_t stride;              /* bytes from row to row, a multiple of a pixel's bytes; negative: bottom up */
} fxs_cuda_frame;

/* How many devices there are; 0 where there is no driver. */
int fxs_cuda_devices(void);

/* The name of a device, cut to `size` bytes with the final 0. Errors: FXS_ERR_DEVICE. */
int fxs_cuda_name(int device, char *name, size_t size, fxs_cuda_failure *failure);

/* Opens device `device`. `max_memory`: most bytes of device memory, 0 for no limit of its own. `slots`: 1 to 16 frames
   under way at a time, each with buffers of its own. Errors: FXS_ERR_ARGUMENT, FXS_ERR_DEVICE, FXS_ERR_MEMORY,
   FXS_ERR_UNSUPPORTED where the device has too little shared memory. */
int fxs_cuda_create(fxs_cuda **out, int device, uint64_t max_memory, uint32_t slots, fxs_cuda_failure *failure);

/* Waits for what is under way and gives everything back; `cuda` may be null. */
void fxs_cuda_destroy(fxs_cuda *cuda);

/* Copies a packed scene to the device, in place of the one before. Errors: FXS_ERR_ARGUMENT, FXS_ERR_MEMORY (nothing is
   loaded then; bytes_needed is for the scene and its frames, but for tiles and pixels), FXS_ERR_DEVICE. */
int fxs_cuda_upload(fxs_cuda *cuda, const fxs_scene *scene, fxs_cuda_failure *failure);

/* Whether stage times are taken: that puts an event between the stages. */
void fxs_cuda_time(fxs_cuda *cuda, int on);

/* Starts 1 to FXS_CUDA_BATCH frames behind the work of `stream` (a cudaStream_t; null: the default one), and lets the
   stream wait for them. The pixels are there once fxs_cuda_finish has returned 0, which must come before the next call
   of any other function. Errors as fxs_render's, and FXS_ERR_DEVICE: no frame is under way then. */
int fxs_cuda_render(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                    void *stream, fxs_cuda_failure *failure);

/* Waits for the frames of fxs_cuda_render. Frames whose tile lists did not fit are rendered again, in more memory.
   *stats may be null. Errors: FXS_ERR_ARGUMENT where none are under way, FXS_ERR_MEMORY, FXS_ERR_DEVICE, FXS_ERR_SCENE
   where a chunk's header is out of range: the scene's bytes had changed before they were uploaded; pixels are undefined
   then. */
int fxs_cuda_finish(fxs_cuda *cuda, fxs_cuda_stats *stats, fxs_cuda_failure *failure);

/* One frame to host memory: render, finish and copy. */
int fxs_cuda_render_host(fxs_cuda *cuda, const fxs_camera *camera, const fxs_options *options, void *pixels,
                         ptrdiff_t stride, fxs_cuda_stats *stats, fxs_cuda_failure *failure);

#ifdef __cplusplus
}
#endif

#endif
