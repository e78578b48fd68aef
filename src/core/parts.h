/* The steps of a frame: the functions that each file of this folder has for frame.c and for the other files. */
#ifndef FXS_PARTS_H
#define FXS_PARTS_H

#include "frame.h"

/* ---- bands.c ----------------------------------------------------------------------------------------------------- */

/* Bytes of a frame with f->eye_count eyes, or more than SIZE_MAX; fills in stats.memory. */
uint64_t fxs_bands_measure(fxs_frame *f);

/* Cuts up the memory for the frame, and sets its mode: FXS_FRAME_WHOLE where it holds every Gaussian, else
   FXS_FRAME_PLAN. Returns 0, or FXS_ERR_MEMORY where no view can be drawn with so little. */
int fxs_bands_init(fxs_frame *f);

/* Projects the Gaussians to count the splats of each tile row. Returns 0, FXS_ERR_SCENE, FXS_ERR_STOPPED, or
   FXS_ERR_MEMORY where a tile row does not fit and slices are not possible. */
int fxs_bands_plan(fxs_frame *f);

/* Goes on to the next band: as many tile rows from end_row on as fit in the memory. Returns 0 where there is none. */
int fxs_band_next(fxs_frame *f);

/* Counts the splats of the chunk at this place in the list of drawn ones, from `slot` on, by tile row, for the plan. */
void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t place, uint32_t slot, uint32_t count);

/* Whether splats of a chunk may touch the band. */
int fxs_band_has_chunk(const fxs_frame *f, uint32_t place);

/* Of `count` splats from `slot` on, keeps those that touch the band, without gaps. Returns how many they are. */
uint32_t fxs_band_keep(fxs_frame *f, uint32_t place, uint32_t slot, uint32_t count);

/* ---- prepare.c --------------------------------------------------------------------------------------------------- */

#define FXS_BLOCK 16u              /* chunks that are projected, shaded and binned in one go */
#define FXS_BLOCK_FAILED UINT32_MAX   /* the scene was damaged or changed */

/* The first stages on splats of a chunk of an object, in the slots from `slot` on; bin works on any slots. project is
   given the chunk's place in the list of drawn ones, shade its number among those of all objects. project leaves out
   splats that the band does not need, and returns how many are left, or FXS_ERR_SCENE. That is also the error where the
   plan left no room for 256 splats before end_slot: the scene's bytes have changed since. shade returns 0 or
   FXS_ERR_SCENE. */
int32_t fxs_prepare_project(fxs_frame *f, uint32_t object, uint32_t place, uint32_t slot, uint32_t end_slot);
int fxs_prepare_shade(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot, uint32_t count);
void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count);

/* The three stages on every block of chunks; for a plan project alone. Returns 0, FXS_ERR_SCENE where a block failed,
   or FXS_ERR_STOPPED. */
int fxs_prepare_blocks(fxs_frame *f);

/* The same for a band, whose splats are counted and timed. */
int fxs_prepare_band(fxs_frame *f);

/* ---- slices.c ---------------------------------------------------------------------------------------------------- */

/* Draws a band of one tile row whose splats do not fit in the memory. Returns 0, FXS_ERR_STOPPED, a back end's error,
   or FXS_ERR_SCENE: also where there are more splats than the scene has Gaussians, as it changes meanwhile. */
int fxs_slices_draw(fxs_frame *f);

/* ---- eyes.c ------------------------------------------------------------------------------------------------------ */

/* Projects a chunk of an object for both eyes, to the slots from `slot` on; share_q8 and grow_q8 as in
   fxs_object_project. A Gaussian that either eye sees has the same slot in both; in the eye that does not see it, it
   has the depth that it has in the other. Returns how many slots are taken, at most 256, or FXS_ERR_SCENE. */
int32_t fxs_eyes_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t share_q8, uint32_t grow_q8,
                         uint32_t slot);

/* After bin: splats that the eye does not see are listed in no tile. */
void fxs_eyes_hide(const fxs_bounds *bounds, uint32_t count, fxs_box *boxes);

/* ---- sort.c, bin.c ----------------------------------------------------------------------------------------------- */

/* Sorts keys by depth, ties by slot (they arrive in the order of their slots), in `parts` jobs. `spare` has room for
   as many keys, and there is a histogram for each job. Returns where the result is: keys or spare. */
