/* State of a frame while it renders. Each file of this folder has a header for its own functions. */
#ifndef FXS_FRAME_H
#define FXS_FRAME_H

#include "cut.h"

#define FXS_SORT_BUCKETS 2048

/* Which splats the stages work on. */
enum fxs_frame_mode {
    FXS_FRAME_WHOLE,               /* all splats: the memory has a slot for every Gaussian */
    FXS_FRAME_PLAN,                /* projection only, to count the splats of each tile row */
    FXS_FRAME_BAND,                /* splats of a band, as many tile rows as fit in the memory */
    FXS_FRAME_SLICES               /* part of a tile row that is too full: nearest splats first, then the next */
};

/* A tile's list, near to far. */
typedef struct fxs_list {
    const uint32_t *entries;
    uint32_t count;
} fxs_list;

/* Stopwatch of a macro tile: start of the current lap, and the sums per lap. `times` is null if the macro tile is not
   timed. */
typedef struct fxs_laps {
    uint64_t start, *times;
} fxs_laps;

/* Receives a tile once its list is ready. */
struct fxs_frame;
typedef void fxs_tile_fn(struct fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* For a tile row: how many of a block's splats start above it (started), and how many end above it (ended). */
typedef struct fxs_row_counts {
    uint32_t started, ended;
} fxs_row_counts;

/* Tiles that a chunk's splats touch, and the range of their depth keys. */
typedef struct fxs_extent {
    fxs_span rows, columns;
    uint32_t nearest, farthest;
} fxs_extent;

typedef struct fxs_frame {
    /* Arguments (setup.c). */
    const fxs_context *context;
    const fxs_options *options;
    const fxs_object *objects;
    uint32_t object_count;
    uint32_t chunk_count;                  /* drawn chunks: all, or those in the cut */
    uint32_t cut_room;                     /* capacity of the cut; 0: no cut */
    unsigned char *memory;
    uint64_t memory_bytes;
    fxs_tile_fn *draw_tile;                /* of draw.c, pick.c, count.c or slices.c; null: a back end draws */
    uint32_t only_tile;                    /* fxs_pick: the tile to draw; otherwise FXS_NOTHING */

    /* The eye (fxs_frame_look). */
    fxs_view view;                         /* in world space */
    fxs_camera camera;
    const fxs_targets *targets;

    /* Work and jobs (bands.c). A block of chunks is a job of project, shade and bin. A part of the blocks is a job that
       makes lists. A macro tile is a job of sort, blend and resolve. */
    enum fxs_frame_mode mode;
    uint32_t blocks, block_chunks;         /* block_chunks: chunks per block */
    uint32_t parts;                        /* one per thread */
    uint32_t tiles, macros;                /* in the picture */

    /* Arrays that live for the whole frame; fixed_bytes in all. */
    uint64_t fixed_bytes, bytes_for_all;   /* bytes_for_all: minimum for FXS_FRAME_WHOLE */
    fxs_object_view *views;                /* objects as the camera sees them */
    uint32_t *block_slots;                 /* first slot of each block, then the end of the last block */
    uint32_t *block_counts;                /* splats of each block, or FXS_BLOCK_FAILED */
    uint64_t *block_times;                 /* nanoseconds in project, shade and bin, per block */
    void *cut_memory;                      /* fxs_cut_bytes(cut_room) bytes */
    const fxs_drawn *drawn;                /* chunks of the cut; null: all are drawn */
    fxs_row_counts *row_counts;            /* plan: tiles_y + 1 per block */
    fxs_extent *extents;                   /* plan: one per drawn chunk */
    uint32_t (*histograms)[FXS_SORT_BUCKETS];   /* one per part, for a back end without lists */
    uint32_t *tile_counts, *tile_ends;     /* length of each tile's list; its end, for back ends */
    uint32_t *lengths;                     /* length of each macro tile's list */
    uint32_t *next;                        /* per part: a counter per macro tile (number of keys, then the place of
                                              the next key), and FXS_NEXT_MORE numbers */
    uint64_t *macro_times;                 /* nanoseconds in sort, bin, blend and resolve, per macro tile */

    /* The band, and its arrays, in the rest of the memory. */
    int32_t first_row, end_row;            /* tile rows */
    int32_t first_column, end_column;      /* tile columns; all, except for slices */
    uint32_t count;                        /* splats that touch the band */
    fxs_splat *splats;                     /* by slot; each block has consecutive slots, in the order of the objects */
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *depths;                      /* depth keys */
    uint32_t *indices;                     /* by slot: number of the Gaussian, counted in the chunks of all objects */
    fxs_key *keys, *spare;                 /* lists of macro tiles; scratch space for sorting and tile lists */
    uint32_t key_capacity;                 /* keys in each of the two */

    /* Slices only: state of their columns. */
    uint32_t slice_room, slice_macros;     /* capacity in splats; macro tile columns, 0 without slices */
    fxs_tile *pixels;                      /* one per tile */
    fxs_trace *nothing;                    /* one per macro tile; requests no output */

    /* Work in progress. */
    uint32_t first_macro, last_macro;      /* macro tiles with lists */
    uint32_t first_tile, last_tile;        /* tiles of a back end's run */
    int stopped;                           /* options.stop returned true: later jobs return at once */

    fxs_stats stats;
} fxs_frame;

/* ---- setup.c ----------------------------------------------------------------------------------------------------- */

/* Checks the arguments, then the memory, and looks from the first eye. Returns 0 or an FXS_ERR_*. */
int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_request *request, void *memory,
                   size_t memory_bytes);

