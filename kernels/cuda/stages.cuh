/* The C stages as device code: the text of src/core itself, compiled for the device, so the integers are the same. Host
 * code gets a copy of its own. */
#ifndef FXS_CUDA_STAGES_CUH
#define FXS_CUDA_STAGES_CUH

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <fixsplat/fixsplat.h>

#include "warp.cuh"

#define FXS_STAGE __host__ __device__
#define static static __host__ __device__
#include <fixsplat/packed.h>
/* This copy is of no interface. */
#undef FXS_API
#define FXS_API
namespace {
#include <fixsplat/fixed.h>
#include <fixsplat/stage.h>
#include "src/core/view.c"
#include "src/core/object.c"
#include "src/core/chunk.c"
#include "src/core/sight.c"
#include "src/core/cut.c"
#include "src/core/project.c"
#include "src/core/shade.c"
#include "src/core/bin.c"
#include "src/core/resolve.c"
#include "src/core/targets.c"
#include "src/core/stereo.c"
}
#undef static

namespace {

__device__ const uint16_t offset_of_code_q11[FXS_OPACITY_LAWS][256] = {
#include "src/core/opacity.inc"
};

/* A splat that does not fit in BOX_COLUMNS x BOX_ROWS tiles, or any with the square cut-off. */
struct large_splat {
    fxs_bounds bounds;
    uint32_t index;
    int32_t first;                 /* of LARGE_ROWS tile rows; the others have records of their own */
};

const uint32_t LISTS_APART = 4, MANY_GAUSSIANS = 256;      /* see list_step; of a tile, as a mean */
const uint32_t PARTS_MOST = 16, SHARED_MOST = 1024;    /* of a tile; tiles */

/* How much a frame needed. Where that is more than the capacity of its buffers, it is not blended. */
struct frame_needs {
    uint64_t entries;
    uint32_t larges, visible;
    uint32_t damaged;              /* 1: a chunk's header is out of range */
};

/* The depths of a list whose tile several blocks of blend_dense share: the least with each bit turned, so that both
   begin at 0. */
struct shared_range {
    uint32_t not_least, most;
};

/* Some entries of such a list, as share_lists finds them for the parts of its tile. */
struct list_segment {
    uint16_t *places;              /* in the segment, of each part's entries, part by part; null: there was no room */
    uint16_t ends[PARTS_MOST];     /* of each part, in those */
};

struct frame_status : frame_needs {
    uint32_t chunks;
    uint32_t classes[32];          /* tiles in each class */
    uint32_t class_entries[32];    /* and their entries */
    uint32_t next_sort[2], next_turn, next_long, next_dense;   /* of sort_lists, and of each kernel that blends */
    uint64_t split_taken[2];       /* of split_entries, and behind the entries */
    shared_range shared[SHARED_MOST];          /* of the longest lists, in the order in which tiles are taken */
};

/* A tile's list. */
struct tile_list {
    uint32_t count;                /* of its entries; until they are added up along a tile row, by how many more than
                                      those of the tile before */
    uint32_t next;                 /* where its next entry goes: after the fill, its end */
};

/* The memory of a frame on the device. */
struct frame_buffers {
    frame_status *status;
    frame_needs *needs;            /* in the host's memory, known before lists are sorted */
    const fxs_object_view *objects;   /* their pointers are the device's; not there for one that is plain */
    uint32_t object_count;
    uint32_t number;               /* of the frame, from 1 on */
    const fxs_drawn *drawn;        /* the chunks of the cut; null where all leaves are drawn */
    const uint32_t *drawn_count;   /* of these; null where the host knows it */
    uint32_t *chunk_objects;       /* of the chunks that can be seen, status->chunks of them: the object */
    fxs_chunk_view *chunk_views;   /* and where they lie; `chunk` is the place among those that are drawn */
    fxs_splat *splats;             /* by index in what is drawn, like the next two; written where visible */
    uint64_t *boxes;               /* the tiles it is listed in: see box_of; of chunks that can be seen */
    uint32_t *depths;
    union {
        large_splat *larges;       /* boxes 0 */
        list_segment *segments;    /* when lists are filled */
    };
    tile_list *lists;              /* of each tile, list_step further. Many threads add to their numbers, and additions
                                      to one sector of memory wait for each other: where tiles have many Gaussians, each
                                      list has a sector of its own */
    uint32_t list_step;            /* 1 or LISTS_APART */
    uint32_t *classes;             /* tiles by the magnitude of their lists: a row of all tiles for each class */
    uint64_t *entries;             /* the lists: depth above, index and FXS_ENTRY_CUT_OFF below, in no order; then,
                                      but for long ones, the lower halves alone, near to far */
    uint64_t *split_entries;       /* long lists again, in bins: over boxes and, where pixels are not traced, over
                                      depths, which are done with by then */
    uint64_t capacity, split_capacity;
    uint32_t large_capacity;
};

/* A splat of frame_buffers by two words of 16 bytes: nvcc would take eight of four, as a splat's words allow. */
__device__ inline fxs_splat load_splat(const fxs_splat *from)
{
    const uint4 halves[2] = {((const uint4 *)from)[0], ((const uint4 *)from)[1]};
    fxs_splat splat;
    static_assert(sizeof splat == sizeof halves, "two words of 16 bytes");
    memcpy(&splat, halves, sizeof splat);
    return splat;
}

__device__ inline void store_splat(fxs_splat *to, const fxs_splat &splat)
{
    uint4 halves[2];
    memcpy(halves, &splat, sizeof halves);
    ((uint4 *)to)[0] = halves[0];
    ((uint4 *)to)[1] = halves[1];
}

__host__ __device__ inline tile_list *list_of(const frame_buffers *f, uint32_t tile)
{
    return f->lists + f->list_step * tile;
}

/* The place of a tile among numbers of lists, for add_at and take_number. */
__device__ inline uint32_t number_of(const frame_buffers *f, uint32_t tile)
{
    return sizeof(tile_list) / sizeof(uint32_t) * f->list_step * tile;
}

/* The entries of a tile. */
struct tile_entries {
    uint64_t *first;
    uint32_t count;
};

__device__ inline tile_entries entries_of(const frame_buffers *f, uint32_t tile)
{
    const uint2 own = *(const uint2 *)list_of(f, tile);    /* count, next */
    return {f->entries + (own.y - own.x), own.x};
}

/* The chunk, of all objects, at a place among those that are drawn. */
__device__ inline uint32_t chunk_at(const frame_buffers *f, uint32_t place)
{
    return f->drawn ? f->drawn[place].chunk : place;
}

__device__ inline bool fits(const frame_buffers *f)
{
    return f->status->entries <= f->capacity && f->status->larges <= f->large_capacity;
}

/* Room to put lists into bins, beside split_entries: what is free behind the entries. */
__device__ inline uint64_t spare_entries(const frame_buffers *f)
{
    return f->capacity - f->status->entries;
}

/* Takes room for `count` entries, by one thread. Returns null where there is none left. */
__device__ inline uint64_t *take_entries(const frame_buffers *f, uint64_t count)
{
    unsigned long long *taken = (unsigned long long *)f->status->split_taken;
    const uint64_t place = atomicAdd(&taken[0], (unsigned long long)count);
    if (place + count <= f->split_capacity)
        return f->split_entries + place;
    const uint64_t behind = atomicAdd(&taken[1], (unsigned long long)count);
    return behind + count <= spare_entries(f) ? f->entries + f->status->entries + behind : nullptr;
}

__device__ inline uint32_t list_magnitude(uint32_t count)
{
    return count ? 31 - (uint32_t)__clz((int)count) : 0;
}

}

#endif
