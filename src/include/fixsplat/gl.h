/* OpenGL: renders in a context of OpenGL ES 3.0 or 3.1, and makes contexts without a window. */
#ifndef FXS_GL_H
#define FXS_GL_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Contexts and targets ---------------------------------------------------------------------------------------- */

/* Shared by the OpenGL ES back ends, gl.h and gl.h, for programs with their own GL context: how GL functions are
   found, how the context is made current, and where a frame is drawn. */

/* Finds a function of OpenGL ES by its name, such as "glDrawArrays"; null if it does not exist. Like
   eglGetProcAddress. */
typedef void (*fxs_gl_function)(void);
typedef fxs_gl_function fxs_gl_load_fn(void *argument, const char *name);

/* Makes the context current on the calling thread. Returns 0, or another value if it cannot. */
typedef int fxs_gl_use_fn(void *argument);

/* Target of fxs_gles_render and fxs_compute_draw: a framebuffer of the caller with one colour buffer of 8 bits,
   normalised, linear, not multisampled; its colour buffer is a texture, or it is framebuffer 0 of the context. */
typedef struct fxs_gles_target {
    uint32_t framebuffer;          /* the framebuffer's GL name */
    int32_t x, y;                  /* the picture's lower left corner */
    enum fxs_format format;        /* RGBA8 or RGBA8_COVERAGE */
    int top_down;                  /* 1: the picture's first row is the lowest, the row order of texture uploads */
    int fetch;                     /* 1: uses fxs_gles_draw_fetch; fxs_gles_render only */
    int over;                      /* 1: blends over the framebuffer's content, with premultiplied alpha (GL_ONE,
                                      GL_ONE_MINUS_SRC_ALPHA); `format` is RGBA8_COVERAGE. The picture has the same
                                      bytes on every device, but the device rounds the sums */

    /* Inputs that the caller has drawn: names of textures of the picture's size, lowest row first as in the
       framebuffer, or 0. Their filter must be GL_NEAREST. */
    uint32_t occluder;             /* GL_R32UI, like the occluder of fxs_targets: the same bytes everywhere */
    int depth_bits;                /* fraction bits of the occluder's depths, or of the depths that depth_buffer is
                                      converted to; 0: 16 */
    uint32_t depth_buffer;         /* instead of occluder: GL_DEPTH_COMPONENT of a perspective. It is converted to
                                      depths in floats, so the last bits of these depths depend on the device */
    float plane_0, plane_1;        /* distances of the depth buffer's values 0 and 1, world units. Either may be the far
                                      plane, which hides nothing and may be infinite */
    uint32_t backdrop;             /* GL_RGBA8: replaces the background; must not be the framebuffer's own texture */

    /* 1: the same draw writes median depths (in units of depth_bits) and ids, with the bytes of fxs_targets, to two
       more colour buffers of the framebuffer: GL_COLOR_ATTACHMENT1, GL_R32UI, and GL_COLOR_ATTACHMENT2, GL_RG32UI
       (object, gaussian). The draw buffers (glDrawBuffers) must be attachments 0, 1 and 2. Coverage is the alpha of
       RGBA8_COVERAGE. The first frame takes longer, as shaders are compiled. */
    int depths_and_ids;
} fxs_gles_target;

/* The context's own framebuffer with the picture at its corner, RGBA8, first row on top; no inputs. */
FXS_API void fxs_gles_target_init(fxs_gles_target *target);

/* ---- OpenGL ES 3.0 ----------------------------------------------------------------------------------------------- */

/* A back end for OpenGL ES 3.0: the core projects, shades, sorts and bins on the processor; a fragment shader blends
   and resolves, with the same bytes. It runs in any context of OpenGL ES 3.0, or of OpenGL 3.3 with
   GL_ARB_ES3_compatibility, on one thread at a time.

       fxs_gles *gles = malloc(fxs_gles_bytes());
       if (fxs_gles_init(gles, load, use, argument, message)) ...
       config.draw = fxs_gles_draw, config.draw_argument = gles;
       fxs_init(&context, &config), fxs_render(&context, ...); */

typedef struct fxs_gles fxs_gles;

#define FXS_GLES_MESSAGE 512

/* Bytes of a back end, for the caller to allocate (aligned as malloc does). */
FXS_API size_t fxs_gles_bytes(void);

/* Loads the GL functions, compiles the shaders, creates buffers and textures. Preserves the context's state, except for
   a pending GL error. `use` makes the context current; every function here calls it first, so several contexts may take
   turns on a thread. Null: the caller makes the context current before every call. `argument` is the first argument of
   both functions, which the back end keeps. Returns 0, or FXS_ERR_UNSUPPORTED, FXS_ERR_DEVICE or FXS_ERR_MEMORY, with
   one line in `message` and all GL objects deleted. */
FXS_API int fxs_gles_init(fxs_gles *gles, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument,
                          char message[FXS_GLES_MESSAGE]);

/* Deletes the GL objects. Do not call it after the context was lost or destroyed, which deletes the objects too. */
FXS_API void fxs_gles_free(fxs_gles *gles);

/* GL_RENDERER of the context. */
FXS_API const char *fxs_gles_renderer(const fxs_gles *gles);

/* For fxs_config.draw, with the fxs_gles as draw_argument. Needs a context of its own: GL state is not preserved.
   Errors: FXS_ERR_DEVICE, and FXS_ERR_MEMORY if the device has too little memory. After either error, free the back end
   and create it again, in a new context if the old one was lost. */
