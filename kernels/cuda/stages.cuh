/* The C stages as device code: the text of src/ itself, so the same integers. Host code gets a copy of its own. */
#ifndef FXS_CUDA_STAGES_CUH
#define FXS_CUDA_STAGES_CUH

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "../../src/fixsplat.h"

#define FXS_STAGE __host__ __device__
#define static static __host__ __device__
#include "../../src/packed.h"
namespace {
#include "../../src/fixed.h"
#include "../../src/stage.h"
#include "../../src/view.c"
#include "../../src/chunk.c"
#include "../../src/project.c"
#include "../../src/shade.c"
#include "../../src/bin.c"
#include "../../src/resolve.c"
}
#undef static

namespace {

__device__ const uint16_t offset_of_code_q11[256] = {
#include "../../src/opacity.inc"
};

/* A splat that does not fit in 8x8 tiles, or any with the square cut-off. */
struct large_splat {
    fxs_bounds bounds;
    uint32_t index;
    int32_t first;                 /* of LARGE_ROWS tile rows; the others have records of their own */
};

/* What a frame needed; over the capacity of its buffers, it is not blended. */
struct frame_status {
    uint64_t entries;
    uint32_t larges, visible, chunks;
    uint32_t classes[32];          /* tiles in each class */
    uint32_t next_turn, next_dense;   /* of blend_tiles, blend_dense */
};

/* What the kernels of a frame share; device memory. */
struct frame_buffers {
    frame_status *status;
    fxs_chunk_view *chunk_views;   /* of the chunks that can be seen, status->chunks of them */
    fxs_splat *splats;             /* by index in the scene, like the next three; written where visible */
    uint64_t *masks;               /* bit 8 r + c: listed in tile base + r tiles_x + c; of chunks that can be seen */
    uint32_t *bases;
    uint32_t *depths;
    large_splat *larges;           /* masks 0 */
    uint32_t *counts;              /* length of each tile's list */
    uint32_t *next;                /* where its next entry goes: after the fill, its end */
    uint32_t *classes;             /* tiles by the magnitude of their lists: a row of all tiles for each class */
    uint64_t *entries;             /* the lists: depth above, index and FXS_ENTRY_FAR below; in no order */
    uint64_t *split_entries;       /* long lists again, in bins */
    uint64_t capacity;             /* of entries, and of split_entries */
    uint32_t large_capacity;
};

__device__ inline bool fits(const frame_buffers *f)
{
    return f->status->entries <= f->capacity && f->status->larges <= f->large_capacity;
}

const uint32_t WARP = 32;
const unsigned ALL_LANES = 0xffffffffu;

__device__ inline uint32_t lane_index()
{
    return threadIdx.x % WARP;
}

/* The sum over the lanes up to this one. */
__device__ inline uint32_t warp_sum(uint32_t x)
{
    for (uint32_t d = 1; d < WARP; d *= 2) {
        const uint32_t below = __shfl_up_sync(ALL_LANES, x, d);
        x += lane_index() >= d ? below : 0;
    }
    return x;
}

}

#endif
