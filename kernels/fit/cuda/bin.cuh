/* Projects the Gaussians of a view to splats, colours them, and lists the splats of each tile, sorted by depth. A slot
 * is a place in memory for a pair of a splat (a projected Gaussian) and a tile that it touches. */
#ifndef FXS_CUDA_FIT_BIN_CUH
#define FXS_CUDA_FIT_BIN_CUH

#include <type_traits>

#include <cub/block/block_scan.cuh>
#include <cub/device/device_scan.cuh>

#include "kernels/cuda/sort.cuh"
#include "step.cuh"

namespace {

const uint32_t BIN_THREADS = 256;

/* For load balance, a splat that touches more than FEW_TILES tiles is processed by a warp of threads. A splat that
   touches more than MANY_TILES tiles gets a whole block of threads. */
const uint32_t FEW_TILES = 16, MANY_TILES = 256, LARGE_BLOCKS = 264;

__device__ inline void note_large(const step_buffers &b, uint32_t gaussian, uint32_t tiles)
{
    const bool is_huge = tiles > MANY_TILES, is_large = !is_huge && tiles > FEW_TILES;
    const uint32_t huge = take_number(b.status->huge_count, b.turn, is_huge);
    const uint32_t large = take_number(b.status->large_count, b.turn, is_large);
    if (is_huge)
        b.huge[huge] = gaussian;
    if (is_large)
        b.large[large] = gaussian;
}

template <class ByBlock, class ByWarp>
__device__ inline void visit_large(const step_buffers &b, ByBlock by_block, ByWarp by_warp)
{
    const uint32_t huge = b.status->huge_count[b.turn], large = b.status->large_count[b.turn];
    for (uint32_t i = blockIdx.x; i < huge; i += LARGE_BLOCKS)
        by_block(b.huge[i]);
    for (uint32_t i = threadIdx.x / WARP * LARGE_BLOCKS + blockIdx.x; i < large; i += blockDim.x / WARP * LARGE_BLOCKS)
        by_warp(b.large[i]);
}

/* Returns the Gaussian of a thread. Neighbouring Gaussians are alike in size, so groups of four neighbours go to
   different blocks of threads, for load balance. */
__device__ inline uint32_t spread_over_blocks(uint32_t thread)
{
    return (thread / 4 * (gridDim.x - LARGE_BLOCKS) + (blockIdx.x - LARGE_BLOCKS)) * 4 + thread % 4;
}

inline uint32_t bin_grid(uint64_t threads)
{
    return (uint32_t)((threads + BIN_THREADS - 1) / BIN_THREADS);
}

template <class Launch>
void by_degree(int degree, Launch launch)
{
    switch (degree) {
    case 0:
        return launch(std::integral_constant<int, 0>());
    case 1:
        return launch(std::integral_constant<int, 1>());
    case 2:
        return launch(std::integral_constant<int, 2>());
    default:
        return launch(std::integral_constant<int, 3>());
    }
}

__device__ inline void put_splat(const real numbers[SPLAT_NUMBERS], fxs_fit_splat *splat)
{
    float4 *to = (float4 *)splat;
    to[0] = make_float4(numbers[0], numbers[1], numbers[2], numbers[3]);
    to[1] = make_float4(numbers[4], numbers[5], numbers[6], numbers[7]);
    to[2] = make_float4(numbers[8], numbers[9], numbers[10], numbers[11]);
    to[3] = make_float4(numbers[12], numbers[13], numbers[14], 0);
}

template <bool IsPosed>
__global__ void __launch_bounds__(BIN_THREADS)
    project_splats(step_buffers b, device_model m, const __grid_constant__ fxs_fit_camera camera,
                   const posed_camera *posed)
{
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    real numbers[SPLAT_NUMBERS];
    bool is_seen = false;
    if (is_stopped(b.status))
        return;
    for (uint32_t tile = i; tile < (uint32_t)(camera.tiles_x * camera.tiles_y); tile += gridDim.x * BIN_THREADS)
        b.starts[tile] = 0;
    if constexpr (IsPosed) {
        const fxs_fit_camera own = with_pose(camera, posed);
        is_seen = i < m.count && find_splat(&own, m.parameters + i, m.stride, numbers);
    } else
        is_seen = i < m.count && find_splat(&camera, m.parameters + i, m.stride, numbers);
    if (i == 0)
        b.status->large_count[1 - b.turn] = b.status->huge_count[1 - b.turn] = 0;
    const int seen = __syncthreads_count(is_seen);
    if (!threadIdx.x && seen)
        atomicAdd(&b.status->seen.visible, (uint32_t)seen);
    const uint32_t tiles = is_seen ? (uint32_t)numbers[SPLAT_TILES] : 0;
    note_large(b, i, tiles);
    if (i <= m.count)
        b.bases[i] = tiles;
    if (i >= m.count)
        return;
    if (is_seen)
        put_splat(numbers, &b.splats[i]);
    else
        b.splats[i].depth = 0;
}

template <int Degree, bool IsPosed>
__global__ void __launch_bounds__(BIN_THREADS)
    shade_splats(step_buffers b, device_model m, const __grid_constant__ fxs_fit_camera camera,
                 const posed_camera *posed)
{
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    if (i >= m.count || is_stopped(b.status) || !(b.splats[i].depth > 0))
        return;
    fxs_fit_splat *splat = &b.splats[i];
    if constexpr (IsPosed) {
        const fxs_fit_camera own = with_pose(camera, posed);
        find_colours(&own, Degree, m.parameters + i, m.stride, &splat->limit, splat->colour);
    } else
        find_colours(&camera, Degree, m.parameters + i, m.stride, &splat->limit, splat->colour);
}

cudaError_t launch_project(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera,
                           const posed_camera *posed, cudaStream_t stream)
{
    const auto kernel = posed ? project_splats<true> : project_splats<false>;
    kernel<<<bin_grid((uint64_t)m->count + 1), BIN_THREADS, 0, stream>>>(*b, *m, *camera, posed);
    return cudaGetLastError();
}

cudaError_t launch_shade(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera,
                         const posed_camera *posed, int degree, cudaStream_t stream, const side_stream *beside)
{
    const cudaError_t failure = beside->start(stream);
    by_degree(degree, [&](auto d) {
        constexpr int Degree = d.value;
        const auto kernel = posed ? shade_splats<Degree, true> : shade_splats<Degree, false>;
        kernel<<<bin_grid(m->count), BIN_THREADS, 0, beside->stream>>>(*b, *m, *camera, posed);
    });
    return first_of(first_of(failure, cudaGetLastError()), cudaEventRecord(beside->end, beside->stream));
}

/* Adds unsigned numbers with saturation, so that an overflowing sum stays too large for the memory instead of wrapping
   around. */
struct add_saturated {
    __host__ __device__ uint32_t operator()(uint32_t x, uint32_t y) const
    {
        return x + y < x ? UINT32_MAX : x + y;
    }
};

/* Notes the number of slots (pairs of a splat and a tile) of this step. Returns true if they fit into memory. */
__device__ inline bool has_room(const step_buffers &b, uint32_t total)
{
    if (!blockIdx.x && !threadIdx.x) {
        b.status->seen.entries += total;
        b.status->entries_most = max(b.status->entries_most, total);
        if (total > b.capacity)
            b.status->is_full = 1;
    }
    return total <= b.capacity;
}

__device__ inline ellipses ellipse_of(const fxs_fit_camera *camera, const fxs_fit_splat *splat)
{
    const float4 *from = (const float4 *)splat;
    const float4 first = from[0], second = from[1], third = from[2], last = from[3];
    ellipses e;
    e.x = first.x;
    e.y = first.y;
    e.ux = first.z;
    e.uy = first.w;
    e.vy = second.x;
    e.radius2 = third.w;
    e.half_y = last.x;
    e.tip = last.y;
    find_rows(camera, 1, &e);
    return e;
}

__device__ inline void put_slot(const step_buffers &b, uint32_t slot, uint32_t tile, uint32_t gaussian)
{
    b.tiles[slot] = tile;
    b.splat_of[slot] = gaussian;
}

/* Slots (pairs of a splat and a tile) of each warp. They are staged in shared memory so that the writes to global
   memory are consecutive. */
struct staged_slots {
    uint32_t tiles[BIN_THREADS / WARP][WARP * FEW_TILES];
    uint8_t lanes[BIN_THREADS / WARP][WARP * FEW_TILES];
};

__device__ inline void stage_small(const fxs_fit_camera *camera, const ellipses &e, uint32_t *tiles, uint8_t *lanes)
{
    for (real row = e.first; row < e.end; row = row + 1.0f) {
        real first, end;
        find_columns(camera, &e, row, &first, &end);
        const uint32_t tile = (uint32_t)row * (uint32_t)camera->tiles_x;
        for (uint32_t x = (uint32_t)first; x < (uint32_t)end; x++) {
            *tiles++ = tile + x;
            *lanes++ = (uint8_t)(threadIdx.x % WARP);
        }
    }
}

__device__ inline void put_small(const step_buffers &b, const fxs_fit_camera *camera, const ellipses &e, uint32_t slot,
                                 uint32_t tiles, uint32_t gaussian, staged_slots *staged)
{
    const uint32_t lane = lane_index(), before = warp_sum(tiles) - tiles;
    const uint32_t total = __shfl_sync(ALL_LANES, before + tiles, WARP - 1);
    uint32_t *const staged_tiles = staged->tiles[threadIdx.x / WARP];
    uint8_t *const lanes = staged->lanes[threadIdx.x / WARP];
    if (tiles)
        stage_small(camera, e, staged_tiles + before, lanes + before);
    __syncwarp();
    for (uint32_t first = 0; first < total; first += WARP) {
        const uint32_t i = first + lane, from = i < total ? lanes[i] : 0;
        const uint32_t origin = __shfl_sync(ALL_LANES, slot - before, from);
        const uint32_t own = __shfl_sync(ALL_LANES, gaussian, from);
        const uint32_t tile = i < total ? staged_tiles[i] : 0;
        if (i < total)
            put_slot(b, origin + i, tile, own);
        add_at(b.starts, tile, 1, i < total);
    }
}

/* Writes the slots of a large splat (its pairs with tiles). Each thread finds the touched tiles of one row of tiles;
   then all threads of the warp write these rows together. */
__device__ inline void put_large(const step_buffers &b, const fxs_fit_camera *camera, uint32_t gaussian, uint32_t n,
                                 uint32_t warps)
{
    const uint32_t lane = lane_index();
    const ellipses e = ellipse_of(camera, &b.splats[gaussian]);
    uint32_t slot = b.bases[gaussian];
    for (real rows = e.first; rows < e.end; rows = rows + (float)WARP) {
        real first, end;
        const uint32_t left = (uint32_t)(e.end - rows), count = min(left, WARP);
        find_columns(camera, &e, rows + (float)lane, &first, &end);
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t from = __shfl_sync(ALL_LANES, (uint32_t)first, i);
            const uint32_t to = __shfl_sync(ALL_LANES, (uint32_t)end, i);
            const uint32_t tile = ((uint32_t)rows + i) * (uint32_t)camera->tiles_x;
            for (uint32_t x = from + lane; x < to && i % warps == n; x += WARP) {
                put_slot(b, slot + (x - from), tile + x, gaussian);
                atomicAdd(&b.starts[tile + x], 1u);
            }
            slot += to > from ? to - from : 0;
        }
    }
}

