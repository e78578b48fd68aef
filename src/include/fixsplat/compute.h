/* A back end that renders whole frames in compute shaders of OpenGL ES 3.1, with the same bytes as fxs_render: project,
 * shade, bin, sort, blend and resolve, with packed scenes that are on the device as they are. It takes the place of
 * fxs_render, in any context of OpenGL ES 3.1, on one thread at a time.
 *
 *     fxs_compute *compute = malloc(fxs_compute_bytes());
 *     if (fxs_compute_init(compute, load, use, argument, &why)) ...
 *     fxs_compute_scene copies[1] = {{0}}, *of_objects[1] = {copies};
 *     if (fxs_compute_upload(compute, copies, scene, &why)) ...
 *     memory = malloc(fxs_compute_memory(&request));
 *     if (fxs_compute_render(compute, &request, of_objects, memory, NULL, &why)) ...
 *
 * Functions return 0 or an FXS_ERR_*, and then `why`, which must not be null, has a message: FXS_ERR_DEVICE where the
 * device failed or the context was lost, FXS_ERR_MEMORY where the device has too little memory or a buffer would be
 * larger than its limit. After either, the next call may work. Not stable: may change with every version. */
#ifndef FXS_COMPUTE_H
#define FXS_COMPUTE_H

#include "gl_target.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_compute fxs_compute;

#define FXS_COMPUTE_PARTS 64       /* buffers of a scene's rows: with the 128 MiB that every device has, 8 GiB */

/* A packed scene on the device. All 0: there is none. */
typedef struct fxs_compute_scene {
    const fxs_scene *key;          /* the caller's; for the caller's use */
    fxs_scene here;                /* as it was when it was copied */
    uint32_t heads, parts[FXS_COMPUTE_PARTS];   /* names of buffers */
    uint32_t part_chunks;          /* chunks of a part */
    uint64_t bytes;                /* on the device */
} fxs_compute_scene;

/* Bytes of a back end, for the caller to allocate (aligned as malloc does). */
FXS_API size_t fxs_compute_bytes(void);

/* Loads the functions and compiles the shaders. `use`: every call here makes the context current by it; null: the caller
   sees to that. Errors: FXS_ERR_UNSUPPORTED (no compute shaders, a limit below what is needed, a shader that does not
   compile), FXS_ERR_DEVICE, FXS_ERR_MEMORY; then nothing is left behind. */
FXS_API int fxs_compute_init(fxs_compute *compute, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument,
                             fxs_message *why);

/* Sets the most bytes of device memory that frames and scenes may take together; 0, as at first: no limit. */
FXS_API void fxs_compute_limit(fxs_compute *compute, uint64_t bytes);

/* Deletes what was made, but for scenes. */
FXS_API void fxs_compute_free(fxs_compute *compute);

/* The renderer that the context names, as GL_RENDERER. */
FXS_API const char *fxs_compute_renderer(const fxs_compute *compute);

/* Copies a scene to the device, in place of what *copy has been. All its rows must be there (no places). */
FXS_API int fxs_compute_upload(fxs_compute *compute, fxs_compute_scene *copy, const fxs_scene *scene, fxs_message *why);

/* Deletes a copy, which is all 0 then. */
FXS_API void fxs_compute_drop(fxs_compute *compute, fxs_compute_scene *copy);

/* Bytes of the host's memory that a frame of this request takes (aligned as malloc does); 0 where it is out of range. */
FXS_API size_t fxs_compute_memory(const fxs_request *request);

/* Renders the first eye of a request into its targets, and waits. copies[i] is the copy of the scene of object i.
   Errors: those of fxs_render, and FXS_ERR_UNSUPPORTED for formats that are the processor's alone; then the targets hold
   what they held before, or where the device failed last of all, the whole picture. */
FXS_API int fxs_compute_render(fxs_compute *compute, const fxs_request *request,
                               const fxs_compute_scene *const *copies, void *memory, fxs_stats *stats,
                               fxs_message *why);

/* Renders the first eye of a request into a target, in the caller's GL context, as fxs_gles_render does: its own targets
   are not used, the bytes are the same, and the GL state is left as it was, with the same exceptions. No pixel is read
   back; but whether the frame fitted into the device's buffers is, 64 bytes, for which it waits before it draws.
   fxs_compute_render alone does not leave the state.
   Errors: those of fxs_compute_render, with FXS_ERR_TARGET and FXS_ERR_UNSUPPORTED as fxs_gles_render has them, and
   FXS_ERR_UNSUPPORTED for `fetch` and `quads` too. After an error nothing was drawn, unless the device failed while it
   drew. The first time takes longer, as shaders are compiled. */
FXS_API int fxs_compute_draw(fxs_compute *compute, const fxs_request *request, const fxs_compute_scene *const *copies,
                             const fxs_gles_target *target, void *memory, fxs_stats *stats, fxs_message *why);

/* The device's time for the last frame, without reading back; 0 where it has no timer. Not of fxs_compute_draw. */
FXS_API uint64_t fxs_compute_nanoseconds(const fxs_compute *compute);

/* The device's memory beside scenes, bytes. */
FXS_API uint64_t fxs_compute_taken(const fxs_compute *compute);

#ifdef __cplusplus
}
#endif

#endif
