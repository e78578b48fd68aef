/* blend and resolve. A warp has 8x8 pixels, two a lane, and walks the list of their tile by itself. 32 splats at a time
 * are tested against the 8 rows, a splat a lane; those that can touch a pixel are queued in shared memory, then all
 * lanes take them one by one.
 *
 * Levels are integers in float registers, twice the level of pixel.h plus the bit that its rounding drops: with c =
 * coordinate_q13 2^-7,
 *     fma(c, c, 2^23 + 2 row_level + 1), rounded down, = 2^23 + floor(2 (coordinate_q13^2 2^-15 + 1/2 + row_level))
 * where that is below 2^24, and no less than 2^24 elsewhere; a limit is at most 2^23 + 45395. Coordinates are not cut to
 * +-4: beyond that the level is over every limit either way. */
#ifndef FXS_CUDA_BLEND_CUH
#define FXS_CUDA_BLEND_CUH

#include "stages.cuh"

namespace {

const uint32_t BLEND_THREADS = 1024, BLEND_WARPS = BLEND_THREADS / WARP;
const int REGION = 8;                      /* pixels, across and down */
const uint32_t REGIONS = 4;                /* of a tile */
const int LEVEL_ONE = 0x4b000000;          /* 2^23 as a float, in bits */

/* A splat at a region. */
struct queued_row {
    uint32_t u_q24;                        /* at its first pixel */
    float level;                           /* 2^23 + 2 row_level + 1 */
};

struct queued_rest {
    uint32_t ux_q24;
    int limit;                             /* of the level's bits */
    uint32_t red_green, blue;
};

struct blend_shared {
    uint16_t alpha_q15[FXS_FAINT_Q11 + 1]; /* fxs_alpha_q15 */
    alignas(16) queued_row rows[BLEND_WARPS][WARP][REGION];
    queued_rest rest[BLEND_WARPS][WARP];
    uint32_t next_region;
};

struct pixel {
    int transmittance, sum[3];
};

/* coordinate_q13 2^-7, not cut: added to the mantissa of 1.5 2^16, whose unit is 2^-7. */
__device__ inline float coordinate_q6(uint32_t coordinate_q24)
{
    return __int_as_float(((int32_t)coordinate_q24 >> 11) + 0x47c00000) - 98304.0f;
}

/* 2^23 + 2 row_level + 1 */
__device__ inline float row_level(uint32_t v_q24, int offset_q11)
{
    const float v = coordinate_q6(v_q24);
    const int twice = __float_as_int(__fmaf_rd(v, v, 8388609.0f)) & ~1;
    return __int_as_float(twice) + (float)(2 * offset_q11 + 1);
}

__device__ inline int limit_bits(int offset_q11, int cut_q11)
{
    return LEVEL_ONE + 2 * fxs_limit_q11(offset_q11, cut_q11) + 1;
}

__device__ inline void blend_pixel(pixel *p, const blend_shared *shared, uint32_t u_q24, float level_of_row,
                                   const queued_rest *s)
{
    const float u = coordinate_q6(u_q24);
    const int level = __float_as_int(__fmaf_rd(u, u, level_of_row));
    int alpha = 0;
    if (level <= s->limit && p->transmittance >= FXS_CLOSED_Q15)
        alpha = shared->alpha_q15[(level & 0xffff) >> 1];
    const int weight = fxs_weight_q15(alpha, p->transmittance);
    p->transmittance -= weight;
    /* Sums only grow: cut to 32767 once, by resolve. */
    p->sum[0] += fxs_mul_q15(weight, (int)(s->red_green & 0xffff));
    p->sum[1] += fxs_mul_q15(weight, (int)(s->red_green >> 16));
    p->sum[2] += fxs_mul_q15(weight, (int)s->blue);
}

/* Whether a splat can touch a pixel of the region at (x, y), and its rows there. u grows along a row, so the least |u|
   is at an end or 0 between them. */
__device__ inline bool place_rows(queued_row rows[REGION], const fxs_splat *s, int limit, int32_t x, int32_t y)
{
    uint32_t u = s->u0_q24 + (uint32_t)x * (uint32_t)s->ux_q24 + (uint32_t)y * (uint32_t)s->uy_q24;
    uint32_t v = s->v0_q24 + (uint32_t)y * (uint32_t)s->vy_q24;
    bool touched = false;
    for (int row = 0; row < REGION; row++) {
        const float left = coordinate_q6(u), right = coordinate_q6(u + (REGION - 1) * (uint32_t)s->ux_q24);
        const float least = fmaxf(fmaxf(left, -right), 0.0f);
        rows[row].u_q24 = u;
        rows[row].level = row_level(v, s->offset_q11);
        touched |= __float_as_int(__fmaf_rd(least, least, rows[row].level)) <= limit;
        u += (uint32_t)s->uy_q24;
        v += (uint32_t)s->vy_q24;
    }
    return touched;
}

/* Tests one splat a lane and queues those that touch the region. Returns how many. */
__device__ inline uint32_t queue_splats(blend_shared *shared, uint32_t warp, const frame_buffers *f,
                                        const fxs_view *view, uint64_t entry, bool listed, int32_t x, int32_t y)
{
    queued_row rows[REGION];
    fxs_splat s;
    int limit = 0;
    bool touched = false;
    if (listed && !((uint32_t)entry & FXS_ENTRY_FAR)) {
        s = f->splats[(uint32_t)entry];
        limit = limit_bits(s.offset_q11, view->cut_q11);
        touched = place_rows(rows, &s, limit, x, y);
    }
    const unsigned lanes = __ballot_sync(ALL_LANES, touched);
    if (touched) {
        const uint32_t place = (uint32_t)__popc(lanes & ((1u << lane_index()) - 1));
        for (int row = 0; row < REGION; row++)
            shared->rows[warp][place][row] = rows[row];
        shared->rest[warp][place] = {(uint32_t)s.ux_q24, limit,
                                     (uint32_t)s.colour_q13[0] | (uint32_t)s.colour_q13[1] << 16,
                                     (uint32_t)s.colour_q13[2]};
    }
    __syncwarp();
    return (uint32_t)__popc(lanes);
}

__device__ inline void blend_region(pixel p[2], blend_shared *shared, uint32_t warp, const frame_buffers *f,
                                    const fxs_view *view, const uint64_t *list, uint32_t count, int32_t x, int32_t y)
{
    const uint32_t lane = lane_index(), column = lane % REGION, row = lane / REGION;
    for (uint32_t first = 0; first < count; first += WARP) {
        if (!__any_sync(ALL_LANES, p[0].transmittance >= FXS_CLOSED_Q15 || p[1].transmittance >= FXS_CLOSED_Q15))
            break;
        const bool listed = first + lane < count;
        const uint32_t queued = queue_splats(shared, warp, f, view, listed ? list[first + lane] : 0, listed, x, y);
        for (uint32_t i = 0; i < queued; i++) {
            const queued_rest s = shared->rest[warp][i];
            const uint32_t across = column * s.ux_q24;
            const queued_row upper = shared->rows[warp][i][row], lower = shared->rows[warp][i][row + REGION / 2];
            blend_pixel(&p[0], shared, upper.u_q24 + across, upper.level, &s);
            blend_pixel(&p[1], shared, lower.u_q24 + across, lower.level, &s);
        }
        __syncwarp();
    }
}

struct target {
    unsigned char *pixels;
    ptrdiff_t stride;
    int background_q13[3];
    enum fxs_format format;
};

__device__ inline void store_pixel(const target *t, const pixel *p, int32_t x, int32_t y)
{
    union {
        unsigned char bytes[4];
        uint32_t word;
        uint16_t half;
    } packed;
    int rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = fxs_resolve_8bit(fxs_min(p->sum[c], 32767), p->transmittance, t->background_q13[c]);
    store(packed.bytes, t->format, rgb, p->transmittance);
    unsigned char *row = t->pixels + y * t->stride;
    if (t->format == FXS_FORMAT_RGB565)
        ((uint16_t *)row)[x] = packed.half;
    else
        ((uint32_t *)row)[x] = packed.word;
}

/* A block has tiles blockIdx.x, + gridDim.x, ... in the order of their lists' lengths; its warps take their regions as
   they come. */
__global__ void __launch_bounds__(BLEND_THREADS, 1) blend_tiles(const __grid_constant__ fxs_view view,
                                                                const __grid_constant__ frame_buffers f,
                                                                const __grid_constant__ target t)
{
    extern __shared__ __align__(16) unsigned char memory[];
    blend_shared *shared = (blend_shared *)memory;
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y), lane = lane_index(), warp = threadIdx.x / WARP;
    if (f.status->entries > f.capacity)
        return;
    for (uint32_t level = threadIdx.x; level <= FXS_FAINT_Q11; level += BLEND_THREADS)
        shared->alpha_q15[level] = (uint16_t)fxs_alpha_q15((int)level);
    if (threadIdx.x == 0)
        shared->next_region = 0;
    __syncthreads();
    for (;;) {
        uint32_t region = lane == 0 ? atomicAdd(&shared->next_region, 1u) : 0;
        region = __shfl_sync(ALL_LANES, region, 0);
        const uint32_t turn = blockIdx.x + region / REGIONS * gridDim.x;
        if (turn >= tiles)
            return;
        const uint32_t tile = f.order[turn], count = f.counts[tile], part = region % REGIONS;
        const int32_t x = (int32_t)(tile % (uint32_t)view.tiles_x * FXS_TILE + part % 2 * REGION);
        const int32_t y = (int32_t)(tile / (uint32_t)view.tiles_x * FXS_TILE + part / 2 * REGION);
        pixel p[2];
        for (int i = 0; i < 2; i++) {
            const int32_t px = x + (int32_t)lane % REGION, py = y + (int32_t)lane / REGION + i * REGION / 2;
            p[i] = {px < view.width && py < view.height ? FXS_CLEAR_Q15 : 0, {0, 0, 0}};
        }
        blend_region(p, shared, warp, &f, &view, f.entries + (f.next[tile] - count), count, x, y);
        for (int i = 0; i < 2; i++) {
            const int32_t px = x + (int32_t)lane % REGION, py = y + (int32_t)lane / REGION + i * REGION / 2;
            if (px < view.width && py < view.height)
                store_pixel(&t, &p[i], px, py);
        }
    }
}

}

#endif
