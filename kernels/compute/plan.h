/* Plan of a frame of the compute back ends, for one eye or two: buffers and dispatches. The plan calls no graphics API.
 * Each eye has its own buffers, but UNIFORMS and DOWNLOAD are shared.
 *
 *     fxs_plan_begin(&plan, request, memory, why)         then fill in plan.part_chunks
 *     fxs_plan_lay_out(&plan, &rooms, why)                allocate plan.bytes[]; write uniforms and places
 *     fxs_plan_steps(&plan, step, argument)               execute each step
 *     fxs_plan_look(&rooms, status, eyes, why)            when the device has finished the frame, even frames later
 *
 * fxs_plan_draw replaces fxs_plan_lay_out for images in host memory. If the frame exceeds a storage buffer, it lays out
 * windows of the pictures, one after the other.
 *
 * The device completes every frame itself. If the frame's lists exceed their capacities, the last step draws the frame
 * without the lists, which takes longer. fxs_plan_look enlarges the capacities for later frames before they are full.
 *
 * Functions return 0 or an FXS_ERR_* with a message, unless stated otherwise. */
#ifndef FXS_PLAN_H
#define FXS_PLAN_H

#include "records.h"
#include "src/core/cut.h"

typedef struct fxs_plan_rooms {
    uint64_t most;                 /* size of the largest storage buffer in bytes */
    uint32_t chunks, larges, pages, merges;
    uint32_t whole_tiles;
    uint32_t finishes;             /* number of steps that draw the tiles of a frame that does not fit; 0: 1 */
    uint32_t most_larges, most_pages, most_merges;     /* test hook: artificial capacities; 0: none */
} fxs_plan_rooms;

typedef struct fxs_plan {
    const fxs_request *request;
    fxs_stage_view views[FXS_COMPUTE_EYES];
    fxs_object_view *objects;      /* the objects in the space of the first eye, then of the second */
    /* number of chunks that fit in one buffer, per object; number of buffers of a scene in parts; set by the back
       end */
    uint32_t *part_chunks, *part_counts;
    const fxs_drawn *drawn;        /* chunks to draw; null: every chunk of all objects */
    const uint32_t *indices;       /* index of each chunk of `drawn` in the buffers of its object */
    uint64_t gaussians;
    uint32_t places, cut_room, missing;
    int32_t first[2], size[2];     /* window of the pictures that is laid out: first pixel and size */
    const fxs_drawn *all;          /* all, all_indices, all_places: drawn, indices and places of the whole pictures */
    const uint32_t *all_indices;
    uint32_t all_places;
    fxs_drawn *seen;               /* memory for `drawn` and `indices` of a window */
    uint64_t bytes[FXS_COMPUTE_BUFFERS];   /* of the buffers of an eye */
    uint64_t read_at[FXS_COMPUTE_EYES], read_words[FXS_COMPUTE_EYES];      /* range of words to read back: the finished
                                                                              picture */
    fxs_compute_frame frames[FXS_COMPUTE_EYES];
} fxs_plan;

enum { FXS_PLAN_NONE = -1, FXS_PLAN_HEADS = -2, FXS_PLAN_ROWS = -3 };
enum { FXS_PLAN_MERGES = 19, FXS_PLAN_FINISHES = 16,
       FXS_PLAN_STEPS = 10 + FXS_PLAN_FINISHES + FXS_PLAN_MERGES };  /* most steps of an eye besides 3 a span */

typedef struct fxs_step {
    uint32_t program;
    uint32_t waits;                /* 1: a barrier must precede the step, which reads what earlier steps wrote */
    uint32_t groups[2];
    int32_t arguments;             /* buffer that holds the numbers of workgroups; FXS_PLAN_NONE: `groups` holds them */
    uint32_t arguments_at;
    int32_t buffers[4];
    uint32_t uniform;     /* offset of the object's record in the uniform buffer, in bytes; 0: the step has no object */
    uint32_t object, part;
    uint32_t eye, frame;           /* eye whose buffers the step uses; offset of the eye's fxs_compute_frame in the
                                      uniform buffer */
} fxs_step;
typedef void fxs_step_fn(void *argument, const fxs_step *step);

