/* Functions that the files of this folder offer to frame.c and to each other, by file. */
#ifndef FXS_PARTS_H
#define FXS_PARTS_H

#include "frame.h"

/* ---- bands.c ----------------------------------------------------------------------------------------------------- */

/* Returns the bytes of a frame with f->eye_count eyes; the result may exceed SIZE_MAX. Fills in stats.memory. */
uint64_t fxs_bands_measure(fxs_frame *f);

/* Lays out the memory and sets the mode: FXS_FRAME_WHOLE if the memory has a slot for every Gaussian, otherwise
   FXS_FRAME_PLAN. Returns 0, or FXS_ERR_MEMORY if the memory is below the minimum for any view. */
int fxs_bands_init(fxs_frame *f);

/* Projects the Gaussians to count the splats of each tile row. Returns 0, FXS_ERR_SCENE, FXS_ERR_STOPPED, or
   FXS_ERR_MEMORY if a tile row does not fit and slices are not possible. */
int fxs_bands_plan(fxs_frame *f);

/* Advances to the next band: as many tile rows as fit in the memory, from end_row on. Returns 0 after the last band. */
int fxs_band_next(fxs_frame *f);

/* Plan: counts splats by tile row. They belong to the chunk at this place in the list of drawn chunks, and start at
   `slot`. */
void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t place, uint32_t slot, uint32_t count);

int fxs_band_has_chunk(const fxs_frame *f, uint32_t place);

/* Compacts `count` splats from `slot` on to those that touch the band. Returns how many remain. */
uint32_t fxs_band_keep(fxs_frame *f, uint32_t place, uint32_t slot, uint32_t count);

/* ---- prepare.c --------------------------------------------------------------------------------------------------- */

#define FXS_BLOCK 16u              /* chunks that go through project, shade and bin together */
#define FXS_BLOCK_FAILED UINT32_MAX   /* scene damaged or changed */

/* project, shade and bin for splats of one chunk of an object, from `slot` on; bin takes any slots. fxs_prepare_project
   takes the chunk's place in the list of drawn chunks; fxs_prepare_shade takes its number among all objects' chunks.
   fxs_prepare_project drops splats outside the band. It returns the number of splats left, or FXS_ERR_SCENE; also if
   fewer than 256 slots are left before end_slot, because then the scene has changed since the plan. fxs_prepare_shade
   returns 0 or FXS_ERR_SCENE. */
int32_t fxs_prepare_project(fxs_frame *f, uint32_t object, uint32_t place, uint32_t slot, uint32_t end_slot);
int fxs_prepare_shade(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot, uint32_t count);
void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count);

/* Runs the three stages on all blocks; a plan runs only project. Returns 0, FXS_ERR_STOPPED, or FXS_ERR_SCENE if a
   block failed. */
int fxs_prepare_blocks(fxs_frame *f);

/* fxs_prepare_blocks for a band; also counts its splats and measures the time. */
int fxs_prepare_band(fxs_frame *f);

/* ---- slices.c ---------------------------------------------------------------------------------------------------- */

/* Draws a band of one tile row whose splats do not fit in the memory. Returns 0, FXS_ERR_STOPPED, a back end's error,
   or FXS_ERR_SCENE, which is also the error if the scene changes meanwhile and yields more splats than Gaussians. */
int fxs_slices_draw(fxs_frame *f);

/* ---- eyes.c ------------------------------------------------------------------------------------------------------ */

/* Projects a chunk of an object for both eyes, from `slot` on; share_q8 and grow_q8 as in fxs_object_project. A
   Gaussian that either eye sees takes the same slot in both. In an eye that does not see it, it has the depth from the
   other eye. Returns the number of slots taken, at most 256, or FXS_ERR_SCENE. */
int32_t fxs_eyes_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t share_q8, uint32_t grow_q8,
                         uint32_t slot);

/* After bin: removes from all tiles the splats that the eye does not see. */
void fxs_eyes_hide(const fxs_bounds *bounds, uint32_t count, fxs_box *boxes);

/* ---- sort.c, bin.c ----------------------------------------------------------------------------------------------- */

