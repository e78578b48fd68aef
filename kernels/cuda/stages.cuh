/* Compiles the C sources of src/core for the device, so that all integers equal the processor's. Defines the device
 * buffers of a frame. */
#ifndef FXS_CUDA_STAGES_CUH
#define FXS_CUDA_STAGES_CUH

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <fixsplat/fixsplat.h>

#include "warp.cuh"

#define FXS_STAGE __host__ __device__
#define static static __host__ __device__
#include <fixsplat/internal/packed.h>
#include "src/core/sized.h"
/* this copy of the C sources is internal to the CUDA back end */
#undef FXS_API
#define FXS_API
/* the macro `static` marks functions of the host too, which may call others of the host */
#pragma nv_diagnostic push
#pragma nv_diag_suppress 20011
namespace {
#include <fixsplat/internal/fixed.h>
#include <fixsplat/internal/stage.h>
#include "src/core/view.c"
#include "src/core/animate.c"
#include "src/core/object.c"
#include "src/core/chunk.c"
#include "src/core/sight.c"
#include "src/core/cut.c"
#include "src/core/project.c"
#include "src/core/shade.c"
#include "src/core/bin.c"
#include "src/core/resolve.c"
#include "src/core/targets.c"
}
#undef static
#pragma nv_diagnostic pop

namespace {

__device__ const uint16_t offset_of_code_q11[FXS_OPACITY_LAWS][256] = {
#include "src/core/opacity.inc"
};

/* A splat (projected Gaussian) that covers more than BOX_COLUMNS x BOX_ROWS tiles. With the square cut-off (an option),
   every splat counts as large. */
struct large_splat {
    fxs_bounds bounds;
    uint32_t index;
    int32_t first;
};

const uint32_t LISTS_APART = 4, MANY_GAUSSIANS = 256;      /* with more than MANY_GAUSSIANS Gaussians per tile, the
                                                              lists of two tiles are LISTS_APART elements apart */
const uint32_t PARTS_MOST = 16, SHARED_MOST = 1024;

/* Sizes of the buffers that a frame needs. If the allocated buffers are smaller, the kernel finish_tiles draws the
   frame without tile lists. */
struct frame_needs {
    uint64_t entries;
    uint32_t larges, visible;
    uint32_t damaged;              /* 1: the header of a chunk (256 Gaussians) is out of range */
};

/* Depth range of a tile's list that several thread blocks share. The minimum is stored as ~minimum, so that
   atomicMax works on zeroed memory. */
struct shared_range {
    uint32_t not_least, most;
};

/* A segment (consecutive entries) of a tile's list, with the splats that can touch each part of the tile. */
struct list_segment {
    uint16_t *places;              /* indices of list entries, in the order of the tile's parts; null: out of memory */
    uint16_t ends[PARTS_MOST];
};

struct frame_status : frame_needs {
    uint32_t chunks;
    uint32_t classes[32];
    uint32_t class_entries[32];
    uint32_t next_sort[2], next_turn, next_long, next_dense;
    uint32_t next_cover, covered, next_tile;
    uint64_t split_taken[2];
    shared_range shared[SHARED_MOST];
};

struct tile_list {
    uint32_t count;                /* length of the tile's list; before the kernel start_lists: difference to the
                                      previous tile's length */
    uint32_t next;                 /* index of the next entry to fill in; after the kernel fill_lists: end of the
                                      list */
};

struct frame_buffers {
    frame_status *status;
    frame_needs *needs;
    const fxs_object_view *objects;
    uint32_t object_count;
    uint32_t number;
    const fxs_drawn *drawn;        /* chunks (256 Gaussians each) that are drawn; null: all */
    const uint32_t *drawn_count;
    const uint32_t *numbers;       /* frames with scenes in parts: number in its scene of each drawn chunk; `drawn` then
                                      has chunks of the pools. Otherwise null */
    uint32_t *chunk_objects;
    fxs_chunk_view *chunk_views;
    fxs_splat *splats;             /* projected Gaussians; only visible splats are valid */
    uint64_t *boxes;
    uint32_t *depths;
    union {
        large_splat *larges;
        list_segment *segments;    /* segments of tile lists share memory with `larges`; valid after the kernel
                                      fill_lists */
    };
    tile_list *lists;              /* lists[i list_step] describes the list of tile i. With many Gaussians per tile,
                                      each element has its own memory sector, as atomics on one sector are serialised */
    uint32_t list_step;            /* distance in `lists` between two tiles: 1 or LISTS_APART */
    uint32_t *classes;
    uint64_t *entries;             /* entries of all tile lists: depth << 32 | splat index, with the flag
                                      FXS_ENTRY_CUT_OFF. The kernel sort_lists leaves only the low halves, sorted by
                                      depth */
    uint64_t *split_entries;
    uint64_t capacity, split_capacity;
    uint32_t large_capacity;
    uint64_t *covers;              /* rectangle of tiles that each visible chunk covers; only for frames whose lists do
                                      not fit */
};

/* Loads a splat as two 16-byte words; nvcc would load eight 4-byte words. */
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

__device__ inline uint32_t number_of(const frame_buffers *f, uint32_t tile)
{
    return sizeof(tile_list) / sizeof(uint32_t) * f->list_step * tile;
}

struct tile_entries {
    uint64_t *first;
    uint32_t count;
};

__device__ inline tile_entries entries_of(const frame_buffers *f, uint32_t tile)
{
    const uint2 own = *(const uint2 *)list_of(f, tile);
    return {f->entries + (own.y - own.x), own.x};
}

__device__ inline uint32_t chunk_at(const frame_buffers *f, uint32_t place)
{
    return f->drawn ? f->drawn[place].chunk : place;
}

__device__ inline bool fits(const frame_buffers *f)
{
    return f->status->entries <= f->capacity && f->status->larges <= f->large_capacity;
}

__device__ inline uint64_t spare_entries(const frame_buffers *f)
{
    return f->capacity - f->status->entries;
}

/* Takes `count` 64-bit words of scratch memory. Returns null if too few are left. */
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
