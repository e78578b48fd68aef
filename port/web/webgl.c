/* The OpenGL ES back end (kernels/gles) on WebGL 2, with the functions of webgl.js. */
#include <stdlib.h>
#include <string.h>

#include "kernels/gl/gl_functions.h"
#include <fixsplat/gl.h>
#include "web.h"

#define IMPORT(type, name) \
    __attribute__((import_module("gl"), import_name(#name))) extern __typeof__(gl##name) gl##name;
FXS_GL_FUNCTIONS(IMPORT)

typedef struct named {
    const char *name;
    fxs_gl_function function;
} named;

/* Replaces glGetString. WebGL 2 is OpenGL ES 3.0 with another name of the version. */
static const GLubyte *text(GLenum name)
{
    return (const GLubyte *)(name == GL_VERSION ? "OpenGL ES 3.0 (WebGL 2.0)" : "WebGL");
}

static fxs_gl_function load(void *argument, const char *name)
{
#define ROW(type, function) {"gl" #function, (fxs_gl_function)gl##function},
    static const named functions[] = {
        {"glGetString", (fxs_gl_function)text}, FXS_GL_FUNCTIONS(ROW)
    };
    (void)argument;
    const named *f = functions;
    while (strcmp(f->name, name))
        f++;
    return f->function;
}

EXPORT(gl_open) fxs_gles *fxs_web_gl_open(void)
{
    fxs_gles *gles;
    fxs_gles_create(&gles, load, NULL, NULL, fxs_web_message());
    return gles;
}

EXPORT(gl_close) void fxs_web_gl_close(fxs_gles *gles)
{
    fxs_gles_destroy(gles);
}

/* Draws a picture into a framebuffer, with its lower left corner at (x, y). `depth` is the texture of a depth buffer,
   or 0. plane_0 and plane_1 are the distances of the depths 0 and 1 in this texture. `backdrop` is a texture to draw
   instead of the background, or 0. */
EXPORT(gl_render) int fxs_web_gl_render(fxs_gles *gles, uint32_t framebuffer, uint32_t depth, uint32_t backdrop,
                                        int x, int y, float plane_0, float plane_1, int format, uint32_t background,
                                        int sh_degree, int square, uint32_t budget, uint32_t detail_q8, size_t limit)
{
    fxs_web_frame f;
    fxs_gl_target target;
    if (fxs_web_frame_begin(&f, background, sh_degree, square, budget, detail_q8, limit))
        return FXS_ERR_MEMORY;
    fxs_gl_target_init(&target);
    target.framebuffer = framebuffer;
    target.backdrop = backdrop;
    target.x = x;
    target.y = y;
    target.depth_buffer = depth;
    target.plane_0 = plane_0;
    target.plane_1 = plane_1;
    target.format = (enum fxs_format)format;
    return fxs_web_frame_end(&f, fxs_gles_render(gles, f.context, &f.request, &target, f.memory, f.bytes, &f.stats));
}