__global__ void __launch_bounds__(BIN_THREADS)
    put_slots(step_buffers b, uint32_t count, const __grid_constant__ fxs_fit_camera camera)
{
    __shared__ staged_slots staged;
    if (is_stopped(b.status) || !has_room(b, b.bases[count]))
        return;
    if (blockIdx.x < LARGE_BLOCKS)
        return visit_large(
            b, [&](uint32_t gaussian) { put_large(b, &camera, gaussian, threadIdx.x / WARP, BIN_THREADS / WARP); },
            [&](uint32_t gaussian) { put_large(b, &camera, gaussian, 0, 1); });
    const uint32_t gaussian = spread_over_blocks(threadIdx.x);
    const uint32_t slot = gaussian < count ? b.bases[gaussian] : 0;
    const uint32_t tiles = gaussian < count ? b.bases[gaussian + 1] - slot : 0;
    ellipses e;
    memset(&e, 0, sizeof e);
    if (tiles)
        e = ellipse_of(&camera, &b.splats[gaussian]);
    put_small(b, &camera, e, slot, tiles <= FEW_TILES ? tiles : 0, gaussian, &staged);
}

const uint32_t START_THREADS = 1024, START_TILES = 4;
const uint32_t CLASSES = 64;       /* number of classes of tile lists by length, two per power of 2 */
const uint32_t LONG_LIST = 256;    /* tile lists with at least this many entries are sorted by a block of threads,
                                      shorter lists by a warp */

