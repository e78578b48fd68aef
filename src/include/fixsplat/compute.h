/* A back end that renders whole frames in compute shaders of OpenGL ES 3.1, with the same bytes as fxs_render: project,
 * shade, bin, sort, blend and resolve, from copies of packed scenes on the device. It replaces fxs_render, in any
 * context of OpenGL ES 3.1, on one thread at a time.
 *
 *     fxs_compute *compute = malloc(fxs_compute_bytes());
 *     if (fxs_compute_init(compute, load, use, argument, &why)) ...
 *     fxs_compute_scene copies[1] = {{0}}, *of_objects[1] = {copies};
 *     if (fxs_compute_upload(compute, copies, scene, &why)) ...
 *     memory = malloc(fxs_compute_memory(&request));
 *     if (fxs_compute_render(compute, &request, of_objects, memory, NULL, &why)) ...
 *
 * Functions return 0, or an FXS_ERR_* and a message in `why`, which must not be null: FXS_ERR_DEVICE if the device
 * failed or the context was lost, FXS_ERR_MEMORY if the device has too little memory or a buffer would exceed the
 * device's limit. After either error, the next call may succeed. Not stable: may change with every version. */
#ifndef FXS_COMPUTE_H
#define FXS_COMPUTE_H

#include "gl_target.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_compute fxs_compute;

#define FXS_COMPUTE_PARTS 64       /* most buffers for a scene's rows; every device allows buffers of 128 MiB, so 64
                                      hold 8 GiB */

/* A packed scene on the device. All 0: not uploaded. */
typedef struct fxs_compute_scene {
    const fxs_scene *key;          /* the caller's scene; for the caller's use */
    fxs_scene here;                /* the fxs_scene at the time of the upload */
    uint32_t heads, parts[FXS_COMPUTE_PARTS];   /* names of GL buffers */
    uint32_t part_chunks;          /* chunks per buffer */
    uint64_t bytes;                /* device memory */
} fxs_compute_scene;

/* Bytes of a back end, for the caller to allocate (aligned as malloc does). */
FXS_API size_t fxs_compute_bytes(void);

/* Loads the GL functions and compiles the shaders. `use` makes the context current; every function here calls it first.
   Null: the caller makes the context current before every call. Errors: FXS_ERR_UNSUPPORTED (no compute shaders, a
   limit that is too low, a shader that does not compile), FXS_ERR_DEVICE, FXS_ERR_MEMORY; all GL objects are then
   deleted. */
FXS_API int fxs_compute_init(fxs_compute *compute, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument,
                             fxs_message *why);

/* Sets the most bytes of device memory that frames and scenes may use together; 0 (initial value): no limit. */
FXS_API void fxs_compute_limit(fxs_compute *compute, uint64_t bytes);

/* Deletes the back end's GL objects, except scenes. */
FXS_API void fxs_compute_free(fxs_compute *compute);

/* GL_RENDERER of the context. */
FXS_API const char *fxs_compute_renderer(const fxs_compute *compute);

/* Copies a scene to the device and replaces the previous content of *copy. All rows of the scene must be in memory (no
   `places`). */
FXS_API int fxs_compute_upload(fxs_compute *compute, fxs_compute_scene *copy, const fxs_scene *scene, fxs_message *why);

/* Deletes a copy and sets it to 0. */
FXS_API void fxs_compute_drop(fxs_compute *compute, fxs_compute_scene *copy);

/* Bytes of host memory that a frame of this request takes (aligned as malloc does); 0 if the request is out of
   range. */
FXS_API size_t fxs_compute_memory(const fxs_request *request);

/* Renders the first eye of a request into its targets, and waits. copies[i] is the copy of the scene of object i.
   Errors: as fxs_render, and FXS_ERR_UNSUPPORTED for the processor-only formats. After an error the targets are
   unchanged, or complete if the device failed at the very end. */
FXS_API int fxs_compute_render(fxs_compute *compute, const fxs_request *request,
                               const fxs_compute_scene *const *copies, void *memory, fxs_stats *stats,
                               fxs_message *why);

/* Renders the first eye of a request into a target in the caller's GL context, like fxs_gles_render: the request's own
   targets are ignored, the bytes are the same, and the GL state is preserved, with the same exceptions. No pixels are
   read back, only 64 bytes that tell whether the frame fitted into the device's buffers; the call waits for these bytes
   before it draws. (fxs_compute_render does not preserve the GL state.)
   Errors: as fxs_compute_render; FXS_ERR_TARGET and FXS_ERR_UNSUPPORTED as fxs_gles_render; FXS_ERR_UNSUPPORTED also
   for `fetch`. After an error nothing was drawn, unless the device failed while drawing. The first call takes longer,
   as shaders are compiled. */
FXS_API int fxs_compute_draw(fxs_compute *compute, const fxs_request *request, const fxs_compute_scene *const *copies,
                             const fxs_gles_target *target, void *memory, fxs_stats *stats, fxs_message *why);

/* Device time of the last frame, without readback; 0 without a timer. Does not cover fxs_compute_draw. */
FXS_API uint64_t fxs_compute_nanoseconds(const fxs_compute *compute);

/* Device memory in use, without scenes, bytes. */
FXS_API uint64_t fxs_compute_taken(const fxs_compute *compute);

#ifdef __cplusplus
}
#endif

#endif