FXS_API fxs_draw_fn fxs_gles_draw;

/* Gives the same bytes as fxs_gles_draw without tile lists, in a context with framebuffer fetch: blends splats one by
   one, near to far, on an integer framebuffer. Needs fxs_config.draw_unlisted. Which of the two functions is faster
   depends on the device and the scene. Errors: as fxs_gles_draw, and FXS_ERR_UNSUPPORTED for the reason that
   fxs_gles_no_fetch gives. */
FXS_API fxs_draw_fn fxs_gles_draw_fetch;

/* Null if fxs_gles_draw_fetch is supported; else the reason, one line. */
FXS_API const char *fxs_gles_no_fetch(const fxs_gles *gles);

/* Device time of the last frame, from the first upload to the last draw, without readback; 0 without a timer
   (EXT_disjoint_timer_query). Does not cover fxs_gles_render. */
FXS_API uint64_t fxs_gles_nanoseconds(const fxs_gles *gles);

/* Renders the first eye of a request into a target in the caller's GL context. Errors as fxs_render; the request's own
   targets are ignored. `context` configures the stages before blend; its draw is ignored. The GL state is preserved,
   except for a pending GL error.
   The frame does not depend on blending, culling, depth and stencil tests, dithering, rasterizer discard, alpha to
   coverage, scissor, viewport, colour mask, bindings, and pixel unpacking. Depth and stencil buffers are neither read
   nor written. Transform feedback must not be active. An active occlusion query counts this draw too.
   Further errors: FXS_ERR_TARGET (both an occluder and a depth buffer, planes or depth_bits out of range, a backdrop
   with RGBA8_COVERAGE, `over` without RGBA8_COVERAGE, depths_and_ids in framebuffer 0), FXS_ERR_UNSUPPORTED (another
   format, a picture larger than the device's textures, `fetch` without support (fxs_gles_no_fetch), depths_and_ids
   with `fetch`), FXS_ERR_DEVICE, FXS_ERR_MEMORY (device memory). */
FXS_API int fxs_gles_render(fxs_gles *gles, const fxs_context *context, const fxs_request *request,
                            const fxs_gles_target *target, void *memory, size_t memory_bytes, fxs_stats *stats);

/* ---- Compute shaders --------------------------------------------------------------------------------------------- */

/* A back end that renders whole frames in compute shaders of OpenGL ES 3.1, with the same bytes as fxs_render: project,
   shade, bin, sort, blend and resolve, from copies of packed scenes on the device. It replaces fxs_render, in any
   context of OpenGL ES 3.1, on one thread at a time.

       fxs_compute *compute = malloc(fxs_compute_bytes());
       if (fxs_compute_init(compute, load, use, argument, &why)) ...
       fxs_compute_scene copies[1] = {{0}}, *of_objects[1] = {copies};
       if (fxs_compute_upload(compute, copies, scene, &why)) ...
       memory = malloc(fxs_compute_memory(&request));
       if (fxs_compute_render(compute, &request, of_objects, memory, NULL, &why)) ...

   Functions return 0, or an FXS_ERR_* and a message in `why`, which must not be null: FXS_ERR_DEVICE if the device
   failed or the context was lost, FXS_ERR_MEMORY if the device has too little memory or a buffer would exceed the
   device's limit. After either error, the next call may succeed. */

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

/* ---- Contexts of EGL --------------------------------------------------------------------------------------------- */

/* An OpenGL ES 3.0 context without a display, for kernels/gles: EGL on a device (EGL_EXT_platform_device), Mesa without
   a surface (EGL_MESA_platform_surfaceless), or the default display. libEGL and libGLESv2 are loaded at run time. */

/* Creates a context with the first of these that works and makes it current on this thread. Returns 0, or -1 and a
   message. */
FXS_API int fxs_egl_open(void **egl, fxs_message *message);

/* Finds a function of OpenGL ES by its name: an fxs_gl_load_fn, whose argument is the context of fxs_egl_open. */
FXS_API void (*fxs_egl_load(void *egl, const char *name))(void);

/* Makes the context current on this thread again. Returns 0, or -1. */
FXS_API int fxs_egl_use(void *egl);

/* Ends the context; null is allowed. The display stays open, as the process may have other contexts on it. */
FXS_API void fxs_egl_close(void *egl);

/* ---- Contexts of OSMesa ------------------------------------------------------------------------------------------ */

/* An OpenGL 3.3 context of Mesa's off-screen library, for kernels/gles: rendered on the processor, without a display.
   libOSMesa is loaded at run time; Mesa dropped it in version 25.1. */

/* Makes a context and makes it current on this thread. Returns 0, or -1 and a message. */
FXS_API int fxs_osmesa_open(void **osmesa, fxs_message *message);

/* Finds a function of OpenGL by its name: an fxs_gl_load_fn, whose argument is the context of fxs_osmesa_open. */
FXS_API void (*fxs_osmesa_load(void *osmesa, const char *name))(void);

/* Makes the context current on this thread again. Returns 0, or -1. */
FXS_API int fxs_osmesa_use(void *osmesa);

/* Ends the context; null is allowed. */
FXS_API void fxs_osmesa_close(void *osmesa);

#ifdef __cplusplus
}
#endif

#endif