__device__ inline uint32_t class_of(uint32_t count)
{
    const uint32_t bits = 32 - (uint32_t)__clz((int)count);
    return CLASSES - 1 - (bits < 2 ? bits : 2 * bits - 2 + (count >> (bits - 2) & 1));
}

__global__ void __launch_bounds__(START_THREADS) start_lists(step_buffers b, uint32_t tile_count)
{
    typedef cub::BlockScan<uint32_t, START_THREADS> scan;
    __shared__ scan::TempStorage memory;
    __shared__ uint32_t places[CLASSES];
    uint32_t before = 0, all;
    if (is_stopped(b.status))
        return;
    if (threadIdx.x < CLASSES)
        places[threadIdx.x] = 0;
    for (uint32_t first = 0; first <= tile_count; first += START_THREADS * START_TILES, before += all) {
        const uint32_t own = first + threadIdx.x * START_TILES;
        uint32_t counts[START_TILES], starts[START_TILES];
        for (uint32_t i = 0; i < START_TILES; i++)
            counts[i] = own + i < tile_count ? b.starts[own + i] : 0;
        scan(memory).ExclusiveSum(counts, starts, all);
        __syncthreads();
        for (uint32_t i = 0; i < START_TILES; i++) {
            if (own + i <= tile_count)
                b.starts[own + i] = before + starts[i];
            if (own + i < tile_count) {
                b.next[own + i] = before + starts[i];
                atomicAdd(&places[class_of(counts[i])], 1u);
            }
        }
    }
    __syncthreads();
    if (threadIdx.x < WARP) {
        const uint32_t two[] = {places[2 * threadIdx.x], places[2 * threadIdx.x + 1]};
        const uint32_t end = warp_sum(two[0] + two[1]);
        places[2 * threadIdx.x] = end - two[0] - two[1];
        places[2 * threadIdx.x + 1] = end - two[1];
    }
    __syncthreads();
    if (threadIdx.x == 0)
        b.status->long_lists = places[class_of(LONG_LIST - 1)];
    __syncthreads();
    for (uint32_t own = threadIdx.x * START_TILES; own < tile_count; own += START_THREADS * START_TILES) {
        uint32_t starts[START_TILES + 1];
        for (uint32_t i = 0; i <= START_TILES; i++)
            starts[i] = b.starts[min(own + i, tile_count)];
        for (uint32_t i = 0; i < START_TILES && own + i < tile_count; i++)
            b.order[atomicAdd(&places[class_of(starts[i + 1] - starts[i])], 1u)] = own + i;
    }
}

