/* A frame while it is rendered: what it has, and the functions that take it from its memory to its pixels. The
 * functions of each step are in parts.h. */
#ifndef FXS_FRAME_H
#define FXS_FRAME_H

#include "cut.h"

#define FXS_SORT_BUCKETS 2048

/* Which splats are at work. */
enum fxs_frame_mode {
    FXS_FRAME_WHOLE,               /* all: the memory holds a splat for every Gaussian */
    FXS_FRAME_PLAN,                /* it does not: splats are projected only to count those of each tile row */
    FXS_FRAME_BAND,                /* then those of a band, as many tile rows as the memory has room for */
    FXS_FRAME_SLICES               /* the band is a tile row whose splats do not fit: the nearest ones, then the next */
};

/* A tile's list, near to far. */
typedef struct fxs_list {
    const uint32_t *entries;
    uint32_t count;
} fxs_list;

/* A stopwatch: when the last lap ended, and the sums of a macro tile's laps; null where it is not timed. */
typedef struct fxs_laps {
    uint64_t start, *times;
} fxs_laps;

/* What becomes of a tile, once its list is there. */
struct fxs_frame;
typedef void fxs_tile_fn(struct fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* Splats of a block whose first, or last, tile row is above a given one. */
typedef struct fxs_row_counts {
    uint32_t started, ended;
} fxs_row_counts;

/* The tiles that the splats of a chunk touch, and the range of their depth keys. */
typedef struct fxs_extent {
    fxs_span rows, columns;
    uint32_t nearest, farthest;
} fxs_extent;

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
    /* The arguments (setup.c). */
    const fxs_context *context;
    const fxs_options *options;
    const fxs_object *objects;
    uint32_t object_count;
    uint32_t chunk_count;                  /* that are drawn: all, or those of the cut */
    uint32_t cut_room;                     /* at most so many are in the cut; 0: there is none */
    unsigned char *memory;
    uint64_t memory_bytes;
    fxs_tile_fn *draw_tile;                /* of draw.c, pick.c, count.c or slices.c; null: a back end draws */
    uint32_t only_tile;                    /* a pick draws one; else FXS_NOTHING */
    uint32_t eye_count;                    /* eyes that are prepared together, in the same slots */
    fxs_eye *eye;                          /* the one that is drawn, */
    const uint32_t *depths;                /* and the depths by which its lists are sorted */

    /* The work and its jobs (bands.c). Blocks of chunks are the jobs of project, shade and bin; parts of the blocks
       those that make lists; macro tiles those of sort, blend and resolve. */
    enum fxs_frame_mode mode;
    uint32_t blocks, block_chunks;         /* chunks of a block */
    uint32_t parts;                        /* one a thread */
    uint32_t tiles, macros;                /* of the picture */

    /* What is cut from the memory once, fixed_bytes long. */
    uint64_t fixed_bytes, bytes_for_all;   /* bytes_for_all: of a frame at once */
    uint32_t *block_slots;                 /* first slot of each block, and the end of the last one's */
    uint32_t *block_counts;                /* its splats, or FXS_BLOCK_FAILED */
    uint64_t *block_times;                 /* nanoseconds of project, shade and bin */
    void *cut_memory;                      /* of fxs_cut_bytes */
    const fxs_drawn *drawn;                /* the chunks of the cut; null where all are drawn */
    fxs_row_counts *row_counts;            /* of a plan: tiles_y + 1 for each block */
    fxs_extent *extents;                   /* of a plan: of each chunk that is drawn */
    uint32_t (*histograms)[FXS_SORT_BUCKETS];   /* of each part, for a back end without lists */
    uint32_t *tile_counts, *tile_ends;     /* length of each tile's list, and for back ends where it ends */
    uint32_t *lengths;                     /* of each macro tile's list */
    uint32_t *next;                        /* of each part, by macro tile: how many keys, then where the next goes */
    uint64_t *macro_times;                 /* nanoseconds of sort, bin, blend and resolve */

    /* The band, and what is cut from the rest of the memory for it, beside the eyes' splats. */
    int32_t first_row, end_row;            /* of tiles */
    int32_t first_column, end_column;      /* all, but for slices */
    uint32_t count;                        /* splats that touch it */
    uint32_t *indices;                     /* by slot: the Gaussian's place in the chunks of all objects */
    fxs_key *keys, *spare;                 /* the lists, and as much room, to sort them and for the lists of tiles */
    uint32_t key_capacity;                 /* of each */

    /* Slices alone: what is kept of their columns. */
    uint32_t slice_room, slice_macros;     /* splats; macro tiles, 0 without slices */
    fxs_tile *pixels;                      /* of the tiles */
    fxs_trace *nothing;                    /* one for each macro tile: names none of its arrays */

    /* What is drawn at the moment. */
    uint32_t first_macro, last_macro;      /* whose lists there are */
    uint32_t first_tile, last_tile;        /* of a back end's run */
    int stopped;                           /* the caller's stop said yes: jobs that begin later do nothing */

    fxs_stats stats;
    fxs_eye eyes[2];
} fxs_frame;

/* ---- setup.c ----------------------------------------------------------------------------------------------------- */

/* Checks the arguments, then the memory. Returns 0 or an FXS_ERR_*. */
int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_request *request, void *memory,
                   size_t memory_bytes);

/* Cuts up the memory, places the objects and chooses their chunks; where the memory does not hold every Gaussian, finds
   out how many splats each tile row has. Returns 0, FXS_ERR_MEMORY where they do not fit either (stats.memory.least has
   what would do), FXS_ERR_OBJECT, FXS_ERR_SCENE or FXS_ERR_STOPPED. */
int fxs_frame_begin(fxs_frame *f);

/* Bytes of a request's frame of this size, whatever its cameras; 0 where an argument is out of range. *memory may be
   null. */
size_t fxs_measure(const fxs_context *context, const fxs_request *request, int32_t width, int32_t height,
                   fxs_frame_memory *memory);

/* ---- frame.c ----------------------------------------------------------------------------------------------------- */

/* Lists the splats of f->eye, by f->depths, and draws the band into its targets. Returns 0, FXS_ERR_STOPPED or a
   back end's error. */
int fxs_frame_draw(fxs_frame *f);

/* The whole frame of f->eye, from its memory to its pixels. Errors: those of fxs_frame_begin and fxs_frame_draw. */
int fxs_frame_render(fxs_frame *f);

/* ---- Everywhere -------------------------------------------------------------------------------------------------- */

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

/* Where a block's places in the list of drawn chunks begin; they end where those of the next one begin. */
static inline uint32_t fxs_block_start(const fxs_frame *f, uint32_t block)
{
    uint64_t chunk = (uint64_t)block * f->block_chunks;
    return chunk < f->chunk_count ? (uint32_t)chunk : f->chunk_count;
}

/* The chunk, of all objects, at a place in the list of drawn ones. */
static inline uint32_t fxs_frame_chunk(const fxs_frame *f, uint32_t place)
{
    return f->drawn ? f->drawn[place].chunk : place;
}

/* The object that a chunk of all objects is of. */
static inline uint32_t fxs_frame_object(const fxs_frame *f, uint32_t chunk)
{
    return fxs_object_of(f->eye->objects, f->object_count, chunk);
}

/* Moves the splat of a slot to slot `to`. */
static inline void fxs_frame_move(const fxs_frame *f, uint32_t to, uint32_t slot)
{
    const fxs_eye *eye = f->eye;
    eye->splats[to] = eye->splats[slot];
    eye->bounds[to] = eye->bounds[slot];
    eye->depths[to] = eye->depths[slot];
    f->indices[to] = f->indices[slot];
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

#endif