/* Sorts keys by depth, then slot, in `parts` jobs. The keys must arrive in the order of their slots. `spare` has
   `count` keys, and `histograms` one entry per job. Returns the array with the result: keys or spare. */
fxs_key *fxs_sort(const fxs_config *config, fxs_key *keys, fxs_key *spare, uint32_t count,
                  uint32_t (*histograms)[FXS_SORT_BUCKETS], uint32_t parts);

/* Tile rows that may list a splat. */
FXS_STAGE fxs_span fxs_bin_rows(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds);

/* Tile columns that may list a splat. */
fxs_span fxs_bin_columns(const fxs_view *view, const fxs_bounds *bounds);

/* Input of a job that makes the lists of macro tiles first_macro to last_macro. Arrays are indexed by slot, `next` by
   macro tile. The first pass counts the keys of each list; the second pass writes them. While space lasts, the first
   pass notes its results so that the second need not compute them again. */
typedef struct fxs_lister {
    const fxs_view *view;
    const fxs_splat *splats;
    const fxs_bounds *bounds;
    const fxs_box *boxes;
    const uint32_t *depths;        /* lists are sorted by these */
    void (*spans)(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row, int32_t rows,
                  fxs_span *spans);    /* `spans` and `note` as in fxs_kernels */
    uint32_t (*note)(const fxs_view *view, const fxs_box *boxes, uint32_t first, uint32_t count, uint32_t *macros,
                     uint32_t *listed);
    uint32_t first_macro, last_macro;
    uint32_t *next;                /* keys in each list; in the second pass, place of the next key */
    uint64_t *notes;
    uint32_t room, taken;          /* capacity for notes; notes taken, UINT32_MAX after an overflow */
    uint32_t noted, from;          /* the first `noted` notes cover all slots before `from` */
} fxs_lister;

/* First pass over `count` slots from `first` on: adds 1 to next[macro] for each list that gets a splat, and takes
   notes. */
void fxs_bin_count(fxs_lister *l, uint32_t first, uint32_t count);

/* Second pass: writes each key to keys[next[macro]], then adds 1 to next[macro]. */
void fxs_bin_fill(fxs_lister *l, uint32_t first, uint32_t count, fxs_key *keys);

/* Second pass for slots before `from`, from the notes. */
void fxs_bin_fill_noted(fxs_lister *l, fxs_key *keys);

/* Square cut-off only: sets FXS_ENTRY_CUT_OFF in the entries of a tile's list whose ellipse misses the tile. */
void fxs_mark_cut_off(const fxs_lister *l, uint32_t tile, uint32_t *entries, uint32_t count);

/* ---- lists.c ----------------------------------------------------------------------------------------------------- */

#define FXS_NEXT_MORE 4u           /* numbers per part in fxs_frame.next, after the macro tiles' counters */

/* The lister of the job for this part of the blocks. */
fxs_lister fxs_lister_of(const fxs_frame *f, uint32_t part);

/* Sets first_macro and last_macro to the macro tiles of the band, and counts the keys of their lists. */
void fxs_lists_count(fxs_frame *f);

/* After fxs_lists_count: true if the lists of each single row of macro tiles fit in the memory. */
int fxs_lists_rows_fit(const fxs_frame *f);

/* Makes the lists of macro tiles from first_macro to before `end`, as many as fit in `keys`, and sets last_macro. One
   list always fits, because it is at most as long as the number of slots. For a back end, the macro tiles are whole
   rows, or part of one row. */
void fxs_lists_fill(fxs_frame *f, uint32_t end);

/* A macro tile's list unsorted; sorts it and returns it; scratch space for as many keys. */
const fxs_key *fxs_list_of(const fxs_frame *f, uint32_t macro);
const fxs_key *fxs_list_sort(const fxs_frame *f, uint32_t macro);
uint32_t *fxs_list_room(const fxs_frame *f, uint32_t macro);

/* Sets *tile to the picture's number of tile i (0 to 3, row by row) of a macro tile. Returns 0 if that tile is not
   drawn: outside the picture, the band or a slice's columns, or not the picked tile. */
int fxs_tile_of(const fxs_frame *f, uint32_t macro, int32_t i, uint32_t *tile);

