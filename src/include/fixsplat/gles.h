/* A back end for OpenGL ES 3.0: the core projects, shades, sorts and bins on the processor; a fragment shader blends
 * and resolves, with the same bytes. It runs in any context of OpenGL ES 3.0, or of OpenGL 3.3 with
 * GL_ARB_ES3_compatibility, on one thread at a time.
 *
 *     fxs_gles *gles = malloc(fxs_gles_bytes());
 *     if (fxs_gles_init(gles, load, use, argument, message)) ...
 *     config.draw = fxs_gles_draw, config.draw_argument = gles;
 *     fxs_init(&context, &config), fxs_render(&context, ...); */
#ifndef FXS_GLES_H
#define FXS_GLES_H

#include "gl_target.h"

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif

#endif
