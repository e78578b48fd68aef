/* A frame while it is rendered, and the parts that frame.c is made of. */
#ifndef FXS_PARTS_H
#define FXS_PARTS_H

#include "object.h"

#define FXS_BLOCK 16u              /* chunks that are projected, shaded and binned in one go */
#define FXS_BLOCK_FAILED UINT32_MAX   /* the scene was damaged or changed */
#define FXS_SORT_BUCKETS 2048

/* Splats of a block whose first, or last, tile row is above a given one. */
typedef struct fxs_row_counts {
    uint32_t started, ended;
} fxs_row_counts;

/* What the splats of a chunk touch, and their depth keys. */
typedef struct fxs_extent {
    fxs_span rows, columns;                /* of tiles */
    uint32_t nearest, farthest;
} fxs_extent;

/* A tile's list, near to far. */
typedef struct fxs_list {
    const uint32_t *entries;
    uint32_t count;
} fxs_list;

#define FXS_NEXT_MORE 4u           /* of a row of `next` beside the macro tiles */

/* Where the time of drawing a macro tile goes. */
enum { FXS_SORTED, FXS_LISTED_TILES, FXS_BLENDED, FXS_RESOLVED, FXS_LAPS };

typedef struct fxs_laps {
    uint64_t start, *times;
} fxs_laps;

/* A picture of the frame: the camera, its splats and where they are drawn. Two eyes share the other memory. */
typedef struct fxs_eye {
    fxs_view view;                         /* of the world */
    fxs_camera camera;
    fxs_object_view *objects;              /* as this camera sees them */
    fxs_splat *splats;                     /* by slot: those of a block lie together, in the order of the objects */
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *depths;                      /* depth keys */
    const fxs_targets *targets;
} fxs_eye;

typedef struct fxs_frame {
    const fxs_context *context;
    const fxs_object *objects;
    const fxs_options *options;
    uint32_t object_count, chunk_count;    /* chunks of all objects */
    fxs_stats stats;
    unsigned char *memory;
    uint64_t memory_bytes;

    fxs_eye eyes[2];
    uint32_t eye_count;                    /* that are prepared together, in the same slots */
    fxs_eye *eye;                          /* the one that is drawn, */
    const uint32_t *depths;                /* and those by which it is sorted */

    uint32_t tiles, macros;
    uint32_t parts;                        /* jobs that share the lists: one a thread */
    uint32_t blocks, block_chunks;         /* jobs that share the first stages, and the chunks of each */
    int planned;                           /* the memory does not hold every Gaussian: there may be several bands */
    int can_slice;                         /* what is drawn can be kept while slices are blended */
    int planning;                          /* blocks only count their splats by tile row */

    /* Cut from the memory once, fixed_bytes long. */
    uint64_t fixed_bytes, bytes_for_all;   /* bytes_for_all: of a frame at once */
    uint32_t *block_slots;                 /* first slot of each block, and the end of the last one's */
    uint32_t *block_counts;                /* its splats, or FXS_BLOCK_FAILED */
    uint64_t *block_times;                 /* nanoseconds of project, shade and bin */
    fxs_row_counts *row_counts;            /* planned only: tiles_y + 1 for each block */
    fxs_extent *extents;                   /* planned only: of each chunk */
    uint32_t (*histograms)[FXS_SORT_BUCKETS];   /* of each part, for a back end without lists */
    uint32_t *tile_counts, *tile_ends;     /* length of each tile's list, and for back ends where it ends */
    uint32_t *lengths;                     /* of each macro tile's list */
    uint32_t *next;                        /* a row of macro tiles for each part: keys, then where they go; and more */
    uint64_t *macro_times;                 /* nanoseconds of sort, bin, blend and resolve */

    /* The band of tile rows, and what is cut from the rest of the memory for it, beside the eyes' splats. */
    int32_t first_row, end_row;
    int32_t first_column, end_column;      /* of tiles; all, but where the band is sliced */
    int sliced;                            /* one tile row, whose splats do not fit: slices.c */
    fxs_tile *pixels;                      /* sliced only: of the columns */
    fxs_trace *nothing;                    /* sliced only, one for each macro tile: names none of its arrays */
    uint32_t slice_room, slice_macros;     /* splats; macro tiles, 0 where the band is not sliced */
    uint32_t count;                        /* splats that touch it */
    uint32_t *indices;                     /* by slot: in all objects' chunks */
    fxs_key *keys, *spare;                 /* the lists, and as much room, to sort them and for the lists of tiles */
    uint32_t key_capacity;                 /* of each */

    uint32_t first_macro, last_macro;      /* whose lists there are */
    uint32_t first_tile, last_tile;        /* of a back end's run */
    uint32_t only_tile;                    /* fxs_pick draws one; else FXS_NOTHING */
    void (*draw_tile)(struct fxs_frame *f, uint32_t tile, const fxs_list *list,
                      fxs_laps *laps);     /* null: the back end draws */
    uint64_t evaluated, blended;           /* fxs_count_pairs only */
    int stopped;                           /* the caller's stop said yes: jobs that begin later do nothing */
} fxs_frame;