__global__ void __launch_bounds__(BIN_THREADS) fill_lists(step_buffers b, uint32_t count)
{
    if (is_stopped(b.status))
        return;
    const uint32_t slot = blockIdx.x * BIN_THREADS + threadIdx.x, total = b.bases[count];
    const bool is_slot = slot < total;
    if (slot - lane_index() >= total)
        return;
    const uint32_t place = take_number(b.next, is_slot ? b.tiles[slot] : 0, is_slot);
    if (is_slot)
        b.keys[place] = (uint64_t)(uint32_t)bits_of(b.splats[b.splat_of[slot]].depth) << 32 | slot;
}

const uint32_t SORT_THREADS = 256;

/* Sorts the splat lists of tiles by depth. Lists longer than Room are first split into 2^Bits bins by their sort
   key. */
template <uint32_t T, uint32_t Room, int Bits>
struct list_sorter {
    typedef group_keys<Room, Bits> keys_type;
    keys_type keys;
    uint32_t bins[bins_of<keys_type, T>];

    __device__ void sort(const step_buffers &b, uint32_t start, uint32_t count, group<T> g)
    {
        const uint64_t *list = b.keys + start;
        uint32_t *ends = nullptr, *slots = b.slots + start;
        if (count > Room) {                /* The array `sums` of gradients is not in use yet, so its memory holds the
                                              bins of the sort. */
            uint64_t *moved = (uint64_t *)(((uintptr_t)(b.sums + (size_t)start * FXS_FIT_SUMS) + 7) / 8 * 8);
            auto visit_all = [&](auto visit) { visit_keys(list, count, &g, visit); };
            const key_range r = range_of_list(&keys, &g, visit_all);
            move_to_bins(moved, &keys, bins, r, &g,
                         [&](auto visit) { visit_all([&](uint64_t key) { visit(key, key); }); });
            ends = (uint32_t *)(moved + count);
            for (uint32_t i = g.thread; i < keys_type::bins; i += T)
                ends[i] = bins[slot_of<keys_type, group<T>>(i)];
            g.sync();
            list = moved;
        }
        uint32_t *to = slots;
        take_keys(&keys, bins, list, count, ends, &g, [&](uint32_t some) {
            __builtin_assume(some > 0);
            sort_keys_by_count(to, &keys, bins, some, &g);
            to += some;
            return true;
        });
        for (uint32_t i = g.thread; i < count; i += T)
            b.gaussians[start + i] = b.splat_of[slots[i]];
    }
};

