/* State of a frame while it renders. A chunk has 256 Gaussians; a place is the index of a drawn chunk. A splat is a
 * projected Gaussian; a slot is its index. A macro tile is 2x2 tiles of 16x16 pixels. A band is a range of tile rows
 * that is drawn at once. */
#ifndef FXS_FRAME_H
#define FXS_FRAME_H

#include <fixsplat/internal/stage.h>

#include "cut.h"

#define FXS_SORT_BUCKETS 2048

enum fxs_frame_mode {
    FXS_FRAME_WHOLE,               /* memory holds a splat for every Gaussian */
    FXS_FRAME_PLAN,                /* counts the splats of each tile row without keeping them */
    FXS_FRAME_BAND,                /* memory holds the splats of one band */
    FXS_FRAME_SLICES               /* memory holds part of the splats of a tile row */
};

/* A tile's list of splats in ascending order of depth. */
typedef struct fxs_list {
    const uint32_t *entries;
    uint32_t count;
} fxs_list;

/* Stopwatch of a macro tile. `times`: sums per lap; null: not timed. */
typedef struct fxs_laps {
    uint64_t start, *times;
} fxs_laps;

struct fxs_frame;
typedef void fxs_tile_fn(struct fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps);

/* Numbers of a block's splats that start, and that end, above a tile row. */
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
    uint32_t chunk_count;                  /* number of drawn chunks */
    uint32_t cut_room;                     /* capacity of the level-of-detail cut; 0: no cut */
    unsigned char *memory;
    uint64_t memory_bytes;
    fxs_tile_fn *draw_tile;                /* draws a tile; null: a back end draws */
    uint32_t only_tile;                    /* tile to draw for fxs_pick; FXS_NOTHING: all */

    fxs_stage_view view;
    fxs_camera camera;
    const fxs_targets *targets;

    /* Project, shade and bin run once per block of chunks, the lists once per part of the blocks, the other stages once
       per macro tile. */
    enum fxs_frame_mode mode;
    uint32_t blocks, block_chunks;
    uint32_t parts;
    uint32_t tiles, macros;                /* numbers of tiles and macro tiles in the picture */

    /* Arrays that live for the whole frame; fixed_bytes bytes in all. */
    uint64_t fixed_bytes, bytes_for_all;
    fxs_object_view *views;
    uint32_t *block_slots;                 /* first slot of each block; last: end of the last block */
    uint32_t *block_counts;                /* splats of each block; FXS_BLOCK_FAILED: error */
    uint64_t *block_times;
    void *cut_memory;
    const fxs_drawn *drawn;                /* chunks to draw; null: all */
    fxs_row_counts *row_counts;
    fxs_extent *extents;
    uint32_t (*histograms)[FXS_SORT_BUCKETS];
    uint32_t *tile_counts, *tile_ends;     /* length of each tile's list; end of the list, for back ends */
    uint32_t *lengths;
    uint32_t *next;                        /* per part: a counter per macro tile, then FXS_NEXT_MORE numbers */
    uint64_t *macro_times;

    int32_t first_row, end_row;
    int32_t first_column, end_column;
    uint32_t count;
    fxs_splat *splats;                     /* splats by slot; each block has consecutive slots */
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *depths;
    uint32_t *indices;                     /* number of each splat's Gaussian, counted over all objects */
    fxs_key *keys, *spare;
    uint32_t key_capacity;

    /* capacity of a slice in splats; columns of macro tiles in a slice, 0: no slices */
    uint32_t slice_room, slice_macros;
    fxs_tile *pixels;
    fxs_trace *nothing;

    uint32_t first_macro, last_macro;
    uint32_t first_tile, last_tile;
    int stopped;                           /* 1: options.stop returned true */

    fxs_stats stats;
} fxs_frame;

/* Checks the arguments and the memory, and sets the first eye. Returns 0 or an FXS_ERR_*. */
int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_request *request, void *memory,
                   size_t memory_bytes);

/* Sets the eye, 0 or 1. Returns 0, FXS_ERR_CAMERA, FXS_ERR_SIZE or FXS_ERR_TARGET. */
int fxs_frame_look(fxs_frame *f, const fxs_request *request, uint32_t eye);

/* Lays out the memory, transforms the objects and chooses their chunks. Returns 0, FXS_ERR_OBJECT, FXS_ERR_SCENE or
   FXS_ERR_STOPPED. Returns FXS_ERR_MEMORY if a tile row does not fit in the memory. */
int fxs_frame_begin(fxs_frame *f);

int fxs_frame_check(fxs_frame *f);

/* Lists, sorts and draws the splats of the band. Returns 0, FXS_ERR_STOPPED or a back end's error. */
int fxs_frame_draw(fxs_frame *f);

/* Renders all bands. Returns the errors of fxs_frame_begin and fxs_frame_draw. */
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

/* Returns the number of a drawn chunk, counted over all objects. */
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