static inline void fxs_frame_run(const fxs_frame *f, void (*job)(void *, uint32_t), uint32_t jobs)
{
    fxs_run(&f->context->config, job, (void *)f, jobs);
}

/* Asked by each job, until one is told to stop. */
static inline int fxs_frame_stopped(fxs_frame *f)
{
    const fxs_options *o = f->options;
    if (o->stop && !FXS_SHARED_READ(f->stopped) && o->stop(o->stop_argument))
        FXS_SHARED_WRITE(f->stopped, 1);
    return o->stop && FXS_SHARED_READ(f->stopped);
}

static inline uint64_t fxs_now(const fxs_frame *f)
{
    const fxs_config *config = &f->context->config;
    return config->clock ? config->clock(config->clock_argument) : 0;
}

/* The chunks of a block: from fxs_block_start(f, block) to fxs_block_start(f, block + 1). */
static inline uint32_t fxs_block_start(const fxs_frame *f, uint32_t block)
{
    uint64_t chunk = (uint64_t)block * f->block_chunks;
    return chunk < f->chunk_count ? (uint32_t)chunk : f->chunk_count;
}

/* The object that a chunk of all objects is of. */
static inline uint32_t fxs_frame_object(const fxs_frame *f, uint32_t chunk)
{
    return fxs_object_of(f->eye->objects, f->object_count, chunk);
}

/* Tiles of the picture above a tile row. */
static inline uint32_t fxs_tiles_above(const fxs_frame *f, int32_t row)
{
    return (uint32_t)(row * f->eye->view.tiles_x);
}

/* The first pixel of a tile. */
static inline void fxs_tile_origin(const fxs_frame *f, uint32_t tile, int32_t *x, int32_t *y)
{
    *x = (int32_t)tile % f->eye->view.tiles_x * FXS_TILE;
    *y = (int32_t)tile / f->eye->view.tiles_x * FXS_TILE;
}

/* ---- bands.c ----------------------------------------------------------------------------------------------------- */

/* Bytes of a frame with f->eye_count eyes, or more than SIZE_MAX; fills in stats.memory. */
uint64_t fxs_frame_measure(fxs_frame *f);

/* Cuts up the memory for the frame, and sets `planned` where it does not hold every Gaussian. Returns the bytes without
   which that cannot be. */
uint64_t fxs_bands_init(fxs_frame *f);

/* Before and after the blocks that count the splats of each tile row. The end returns the bytes that the fullest tile
   row takes. */
void fxs_bands_begin_plan(fxs_frame *f);
uint64_t fxs_bands_end_plan(fxs_frame *f);

/* Goes on to the next band: as many tile rows from end_row on as fit in the memory. */
void fxs_band_next(fxs_frame *f);