/* Sets the eye of the frame: 0 or 1. Returns 0, FXS_ERR_CAMERA, FXS_ERR_SIZE or FXS_ERR_TARGET; 0 for the eyes of an
   initialised frame. */
int fxs_frame_look(fxs_frame *f, const fxs_request *request, uint32_t eye);

/* Lays out the memory, places the objects and chooses their chunks. If the memory has no slot for every Gaussian,
   counts the splats of each tile row. Returns 0, FXS_ERR_OBJECT, FXS_ERR_SCENE, FXS_ERR_STOPPED, or FXS_ERR_MEMORY if a
   tile row does not fit; stats.memory.least then has the minimum. */
int fxs_frame_begin(fxs_frame *f);

/* Finds the errors that fxs_frame_begin returns before a pixel is written, other than FXS_ERR_SCENE and
   FXS_ERR_STOPPED, and sets stats.memory.least. */
int fxs_frame_check(fxs_frame *f);

/* ---- frame.c ----------------------------------------------------------------------------------------------------- */

/* Lists the splats of the band, sorted by depth, and draws them to the targets. Returns 0, FXS_ERR_STOPPED or a back
   end's error. */
int fxs_frame_draw(fxs_frame *f);

/* Renders the whole frame. Errors as in fxs_frame_begin and fxs_frame_draw. */
int fxs_frame_render(fxs_frame *f);

/* ---- Everywhere -------------------------------------------------------------------------------------------------- */

static inline void fxs_frame_run(const fxs_frame *f, void (*job)(void *, uint32_t), uint32_t jobs)
{
    fxs_run(&f->context->config, job, (void *)f, jobs);
}

/* Called by each job. Calls options.stop until it has returned true once. */
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

/* First place of a block in the list of drawn chunks. The block ends where the next one starts. */
static inline uint32_t fxs_block_start(const fxs_frame *f, uint32_t block)
{
    uint64_t chunk = (uint64_t)block * f->block_chunks;
    return chunk < f->chunk_count ? (uint32_t)chunk : f->chunk_count;
}

/* Chunk number, counted over all objects, at a place in the list of drawn chunks. */
static inline uint32_t fxs_frame_chunk(const fxs_frame *f, uint32_t place)
{
    return f->drawn ? f->drawn[place].chunk : place;
}

static inline uint32_t fxs_frame_object(const fxs_frame *f, uint32_t chunk)
{
    return fxs_object_of(f->views, f->object_count, chunk);
}

static inline void fxs_frame_move(const fxs_frame *f, uint32_t to, uint32_t slot)
{
    f->splats[to] = f->splats[slot];
    f->bounds[to] = f->bounds[slot];
    f->depths[to] = f->depths[slot];
    f->indices[to] = f->indices[slot];
}

/* Number of tiles above a tile row. */
static inline uint32_t fxs_tiles_above(const fxs_frame *f, int32_t row)
{
    return (uint32_t)(row * f->view.tiles_x);
}

static inline void fxs_tile_origin(const fxs_frame *f, uint32_t tile, int32_t *x, int32_t *y)
{
    *x = (int32_t)tile % f->view.tiles_x * FXS_TILE;
    *y = (int32_t)tile / f->view.tiles_x * FXS_TILE;
}

#endif
