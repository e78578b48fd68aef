/* project and bin: the splats of a view, and the lists of its tiles. */
#ifndef FXS_CUDA_FIT_BIN_CUH
#define FXS_CUDA_FIT_BIN_CUH

#include <type_traits>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "step.cuh"

namespace {

const uint32_t BIN_THREADS = 256;

/* Splats that touch more tiles are listed by a whole warp each. */
const uint32_t LARGE_TILES = 16;

inline uint32_t bin_grid(uint64_t threads)
{
    return (uint32_t)((threads + BIN_THREADS - 1) / BIN_THREADS);
}

/* Calls launch(degree) with a constant, so that the SH of a kernel stay in registers. */
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

/* ---- project ----------------------------------------------------------------------------------------------------- */

/* Writes a splat; of one that is not in the picture only the number that says so. */
__device__ inline void put_splat(const real numbers[SPLAT_NUMBERS], fxs_fit_splat *splat)
{
    float4 *to = (float4 *)splat;
    to[0] = make_float4(numbers[0], numbers[1], numbers[2], numbers[3]);
    to[1] = make_float4(numbers[4], numbers[5], numbers[6], numbers[7]);
    to[2] = make_float4(numbers[8], numbers[9], numbers[10], numbers[11]);
    to[3] = make_float4(numbers[12], numbers[13], numbers[14], 0);
}

/* `posed`: of the camera, where IsPosed. */
template <int Degree, bool IsPosed>
__global__ void __launch_bounds__(BIN_THREADS)
    project_splats(step_buffers b, device_model m, const __grid_constant__ fxs_fit_camera camera,
                   const posed_camera *posed)
{
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    real numbers[SPLAT_NUMBERS];
    bool is_seen = false;
    if (is_stopped(b.status))
        return;
    if constexpr (IsPosed) {
        const fxs_fit_camera own = with_pose(camera, posed);
        is_seen = i < m.count && find_splat(&own, Degree, m.parameters + i, m.stride, numbers);
    } else
        is_seen = i < m.count && find_splat(&camera, Degree, m.parameters + i, m.stride, numbers);
    const int seen = __syncthreads_count(is_seen);
    if (!threadIdx.x && seen)
        atomicAdd(&b.status->seen.visible, (uint32_t)seen);
    if (i >= m.count)
        return;
    if (is_seen)
        put_splat(numbers, &b.splats[i]);
    else
        b.splats[i].depth = 0;
    b.depths[0][i] = is_seen ? (uint32_t)bits_of(numbers[10]) : UINT32_MAX;
    b.gaussians[0][i] = i;
}

/* `posed`: null, or the camera's pose, which is read on the device. */
cudaError_t launch_project(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera,
                           const posed_camera *posed, int degree, cudaStream_t stream)
{
    by_degree(degree, [&](auto d) {
        constexpr int Degree = d.value;
        const auto kernel = posed ? project_splats<Degree, true> : project_splats<Degree, false>;
        kernel<<<bin_grid(m->count), BIN_THREADS, 0, stream>>>(*b, *m, *camera, posed);
    });
    return cudaGetLastError();
}

/* ---- Slots ------------------------------------------------------------------------------------------------------- */

/* bases[i] becomes how many tiles the i-th splat in the order of depth touches. */
__global__ void __launch_bounds__(BIN_THREADS) count_tiles(step_buffers b, uint32_t count)
{
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    if (i <= count)
        b.bases[i] = i < count && b.depths[1][i] != UINT32_MAX ? (uint32_t)b.splats[b.gaussians[1][i]].tiles : 0;
}

/* A sum that stays at the largest number, so that a count that is too large does not look small. */
struct add_saturated {
    __host__ __device__ uint32_t operator()(uint32_t x, uint32_t y) const
    {
        return x + y < x ? UINT32_MAX : x + y;
    }
};

/* Whether there is room for the step's slots; notes how many they are. */
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
    b.tiles[0][slot] = tile;
    b.splat_of[slot] = gaussian;
}

/* Slots of a warp's splats of few tiles: they are written one after the other. */
struct staged_slots {
    uint32_t tiles[BIN_THREADS / WARP][WARP * LARGE_TILES];
    uint8_t lanes[BIN_THREADS / WARP][WARP * LARGE_TILES];
};

