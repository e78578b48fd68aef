/* Plan of a frame of the compute back ends: its buffers, their contents, the dispatches of its stages, and the retry if
 * a list exceeded its capacity. The plan calls no API: compute.c executes it with OpenGL ES, port/web/webgpu.js with
 * WebGPU.
 *
 *     fxs_plan_begin(&plan, request, memory, why)         then fill in plan.part_chunks
 *     do {
 *         fxs_plan_lay_out(&plan, &rooms, why)            allocate plan.bytes[] at least; write table, uniforms, places
 *         fxs_plan_steps(&plan, step, argument)           execute each step
 *     } while ((result = fxs_plan_look(&plan, &rooms, status, why)) > 0)
 *
 * Functions return 0 or an FXS_ERR_* with a message, unless stated otherwise. */
#ifndef FXS_PLAN_H
#define FXS_PLAN_H

#include "records.h"
#include "src/core/cut.h"

/* A device's capacities for a frame's lists. They grow when a frame needs more. */
typedef struct fxs_plan_rooms {
    uint64_t most;                 /* largest storage buffer in bytes */
    uint32_t chunks, larges, pages, merges;    /* minimum for the next frame */
    uint32_t whole_tiles;          /* 1: lists of 8x8 tiles once exceeded a buffer */
} fxs_plan_rooms;

typedef struct fxs_plan {
    const fxs_request *request;
    fxs_view view;                 /* in world space */
    fxs_object_view *objects;
    uint32_t *part_chunks;         /* per object: chunks in a part of its scene; filled in by the back end */
    const fxs_drawn *drawn;        /* null: all leaves are drawn */
    uint64_t gaussians;
    uint32_t places, cut_room, merges, tries;
    uint64_t bytes[FXS_COMPUTE_BUFFERS];
    uint64_t read_at, read_words;  /* range of the memory to read back: the picture's written planes */
    fxs_compute_frame frame;
    uint32_t status[FXS_COMPUTE_STATUS];
} fxs_plan;

/* Buffers of a scene; FXS_COMPUTE_* are the buffers of a frame. */
enum { FXS_PLAN_NONE = -1, FXS_PLAN_HEADS = -2, FXS_PLAN_ROWS = -3 };

/* A dispatch. All fields have 32 bits, because port/web/webgpu.js reads them as such. */
typedef struct fxs_step {
    uint32_t program;
    uint32_t waits;                /* 1: it reads data written by earlier steps */
    uint32_t groups[2];            /* along x and y; 0: indirect */
    int32_t arguments;             /* buffer with the numbers of groups; FXS_PLAN_NONE: in `groups` */
    uint32_t arguments_at;         /* offset in it, in bytes */
    int32_t buffers[4];            /* bindings 0 to 3 of group 1 */
    uint32_t uniform;              /* offset of the object in the uniforms, in bytes; 0: not needed */
    uint32_t object, part;         /* for FXS_PLAN_HEADS and FXS_PLAN_ROWS */
} fxs_step;
typedef void fxs_step_fn(void *argument, const fxs_step *step);

/* Host memory for a frame of this request, in bytes; 0 if the request is out of range. */
size_t fxs_plan_memory(const fxs_request *request);

/* Checks a request and finds the drawn chunks of its scenes. Scenes and objects are not read afterwards. The request,
   the crop boxes and `memory` must stay valid. */
int fxs_plan_begin(fxs_plan *plan, const fxs_request *request, void *memory, fxs_message *why);

/* Fills in plan->frame and plan->bytes. */
int fxs_plan_lay_out(fxs_plan *plan, fxs_plan_rooms *rooms, fxs_message *why);

/* Writes the uniforms, plan->bytes[FXS_COMPUTE_UNIFORMS] bytes. */
void fxs_plan_uniforms(const fxs_plan *plan, void *to);

/* Size in bytes of the places; writes them. They go to word plan->frame.spans_at of the memory. The memory starts with
   fxs_offset_of_code_q11. */
size_t fxs_plan_places_bytes(const fxs_plan *plan);
void fxs_plan_places(const fxs_plan *plan, uint32_t *to);

/* Calls step for each dispatch, in order. */
void fxs_plan_steps(const fxs_plan *plan, fxs_step_fn *step, void *argument);

/* Reads the first FXS_COMPUTE_STATUS words of the counts. Returns 0 if the frame is complete, 1 if a list exceeded its
   capacity and the frame must be laid out and run again, or an error. */
int fxs_plan_look(fxs_plan *plan, fxs_plan_rooms *rooms, const uint32_t *status, fxs_message *why);

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* Bytes of a scene and their offset in a buffer. */
typedef struct fxs_piece {
    const void *from;
    uint64_t bytes, at;
} fxs_piece;

/* Number of chunks with rows that fit in a buffer; a scene is split into parts of this size. Returns 0, with a message,
   if the scene does not fit on the device. */
uint32_t fxs_plan_part_chunks(const fxs_scene *scene, uint64_t most, fxs_message *why);

/* The pieces of a part, or of the heads (part FXS_PLAN_HEADS); a piece may have 0 bytes. Returns the sum of their
   bytes. */
uint64_t fxs_plan_pieces(const fxs_scene *scene, uint32_t part_chunks, int64_t part, fxs_piece pieces[3]);

/* ---- Messages ---------------------------------------------------------------------------------------------------- */

/* Writes a text and its subject to *why. Returns `error`. */
int fxs_plan_say(fxs_message *why, int error, const char *text, const char *what);

#endif
