/* What a frame of the compute back ends is: its buffers, what is put into them, the dispatches of its stages, and what
 * is done again where lists were longer than their room. Here is no API: compute.c carries it out by OpenGL ES, and
 * port/web/webgpu.js by WebGPU.
 *
 *     fxs_plan_begin(&plan, request, memory, why)         fill in plan.part_chunks
 *     do {
 *         fxs_plan_lay_out(&plan, &rooms, why)            buffers of plan.bytes[] at least; table, uniforms, places
 *         fxs_plan_steps(&plan, step, argument)           each step is carried out
 *     } while ((result = fxs_plan_look(&plan, &rooms, status, why)) > 0)
 *
 * Functions return 0 or an FXS_ERR_* with a message, unless they say otherwise. */
#ifndef FXS_PLAN_H
#define FXS_PLAN_H

#include "records.h"
#include "src/core/cut.h"

/* A device's room for a frame's lists, which grows where a frame needs more. */
typedef struct fxs_plan_rooms {
    uint64_t most;                 /* bytes of a storage buffer */
    uint32_t chunks, larges, pages, merges;    /* of the next frame, at least */
    uint32_t whole_tiles;          /* 1: the lists of tiles of 8x8 once took more than a buffer holds */
} fxs_plan_rooms;

typedef struct fxs_plan {
    const fxs_request *request;
    fxs_view view;                 /* of the world */
    fxs_object_view *objects;
    uint32_t *part_chunks;         /* of each object: chunks of a part of its scene; for the back end to fill in */
    const fxs_drawn *drawn;        /* null: all leaves are drawn */
    uint64_t gaussians;
    uint32_t places, cut_room, merges, tries;
    uint64_t bytes[FXS_COMPUTE_BUFFERS];
    uint64_t read_at, read_words;  /* of the memory that are read back: the picture's planes that are written */
    fxs_compute_frame frame;
    uint32_t status[FXS_COMPUTE_STATUS];
} fxs_plan;

/* Buffers of a scene, beside those of a frame. */
enum { FXS_PLAN_NONE = -1, FXS_PLAN_HEADS = -2, FXS_PLAN_ROWS = -3 };

/* A dispatch. All words are of 32 bits, as port/web/webgpu.js reads them so. */
typedef struct fxs_step {
    uint32_t program;
    uint32_t waits;                /* whether it reads what steps before it wrote */
    uint32_t groups[2];            /* along x and y; 0: see arguments */
    int32_t arguments;             /* the buffer with the number of groups; FXS_PLAN_NONE: groups has them */
    uint32_t arguments_at;         /* and where in it, bytes */
    int32_t buffers[4];            /* of the bindings 0 to 3 of group 1 */
    uint32_t uniform;              /* where the object lies in the uniforms, bytes; 0: the program reads none */
    uint32_t object, part;         /* whose heads or rows are meant */
} fxs_step;
typedef void fxs_step_fn(void *argument, const fxs_step *step);

/* Memory of the host that a frame of this request takes; 0 where it is out of range. */
size_t fxs_plan_memory(const fxs_request *request);

/* Checks a request and finds what of its scenes is drawn. After that, the scenes and the objects are not read any more.
   The request, crop boxes and `memory` must stay. */
int fxs_plan_begin(fxs_plan *plan, const fxs_request *request, void *memory, fxs_message *why);

/* Fills in plan->frame and plan->bytes. */
int fxs_plan_lay_out(fxs_plan *plan, fxs_plan_rooms *rooms, fxs_message *why);

/* Writes the uniforms, plan->bytes[FXS_COMPUTE_UNIFORMS] bytes of them. */
void fxs_plan_uniforms(const fxs_plan *plan, void *to);

/* The bytes of the places, and writes these, which lie in the memory from word plan->frame.spans_at on. The memory
   begins with fxs_offset_of_code_q11. */
size_t fxs_plan_places_bytes(const fxs_plan *plan);
void fxs_plan_places(const fxs_plan *plan, uint32_t *to);

/* Calls for each dispatch, in their order. */
void fxs_plan_steps(const fxs_plan *plan, fxs_step_fn *step, void *argument);

/* Looks at the first FXS_COMPUTE_STATUS words of the counts. Returns 0 where the frame is complete, 1 where it is to be
   laid out and done again, as a list was longer than its room, or an error. */
int fxs_plan_look(fxs_plan *plan, fxs_plan_rooms *rooms, const uint32_t *status, fxs_message *why);

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* Some bytes of a scene, and where they lie in a buffer. */
typedef struct fxs_piece {
    const void *from;
    uint64_t bytes, at;
} fxs_piece;

/* The chunks whose rows have room in a buffer: a scene has as many parts as it takes of these. 0: the scene cannot be
   on the device, and there is a message. */
uint32_t fxs_plan_part_chunks(const fxs_scene *scene, uint64_t most, fxs_message *why);

/* The pieces of a part, or of the heads (part FXS_PLAN_HEADS); some may have 0 bytes. Returns their bytes together. */
uint64_t fxs_plan_pieces(const fxs_scene *scene, uint32_t part_chunks, int64_t part, fxs_piece pieces[3]);

/* ---- Messages ---------------------------------------------------------------------------------------------------- */

/* Writes a text and what it is about. Returns the error. */
int fxs_plan_say(fxs_message *why, int error, const char *text, const char *what);

#endif
