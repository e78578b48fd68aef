/* OpenGL: renders in a context of OpenGL ES 3.0 or 3.1. */
#ifndef FXS_GL_H
#define FXS_GL_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Contexts and targets ---------------------------------------------------------------------------------------- */

/* Types that the OpenGL ES back ends share, for programs with their own GL context: how GL functions are found, how the
   context is made current, and where a frame is drawn. */

/* A function that finds a function of OpenGL ES by its name, such as "glDrawArrays". It returns null for an unknown
   name. eglGetProcAddress is similar. */
typedef void (*fxs_gl_function)(void);
typedef fxs_gl_function fxs_gl_load_fn(void *argument, const char *name);

/* A function that makes the program's GL context current on the calling thread. It returns 0, or another value if it
   cannot. */
typedef int fxs_gl_use_fn(void *argument);

/* What a back end knows of its GL context. */
typedef struct fxs_gl_info {
    const char *renderer;          /* the context's GL_RENDERER string; valid as long as the back end */
    const char *no_fetch;          /* reason why fxs_gles_draw_fetch is not supported, one line; null: it is
                                      supported */
    uint64_t nanoseconds;          /* device time in nanoseconds of the last frame that was read back; 0 without a GPU
                                      timer (EXT_disjoint_timer_query) */
} fxs_gl_info;

/* Where fxs_gles_render and fxs_compute_draw draw: a framebuffer of the caller with one colour buffer of 8 bits,
   normalised, linear, not multisampled. The colour buffer is a texture, or the framebuffer is number 0 of the
   context. */
typedef struct fxs_gl_target {
    uint32_t framebuffer;          /* GL name of the framebuffer to draw into */
    int32_t x, y;                  /* position of the picture's lower left corner in the framebuffer */
    enum fxs_format format;        /* pixel format of the picture: RGBA8 or RGBA8_COVERAGE */
    int top_down;                  /* 1: the picture's first row is the lowest, as in texture uploads */
    int fetch;                     /* 1: draws with framebuffer fetch, like fxs_gles_draw_fetch; for fxs_gles_render
                                      only */
    int over;                      /* 1: blends the picture over the framebuffer's content, with premultiplied alpha
                                      (GL_ONE, GL_ONE_MINUS_SRC_ALPHA); `format` is RGBA8_COVERAGE. The picture has the
                                      same bytes on every device, but the device rounds the sums */

    /* Inputs of a frame that the caller has drawn: names of textures of the picture's size, lowest row first as in the
       framebuffer, or 0 for none. Their filter must be GL_NEAREST. */
    uint32_t occluder;             /* texture of depths that hide Gaussians, GL_R32UI, with the same bytes as the
                                      occluder of fxs_targets */
    int depth_bits;                /* fraction bits of the occluder's depths, or of the depths that depth_buffer is
                                      converted to; 0: 16 */
    uint32_t depth_buffer;         /* depth texture in place of the occluder: GL_DEPTH_COMPONENT of a perspective. Its
                                      values are converted to depths in floats, so the last bits of these depths depend
                                      on the device */
    float plane_0, plane_1;        /* distances that the depth buffer's values 0 and 1 stand for, world units. Either
                                      may be the far plane, which hides nothing and may be infinite */
    uint32_t backdrop;             /* texture that replaces the background, GL_RGBA8; must not be the framebuffer's own
                                      texture */

    /* 1: the same draw writes median depths (in units of depth_bits) and ids, with the bytes of fxs_targets, to two
       more colour buffers of the framebuffer: GL_COLOR_ATTACHMENT1, GL_R32UI, and GL_COLOR_ATTACHMENT2, GL_RG32UI
       (object, gaussian). The draw buffers (glDrawBuffers) must be attachments 0, 1 and 2. Coverage is the alpha of
       RGBA8_COVERAGE. The first frame takes longer, as shaders are compiled. */
    int depths_and_ids;
} fxs_gl_target;

/* Initialises a target: the framebuffer of the current context, with the picture at its corner, RGBA8, first row on
   top, and no inputs. */
FXS_EXPERIMENTAL void fxs_gl_target_init(fxs_gl_target *target);

/* ---- OpenGL ES 3.0 ----------------------------------------------------------------------------------------------- */

/* A back end for OpenGL ES 3.0: the library projects, shades, sorts and bins Gaussians on the processor; a fragment
   shader blends them and writes the pixels, with the same bytes as fxs_render. It runs in any context of OpenGL ES 3.0,
   or of OpenGL 3.3 with GL_ARB_ES3_compatibility, on one thread at a time.

       fxs_gles *gles;
       if (fxs_gles_create(&gles, load, use, argument, &message)) ...
       config.draw = fxs_gles_draw, config.draw_argument = gles;
       fxs_context_init(&context, &config), fxs_render(&context, ...); */

typedef struct fxs_gles fxs_gles;

