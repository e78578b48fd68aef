/* Balances the load of the kernel blend_dense, which blends tiles with long lists of splats. Such a tile is split into
 * parts, groups of pixel columns, each with its own thread block. The kernel share_lists finds the splats of each part,
 * in segments of the tile's list. */
#ifndef FXS_CUDA_SHARE_CUH
#define FXS_CUDA_SHARE_CUH

#include "tile_walk.cuh"

namespace {

const uint32_t DENSE_THREADS = 1024;
const uint32_t SHARE_THREADS = 512;
const uint32_t DENSE_BLOCKS = 1, SHARE_BLOCKS = 4;
const uint32_t PART_MAGNITUDE = 11, SEGMENT_MAGNITUDE = 11;    /* log2 of the smallest number of list entries in a part
                                                                  of a tile; log2 of the largest number in a segment */
typedef group<DENSE_THREADS> dense_group;
typedef group<SHARE_THREADS> share_group;

__device__ inline uint32_t segments_of(uint32_t magnitude)
{
    return magnitude < SEGMENT_MAGNITUDE ? 1 : 2u << (magnitude - SEGMENT_MAGNITUDE);
}

/* Returns the number of parts into which each tile with a long list is split, a power of two. A tile is split while a
   part has more than half of a thread block's average load. The limit is a quarter if the split adds few list
   entries. */
__device__ inline uint32_t parts_of_tiles(const frame_buffers *f, uint32_t blocks)
{
    const uint32_t magnitude = WARP - 1 - lane_index(), tiles = f->status->classes[magnitude];
    const uint32_t entries = magnitude >= LONG_MAGNITUDE ? f->status->class_entries[magnitude] : 0;
    const uint32_t mean = entries / max(tiles, 1), places = warp_sum(entries ? tiles : 0);
    const uint64_t segments = warp_sum(entries ? (uint64_t)tiles * segments_of(magnitude) : 0);
    const uint64_t all = __shfl_sync(ALL_LANES, warp_sum((uint64_t)entries), WARP - 1), load = all / blocks;
    const uint64_t there = f->split_capacity + spare_entries(f);
    const bool fit = places <= SHARED_MOST &&
                     segments * sizeof(list_segment) <= f->large_capacity * sizeof(large_splat);
    const uint32_t most = fit ? min(PARTS_MOST, mean >> PART_MAGNITUDE) : 1;
    uint64_t room = there > all ? there - all : 0;
    for (uint32_t parts = 1;;) {
        const uint32_t share = mean / parts;
        const uint64_t more = (uint64_t)entries * parts / 12;
        const bool late = share > load / 2 || (share > load / 4 && more <= all / 24);
        const bool cut = parts < most && more <= room && late;
        const uint32_t largest = __reduce_max_sync(ALL_LANES, cut ? share : 0);
        if (!largest)
            return magnitude < LONG_MAGNITUDE ? 0 : parts;
        const int lane = __ffs((int)__ballot_sync(ALL_LANES, cut && share == largest)) - 1;
        room -= __shfl_sync(ALL_LANES, more, lane);
        parts *= (int)lane_index() == lane ? 2 : 1;
    }
}

__device__ inline turns segment_turns(const frame_buffers *f, uint32_t parts)
{
    return turns_of(f, parts > 1 ? segments_of(WARP - 1 - lane_index()) : 0);
}

__device__ inline uint32_t segment_start(uint32_t count, uint32_t n, uint32_t all)
{
    return (uint32_t)((uint64_t)count * n / all);
}

struct part_list {
    uint64_t *keys;
    uint32_t count, part;
    const list_segment *segments;
    uint32_t segment_count;

    __device__ part_list(const frame_buffers *f, const turn_of_tile &turn, uint32_t parts)
        : part(turn.number)
    {
        const tile_entries list = entries_of(f, turn.tile);
        keys = list.first;
        count = list.count;
        segment_count = segments_of(list_magnitude(count));
        const turns order = segment_turns(f, parts);
        const int lane = (int)(WARP - 1 - list_magnitude(count));
        const uint32_t before = turn.place - __shfl_sync(ALL_LANES, order.tiles, lane);
        segments = f->segments + __shfl_sync(ALL_LANES, order.start, lane) + before * segment_count;
    }

    __device__ uint32_t start_in(uint32_t segment) const
    {
        return part ? __ldcg(&segments[segment].ends[part - 1]) : 0;
    }

    __device__ uint32_t end_in(uint32_t segment) const
    {
        return __ldcg(&segments[segment].ends[part]);
    }

    __device__ uint32_t count_own(bool *missing, const dense_group *g) const
    {
        uint32_t own = 0;
        *missing = false;
        for (uint32_t i = g->thread; i < segment_count; i += DENSE_THREADS) {
            own += end_in(i) - start_in(i);
            *missing |= !__ldcg((const uint64_t *)&segments[i].places);
        }
        return own;
    }