fxs_key *fxs_sort(const fxs_config *config, fxs_key *keys, fxs_key *spare, uint32_t count,
                  uint32_t (*histograms)[FXS_SORT_BUCKETS], uint32_t parts);

/* The tile rows in which a splat may be listed. */
FXS_STAGE fxs_span fxs_bin_rows(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds);

/* The tile columns in which it may be. */
fxs_span fxs_bin_columns(const fxs_view *view, const fxs_bounds *bounds);

/* What a job needs that makes the lists of the macro tiles first_macro to last_macro: arrays by slot, `next` by macro
   tile. Lists are made in two passes: the first counts each list's keys, the second fills them in. As far as there is
   room, the first notes its findings, so that the second need not look for them again. */
typedef struct fxs_lister {
    const fxs_view *view;
    const fxs_splat *splats;
    const fxs_bounds *bounds;
    const fxs_box *boxes;
    const uint32_t *depths;        /* by which lists are sorted */
    void (*spans)(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row, int32_t rows,
                  fxs_span *spans);    /* this and the next as in fxs_kernels */
    uint32_t (*note)(const fxs_view *view, const fxs_box *boxes, uint32_t first, uint32_t count, uint32_t *macros,
                     uint32_t *listed);
    uint32_t first_macro, last_macro;
    uint32_t *next;                /* how many keys each list has; then where its next key goes */
    uint64_t *notes;
    uint32_t room, taken;          /* notes that there is room for; notes so far, UINT32_MAX where there was no room */
    uint32_t noted, from;          /* the first `noted` notes are everything about the slots before `from` */
} fxs_lister;

/* The first pass, on `count` slots from `first` on: adds 1 to next[macro] for every macro tile that a splat is listed
   in, and takes notes. */
void fxs_bin_count(fxs_lister *l, uint32_t first, uint32_t count);

/* The second pass: puts the splat's key to keys[next[macro]], then adds 1. */
void fxs_bin_fill(fxs_lister *l, uint32_t first, uint32_t count, fxs_key *keys);

/* The second pass on slots before `from`, by the notes. */
void fxs_bin_fill_noted(fxs_lister *l, fxs_key *keys);

/* With the square cut-off: marks the entries of a tile's list whose ellipse does not touch it, by FXS_ENTRY_CUT_OFF. */
void fxs_mark_cut_off(const fxs_lister *l, uint32_t tile, uint32_t *entries, uint32_t count);

/* ---- lists.c ----------------------------------------------------------------------------------------------------- */

#define FXS_NEXT_MORE 4u           /* numbers of a part in fxs_frame.next, behind those of the macro tiles */

/* For the job that lists a part of the blocks. */
fxs_lister fxs_lister_of(const fxs_frame *f, uint32_t part);

/* Finds the macro tiles of the band, first_macro to last_macro, and how long their lists are. */
void fxs_lists_count(fxs_frame *f);

/* Once they are counted: whether the lists of each row of macro tiles fit in the memory. */
int fxs_lists_rows_fit(const fxs_frame *f);

/* Makes the lists of as many macro tiles, from first_macro to before `end`, as fit in `keys`, and sets last_macro. A
   list is never longer than the number of slots, so one always fits. For a back end the macro tiles are whole rows, or
   a part of one row. */
void fxs_lists_fill(fxs_frame *f, uint32_t end);

/* The list of a macro tile; the same list once it is sorted, which this does; and room for as many keys. */
const fxs_key *fxs_list_of(const fxs_frame *f, uint32_t macro);
const fxs_key *fxs_list_sort(const fxs_frame *f, uint32_t macro);
uint32_t *fxs_list_room(const fxs_frame *f, uint32_t macro);

/* *tile becomes the number in the picture of tile i (0 to 3, row by row) of a macro tile. Returns 0 where that tile is
   not to be drawn: it is outside of the picture, the band or a slice's columns, or another one is picked. */
int fxs_tile_of(const fxs_frame *f, uint32_t macro, int32_t i, uint32_t *tile);

/* ---- draw.c ------------------------------------------------------------------------------------------------------ */

/* Sorts the lists of the macro tiles first_macro to last_macro, and has draw_tile draw their tiles. Returns 0 or
   FXS_ERR_STOPPED. */
int fxs_draw_macros(fxs_frame *f);

/* An fxs_tile_fn: blends the tile and writes its pixels. */
void fxs_draw_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* ---- runs.c ------------------------------------------------------------------------------------------------------ */

