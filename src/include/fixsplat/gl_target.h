/* Shared by the OpenGL ES back ends, gles.h and compute.h, for programs with their own GL context: how GL functions are
 * found, how the context is made current, and where a frame is drawn. */
#ifndef FXS_GL_TARGET_H
#define FXS_GL_TARGET_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif

#endif
