/* OpenGL ES functions that fail from a chosen call on, as after a lost context or without device memory. A failing
   function writes nothing, and glGetError returns the reason. */
#ifndef LOSING_GL_H
#define LOSING_GL_H

#include <limits.h>
#include <string.h>

#include "kernels/compute/gl31.h"

enum { CONTEXT_LOST = 0x0507 };

static long calls_left = LONG_MAX;         /* number of OpenGL calls that still succeed before all fail */
static GLenum loss;
static struct {
    fxs_gl gl;
    fxs_compute_gl more;
} real;

static int is_lost(void)
{
    return calls_left <= 0 || calls_left-- <= 0;
}

#define LOSING(table, name, arguments, values) \
    static void GL_APIENTRY losing_##name arguments \
    { \
        if (!is_lost()) \
            real.table.name values; \
    }
#define LOSING_VALUE(type, name, arguments, values, nothing) \
    static type GL_APIENTRY losing_##name arguments \
    { \
        return is_lost() ? nothing : real.gl.name values; \
    }
LOSING(gl, BindBuffer, (GLenum a, GLuint b), (a, b))
LOSING(gl, BufferData, (GLenum a, GLsizeiptr b, const void *c, GLenum d), (a, b, c, d))
LOSING(gl, CompileShader, (GLuint a), (a))
LOSING(gl, DrawArrays, (GLenum a, GLint b, GLsizei c), (a, b, c))
LOSING(gl, GetIntegerv, (GLenum a, GLint *b), (a, b))
LOSING(gl, GetProgramiv, (GLuint a, GLenum b, GLint *c), (a, b, c))
LOSING(gl, GetQueryObjectuiv, (GLuint a, GLenum b, GLuint *c), (a, b, c))
LOSING(gl, GetShaderiv, (GLuint a, GLenum b, GLint *c), (a, b, c))
LOSING(gl, LinkProgram, (GLuint a), (a))
LOSING(gl, TexSubImage2D, (GLenum a, GLint b, GLint c, GLint d, GLsizei e, GLsizei f, GLenum g, GLenum h,
                           const void *i), (a, b, c, d, e, f, g, h, i))
LOSING(gl, UseProgram, (GLuint a), (a))
LOSING(more, BindBufferBase, (GLenum a, GLuint b, GLuint c), (a, b, c))
LOSING(more, BindBufferRange, (GLenum a, GLuint b, GLuint c, GLintptr d, GLsizeiptr e), (a, b, c, d, e))
LOSING(more, BufferSubData, (GLenum a, GLintptr b, GLsizeiptr c, const void *d), (a, b, c, d))
LOSING(more, CopyBufferSubData, (GLenum a, GLenum b, GLintptr c, GLintptr d, GLsizeiptr e), (a, b, c, d, e))
LOSING(more, DispatchCompute, (GLuint a, GLuint b, GLuint c), (a, b, c))
LOSING(more, DispatchComputeIndirect, (GLintptr a), (a))
LOSING_VALUE(GLuint, CreateProgram, (void), (), 0)
LOSING_VALUE(GLuint, CreateShader, (GLenum a), (a), 0)
LOSING_VALUE(GLenum, GetError, (void), (), loss)
LOSING_VALUE(const GLubyte *, GetString, (GLenum a), (a), 0)
LOSING_VALUE(const GLubyte *, GetStringi, (GLenum a, GLuint b), (a, b), 0)
LOSING_VALUE(void *, MapBufferRange, (GLenum a, GLintptr b, GLsizeiptr c, GLbitfield d), (a, b, c, d), 0)

/* Unmaps a buffer even after the simulated loss of the device, because the real context still works. */
static GLboolean GL_APIENTRY losing_UnmapBuffer(GLenum target)
{
    const GLboolean good = real.gl.UnmapBuffer(target);
    return is_lost() ? GL_FALSE : good;
}

static inline fxs_gl_function losing_load(fxs_gl_load_fn *load, void *context, const char *name)
{
#define LOSES(name) {"gl" #name, (fxs_gl_function)losing_##name}
    static const struct {
        const char *name;
        fxs_gl_function function;
    } rows[] = {
        LOSES(BindBuffer), LOSES(BufferData), LOSES(CompileShader), LOSES(DrawArrays), LOSES(GetIntegerv),
        LOSES(GetProgramiv), LOSES(GetQueryObjectuiv), LOSES(GetShaderiv), LOSES(LinkProgram), LOSES(TexSubImage2D),
        LOSES(UseProgram), LOSES(BindBufferBase), LOSES(BindBufferRange), LOSES(BufferSubData),
        LOSES(CopyBufferSubData), LOSES(DispatchCompute), LOSES(DispatchComputeIndirect), LOSES(CreateProgram),
        LOSES(CreateShader), LOSES(GetError), LOSES(GetString), LOSES(GetStringi), LOSES(MapBufferRange),
        LOSES(UnmapBuffer)
    };
#define REAL(type, function) real.gl.function = (PFNGL##type##PROC)load(context, "gl" #function);
#define REAL_MORE(type, function) real.more.function = (PFNGL##type##PROC)load(context, "gl" #function);
    FXS_GL_FUNCTIONS(REAL)
    FXS_COMPUTE_FUNCTIONS(REAL_MORE)
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (!strcmp(rows[i].name, name))
            return rows[i].function;
    return load(context, name);
}

static inline int is_loss(int error)
{
    return error == FXS_ERR_DEVICE || (loss == GL_OUT_OF_MEMORY && error == FXS_ERR_MEMORY);
}

static inline void lose_after(long calls, GLenum why)
{
    calls_left = calls;
    loss = why;
}

static inline void find_again(void)
{
    calls_left = LONG_MAX;
}

#endif
