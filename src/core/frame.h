/* State of a frame while it renders. A chunk has 256 Gaussians; a place is the index of a drawn chunk. A splat is a
 * projected Gaussian; a slot is its index. A macro tile is 2x2 tiles of 16x16 pixels. A band is a range of tile rows
 * that is drawn at once. */
#ifndef FXS_FRAME_H
#define FXS_FRAME_H

#include <fixsplat/internal/stage.h>

#include "cut.h"

#define FXS_SORT_BUCKETS 2048

enum fxs_frame_mode {
    FXS_FRAME_WHOLE,               /* the memory holds a splat for every Gaussian */
    FXS_FRAME_PLAN,                /* a first pass counts the splats of each tile row without keeping them */
    FXS_FRAME_BAND,                /* the memory holds the splats of one band (some rows of tiles) */
    FXS_FRAME_SLICES               /* the memory holds only part of the splats of a tile row */
};

/* A tile's list of splats in ascending order of depth. */
typedef struct fxs_list {
    const uint32_t *entries;
    uint32_t count;
} fxs_list;

/* Stopwatch for a macro tile (2x2 tiles). `times` holds the sum of each timed step; null: the macro tile is not
   timed. */
typedef struct fxs_laps {
    uint64_t start, *times;
} fxs_laps;

struct fxs_frame;
typedef void fxs_tile_fn(struct fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* The numbers of splats of a block of Gaussians that start, and that end, above a tile row. */
typedef struct fxs_row_counts {
    uint32_t started, ended;
} fxs_row_counts;

typedef struct fxs_extent {
    fxs_span rows, columns;
    uint32_t nearest, farthest;
} fxs_extent;

typedef struct fxs_frame {
    const fxs_context *context;
    const fxs_options *options;
    const fxs_object *objects;
    uint32_t object_count;
    const fxs_camera *cameras;             /* cameras of all eyes */
    uint32_t eyes;
    uint32_t chunk_count;                  /* number of drawn chunks (256 Gaussians each) */
    uint32_t cut_room;                     /* largest number of chunks that the level of detail may choose; 0: all
                                              chunks are drawn */
    unsigned char *memory;
    uint64_t memory_bytes;
    fxs_tile_fn *draw_tile;                /* function that draws a tile on the processor; null: a back end draws the
                                              tiles */
    uint32_t only_tile;                    /* the only tile to draw, for fxs_pick; FXS_NOTHING: all tiles are drawn */

    fxs_stage_view view;
    const fxs_camera *camera;
    const fxs_targets *targets;

    /* The stages project, shade and bin run once per block, a range of chunks (256 Gaussians each). The lists of splats
       are made once per part, a range of blocks. The other stages run once per macro tile (2x2 tiles). */
    enum fxs_frame_mode mode;
    uint32_t blocks, block_chunks;
    uint32_t parts;
    uint32_t tiles, macros;                /* numbers of tiles and macro tiles in the picture */

    /* The next arrays live for the whole frame and take fixed_bytes bytes in all. */
    uint64_t fixed_bytes, bytes_for_all;
    fxs_object_view *views;
    uint32_t *block_slots;                 /* first slot (place for a splat) of each block; the last element is the end
                                              of the last block */
    uint32_t *block_counts;                /* number of splats of each block; FXS_BLOCK_FAILED: the block had an
                                              error */
    uint64_t *block_times;
    unsigned char *animated;               /* for each block, room for a chunk of a moving scene at this moment */
    uint32_t animated_bytes;               /* bytes of each; 0: no scene moves */
    void *cut_memory;
    const fxs_drawn *drawn;                /* chunks (256 Gaussians each) to draw; null: all. Both eyes draw the same */
    uint32_t drawn_count;
    fxs_row_counts *row_counts;
    fxs_extent *extents;
    uint32_t (*histograms)[FXS_SORT_BUCKETS];
    uint32_t *tile_counts, *tile_ends;     /* length of each tile's list of splats; end of the list in `spare`, for back
                                              ends */
    uint32_t *lengths;
    uint32_t *next;                        /* for each part of the splats: a counter per macro tile (2x2 tiles), then
                                              FXS_NEXT_MORE numbers about notes */
    uint64_t *macro_times;

    int32_t first_row, end_row;
    int32_t first_column, end_column;
    uint32_t count;
    fxs_splat *splats;                     /* projected Gaussians; the splats of a block of Gaussians are consecutive */
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *depths;
    uint32_t *indices;                     /* number of the Gaussian of each splat, counted over all objects */
    fxs_key *keys, *spare;
    uint32_t key_capacity;

    /* A slice draws part of a tile row's splats. slice_room: its capacity in splats; slice_macros: its width in macro
       tiles (2x2 tiles), 0: no slices. */
    uint32_t slice_room, slice_macros;
    fxs_tile *pixels;
    fxs_trace *nothing;

    uint32_t first_macro, last_macro;
    uint32_t first_tile, last_tile;
    int stopped;                           /* 1: the caller's function options.stop has returned true */

    fxs_stats stats;
} fxs_frame;

/* Checks a frame's arguments and memory, and prepares the camera of the first eye. Returns 0 or an FXS_ERR_* code. */
int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_request *request, void *memory,
                   size_t memory_bytes);

