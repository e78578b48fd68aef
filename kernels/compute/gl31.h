/* Internal declarations of the compute back end for OpenGL ES 3.1. */
#ifndef FXS_COMPUTE_GL31_H
#define FXS_COMPUTE_GL31_H

#include <GLES3/gl31.h>

#include <fixsplat/gl.h>
#include "kernels/gl/gl_functions.h"
#include "plan.h"

/* List of the functions of OpenGL ES 3.1 that the back end calls: F(function's name in its pointer type, function's
   name). */
#define FXS_COMPUTE_FUNCTIONS(F) \
    F(BINDBUFFERBASE, BindBufferBase) F(BINDBUFFERRANGE, BindBufferRange) F(BUFFERSUBDATA, BufferSubData) \
    F(COPYBUFFERSUBDATA, CopyBufferSubData) F(DELETESYNC, DeleteSync) F(DISPATCHCOMPUTE, DispatchCompute) \
    F(DISPATCHCOMPUTEINDIRECT, DispatchComputeIndirect) F(FENCESYNC, FenceSync) F(FINISH, Finish) \
    F(GETINTEGER64I_V, GetInteger64i_v) F(GETINTEGERI_V, GetIntegeri_v) F(GETSYNCIV, GetSynciv) \
    F(MEMORYBARRIER, MemoryBarrier)
typedef struct fxs_compute_gl {
    FXS_COMPUTE_FUNCTIONS(FXS_GL_MEMBER)
} fxs_compute_gl;

enum { FXS_COMPUTE_DRAWING = 3, FXS_COMPUTE_FLIGHTS = 4 };

/* A drawn frame whose status was not read yet. */
typedef struct fxs_compute_flight {
    GLsync done;                   /* null: no frame */
    uint32_t eyes;
    fxs_stats stats;
} fxs_compute_flight;

struct fxs_compute {
    fxs_gl gl;
    fxs_compute_gl more;
    fxs_gl_use_fn *use;
    void *use_argument;
    char renderer[128];
    GLuint programs[FXS_COMPUTE_PROGRAMS], buffers[FXS_COMPUTE_EYES][FXS_COMPUTE_BUFFERS], query;
    uint64_t bytes[FXS_COMPUTE_EYES][FXS_COMPUTE_BUFFERS], scene_bytes;
    uint64_t limit;                /* most bytes of device memory that may be allocated; 0: no limit */
    uint64_t pool_bytes, upload_bytes;     /* of fxs_compute_stream; 0: the default */
    GLuint stage;                  /* buffer through which chunks of scenes in parts are uploaded */
    uint64_t stage_bytes;          /* most bytes that one frame uploads; 0: there is no scene in parts */
    uint32_t turn, mirrors;        /* number of the frame; number of scenes in parts on the device */
    int timer;
    fxs_plan_rooms rooms;
    fxs_plan plan;
    uint64_t nanoseconds;
    fxs_compute_flight flights[FXS_COMPUTE_FLIGHTS];
    GLuint statuses[FXS_COMPUTE_FLIGHTS];          /* buffers that the statuses are copied to */
    uint32_t frames;               /* number of drawn frames; frame i uses flights[i % FXS_COMPUTE_FLIGHTS] */
    fxs_stats stats;               /* of the newest frame whose status was read */
    GLuint drawing[FXS_COMPUTE_DRAWING], vertex_array, words;  /* GL objects made on first use by framebuffer.c */
    int32_t word_rows, most_rows;
    int shift;              /* log2 of the width of texture `words`; 0: the texture is not needed */
};

/* Returns 0 if the memory limit allows `bytes` more bytes, otherwise FXS_ERR_MEMORY. */
int fxs_compute_allow(const fxs_compute *compute, uint64_t bytes, fxs_message *why);

/* Clears pending GL errors. Returns 0 if no error was pending. */
int fxs_compute_check(const fxs_compute *compute, fxs_message *why);

int fxs_compute_lacks(const fxs_compute *compute, const char *text, const char *what, fxs_message *why);

/* fxs_compute_begin checks a request to render a frame, and replaces its scenes in parts by their mirrors
   (src/core/mirror.h). fxs_compute_finish renders the frame to the request's images, or to the caller's framebuffers,
   one per eye, if `targets` is not null. */
int fxs_compute_begin(fxs_compute *compute, fxs_request *request, const fxs_compute_scene *const *copies,
                      void *memory, fxs_message *why);
int fxs_compute_finish(fxs_compute *compute, const fxs_compute_scene *const *copies, const fxs_gl_target *targets,
                       fxs_stats *stats, fxs_message *why);

/* Reads the statuses of drawn frames that the device has finished. Does not wait. */
int fxs_compute_look_back(fxs_compute *compute, fxs_message *why);

int fxs_compute_take_mesh(const fxs_compute *compute, const fxs_gl_target *target, uint32_t eye, fxs_message *why);

int fxs_compute_show(fxs_compute *compute, const fxs_gl_target *target, uint32_t eye, fxs_message *why);

void fxs_compute_end_drawing(fxs_compute *compute);

/* Returns the bytes of device memory that rendering takes besides the scenes. */
uint64_t fxs_compute_taken(const fxs_compute *c);

#endif