__device__ inline uint32_t sum_before(uint32_t own)
{
    const uint32_t lane = threadIdx.x % WARP;
    uint32_t sum = own;
    for (uint32_t d = 1; d < WARP; d *= 2) {
        const uint32_t other = __shfl_up_sync(ALL_LANES, sum, d);
        sum += lane >= d ? other : 0;
    }
    return sum - own;
}

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

/* By a warp: each thread's splat, where it has `tiles` of them, LARGE_TILES at most. */
__device__ inline void put_small(const step_buffers &b, const fxs_fit_camera *camera, const ellipses &e, uint32_t slot,
                                 uint32_t tiles, uint32_t gaussian, staged_slots *staged)
{
    const uint32_t lane = threadIdx.x % WARP, before = sum_before(tiles);
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
        if (i < total)
            put_slot(b, origin + i, staged_tiles[i], own);
    }
}

__device__ inline ellipses shuffled(const ellipses &e, uint32_t from)
{
    ellipses out;
    out.x = __shfl_sync(ALL_LANES, e.x, from);
    out.y = __shfl_sync(ALL_LANES, e.y, from);
    out.ux = __shfl_sync(ALL_LANES, e.ux, from);
    out.uy = __shfl_sync(ALL_LANES, e.uy, from);
    out.vy = __shfl_sync(ALL_LANES, e.vy, from);
    out.radius2 = __shfl_sync(ALL_LANES, e.radius2, from);
    out.half_y = __shfl_sync(ALL_LANES, e.half_y, from);
    out.tip = __shfl_sync(ALL_LANES, e.tip, from);
    out.first = __shfl_sync(ALL_LANES, e.first, from);
    out.end = __shfl_sync(ALL_LANES, e.end, from);
    return out;
}

/* By a warp: its threads find the columns of a row each, and then fill the rows together. */
__device__ inline void put_large(const step_buffers &b, const fxs_fit_camera *camera, const ellipses &e, uint32_t slot,
                                 uint32_t gaussian)
{
    const uint32_t lane = threadIdx.x % WARP;
    for (real rows = e.first; rows < e.end; rows = rows + (float)WARP) {
        real first, end;
        const uint32_t left = (uint32_t)(e.end - rows), count = min(left, WARP);
        find_columns(camera, &e, rows + (float)lane, &first, &end);
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t from = __shfl_sync(ALL_LANES, (uint32_t)first, i);
            const uint32_t to = __shfl_sync(ALL_LANES, (uint32_t)end, i);
            const uint32_t tile = ((uint32_t)rows + i) * (uint32_t)camera->tiles_x;
            for (uint32_t x = from + lane; x < to; x += WARP)
                put_slot(b, slot + (x - from), tile + x, gaussian);
            slot += to > from ? to - from : 0;
        }
    }
}

/* The place in the order of depth that a thread has the splat of. Neighbours are often large alike, and go to different
   blocks, four by four. */
__device__ inline uint32_t place_in_order(uint32_t count)
{
    const uint32_t blocks = (count + BIN_THREADS - 1) / BIN_THREADS;
    return blockIdx.x < blocks ? (threadIdx.x / 4 * blocks + blockIdx.x) * 4 + threadIdx.x % 4 : count;
}

/* A thread for each splat in the order of depth, and for each slot. */
__global__ void __launch_bounds__(BIN_THREADS)
    put_slots(step_buffers b, uint32_t count, const __grid_constant__ fxs_fit_camera camera)
{
    __shared__ staged_slots staged;
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    if (is_stopped(b.status))
        return;
    const uint32_t total = b.bases[count];
    if (!has_room(b, total))
        return;
    if (i < b.capacity)
        b.slots[0][i] = i;
    if (i >= total && i < b.capacity)
        b.tiles[0][i] = UINT32_MAX;
    const uint32_t place = place_in_order(count);
    const uint32_t slot = place < count ? b.bases[place] : 0, tiles = place < count ? b.bases[place + 1] - slot : 0;
    uint32_t gaussian = 0;
    ellipses e;
    memset(&e, 0, sizeof e);
    if (tiles) {
        gaussian = b.gaussians[1][place];
        b.splats[gaussian].slot = slot;
        e = ellipse_of(&camera, &b.splats[gaussian]);
    }
    put_small(b, &camera, e, slot, tiles <= LARGE_TILES ? tiles : 0, gaussian, &staged);
    for (uint32_t large = __ballot_sync(ALL_LANES, tiles > LARGE_TILES); large; large &= large - 1) {
        const uint32_t from = (uint32_t)__ffs((int)large) - 1;
        put_large(b, &camera, shuffled(e, from), __shfl_sync(ALL_LANES, slot, from),
                  __shfl_sync(ALL_LANES, gaussian, from));
    }
}

