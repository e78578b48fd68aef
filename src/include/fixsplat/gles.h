/* A back end for OpenGL ES 3.0: the core projects, shades, sorts and bins on the processor, a fragment shader blends
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

/* Loads the functions, compiles the shaders, makes buffers and textures. Leaves the context's state as it was, but for
   a GL error that was pending. `use`: every call here makes the context current by it, so that several contexts may
   take turns on a thread; null: the caller sees to it that the context is current at every call. `argument` is that of
   both functions, which are kept. Returns 0, or FXS_ERR_UNSUPPORTED, FXS_ERR_DEVICE or FXS_ERR_MEMORY, one line why not
   in `message`, and nothing left behind. */
FXS_API int fxs_gles_init(fxs_gles *gles, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument,
                          char message[FXS_GLES_MESSAGE]);

/* Deletes what was made. Not to be called where the context is gone: its objects went with it. */
FXS_API void fxs_gles_free(fxs_gles *gles);

/* The renderer that the context names, as GL_RENDERER. */
FXS_API const char *fxs_gles_renderer(const fxs_gles *gles);

/* For fxs_config.draw, with the fxs_gles as argument, in a context that is the back end's own: GL state is not kept.
   Errors: FXS_ERR_DEVICE, and FXS_ERR_MEMORY where the device has too little. After either the back end is freed and
   made anew, in another context where that one was lost. */
FXS_API fxs_draw_fn fxs_gles_draw;

/* The same bytes without lists, in a context that can read the framebuffer where it draws: splats are blended near to
   far, one by one, on a framebuffer of integers. Wants fxs_config.draw_unlisted. Which of the two is faster depends on
   device and scene. Errors: those of fxs_gles_draw, and FXS_ERR_UNSUPPORTED where fxs_gles_no_fetch says why. */
FXS_API fxs_draw_fn fxs_gles_draw_fetch;

/* Null where fxs_gles_draw_fetch can be had; else one line why not. */
FXS_API const char *fxs_gles_no_fetch(const fxs_gles *gles);

/* As fxs_gles_draw, for an inexact picture: a quad for each Gaussian, back to front, blended by the hardware in half
   floats where it can, else in 10 or 8 bits. Wants fxs_config.draw_unlisted. Errors: those of fxs_gles_draw, and
   FXS_ERR_UNSUPPORTED (the picture is larger than a render target can be, or the memory cuts the frame into bands). */
FXS_API fxs_draw_fn fxs_gles_draw_quads;

/* The time that the device took from the first upload to the last draw of the last frame, without reading back; 0
   where it has no timer (EXT_disjoint_timer_query). Not of fxs_gles_render. */
FXS_API uint64_t fxs_gles_nanoseconds(const fxs_gles *gles);

/* Renders the first eye of a request (errors as fxs_render; its own targets are not used) into a target, in the
   caller's GL context. `context` says how the stages before blend run; its draw is not used. The GL state is left as it
   was, but for a GL error that was pending.
   The frame does not depend on blending, culling, depth and stencil tests, dithering, rasterizer discard, alpha to
   coverage, scissor, viewport, colour mask, bindings, and how pixels are unpacked. Depth and stencil buffers are
   neither read nor written. Transform feedback must not be active. An occlusion query that is active counts this draw
   too.
   Further errors: FXS_ERR_TARGET (both an occluder and a depth buffer, planes or depth_bits out of range, a
   backdrop with RGBA8_COVERAGE, `over` without it, depths_and_ids in framebuffer 0), FXS_ERR_UNSUPPORTED (another
   format, a picture larger than the device's textures, `fetch` where fxs_gles_no_fetch says why not, `quads` with
   `fetch`, an occluder, a backdrop or `over`, depths_and_ids with `fetch` or `quads`), FXS_ERR_DEVICE, FXS_ERR_MEMORY
   (the device's). */
FXS_API int fxs_gles_render(fxs_gles *gles, const fxs_context *context, const fxs_request *request,
                            const fxs_gles_target *target, void *memory, size_t memory_bytes, fxs_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
