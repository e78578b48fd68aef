/* The functions of OpenGL ES 3.0 that the back end calls, as a table of pointers. */
#ifndef FXS_GL_H
#define FXS_GL_H

#include <GLES3/gl3.h>

/* F(type's name, function's name) of each */
#define FXS_GL_FUNCTIONS(F) \
    F(ACTIVETEXTURE, ActiveTexture) F(ATTACHSHADER, AttachShader) F(BEGINQUERY, BeginQuery) \
    F(BINDATTRIBLOCATION, BindAttribLocation) F(BINDBUFFER, BindBuffer) F(BINDFRAMEBUFFER, BindFramebuffer) \
    F(BINDRENDERBUFFER, BindRenderbuffer) F(BINDSAMPLER, BindSampler) F(BINDTEXTURE, BindTexture) \
    F(BINDVERTEXARRAY, BindVertexArray) F(BLENDEQUATIONSEPARATE, BlendEquationSeparate) \
    F(BLENDFUNCSEPARATE, BlendFuncSeparate) F(BLITFRAMEBUFFER, BlitFramebuffer) F(BUFFERDATA, BufferData) \
    F(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) F(CLEARBUFFERFV, ClearBufferfv) \
    F(CLEARBUFFERIV, ClearBufferiv) F(COLORMASK, ColorMask) \
    F(COMPILESHADER, CompileShader) F(CREATEPROGRAM, CreateProgram) F(CREATESHADER, CreateShader) \
    F(DELETEBUFFERS, DeleteBuffers) F(DELETEFRAMEBUFFERS, DeleteFramebuffers) F(DELETEPROGRAM, DeleteProgram) \
    F(DELETEQUERIES, DeleteQueries) F(DELETERENDERBUFFERS, DeleteRenderbuffers) F(DELETESHADER, DeleteShader) \
    F(DELETETEXTURES, DeleteTextures) F(DELETEVERTEXARRAYS, DeleteVertexArrays) F(DISABLE, Disable) \
    F(DRAWARRAYS, DrawArrays) F(DRAWARRAYSINSTANCED, DrawArraysInstanced) \
    F(DRAWBUFFERS, DrawBuffers) F(ENABLE, Enable) \
    F(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray) F(ENDQUERY, EndQuery) \
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
    F(UNMAPBUFFER, UnmapBuffer) F(USEPROGRAM, UseProgram) F(VERTEXATTRIBDIVISOR, VertexAttribDivisor) \
    F(VERTEXATTRIBIPOINTER, VertexAttribIPointer) F(VIEWPORT, Viewport)

#define FXS_GL_MEMBER(type, name) PFNGL##type##PROC name;
typedef struct fxs_gl {
    FXS_GL_FUNCTIONS(FXS_GL_MEMBER)
} fxs_gl;

#endif