union sort_shared {
    list_sorter<SORT_THREADS, 2048, 11> block;
    list_sorter<WARP, LONG_LIST, 8> warps[SORT_THREADS / WARP];
};

__global__ void __launch_bounds__(SORT_THREADS) sort_lists(step_buffers b, uint32_t tile_count)
{
    __shared__ sort_shared shared;
    if (is_stopped(b.status))
        return;
    const uint32_t long_lists = b.status->long_lists, warp = threadIdx.x / WARP;
    const bool is_long = blockIdx.x < long_lists;
    const uint32_t of_others = (blockIdx.x - long_lists) * (SORT_THREADS / WARP) + warp;
    const uint32_t place = is_long ? blockIdx.x : long_lists + of_others;
    if (place >= tile_count)
        return;
    const uint32_t tile = b.order[place], start = b.starts[tile], count = b.starts[tile + 1] - start;
    if (is_long)
        shared.block.sort(b, start, count, {0, threadIdx.x});
    else if (count)
        shared.warps[warp].sort(b, start, count, {0, lane_index()});
}

cudaError_t add_tiles(void *scratch, size_t *bytes, const step_buffers *b, uint32_t count, cudaStream_t stream)
{
    return cub::DeviceScan::ExclusiveScan(scratch, *bytes, b->bases, b->bases, add_saturated(), 0u, count + 1, stream);
}

size_t bin_scratch(uint32_t gaussians)
{
    size_t bytes = 0;
    step_buffers b;
    memset(&b, 0, sizeof b);
    add_tiles(nullptr, &bytes, &b, gaussians, nullptr);
    return bytes;
}

cudaError_t launch_bin(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera, cudaStream_t stream)
{
    const uint32_t tile_count = (uint32_t)(camera->tiles_x * camera->tiles_y), count = m->count;
    size_t bytes = b->scratch_bytes;
    const cudaError_t failure = add_tiles(b->scratch, &bytes, b, count, stream);
    put_slots<<<LARGE_BLOCKS + bin_grid(count), BIN_THREADS, 0, stream>>>(*b, count, *camera);
    launch_early(start_lists, 1, START_THREADS, 0, stream, *b, tile_count);
    launch_early(fill_lists, bin_grid(b->capacity), BIN_THREADS, 0, stream, *b, count);
    launch_early(sort_lists, tile_count, SORT_THREADS, 0, stream, *b, tile_count);
    return first_of(failure, cudaGetLastError());
}

}

#endif
