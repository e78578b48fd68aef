/* Compute back end for OpenGL ES 3.1: the functions that it calls, and its objects on the device. */
#ifndef FXS_COMPUTE_GL31_H
#define FXS_COMPUTE_GL31_H

#include <GLES3/gl31.h>

#include <fixsplat/gl.h>
#include "kernels/gl/gl_functions.h"
#include "plan.h"

/* F(type's name, function's name) for each function that is not in kernels/gl. */
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
    fxs_compute_gl more;           /* functions not in kernels/gl */
    fxs_gl_use_fn *use;
    void *use_argument;
    char renderer[128];
    GLuint programs[FXS_COMPUTE_PROGRAMS], buffers[FXS_COMPUTE_BUFFERS], query;
    uint64_t bytes[FXS_COMPUTE_BUFFERS], scene_bytes;
    uint64_t limit;                /* maximum of all bytes together; 0: unlimited */
    int timer;
    fxs_plan_rooms rooms;
    fxs_plan plan;                 /* of the current or last frame */
    uint64_t nanoseconds;
    GLuint drawing[FXS_COMPUTE_DRAWING], vertex_array, words;  /* of framebuffer.c, made on first use */
    int32_t word_rows, most_rows;  /* of the texture `words` */
    int shift;                     /* log2 of its width; 0: fragment shaders read storage buffers */
};

/* Returns 0 if the limit allows `bytes` more on the device, otherwise FXS_ERR_MEMORY. */
int fxs_compute_allow(const fxs_compute *compute, uint64_t bytes, fxs_message *why);

/* Clears pending GL errors. Returns 0 if there were none. */
int fxs_compute_check(const fxs_compute *compute, fxs_message *why);

/* Error for a missing feature: FXS_ERR_UNSUPPORTED, or the error of a lost context. */
int fxs_compute_lacks(const fxs_compute *compute, const char *text, const char *what, fxs_message *why);

/* The two halves of a frame. fxs_compute_begin checks the request; fxs_compute_finish renders to the request's targets,
   or to the caller's framebuffer. */
int fxs_compute_begin(fxs_compute *compute, const fxs_request *request, const fxs_compute_scene *const *copies,
                      void *memory, fxs_message *why);
int fxs_compute_finish(fxs_compute *compute, const fxs_compute_scene *const *copies, const fxs_gles_target *target,
                       fxs_stats *stats, fxs_message *why);

/* ---- framebuffer.c ----------------------------------------------------------------------------------------------- */

/* Fills the picture's input planes from the target's textures. */
int fxs_compute_take_mesh(const fxs_compute *compute, const fxs_gles_target *target, fxs_message *why);

/* Draws the picture into the target. */
int fxs_compute_show(fxs_compute *compute, const fxs_gles_target *target, fxs_message *why);

/* Deletes the objects for drawing. */
void fxs_compute_end_drawing(fxs_compute *compute);

#endif
