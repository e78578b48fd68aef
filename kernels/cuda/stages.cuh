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

/* What the kernels of a frame share; device memory. */
struct frame_buffers {
    fxs_chunk_view *chunk_views;   /* chunk null: nothing of it can be seen */
    fxs_splat *splats;             /* by index in the scene, like the next three; written where visible */
    uint64_t *masks;               /* bit 8 r + c: listed in tile base + r tiles_x + c */
    uint32_t *bases;
    uint32_t *depths;
    uint32_t *counts;              /* length of each tile's list */
    uint32_t *next;                /* where its next entry goes: after the fill, its end */
    uint32_t *order;               /* the tiles, long lists first */
    uint64_t *entries;             /* the lists: depth above, index and FXS_ENTRY_FAR below */
    uint64_t capacity;             /* of entries */
    struct frame_status *status;
};

struct frame_status {
    uint64_t entries;              /* over the capacity: the frame is not blended */
    uint32_t visible;
};

/* Bases of splats without a mask. */
enum : uint32_t {
    BASE_NONE = 0xffffffffu,       /* in no tile */
    BASE_LARGE = 0xfffffffeu       /* over 8x8 tiles, or the square cut-off: its tiles are found again */
};

const uint32_t WARP = 32;
const unsigned ALL_LANES = 0xffffffffu;

__device__ inline uint32_t lane_index()
{
    return threadIdx.x % WARP;
}

}

#endif