/* ---- draw.c ------------------------------------------------------------------------------------------------------ */

/* Sorts the lists of macro tiles first_macro to last_macro, and draws their tiles with draw_tile. Returns 0 or
   FXS_ERR_STOPPED. */
int fxs_draw_macros(fxs_frame *f);

/* An fxs_tile_fn: blends the tile and writes its pixels. */
void fxs_draw_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* ---- runs.c ------------------------------------------------------------------------------------------------------ */

/* Sorts the lists of macro tiles first_macro to last_macro, and passes their tiles to the back end. Returns 0 or the
   back end's error, like the functions below. */
int fxs_runs_draw(fxs_frame *f);

/* True if the back end needs no lists; draws the band with such a back end. */
int fxs_runs_unlisted(const fxs_frame *f);
int fxs_runs_draw_unlisted(fxs_frame *f);

/* After fxs_lists_count: true if the back end needs the band tile row by tile row; draws it in this way. */
int fxs_runs_by_rows(const fxs_frame *f);
int fxs_runs_draw_rows(fxs_frame *f);

/* Passes the blended tiles first_tile to last_tile to the back end, which resolves them. */
int fxs_runs_draw_blended(fxs_frame *f);

/* ---- stereo.c ---------------------------------------------------------------------------------------------------- */

/* Renders both eyes of an initialised frame. Returns 0 or an FXS_ERR_*. */
int fxs_stereo_render(fxs_frame *f, const fxs_request *request);

/* ---- times.c ----------------------------------------------------------------------------------------------------- */

/* Laps of a macro tile's stopwatch. */
enum { FXS_SORTED, FXS_LISTED_TILES, FXS_BLENDED, FXS_RESOLVED, FXS_LAPS };

/* Adds the time since the last lap to lap `which`, if the macro tile is timed. */
void fxs_lap(const fxs_frame *f, fxs_laps *laps, int which);

/* Adds the wall time since `start` to the stages in f->stats, in proportion to the time that the jobs spent in each.
   `times` has a row of `columns` times per job; stages[c] is the stage of column c. */
void fxs_share_time(fxs_frame *f, uint64_t start, const uint64_t *times, uint32_t jobs, uint32_t columns,
                    const enum fxs_stage *stages);

/* ---- blend.c, trace.c -------------------------------------------------------------------------------------------- */

/* Empties a tile: sums 0, T = 1. */
void fxs_tile_clear(fxs_tile *tile);

/* Blends the list of the tile at pixel (x, y) with `trace` and writes the tile's depths and ids. slots[256], unless
   null, receives for each pixel the slot of the splat with the largest contribution, or FXS_NOTHING. */
void fxs_trace_tile(const fxs_frame *f, const fxs_list *list, int32_t x, int32_t y, fxs_tile *pixels, uint32_t *slots);

/* Id of a Gaussian from its number in the chunks of all objects. *object caches the last object found; it is tried
   first. */
fxs_id fxs_id_of(const fxs_object_view *objects, uint32_t count, uint32_t index, const fxs_object_view **object);

/* ---- targets.c, resolve.c ---------------------------------------------------------------------------------------- */

/* Checks the non-null targets for pictures of this size. Returns 0 or FXS_ERR_TARGET. */
int fxs_targets_check(const fxs_targets *targets, int32_t width, int32_t height);

/* True if checked targets of two pictures of this size overlap and one of them is written. */
int fxs_targets_collide(const fxs_targets *a, const fxs_targets *b, int32_t width, int32_t height);

/* FXS_ERR_TARGET if an eye has no target to write and no back end can draw elsewhere; otherwise 0. */
int fxs_targets_missing(const fxs_context *context, const fxs_request *request);

/* True if tiles need `trace` instead of `blend`: for depths, ids or an occluder. */
int fxs_targets_traced(const fxs_targets *targets);

/* Writes the pixels of a tile at (x, y) to the colour and coverage targets of f->eye. */
void fxs_resolve_targets(const fxs_frame *f, const fxs_tile *tile, int32_t x, int32_t y);

/* fxs_resolve_c over an RGBA8 picture. */
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
