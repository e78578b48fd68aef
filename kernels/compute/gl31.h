/* The compute back end of OpenGL ES 3.1: the functions that it calls, and its objects in the device. */
#ifndef FXS_COMPUTE_GL31_H
#define FXS_COMPUTE_GL31_H

#include <GLES3/gl31.h>

#include <fixsplat/compute.h>
#include "plan.h"

/* F(type's name, function's name) of each function of OpenGL ES 3.1 that is called. */
#define FXS_COMPUTE_FUNCTIONS(F) \
    F(ATTACHSHADER, AttachShader) F(BEGINQUERY, BeginQuery) F(BINDBUFFER, BindBuffer) \
    F(BINDBUFFERBASE, BindBufferBase) F(BINDBUFFERRANGE, BindBufferRange) F(BUFFERDATA, BufferData) \
    F(BUFFERSUBDATA, BufferSubData) F(COMPILESHADER, CompileShader) F(COPYBUFFERSUBDATA, CopyBufferSubData) \
    F(CREATEPROGRAM, CreateProgram) F(CREATESHADER, CreateShader) F(DELETEBUFFERS, DeleteBuffers) \
    F(DELETEPROGRAM, DeleteProgram) F(DELETEQUERIES, DeleteQueries) F(DELETESHADER, DeleteShader) \
    F(DISPATCHCOMPUTE, DispatchCompute) F(DISPATCHCOMPUTEINDIRECT, DispatchComputeIndirect) \
    F(ENDQUERY, EndQuery) F(GENBUFFERS, GenBuffers) F(GENQUERIES, GenQueries) F(GETERROR, GetError) \
    F(GETINTEGERV, GetIntegerv) F(GETPROGRAMINFOLOG, GetProgramInfoLog) F(GETPROGRAMIV, GetProgramiv) \
    F(GETQUERYOBJECTUIV, GetQueryObjectuiv) F(GETSHADERINFOLOG, GetShaderInfoLog) F(GETSHADERIV, GetShaderiv) \
    F(GETSTRING, GetString) F(GETSTRINGI, GetStringi) F(LINKPROGRAM, LinkProgram) \
    F(MAPBUFFERRANGE, MapBufferRange) F(MEMORYBARRIER, MemoryBarrier) F(SHADERSOURCE, ShaderSource) \
    F(UNMAPBUFFER, UnmapBuffer) F(USEPROGRAM, UseProgram)

#define FXS_COMPUTE_MEMBER(type, name) PFNGL##type##PROC name;
typedef struct fxs_compute_gl {
    FXS_COMPUTE_FUNCTIONS(FXS_COMPUTE_MEMBER)
} fxs_compute_gl;

struct fxs_compute {
    fxs_compute_gl gl;
    fxs_compute_use_fn *use;
    void *use_argument;
    char renderer[128];
    GLuint programs[FXS_COMPUTE_PROGRAMS], buffers[FXS_COMPUTE_BUFFERS], query;
    uint64_t bytes[FXS_COMPUTE_BUFFERS], scene_bytes;
    uint64_t limit;                /* of these together; 0: none */
    int timer;
    fxs_plan_rooms rooms;
    fxs_plan plan;                 /* of the frame that is under way, or the last one */
    uint64_t nanoseconds;
};

#endif
