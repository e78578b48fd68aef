/* The compute back end of OpenGL ES 3.1: the functions that it calls, and its objects in the device. */
#ifndef FXS_COMPUTE_GL31_H
#define FXS_COMPUTE_GL31_H

#include <GLES3/gl31.h>

#include <fixsplat/compute.h>
#include "kernels/gl/gl.h"
#include "plan.h"

/* F(type's name, function's name) of each function that is called beside those of kernels/gl. */
#define FXS_COMPUTE_FUNCTIONS(F) \
    F(BINDBUFFERBASE, BindBufferBase) F(BINDBUFFERRANGE, BindBufferRange) F(BUFFERSUBDATA, BufferSubData) \
    F(COPYBUFFERSUBDATA, CopyBufferSubData) F(DISPATCHCOMPUTE, DispatchCompute) \
    F(DISPATCHCOMPUTEINDIRECT, DispatchComputeIndirect) F(GETINTEGER64I_V, GetInteger64i_v) \
    F(GETINTEGERI_V, GetIntegeri_v) F(MEMORYBARRIER, MemoryBarrier)
typedef struct fxs_compute_gl {
    FXS_COMPUTE_FUNCTIONS(FXS_GL_MEMBER)
} fxs_compute_gl;

struct fxs_compute {
    fxs_gl gl;
    fxs_compute_gl more;           /* functions */
    fxs_gl_use_fn *use;
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