/* Counts the splats of a chunk, at `slot`, by tile row, for the plan. */
void fxs_band_count(fxs_frame *f, uint32_t block, uint32_t chunk, uint32_t slot, uint32_t count);

/* Whether splats of a chunk may touch the band. */
int fxs_band_has_chunk(const fxs_frame *f, uint32_t chunk);

/* Moves those of `count` splats from `slot` on that touch the band together. Returns how many they are. */
uint32_t fxs_band_keep(fxs_frame *f, uint32_t chunk, uint32_t slot, uint32_t count);

/* ---- prepare.c --------------------------------------------------------------------------------------------------- */

/* The first stages, on a chunk of an object, from `slot` on; bin on any slots. project drops what the band does not
   need, and returns how many are left, or FXS_ERR_SCENE: also where there is no room for 256 before end_slot, as there
   are more splats than were planned for. shade returns 0 or FXS_ERR_SCENE. */
int32_t fxs_prepare_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot, uint32_t end_slot);
int fxs_prepare_shade(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot, uint32_t count);
void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count);

/* All three for every block; of a plan, project alone. Returns 0, FXS_ERR_SCENE where a block failed, or
   FXS_ERR_STOPPED. */
int fxs_prepare_blocks(fxs_frame *f);

/* ---- slices.c ---------------------------------------------------------------------------------------------------- */

/* What is taken at a time: the nearest splats from a key on. Keys are depth and place in the scene, no two alike. */
typedef struct fxs_slice {
    fxs_key first, last;
    uint32_t count, room;          /* splats, and those that are kept before a chunk is projected behind them */
    uint64_t taken;                /* in all slices so far */
    int more;                      /* there are some beyond `last` */
} fxs_slice;

/* Takes the next slice of the columns, f->count splats ready for lists; before the first all of *s is 0 but for `room`
   and `more`. Returns 0, FXS_ERR_STOPPED, or FXS_ERR_SCENE: also where there are more than the scene has, as it changes
   meanwhile. */
int fxs_slice_next(fxs_frame *f, fxs_slice *s);

/* ---- eyes.c ------------------------------------------------------------------------------------------------------ */

/* Projects a chunk for both eyes, from `slot` on. What either sees has the same slot in both; what one does not see has
   the other's depth. Returns how many slots are taken, at most 256, or FXS_ERR_SCENE. */
int32_t fxs_eyes_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot);

/* After bin: lists what an eye does not see nowhere. */
void fxs_eyes_hide(const fxs_bounds *bounds, uint32_t count, fxs_box *boxes);

/* ---- sort.c, bin.c ----------------------------------------------------------------------------------------------- */

/* Sorts keys by depth, ties by slot (they arrive in the order of their slots), in `parts` jobs. `spare` has room for
   as many, `histograms` for `parts`. Returns where the result is: keys or spare. */
fxs_key *fxs_sort(const fxs_config *config, fxs_key *keys, fxs_key *spare, uint32_t count,
                  uint32_t (*histograms)[FXS_SORT_BUCKETS], uint32_t parts);

/* The tile rows in which a splat may be listed. */
FXS_STAGE fxs_span fxs_bin_rows(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds);

/* The tile columns in which it may be. */
fxs_span fxs_bin_columns(const fxs_view *view, const fxs_bounds *bounds);

/* What makes lists, of the macro tiles first_macro to last_macro. The rest by slot, next by macro tile. */
typedef struct fxs_lister {
    const fxs_view *view;
    const fxs_splat *splats;
    const fxs_bounds *bounds;
    const fxs_box *boxes;
    const uint32_t *depths;        /* by which lists are sorted */
    void (*spans)(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row, int32_t rows,
                  fxs_span *spans);    /* as in fxs_kernels, */
    uint32_t (*note)(const fxs_view *view, const fxs_box *boxes, uint32_t first, uint32_t count, uint32_t *macros,
                     uint32_t *listed);  /* this too */
    uint32_t first_macro, last_macro;
    uint32_t *next;
    uint64_t *notes;               /* by count for fill; `room` at most are written, */
    uint32_t room, taken;          /* though more are taken; */
    uint32_t noted, from;          /* `noted` of them are all of the slots before `from` */
} fxs_lister;