    template <class Visit>
    __device__ void visit(const dense_group *g, Visit visit) const
    {
        enum { FETCHES = 4 };
        const uint32_t warps = DENSE_THREADS / WARP, warp = g->thread / WARP, each = max(warps / segment_count, 1);
        for (uint32_t n = warp / each; n < segment_count; n += warps / each) {
            const uint16_t *in_segment = (const uint16_t *)__ldcg((const uint64_t *)&segments[n].places);
            const uint32_t start = segment_start(count, n, segment_count), end = end_in(n);
            const uint32_t own = start_in(n) + warp % each * FETCHES * WARP + lane_index();
            for (uint32_t first = own; first < end; first += each * FETCHES * WARP) {
                uint32_t place[FETCHES];
                uint64_t key[FETCHES];
#pragma unroll
                for (uint32_t i = 0; i < FETCHES; i++)
                    place[i] = start + (first + i * WARP < end ? __ldcg(&in_segment[first + i * WARP]) : 0);
#pragma unroll
                for (uint32_t i = 0; i < FETCHES; i++)
                    key[i] = __ldcg(&keys[place[i]]);
#pragma unroll
                for (uint32_t i = 0; i < FETCHES; i++)
                    if (first + i * WARP < end)
                        visit(key[i], place[i]);
            }
        }
    }
};

__device__ inline key_range range_of_shared(const frame_buffers *f, const turn_of_tile &turn)
{
    const shared_range *range = &f->status->shared[turn.place];
    return {(uint64_t)~__ldcg(&range->not_least) << 32, (uint64_t)__ldcg(&range->most) << 32 | UINT32_MAX};
}

struct segment_of_list {
    const uint64_t *keys;
    uint32_t count;
    uint32_t columns;
};

struct share_shared {
    uint32_t parts[PARTS_MOST];
    uint16_t *places;
};

/* Finds, for each part of a tile, the splats that can touch the part, in one segment of the tile's list. Also extends
   the depth range of the list. */
__device__ void share_segment(list_segment *out, shared_range *range, share_shared *shared, const frame_buffers *f,
                              const tile_splats *t, const segment_of_list &s, const share_group *g)
{
    enum { EACH = (1 << SEGMENT_MAGNITUDE) / SHARE_THREADS };
    const uint32_t lane = lane_index(), parts = FXS_TILE / s.columns, of_part = (1u << s.columns) - 1;
    uint32_t touched[EACH], before[EACH], not_least = 0, most = 0;
    if (g->thread < PARTS_MOST)
        shared->parts[g->thread] = 0;
#pragma unroll
    for (uint32_t k = 0; k < EACH; k++) {
        const uint32_t i = g->thread + k * SHARE_THREADS;
        const uint64_t key = i < s.count ? __ldcg(&s.keys[i]) : FXS_ENTRY_CUT_OFF;
        const bool listed = !(key & FXS_ENTRY_CUT_OFF);
        const fxs_splat splat = t->splat_of(key);
        touched[k] = listed ? columns_of(t, &splat) : 0;
        not_least = listed ? max(not_least, ~depth_of(key)) : not_least;
        most = listed ? max(most, depth_of(key)) : most;
    }
    g->sync();
#pragma unroll
    for (uint32_t k = 0; k < EACH; k++) {
        uint32_t own = 0;
        for (uint32_t part = 0; part < parts; part++) {
            const unsigned lanes = __ballot_sync(ALL_LANES, touched[k] >> part * s.columns & of_part);
            own = part == lane ? (uint32_t)__popc(lanes) : own;
        }
        before[k] = lane < parts ? atomicAdd(&shared->parts[lane], own) : 0;
    }
    not_least = __reduce_max_sync(ALL_LANES, not_least);
    most = __reduce_max_sync(ALL_LANES, most);
    if (lane == 0) {
        atomicMax(&range->not_least, not_least);
        atomicMax(&range->most, most);
    }
    g->sync();
    if (g->thread < WARP) {
        const uint32_t own = lane < parts ? shared->parts[lane] : 0, end = warp_sum(own);
        if (lane == WARP - 1)
            out->places = shared->places = (uint16_t *)take_entries(f, (end + 3) / 4);
        if (lane < PARTS_MOST) {
            out->ends[lane] = (uint16_t)end;
            shared->parts[lane] = end - own;
        }
    }
    g->sync();
    uint16_t *places = shared->places;
#pragma unroll
    for (uint32_t k = 0; k < EACH; k++) {
        const uint32_t start = before[k] + shared->parts[lane % PARTS_MOST];
        for (uint32_t part = 0; part < parts && places; part++) {
            const bool touches = touched[k] >> part * s.columns & of_part;
            const unsigned lanes = __ballot_sync(ALL_LANES, touches);
            const uint32_t first = __shfl_sync(ALL_LANES, start, (int)part);
            if (touches)
                places[first + (uint32_t)__popc(lanes & ((1u << lane) - 1))] =
                    (uint16_t)(g->thread + k * SHARE_THREADS);
        }
    }
    g->sync();
}

__global__ void __launch_bounds__(SHARE_THREADS, SHARE_BLOCKS)
share_lists(const __grid_constant__ fxs_stage_view view, const __grid_constant__ frame_buffers f, uint32_t dense_blocks)
{
    __shared__ share_shared shared;
    const share_group g = {0, threadIdx.x};
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y);
    if (!fits(&f))
        return;
    const uint32_t parts = parts_of_tiles(&f, dense_blocks);
    const turns order = segment_turns(&f, parts);
    for (uint32_t i = blockIdx.x; i < order.all; i += gridDim.x) {
        const turn_of_tile turn = tile_of_turn(&f, &order, tiles, i);
        const tile_entries list = entries_of(&f, turn.tile);
        const uint32_t first = segment_start(list.count, turn.number, turn.turns);
        const tile_splats t(&view, &f, turn.tile);
        const uint32_t of_tile = __shfl_sync(ALL_LANES, parts, (int)(WARP - 1 - list_magnitude(list.count)));
        share_segment(&f.segments[i], &f.status->shared[turn.place], &shared, &f, &t,
                      {list.first + first, segment_start(list.count, turn.number + 1, turn.turns) - first,
                       FXS_TILE / of_tile}, &g);
    }
}

}

#endif
