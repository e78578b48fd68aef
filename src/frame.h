/* A frame while it is rendered: what frame.c, bands.c and stereo.c share. */
#ifndef FXS_FRAME_H
#define FXS_FRAME_H

#include "stage.h"

#define FXS_BLOCK 16u              /* chunks that are projected, shaded and binned in one go */
#define FXS_BLOCK_FAILED UINT32_MAX   /* the scene was damaged or changed */

/* Splats of a block whose first, or last, tile row is above a given one. */
typedef struct fxs_row_counts {
    uint32_t started, ended;
} fxs_row_counts;

typedef struct fxs_frame {
    const fxs_context *context;
    const fxs_scene *scene;
    const fxs_options *options;
    fxs_view view;
    fxs_stats stats;
    unsigned char *memory;
    uint64_t memory_bytes;

    uint32_t tiles;
    uint32_t parts;                        /* jobs that share the sort and the lists: one a thread */
    uint32_t blocks, block_chunks;         /* jobs that share the first stages, and the chunks of each */
    int planned;                           /* the memory does not hold every Gaussian: there may be several bands */

    /* Cut from the memory once, fixed_bytes long. */
    uint64_t fixed_bytes;
    uint32_t *block_slots;                 /* first slot of each block, and the end of the last one's */
    uint32_t *block_counts;                /* its splats, or FXS_BLOCK_FAILED */
    uint64_t *block_times;                 /* nanoseconds of project, shade and bin */
    fxs_row_counts *row_counts;            /* planned only: tiles_y + 1 for each block */
    fxs_span *chunk_rows;                  /* planned only: tile rows that the splats of each chunk touch */
    uint32_t (*histograms)[FXS_SORT_BUCKETS];   /* of each part */
    uint32_t *tile_counts;                 /* length of each tile's list */
    uint32_t *next;                        /* a row of tiles for each part of the keys: entries, then where they go */
    uint64_t *tile_times;                  /* nanoseconds of blend and resolve */

    /* The band of tile rows, and what is cut from the rest of the memory for it. */
    int32_t first_row, end_row;
    uint32_t count;                        /* splats that touch it */
    fxs_splat *splats;                     /* by slot: those of a block lie together, in the order of the scene */
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *indices;                     /* in the scene */
    fxs_key *keys, *spare_keys;            /* the depths lie in spare_keys until the sort */
    uint32_t *entries, entry_capacity;

    uint32_t first_tile, last_tile;        /* of the run being blended */
    unsigned char *pixels;
    ptrdiff_t stride;
    uint64_t evaluated, blended;           /* fxs_count_pairs only */
} fxs_frame;

static inline void fxs_frame_run(const fxs_frame *f, void (*job)(void *, uint32_t), uint32_t jobs)
{
    fxs_run(&f->context->config, job, (void *)f, jobs);
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
    return chunk < f->scene->chunk_count ? (uint32_t)chunk : f->scene->chunk_count;
}

/* Cuts up the memory; where it does not hold every Gaussian of the scene, finds out how many splats each tile row has.
   Returns 0, FXS_ERR_MEMORY where they do not fit either (stats.memory.least has what would do), or FXS_ERR_SCENE. */
int fxs_bands_init(fxs_frame *f);

/* Goes on to the next band: as many tile rows from end_row on as fit in the memory. */
void fxs_band_next(fxs_frame *f);

/* Projects a chunk to the slots from `slot` on, and keeps what touches the band. Returns how many, or FXS_ERR_SCENE:
   also where there is no room for 256 before end_slot, as there are more splats than were counted for the plan. */
int32_t fxs_band_project(fxs_frame *f, uint32_t chunk, uint32_t slot, uint32_t end_slot);

/* Checks the arguments, then the memory. Returns 0 or an FXS_ERR_*. */
int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera,
                   const fxs_options *options, void *memory, size_t memory_bytes);

/* Runs a job for each block, which sets its block_counts. Returns 0, or FXS_ERR_SCENE where one failed. */
int fxs_frame_blocks(fxs_frame *f, void (*job)(void *frame, uint32_t block));

/* The band's splats, sorted: runs a job that projects, shades and boxes each block, then the sort. Returns 0 or
   FXS_ERR_SCENE. */
int fxs_frame_prepare(fxs_frame *f, void (*prepare_job)(void *frame, uint32_t block));

/* The sort alone: of the depths in spare_keys. */
void fxs_frame_sort(fxs_frame *f);

/* Lists them by tile, and blends the band into f->pixels. Returns 0 or a back end's error. */
int fxs_frame_draw(fxs_frame *f);

/* The whole frame, from its memory to its pixels. Returns 0, FXS_ERR_MEMORY, FXS_ERR_SCENE or a back end's error. */
int fxs_frame_render(fxs_frame *f);

#endif
