/* What the back ends of OpenGL ES, gles.h and compute.h, take from a program with a context of its own: how functions
 * are found, how the context is made current, and where a frame is drawn. */
#ifndef FXS_GL_TARGET_H
#define FXS_GL_TARGET_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Finds a function of OpenGL ES by its name, "glDrawArrays"; null where there is none. As eglGetProcAddress. */
typedef void (*fxs_gl_function)(void);
typedef fxs_gl_function fxs_gl_load_fn(void *argument, const char *name);

/* Makes the context current on the calling thread. Returns 0, or another value where it cannot. */
typedef int fxs_gl_use_fn(void *argument);

/* Where fxs_gles_render and fxs_compute_draw draw: a framebuffer of the caller with one colour buffer of 8 bits,
   normalised, linear, not multisampled; bound to a texture, or 0 for the context's own. */
typedef struct fxs_gles_target {
    uint32_t framebuffer;          /* its name */
    int32_t x, y;                  /* of the picture's lower left corner */
    enum fxs_format format;        /* RGBA8 or RGBA8_COVERAGE */
    int top_down;                  /* 1: the picture's first row is the lowest one, as a texture is filled by rows */
    int fetch;                     /* 1: by fxs_gles_draw_fetch; of fxs_gles_render alone */
    int quads;                     /* 1: by fxs_gles_draw_quads, without what follows; of fxs_gles_render alone */
    int over;                      /* 1: over what is in the framebuffer, blended as premultiplied colours are (GL_ONE,
                                      GL_ONE_MINUS_SRC_ALPHA); `format` is RGBA8_COVERAGE. The picture has the same
                                      bytes on every device, but the device rounds the sums */

    /* What the caller has drawn: names of textures as large as the picture, with its lowest row first as it is in the
       framebuffer, or 0. No filter but GL_NEAREST. */
    uint32_t occluder;             /* GL_R32UI, as the occluder of fxs_targets: the same bytes everywhere */
    int depth_bits;                /* of that, or of what depth_buffer is turned to; 0: 16 */
    uint32_t depth_buffer;         /* in place of occluder: GL_DEPTH_COMPONENT of a perspective. It is turned to depths
                                      in floats, so their last bits depend on the device */
    float plane_0, plane_1;        /* the distances that 0 and 1 stand for in it, world units. Either may be the farther
                                      one, which hides nothing and may be infinite */
    uint32_t backdrop;             /* GL_RGBA8: in place of the background; not the framebuffer's own texture */

    /* 1: the same draw writes median depths (in units of depth_bits) and ids as in fxs_targets, with their bytes, to two
       more colour buffers of the framebuffer: GL_COLOR_ATTACHMENT1, GL_R32UI, and GL_COLOR_ATTACHMENT2, GL_RG32UI
       (object, gaussian). Its draw buffers (glDrawBuffers) are attachments 0, 1 and 2. Coverage is the alpha of
       RGBA8_COVERAGE. The first time takes longer, as shaders are compiled. */
    int depths_and_ids;
} fxs_gles_target;

/* The context's own framebuffer at its corner, RGBA8, rows from the top; nothing else. */
FXS_API void fxs_gles_target_init(fxs_gles_target *target);

#ifdef __cplusplus
}
#endif

#endif