/* Adds 1 to next[macro] for every macro tile that a slot from `first` on is listed in, and takes notes. */
void fxs_bin_count(fxs_lister *l, uint32_t first, uint32_t count);

/* The same without notes, and keys[next[macro]] is its key before. */
void fxs_bin_fill(fxs_lister *l, uint32_t first, uint32_t count, fxs_key *keys);

/* The same for what was noted of slots before `from`. */
void fxs_bin_fill_noted(fxs_lister *l, fxs_key *keys);

/* With the square cut-off: sets FXS_ENTRY_FAR in those of a tile's list whose ellipse does not touch it. */
void fxs_mark_far(const fxs_lister *l, uint32_t tile, uint32_t *entries, uint32_t count);

/* ---- lists.c, draw.c --------------------------------------------------------------------------------------------- */

fxs_lister fxs_lister_of(const fxs_frame *f, uint32_t part);

/* Finds the macro tiles of the band, first_macro to last_macro, and how long their lists are. */
void fxs_lists_count(fxs_frame *f);

/* Once they are counted: whether the lists of each row of macro tiles fit in the memory. */
int fxs_lists_rows_fit(const fxs_frame *f);

/* Lists as many macro tiles, from first_macro to before `end`, as fit in `keys`, and sets last_macro. A list is never
   longer than the number of slots, so one always fits. For a back end they are whole rows, or of one row. */
void fxs_lists_fill(fxs_frame *f, uint32_t end);

/* The list of a macro tile; the same, when it is sorted; and room for as many keys. */
const fxs_key *fxs_list_of(const fxs_frame *f, uint32_t macro);
const fxs_key *fxs_list_sort(const fxs_frame *f, uint32_t macro);
uint32_t *fxs_list_room(const fxs_frame *f, uint32_t macro);

/* Tile i of a macro tile. Returns 0 where it is not in the band. */
int fxs_tile_of(const fxs_frame *f, uint32_t macro, int32_t i, uint32_t *tile);

/* Has the back end draw the macro tiles whose lists there are, or the band without lists. Returns 0 or its error. */
int fxs_draw_lists(fxs_frame *f);
int fxs_draw_unlisted(fxs_frame *f);

/* Hands tiles first_tile to last_tile, which are blended, to the back end. */
int fxs_draw_blended(fxs_frame *f);

/* ---- blend.c, trace.c -------------------------------------------------------------------------------------------- */

/* All 1 - T = 0. */
void fxs_tile_clear(fxs_tile *tile);

/* Blends the list of the tile at pixel (x, y) by `trace`, and writes its depths and ids. slots, of 256, or null: what
   contributes most to each pixel; FXS_NOTHING where nothing does. */
void fxs_trace_tile(const fxs_frame *f, const fxs_list *list, int32_t x, int32_t y, fxs_tile *pixels, uint32_t *slots);

/* ---- targets.c, resolve.c ---------------------------------------------------------------------------------------- */

/* Checks the targets there are, for pictures of this size. Returns 0 or FXS_ERR_TARGET. */
int fxs_targets_check(const fxs_targets *targets, int32_t width, int32_t height);

/* Whether checked targets of two pictures of this size overlap where one of them is written to. */
int fxs_targets_collide(const fxs_targets *a, const fxs_targets *b, int32_t width, int32_t height);

/* FXS_ERR_TARGET where there is none to write and no back end that may write elsewhere; else 0. */
int fxs_targets_missing(const fxs_context *context, const fxs_targets *targets);

/* Whether they need `trace` in place of `blend`. */
int fxs_targets_traced(const fxs_targets *targets);

/* Writes the pixels of a tile at (x, y) to the other targets of f->eye. */
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