/* Returns the number of steps that draw the tiles of a frame that does not fit, by the name of the device. llvmpipe
   ends all loops of a shader call after 65,535 rounds in all. */
uint32_t fxs_plan_finishes(const char *device);

/* Returns the host memory for a frame in bytes, or 0 if the request is out of range. */
size_t fxs_plan_memory(const fxs_request *request);

/* Checks a request to render a frame, and chooses the chunks to draw. The request, its crop boxes and `memory` must
   stay valid. */
int fxs_plan_begin(fxs_plan *plan, const fxs_request *request, void *memory, fxs_message *why);

/* Returns 1 if an object's scene moves, else 0. Such a frame has a list of drawn chunks. */
int fxs_plan_moves(const fxs_plan *plan);

int fxs_plan_lay_out(fxs_plan *plan, fxs_plan_rooms *rooms, fxs_message *why);

/* Lays out a frame and calls `draw`. If the frame exceeds a storage buffer of the device, does this for windows of the
   pictures: halves the longer side, at the edge of a macro tile, until each window fits. The first call of `draw`
   follows when all windows are known to fit. Returns the first error of `draw`, or the errors of fxs_plan_lay_out. */
typedef int fxs_window_fn(void *argument, fxs_message *why);
int fxs_plan_draw(fxs_plan *plan, fxs_plan_rooms *rooms, fxs_window_fn *draw, void *argument, fxs_message *why);

void fxs_plan_uniforms(const fxs_plan *plan, void *to);

/* fxs_plan_places_bytes returns the size in bytes of the table of drawn chunks, and fxs_plan_places writes the table.
   The caller copies the table to each eye's buffer FXS_COMPUTE_MEMORY at word plan->frames->spans_at, and the array
   fxs_offset_of_code_q11 to the buffer's start. */
size_t fxs_plan_places_bytes(const fxs_plan *plan);
void fxs_plan_places(const fxs_plan *plan, uint32_t *to);

void fxs_plan_steps(const fxs_plan *plan, fxs_step_fn *step, void *argument);

/* Takes the status of a finished frame: the first FXS_COMPUTE_STATUS words of each eye's buffer FXS_COMPUTE_COUNTS.
   Enlarges the capacities for later frames. */
int fxs_plan_look(fxs_plan_rooms *rooms, const uint32_t *status, uint32_t eyes, fxs_message *why);

/* Copies the window of an image of the host, an occluder or a backdrop, to the words of its plane. */
void fxs_plan_put_plane(const fxs_plan *plan, const fxs_image *image, void *to);

/* Copies the finished window, plan->read_words[eye] words for each eye, to the request's images. */
void fxs_plan_take_pictures(const fxs_plan *plan, const uint32_t *pictures);

/* Fills in the statistics of a frame, except for memory and times; *stats is zeros before the frame's first window.
   fxs_plan_count adds what the statuses of the eyes tell, when the window has finished. */
void fxs_plan_stats(const fxs_plan *plan, fxs_stats *stats);
void fxs_plan_count(fxs_stats *stats, const uint32_t *status, uint32_t eyes);

typedef struct fxs_piece {
    const void *from;
    uint64_t bytes, at;
} fxs_piece;

/* Returns the number of chunks whose Gaussians fit in a buffer of `most` bytes, or 0 with a message. */
uint32_t fxs_plan_part_chunks(const fxs_scene *scene, uint64_t most, fxs_message *why);

/* Returns the offset in its buffer of a place of the pool of a scene in parts. The buffer's number is place /
   part_chunks. */
uint64_t fxs_plan_place_at(const fxs_scene *scene, uint32_t part_chunks, uint32_t place);

uint64_t fxs_plan_pieces(const fxs_scene *scene, uint32_t part_chunks, int64_t part, fxs_piece pieces[3]);

int fxs_plan_say(fxs_message *why, int error, const char *text, const char *what);

#endif
