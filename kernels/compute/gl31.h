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

enum { FXS_COMPUTE_DRAWING = 3 };         /* programs of framebuffer.c */

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
    GLuint drawing[FXS_COMPUTE_DRAWING], vertex_array, words;  /* of framebuffer.c, made when first asked for */
    int32_t word_rows, most_rows;  /* of the texture of words */
    int shift;                     /* log2 of its width; 0: fragment shaders read storage buffers */
};

/* Whether so many more bytes of the device may be taken: 0 or FXS_ERR_MEMORY. */
int fxs_compute_allow(const fxs_compute *compute, uint64_t bytes, fxs_message *why);

/* Takes the errors that are pending. Returns 0 where there were none. */
int fxs_compute_check(const fxs_compute *compute, fxs_message *why);

/* The error of what the device lacks: FXS_ERR_UNSUPPORTED, or that of a context that was lost. */
int fxs_compute_lacks(const fxs_compute *compute, const char *text, const char *what, fxs_message *why);

/* The two halves of a frame: what can be wrong with a request; and the rest, into the request's targets, or into a
   target of the caller. */
int fxs_compute_begin(fxs_compute *compute, const fxs_request *request, const fxs_compute_scene *const *copies,
                      void *memory, fxs_message *why);
int fxs_compute_finish(fxs_compute *compute, const fxs_compute_scene *const *copies, const fxs_gles_target *target,
                       fxs_stats *stats, fxs_message *why);

/* ---- framebuffer.c ----------------------------------------------------------------------------------------------- */

/* Fills in the planes of the picture that are read, from the target's textures. */
int fxs_compute_take_mesh(const fxs_compute *compute, const fxs_gles_target *target, fxs_message *why);

/* Draws the picture into the target. */
int fxs_compute_show(fxs_compute *compute, const fxs_gles_target *target, fxs_message *why);

/* Deletes what draws needed. */
void fxs_compute_end_drawing(fxs_compute *compute);

#endif