/* Sorts the lists of the macro tiles first_macro to last_macro, and has the back end draw their tiles. Returns 0 or its
   error, as do the next ones. */
int fxs_runs_draw(fxs_frame *f);

/* Whether the back end takes no lists; and has it draw the band without. */
int fxs_runs_unlisted(const fxs_frame *f);
int fxs_runs_draw_unlisted(fxs_frame *f);

/* Whether the band, whose lists are counted, has to be drawn tile row by tile row; and does so. */
int fxs_runs_by_rows(const fxs_frame *f);
int fxs_runs_draw_rows(fxs_frame *f);

/* Has the back end resolve tiles first_tile to last_tile, which are blended. */
int fxs_runs_draw_blended(fxs_frame *f);

/* ---- stereo.c ---------------------------------------------------------------------------------------------------- */

/* Renders both eyes of a frame that is set up. Returns 0 or an FXS_ERR_*. */
int fxs_stereo_render(fxs_frame *f, const fxs_request *request);

/* ---- times.c ----------------------------------------------------------------------------------------------------- */

/* Where the time of drawing a macro tile goes. */
enum { FXS_SORTED, FXS_LISTED_TILES, FXS_BLENDED, FXS_RESOLVED, FXS_LAPS };

/* Adds the time since the last lap to `which` of the macro tile's times, if it is timed. */
void fxs_lap(const fxs_frame *f, fxs_laps *laps, int which);

/* Adds the time since `start` to the times of stages, in the proportion in which the jobs spent theirs: `times` has a
   row of `columns` times for each job, of these stages. */
void fxs_share_time(fxs_frame *f, uint64_t start, const uint64_t *times, uint32_t jobs, uint32_t columns,
                    const enum fxs_stage *stages);

/* ---- blend.c, trace.c -------------------------------------------------------------------------------------------- */

/* A tile that nothing is blended into: T = 1. */
void fxs_tile_clear(fxs_tile *tile);

/* Blends the list of the tile at pixel (x, y) by `trace`, for the auxiliary outputs, and writes its depths and ids.
   `slots`, of 256, becomes for each pixel the slot of the splat that contributes most, FXS_NOTHING where none does; or
   is null. */
void fxs_trace_tile(const fxs_frame *f, const fxs_list *list, int32_t x, int32_t y, fxs_tile *pixels, uint32_t *slots);

/* The id of the Gaussian at this place in the chunks of all objects. *object: the object of the one before, which is
   tried first. */
fxs_id fxs_id_of(const fxs_object_view *objects, uint32_t count, uint32_t index, const fxs_object_view **object);

/* ---- targets.c, resolve.c ---------------------------------------------------------------------------------------- */

/* Checks the targets there are, for pictures of this size. Returns 0 or FXS_ERR_TARGET. */
int fxs_targets_check(const fxs_targets *targets, int32_t width, int32_t height);

/* Whether checked targets of two pictures of this size overlap where one of them is written to. */
int fxs_targets_collide(const fxs_targets *a, const fxs_targets *b, int32_t width, int32_t height);

/* FXS_ERR_TARGET where an eye has no target to be written and no back end may draw elsewhere; else 0. */
int fxs_targets_missing(const fxs_context *context, const fxs_request *request);

/* Whether a tile has to be blended by `trace` in place of `blend`: for depths, for ids or with an occluder. */
int fxs_targets_traced(const fxs_targets *targets);

/* Writes the pixels of a tile at (x, y) to the targets of f->eye for colour and coverage. */
void fxs_resolve_targets(const fxs_frame *f, const fxs_tile *tile, int32_t x, int32_t y);

/* fxs_resolve_c, over a picture of RGBA8. */
void fxs_resolve_over(enum fxs_format format, const fxs_tile *tile, int32_t columns, int32_t rows,
                      const unsigned char *backdrop, ptrdiff_t backdrop_stride, unsigned char *pixels,
                      ptrdiff_t stride);

static inline unsigned char *fxs_image_at(const fxs_image *image, int32_t x, int32_t y, int pixel_bytes)
{
    return (unsigned char *)image->pixels + y * image->stride + (ptrdiff_t)x * pixel_bytes;
}

static inline int fxs_depth_bits(const fxs_targets *targets)
{
    return targets->depth_bits ? targets->depth_bits : 16;
}

#endif
