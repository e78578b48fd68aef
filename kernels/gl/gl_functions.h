/* Shared by the back ends for OpenGL ES: a table of pointers to the functions of OpenGL ES 3.0 that the back ends call;
 * GL programs, errors, and the state of a GL context. */
#ifndef FXS_GL_FUNCTIONS_H
#define FXS_GL_FUNCTIONS_H

#include <GLES3/gl3.h>

#include <fixsplat/gl.h>

/* List of the GL functions: F(function's name in its pointer type, function's name). */
#define FXS_GL_FUNCTIONS(F) \
    F(ACTIVETEXTURE, ActiveTexture) F(ATTACHSHADER, AttachShader) F(BEGINQUERY, BeginQuery) \
    F(BINDBUFFER, BindBuffer) F(BINDFRAMEBUFFER, BindFramebuffer) \
    F(BINDRENDERBUFFER, BindRenderbuffer) F(BINDSAMPLER, BindSampler) F(BINDTEXTURE, BindTexture) \
    F(BINDVERTEXARRAY, BindVertexArray) F(BLENDEQUATIONSEPARATE, BlendEquationSeparate) \
    F(BLENDFUNCSEPARATE, BlendFuncSeparate) F(BUFFERDATA, BufferData) \
    F(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) F(CLEARBUFFERIV, ClearBufferiv) F(COLORMASK, ColorMask) \
    F(COMPILESHADER, CompileShader) F(CREATEPROGRAM, CreateProgram) F(CREATESHADER, CreateShader) \
    F(DELETEBUFFERS, DeleteBuffers) F(DELETEFRAMEBUFFERS, DeleteFramebuffers) F(DELETEPROGRAM, DeleteProgram) \
    F(DELETEQUERIES, DeleteQueries) F(DELETERENDERBUFFERS, DeleteRenderbuffers) F(DELETESHADER, DeleteShader) \
    F(DELETETEXTURES, DeleteTextures) F(DELETEVERTEXARRAYS, DeleteVertexArrays) F(DISABLE, Disable) \
    F(DRAWARRAYS, DrawArrays) F(DRAWBUFFERS, DrawBuffers) F(ENABLE, Enable) F(ENDQUERY, EndQuery) \
    F(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer) F(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) \
    F(GENBUFFERS, GenBuffers) F(GENFRAMEBUFFERS, GenFramebuffers) F(GENQUERIES, GenQueries) \
    F(GENRENDERBUFFERS, GenRenderbuffers) F(GENTEXTURES, GenTextures) F(GENVERTEXARRAYS, GenVertexArrays) \
    F(GETBOOLEANV, GetBooleanv) F(GETERROR, GetError) F(GETINTEGERV, GetIntegerv) \
    F(GETPROGRAMINFOLOG, GetProgramInfoLog) F(GETPROGRAMIV, GetProgramiv) \
    F(GETQUERYOBJECTUIV, GetQueryObjectuiv) F(GETSHADERINFOLOG, GetShaderInfoLog) F(GETSHADERIV, GetShaderiv) \
    F(GETSTRING, GetString) F(GETSTRINGI, GetStringi) F(GETUNIFORMLOCATION, GetUniformLocation) \
    F(ISENABLED, IsEnabled) F(LINKPROGRAM, LinkProgram) F(MAPBUFFERRANGE, MapBufferRange) \
    F(PIXELSTOREI, PixelStorei) F(READPIXELS, ReadPixels) F(RENDERBUFFERSTORAGE, RenderbufferStorage) \
    F(SCISSOR, Scissor) F(SHADERSOURCE, ShaderSource) F(TEXIMAGE2D, TexImage2D) F(TEXPARAMETERI, TexParameteri) \
    F(TEXSUBIMAGE2D, TexSubImage2D) F(UNIFORM1I, Uniform1i) F(UNIFORM2F, Uniform2f) F(UNIFORM4I, Uniform4i) \
    F(UNMAPBUFFER, UnmapBuffer) F(USEPROGRAM, UseProgram) F(VIEWPORT, Viewport)

#define FXS_GL_MEMBER(type, name) PFNGL##type##PROC name;
typedef struct fxs_gl {
    FXS_GL_FUNCTIONS(FXS_GL_MEMBER)
} fxs_gl;

/* Loads a GL function into `table`. If the function is missing, makes the calling function return the missing name. */
#define FXS_GL_LOAD(type, name) \
    table->name = (PFNGL##type##PROC)load(argument, "gl" #name); \
    if (!table->name) \
        return "gl" #name;

/* Loads all GL functions into *table. Returns null, or the name of a missing function. */
const char *fxs_gl_load(fxs_gl *table, fxs_gl_load_fn *load, void *argument);

int fxs_gl_has_extension(const fxs_gl *gl, const char *name);

/* Clears pending GL errors. Returns 0 if there were none, otherwise FXS_ERR_MEMORY or FXS_ERR_DEVICE. */
int fxs_gl_check(const fxs_gl *gl);

/* Returns the error code FXS_ERR_* for a GL call that has failed, never 0. */
int fxs_gl_failure(const fxs_gl *gl);

/* Compile and link shaders. Both functions return 1, or 0 with the device's message in `log`. */
int fxs_gl_compile(const fxs_gl *gl, GLuint program, GLenum kind, const char *const *parts, GLsizei count, char *log,
                   GLsizei size);
int fxs_gl_link(const fxs_gl *gl, GLuint program, char *log, GLsizei size);

/* Deletes GL programs. Unbinds the current program first, because GL keeps a program in use alive. */
void fxs_gl_delete_programs(const fxs_gl *gl, int count, const GLuint *programs);

int fxs_gl_check_target(const fxs_gl_target *target);

enum { FXS_GL_UNITS = 10 };

typedef struct fxs_gl_state {
    GLint program, vertex_array, unpack_buffer, draw_framebuffer;
    GLint active_texture, textures[FXS_GL_UNITS], samplers[FXS_GL_UNITS], viewport[4], scissor[4], unpack[3];
    GLint blend[6];
    GLboolean switches[8], colour_mask[4];
} fxs_gl_state;

void fxs_gl_save(const fxs_gl *gl, fxs_gl_state *state);
void fxs_gl_restore(const fxs_gl *gl, const fxs_gl_state *state);

/* Sets the GL state for draws, and binds `textures` to the texture units 0 to count - 1. */
void fxs_gl_set(const fxs_gl *gl, GLuint vertex_array, int count, const GLuint *textures);

void fxs_gl_blend_over(const fxs_gl *gl);

#endif
