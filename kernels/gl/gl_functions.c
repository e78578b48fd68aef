/* Functions, extensions, programs and errors of OpenGL ES, and checks of the caller's target. */
#include "gl_functions.h"
#include "src/core/memory.h"

const char *fxs_gl_load(fxs_gl *table, fxs_gl_load_fn *load, void *argument)
{
    FXS_GL_FUNCTIONS(FXS_GL_LOAD)
    return 0;
}

int fxs_gl_has_extension(const fxs_gl *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const char *one = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (one && !strcmp(one, name))
            return 1;
    }
    return 0;
}

int fxs_gl_check(const fxs_gl *gl)
{
    int error = 0;
    GLenum one;
    /* a limited number of rounds, because a lost context may report errors endlessly */
    for (int i = 0; i < 16 && (one = gl->GetError()) != GL_NO_ERROR; i++)
        error = error ? error : one == GL_OUT_OF_MEMORY ? FXS_ERR_MEMORY : FXS_ERR_DEVICE;
    return error;
}

int fxs_gl_failure(const fxs_gl *gl)
{
    const int error = fxs_gl_check(gl);
    return error ? error : FXS_ERR_DEVICE;
}

int fxs_gl_compile(const fxs_gl *gl, GLuint program, GLenum kind, const char *const *parts, GLsizei count, char *log,
                   GLsizei size)
{
    GLint done = 0;
    const GLuint shader = gl->CreateShader(kind);
    gl->ShaderSource(shader, count, parts, 0);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done)
        gl->GetShaderInfoLog(shader, size, 0, log);
    gl->AttachShader(program, shader);
    gl->DeleteShader(shader);
    return done;
}

int fxs_gl_link(const fxs_gl *gl, GLuint program, char *log, GLsizei size)
{
    GLint done = 0;
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &done);
    if (!done)
        gl->GetProgramInfoLog(program, size, 0, log);
    return done;
}

void fxs_gl_delete_programs(const fxs_gl *gl, int count, const GLuint *programs)
{
    GLint current = 0;
    gl->GetIntegerv(GL_CURRENT_PROGRAM, &current);
    for (int i = 0; i < count; i++) {
        if (current && (GLuint)current == programs[i])
            gl->UseProgram(0);
        gl->DeleteProgram(programs[i]);
    }
}

/* ---- The caller's target ----------------------------------------------------------------------------------------- */

void fxs_gl_target_init(fxs_gl_target *target)
{
    memset(target, 0, sizeof *target);
}

int fxs_gl_check_target(const fxs_gl_target *t)
{
    if (t->depth_bits < 0 || t->depth_bits > 28 || (t->occluder && t->depth_buffer) ||
        (t->backdrop && t->format != FXS_FORMAT_RGBA8) || (t->over && t->format != FXS_FORMAT_RGBA8_COVERAGE) ||
        (t->depths_and_ids && !t->framebuffer) ||
        (t->depth_buffer &&
         !(t->plane_0 > 0 && t->plane_1 > 0 && (t->plane_0 < t->plane_1 || t->plane_1 < t->plane_0))))
        return FXS_ERR_TARGET;
    return t->format == FXS_FORMAT_RGBA8 || t->format == FXS_FORMAT_RGBA8_COVERAGE ? 0 : FXS_ERR_UNSUPPORTED;
}