/* Loads the GL functions, compiles the shaders, creates buffers and textures. Preserves the context's state, except for
   a pending GL error. `use` makes the context current; every function here calls it first, so several contexts may take
   turns on a thread. Null: the caller makes the context current before every call. `argument` is the first argument of
   both functions, which the back end keeps. fxs_gles_destroy frees *gles, which is null after an error. Errors:
   FXS_ERR_UNSUPPORTED, FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_gles_create(fxs_gles **gles, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument,
                            fxs_message *message);

/* Deletes the back end's GL objects and frees it; null is allowed. If its function `use` fails, because the context was
   lost, only memory is freed. With a null `use`, the caller makes the context current first, or no context if it
   was lost. */
FXS_EXPERIMENTAL void fxs_gles_destroy(fxs_gles *gles);

FXS_EXPERIMENTAL fxs_gl_info fxs_gles_info(const fxs_gles *gles);

/* Draws tiles with a fragment shader: the function for fxs_config.draw, with the fxs_gles as draw_argument. It needs a
   context of its own, as GL state is not preserved. Errors: FXS_ERR_DEVICE, and FXS_ERR_MEMORY if the device has too
   little memory. After either error, free the back end and create it again, in a new context if the old one was
   lost. */
FXS_EXPERIMENTAL fxs_draw_fn fxs_gles_draw;

/* Gives the same bytes as fxs_gles_draw without tile lists, in a context with framebuffer fetch (shaders that read the
   pixel they write). It blends splats (projected Gaussians) one by one, near to far, on an integer framebuffer. It
   needs fxs_config.draw_unlisted. Which of the two functions is faster depends on the device and the scene. Errors: as
   fxs_gles_draw, and FXS_ERR_UNSUPPORTED for the reason in fxs_gl_info.no_fetch. */
FXS_EXPERIMENTAL fxs_draw_fn fxs_gles_draw_fetch;

/* Renders the first eye of a request into a target in the caller's GL context. Errors as fxs_render; the request's own
   targets are ignored. `context` configures the stages before blend; its draw is ignored. The GL state is preserved,
   except for a pending GL error.
   The frame does not depend on blending, culling, depth and stencil tests, dithering, rasterizer discard, alpha to
   coverage, scissor, viewport, colour mask, bindings, and pixel unpacking. Depth and stencil buffers are neither read
   nor written. Transform feedback must not be active. An active occlusion query counts this draw too.
   Further errors: FXS_ERR_TARGET (both an occluder and a depth buffer, planes or depth_bits out of range, a backdrop
   with RGBA8_COVERAGE, `over` without RGBA8_COVERAGE, depths_and_ids in framebuffer 0), FXS_ERR_UNSUPPORTED (another
   format, a picture larger than the device's textures, `fetch` without support (fxs_gl_info), depths_and_ids
   with `fetch`), FXS_ERR_DEVICE, FXS_ERR_MEMORY (device memory). */
FXS_EXPERIMENTAL int fxs_gles_render(fxs_gles *gles, const fxs_context *context, const fxs_request *request,
                            const fxs_gl_target *target, void *memory, size_t memory_bytes, fxs_stats *stats);

/* ---- Compute shaders --------------------------------------------------------------------------------------------- */

/* A back end that renders whole frames in compute shaders of OpenGL ES 3.1, with the same bytes as fxs_render: project,
   shade, bin, sort, blend and resolve, from copies of packed scenes on the device. It replaces fxs_render, in any
   context of OpenGL ES 3.1, on one thread at a time.

       fxs_compute *compute;
       if (fxs_compute_create(&compute, load, use, argument, &message)) ...
       fxs_compute_scene copies[1] = {{0}}, *of_objects[1] = {copies};
       if (fxs_compute_upload(compute, copies, scene, &why)) ...
       memory = malloc(fxs_compute_memory(&request));
       if (fxs_compute_render(compute, &request, of_objects, memory, NULL, &why)) ...

   Functions return 0, or an FXS_ERR_* and a message in `why`, which must not be null: FXS_ERR_DEVICE if the device
   failed or the context was lost, FXS_ERR_MEMORY if the device has too little memory or a buffer would exceed the
   device's limit. After either error, the next call may succeed. */

typedef struct fxs_compute fxs_compute;

#define FXS_COMPUTE_PARTS 64       /* largest number of GL buffers for the rows (Gaussian codes) of a scene. Every
                                      device allows buffers of 128 MiB, so 64 hold 8 GiB */

/* The copy of a packed scene on the device. All 0: not uploaded. */
typedef struct fxs_compute_scene {
    const fxs_scene *key;          /* the caller's scene that was copied; only for the caller's use */
    fxs_scene here;                /* the fxs_scene as it was at the time of the upload */
    uint32_t heads, parts[FXS_COMPUTE_PARTS];   /* names of the GL buffers that hold the copy */
    uint32_t part_chunks;          /* number of chunks (256 Gaussians each) per buffer */
    uint64_t bytes;                /* device memory */
    struct fxs_mirror *mirror;     /* of a scene in parts: which chunks are on the device (src/core/mirror.h); else
                                      null */
} fxs_compute_scene;