/* Prepares the camera of an eye, 0 or 1. Returns 0, FXS_ERR_CAMERA, FXS_ERR_SIZE or FXS_ERR_TARGET. */
int fxs_frame_look(fxs_frame *f, const fxs_request *request, uint32_t eye);

/* Lays out the memory of a frame, transforms the objects to camera space and chooses the chunks to draw. Returns 0,
   FXS_ERR_OBJECT, FXS_ERR_SCENE or FXS_ERR_STOPPED. Returns FXS_ERR_MEMORY if the splats of a tile row do not fit in
   the memory. */
int fxs_frame_begin(fxs_frame *f);

int fxs_frame_check(fxs_frame *f);

/* Lists, sorts and draws the splats of the current band (some rows of tiles). Returns 0, FXS_ERR_STOPPED or a back
   end's error. */
int fxs_frame_draw(fxs_frame *f);

/* Renders all bands (ranges of tile rows) of a frame. Returns the errors of fxs_frame_begin and fxs_frame_draw. */
int fxs_frame_render(fxs_frame *f);

static inline void fxs_frame_run(const fxs_frame *f, void (*job)(void *, uint32_t), uint32_t jobs)
{
    fxs_run(&f->context->config, job, (void *)f, jobs);
}

/* Returns true if the caller stopped the frame. Does not call options.stop again after it returned true. */
static inline int fxs_frame_stopped(fxs_frame *f)
{
    const fxs_options *o = f->options;
    if (o->stop.call && !FXS_SHARED_READ(f->stopped) && o->stop.call(o->stop.argument))
        FXS_SHARED_WRITE(f->stopped, 1);
    return o->stop.call && FXS_SHARED_READ(f->stopped);
}

static inline uint64_t fxs_now(const fxs_frame *f)
{
    const fxs_config *config = &f->context->config;
    return config->clock ? config->clock(config->clock_argument) : 0;
}

static inline uint32_t fxs_block_start(const fxs_frame *f, uint32_t block)
{
    uint64_t chunk = (uint64_t)block * f->block_chunks;
    return chunk < f->chunk_count ? (uint32_t)chunk : f->chunk_count;
}

/* Returns the number of the chunk at index `place` of the drawn chunks. The number is counted over all objects. */
static inline uint32_t fxs_frame_chunk(const fxs_frame *f, uint32_t place)
{
    return f->drawn ? f->drawn[place].chunk : place;
}

/* Returns the index of a chunk among the drawn chunks, which are in ascending order. */
static inline uint32_t fxs_frame_place(const fxs_frame *f, uint32_t chunk)
{
    uint32_t low = 0, high = f->chunk_count;
    while (f->drawn && high - low > 1) {
        const uint32_t middle = (low + high) / 2;
        if (f->drawn[middle].chunk <= chunk)
            low = middle;
        else
            high = middle;
    }
    return f->drawn ? low : chunk;
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