/* ---- Lists ------------------------------------------------------------------------------------------------------- */

/* A thread for each place in the lists, and one more: where lists begin between it and the place before. */
__global__ void __launch_bounds__(BIN_THREADS) find_starts(step_buffers b, uint32_t tile_count)
{
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    if (is_stopped(b.status) || i > b.capacity)
        return;
    const uint32_t end = i < b.capacity ? min(b.tiles[1][i], tile_count) : tile_count;
    for (uint32_t tile = i ? min(b.tiles[1][i - 1], tile_count) + 1 : 0; tile <= end; tile++)
        b.starts[tile] = i;
}

/* Bits of depths, which are above 0; all of them set come last. */
const int DEPTH_BITS = 31;

/* Bits of a tile's number, such that a number with all bits set comes after all tiles. */
inline int tile_bits(uint32_t tile_count)
{
    int bits = 1;
    while (bits < 32 && (1ull << bits) - 1 < tile_count)
        bits++;
    return bits;
}

cudaError_t sort_depths(void *scratch, size_t *bytes, const step_buffers *b, uint32_t count, cudaStream_t stream)
{
    return cub::DeviceRadixSort::SortPairs(scratch, *bytes, b->depths[0], b->depths[1], b->gaussians[0],
                                           b->gaussians[1], count, 0, DEPTH_BITS, stream);
}

/* Replaces the numbers in `bases` by the sums of the numbers before them. */
cudaError_t add_tiles(void *scratch, size_t *bytes, const step_buffers *b, uint32_t count, cudaStream_t stream)
{
    return cub::DeviceScan::ExclusiveScan(scratch, *bytes, b->bases, b->bases, add_saturated(), 0u, count + 1, stream);
}

cudaError_t sort_tiles(void *scratch, size_t *bytes, const step_buffers *b, int bits, cudaStream_t stream)
{
    return cub::DeviceRadixSort::SortPairs(scratch, *bytes, b->tiles[0], b->tiles[1], b->slots[0], b->slots[1],
                                           b->capacity, 0, bits, stream);
}

/* Bytes that the sorts and the sum need. */
size_t bin_scratch(uint32_t gaussians, uint32_t capacity)
{
    size_t bytes[3] = {0, 0, 0}, most = 0;
    step_buffers b;
    memset(&b, 0, sizeof b);
    b.capacity = capacity;
    sort_depths(nullptr, &bytes[0], &b, gaussians, nullptr);
    add_tiles(nullptr, &bytes[1], &b, gaussians, nullptr);
    sort_tiles(nullptr, &bytes[2], &b, 32, nullptr);
    for (size_t own : bytes)
        most = own > most ? own : most;
    return most;
}

cudaError_t launch_bin(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera, cudaStream_t stream)
{
    const uint32_t tile_count = (uint32_t)(camera->tiles_x * camera->tiles_y), count = m->count;
    const uint32_t slots_grid = bin_grid(count > b->capacity ? count : b->capacity);
    size_t bytes = b->scratch_bytes;
    cudaError_t failure = sort_depths(b->scratch, &bytes, b, count, stream);
    count_tiles<<<bin_grid((uint64_t)count + 1), BIN_THREADS, 0, stream>>>(*b, count);
    if (!failure)
        failure = add_tiles(b->scratch, &bytes, b, count, stream);
    if (failure)
        return failure;
    put_slots<<<slots_grid, BIN_THREADS, 0, stream>>>(*b, count, *camera);
    failure = sort_tiles(b->scratch, &bytes, b, tile_bits(tile_count), stream);
    if (failure)
        return failure;
    find_starts<<<bin_grid((uint64_t)b->capacity + 1), BIN_THREADS, 0, stream>>>(*b, tile_count);
    return cudaGetLastError();
}

}

#endif