/* Creates the back end for compute shaders: loads the GL functions and compiles the shaders. `load`, `use` and
   `argument` are as in fxs_gles_create. fxs_compute_destroy frees *compute, which is null after an error:
   FXS_ERR_UNSUPPORTED (no compute shaders, a limit that is too low, a shader that does not compile), FXS_ERR_DEVICE,
   FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_compute_create(fxs_compute **compute, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument,
                               fxs_message *message);

/* Sets the most bytes of device memory that frames and scenes may use together; 0 (initial value): no limit. */
FXS_EXPERIMENTAL void fxs_compute_limit(fxs_compute *compute, uint64_t bytes);

/* Settings of scenes in parts (fxs_scene.places is not null, as in a pager's scene) that are uploaded from now on.
   `pool_bytes` is the size of the pool on the device for a scene's chunks (256 Gaussians each), at least 16 chunks; 0:
   256 MiB. It is capped at the scene's size, and at half of fxs_compute_limit. `upload_bytes` is the most bytes that a
   frame uploads to all pools together, at least one chunk; 0: 8 MiB. */
FXS_EXPERIMENTAL void fxs_compute_stream(fxs_compute *compute, uint64_t pool_bytes, uint64_t upload_bytes);

/* Frees the back end like fxs_gles_destroy. Drop its scenes first. */
FXS_EXPERIMENTAL void fxs_compute_destroy(fxs_compute *compute);

FXS_EXPERIMENTAL fxs_gl_info fxs_compute_info(const fxs_compute *compute);

/* Copies a scene to the device and replaces the previous content of *copy. Of a scene in parts, only the coarsest
   chunks are copied. Each frame then copies chunks that it lacks and that are in memory, for the next frames; the least
   recently drawn chunks on the device make room. The frame draws the nearest ancestors that are on the device, as
   fxs_render does with the same chunks in memory, and fxs_stats.missing counts chunks that are not on the device.
   options.want tells, as in fxs_render, if a wanted chunk is in memory. `scene` must stay valid until
   fxs_compute_drop. */
FXS_EXPERIMENTAL int fxs_compute_upload(fxs_compute *compute, fxs_compute_scene *copy, const fxs_scene *scene,
                                        fxs_message *why);

/* Deletes the copy of a scene on the device and sets *copy to 0. */
FXS_EXPERIMENTAL void fxs_compute_drop(fxs_compute *compute, fxs_compute_scene *copy);

/* Returns the bytes of host memory that a frame of this request takes (aligned as malloc does); 0 if the request is out
   of range. */
FXS_EXPERIMENTAL size_t fxs_compute_memory(const fxs_request *request);

/* Renders a request, of one eye or two, into its targets (output pictures), and waits. copies[i] is the device's copy
   of the scene of object i. A frame that exceeds a storage buffer of the device is drawn in windows of the pictures,
   one after the other. The bytes are the same. Errors: as fxs_render, and FXS_ERR_UNSUPPORTED for the processor-only
   formats. After an error the targets are unchanged, or complete if the device failed at the very end, except that
   FXS_ERR_STOPPED, FXS_ERR_DEVICE, or FXS_ERR_MEMORY because the device ran out of memory, may leave some windows
   drawn. */
FXS_EXPERIMENTAL int fxs_compute_render(fxs_compute *compute, const fxs_request *request,
                               const fxs_compute_scene *const *copies, void *memory, fxs_stats *stats,
                               fxs_message *why);

/* Renders a request into targets in the caller's GL context, one for each eye, like fxs_gles_render. The request's own
   targets are ignored, except for their maps of rates. The bytes are the same, and the GL state is preserved, with
   the same exceptions. Two eyes are drawn into two framebuffers, which may show the two layers of an array texture,
   or side by side into one framebuffer, with different `x`. The call does not wait for the device. *stats describes
   the newest frame that the device has finished; all 0 before the first. A frame whose lists exceed the device's
   buffers takes longer; later frames get larger buffers. (fxs_compute_render does not preserve the GL state.)
   Errors: as fxs_compute_render; FXS_ERR_MEMORY also if the frame exceeds a storage buffer of the device (then a budget
   helps); FXS_ERR_TARGET and FXS_ERR_UNSUPPORTED as fxs_gles_render; FXS_ERR_UNSUPPORTED also for `fetch`. After an
   error nothing was drawn, unless the device failed while drawing. An error that the device finds in a frame
   (FXS_ERR_SCENE, a lost context) is returned by a later call. The first call takes longer, as shaders are compiled. */
FXS_EXPERIMENTAL int fxs_compute_draw(fxs_compute *compute, const fxs_request *request,
                                      const fxs_compute_scene *const *copies,
                             const fxs_gl_target *targets, void *memory, fxs_stats *stats, fxs_message *why);

/* Waits for all frames of fxs_compute_draw. Returns their error, and the stats of the newest frame; stats may be null.
   Preserves the GL state. */
FXS_EXPERIMENTAL int fxs_compute_wait(fxs_compute *compute, fxs_stats *stats, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
