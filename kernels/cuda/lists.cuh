/* project, shade, bin and sort: from the packed scene to a sorted list for each tile. */
#ifndef FXS_CUDA_LISTS_CUH
#define FXS_CUDA_LISTS_CUH

#include "stages.cuh"

namespace {

const uint32_t SORT_THREADS = 256, SORT_KEYS = 2048;
const uint32_t PLACE_THREADS = 1024, LENGTH_CLASSES = 64;

/* One splat that does not fit in 8x8 tiles, for a warp. */
struct large_splat {
    fxs_splat splat;
    fxs_bounds bounds;
};

/* Calls visit(tile, far) for every tile of a splat; each lane has tile rows of its own. */
template <class Visit>
__device__ void visit_tiles(const fxs_view *view, const large_splat *large, Visit visit)
{
    const ellipse e = ellipse_of(view, &large->splat, &large->bounds);
    const span rows = rows_of(&e, view);
    for (int32_t row = rows.first + (int32_t)lane_index(); row <= rows.last; row += WARP) {
        span s = span_of(&e, view, row), touched = view->square ? ellipse_span(&e, view, row) : s;
        for (int32_t column = s.first; column <= s.last; column++)
            visit((uint32_t)(row * view->tiles_x + column), column < touched.first || column > touched.last);
    }
}

template <class Visit>
__device__ void visit_mask(const fxs_view *view, uint32_t base, uint64_t mask, Visit visit)
{
    for (; mask; mask &= mask - 1) {
        uint32_t bit = (uint32_t)__ffsll((long long)mask) - 1;
        visit(base + bit / 8 * (uint32_t)view->tiles_x + bit % 8);
    }
}

/* The tiles of a splat as a mask over 8x8 tiles from *base on, or 0 and one of the special bases. */
__device__ uint64_t tiles_of(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds, uint32_t *base)
{
    const ellipse e = ellipse_of(view, splat, bounds);
    uint64_t mask = 0;
    *base = BASE_LARGE;
    if (view->square || e.columns.last - e.columns.first > 7 || e.rows.last - e.rows.first > 7)
        return 0;
    *base = BASE_NONE;
    if (e.columns.first > e.columns.last)
        return 0;
    *base = (uint32_t)(e.rows.first * view->tiles_x + e.columns.first);
    for (int32_t row = e.rows.first; row <= e.rows.last; row++) {
        span s = ellipse_span(&e, view, row);
        if (s.first <= s.last)
            mask |= (uint64_t)((2u << (s.last - e.columns.first)) - (1u << (s.first - e.columns.first)))
                    << 8 * (row - e.rows.first);
    }
    return mask;
}

/* A block of 256 threads a chunk: its splats, colours and tiles, and the lengths of the tiles' lists. */
__global__ void __launch_bounds__(FXS_CHUNK) project_chunk(const __grid_constant__ fxs_view view,
                                                           const __grid_constant__ fxs_scene scene,
                                                           const __grid_constant__ frame_buffers f)
{
    __shared__ fxs_chunk_view cv;
    __shared__ large_splat of_warp[FXS_CHUNK / WARP];
    const uint32_t chunk = blockIdx.x, g = threadIdx.x, index = chunk * FXS_CHUNK + g;
    if (g == 0) {
        if (!fxs_chunk_view_init(&cv, &view, &scene.chunks[chunk]))
            cv.chunk = 0;
        f.chunk_views[chunk] = cv;
    }
    __syncthreads();
    if (!cv.chunk)
        return;

    const fxs_codes codes = fxs_codes_of(&scene, fxs_rows(&scene, chunk), g);
    large_splat s;
    uint32_t base = BASE_NONE, depth;
    uint64_t mask = 0;
    const int visible = project_one(&s.splat, &s.bounds, &depth, &view, &cv, &codes, offset_of_code_q11);
    if (visible) {
        mask = tiles_of(&view, &s.splat, &s.bounds, &base);
        shade_one(&s.splat, &view, &scene, chunk, g);
        f.splats[index] = s.splat;
        f.depths[index] = depth;
    }
    f.masks[index] = mask;
    f.bases[index] = base;
    visit_mask(&view, base, mask, [&](uint32_t tile) { atomicAdd(&f.counts[tile], 1u); });

    large_splat *shared = &of_warp[g / WARP];
    for (unsigned large = __ballot_sync(ALL_LANES, base == BASE_LARGE); large; large &= large - 1) {
        if (lane_index() == (uint32_t)__ffs((int)large) - 1)
            *shared = s;
        __syncwarp();
        visit_tiles(&view, shared, [&](uint32_t tile, bool) { atomicAdd(&f.counts[tile], 1u); });
        __syncwarp();
    }
    const int of_block = __syncthreads_count(visible);
    if (g == 0)
        atomicAdd(&f.status->visible, (uint32_t)of_block);
}

/* Longer lists have higher classes: two for each power of 2. */
__device__ uint32_t length_class(uint32_t count)
{
    if (count < 2)
        return count;
    const int log2 = 31 - __clz((int)count);
    return (uint32_t)(2 * log2 + (int)(count >> (log2 - 1) & 1));
}

/* Adds 1 to counters[i] for each lane with `active`; returns what a lane finds there. */
__device__ uint32_t take_place(uint32_t *counters, uint32_t i, bool active)
{
    const unsigned lanes = __ballot_sync(ALL_LANES, active), lane = lane_index();
    uint32_t place = 0;
    if (active) {
        const unsigned same = __match_any_sync(lanes, i), leader = (unsigned)__ffs((int)same) - 1;
        if (lane == leader)
            place = atomicAdd(&counters[i], (uint32_t)__popc(same));
        place = __shfl_sync(same, place, (int)leader) + (uint32_t)__popc(same & ((1u << lane) - 1));
    }
    return place;
}

/* Room for `count` entries, of all lanes together; returns where those of this lane start. */
__device__ uint64_t take_room(unsigned long long *used, uint32_t count)
{
    uint32_t sum = count;
    for (int d = 1; d < (int)WARP; d *= 2) {
        uint32_t below = __shfl_up_sync(ALL_LANES, sum, (unsigned)d);
        sum += lane_index() >= (uint32_t)d ? below : 0;
    }
    unsigned long long start = 0;
    if (lane_index() == WARP - 1)
        start = atomicAdd(used, (unsigned long long)sum);
    return __shfl_sync(ALL_LANES, start, WARP - 1) + sum - count;
}

/* One block: where each tile's list starts, and the order of the tiles. */
__global__ void __launch_bounds__(PLACE_THREADS) place_lists(const __grid_constant__ frame_buffers f, uint32_t tiles)
{
    __shared__ uint32_t places[LENGTH_CLASSES];
    __shared__ unsigned long long used;
    const uint32_t padded = (tiles + PLACE_THREADS - 1) / PLACE_THREADS * PLACE_THREADS;
    if (threadIdx.x < LENGTH_CLASSES)
        places[threadIdx.x] = 0;
    if (threadIdx.x == 0)
        used = 0;
    __syncthreads();
    for (uint32_t tile = threadIdx.x; tile < padded; tile += PLACE_THREADS) {
        uint32_t count = tile < tiles ? f.counts[tile] : 0;
        uint64_t start = take_room(&used, count);
        take_place(places, length_class(count), tile < tiles);
        if (tile < tiles)
            f.next[tile] = (uint32_t)start;
    }
    __syncthreads();
    if (threadIdx.x == 0) {
        f.status->entries = used;
        for (uint32_t i = LENGTH_CLASSES, start = 0; i-- > 0;) {
            uint32_t size = places[i];
            places[i] = start;
            start += size;
        }
    }
    __syncthreads();
    for (uint32_t tile = threadIdx.x; tile < padded; tile += PLACE_THREADS) {
        uint32_t place = take_place(places, length_class(tile < tiles ? f.counts[tile] : 0), tile < tiles);
        if (tile < tiles)
            f.order[place] = tile;
    }
}

__device__ bool fits(const frame_buffers *f)
{
    return f->status->entries <= f->capacity;
}

__device__ void append(const frame_buffers *f, uint32_t tile, uint32_t depth, uint32_t index)
{
    f->entries[atomicAdd(&f->next[tile], 1u)] = FXS_KEY(depth, index);
}

/* A block a chunk: the entries of its splats, in any order. */
__global__ void __launch_bounds__(FXS_CHUNK) fill_lists(const __grid_constant__ fxs_view view,
                                                        const __grid_constant__ fxs_scene scene,
                                                        const __grid_constant__ frame_buffers f)
{
    __shared__ large_splat of_warp[FXS_CHUNK / WARP];
    const uint32_t chunk = blockIdx.x, g = threadIdx.x, index = chunk * FXS_CHUNK + g;
    const fxs_chunk_view *cv = &f.chunk_views[chunk];
    if (!cv->chunk || !fits(&f))
        return;
    const uint32_t base = f.bases[index];
    uint32_t depth = f.depths[index];
    visit_mask(&view, base, f.masks[index], [&](uint32_t tile) { append(&f, tile, depth, index); });

    large_splat *shared = &of_warp[g / WARP];
    for (unsigned large = __ballot_sync(ALL_LANES, base == BASE_LARGE); large; large &= large - 1) {
        const int lane = __ffs((int)large) - 1;
        if (lane_index() == (uint32_t)lane) {
            const fxs_codes codes = fxs_codes_of(&scene, fxs_rows(&scene, chunk), g);
            project_one(&shared->splat, &shared->bounds, &depth, &view, cv, &codes, offset_of_code_q11);
        }
        __syncwarp();
        const uint32_t key_depth = __shfl_sync(ALL_LANES, depth, lane), key_index = __shfl_sync(ALL_LANES, index, lane);
        visit_tiles(&view, shared, [&](uint32_t tile, bool far) {
            append(&f, tile, key_depth, key_index | (far ? FXS_ENTRY_FAR : 0));
        });
        __syncwarp();
    }
}

/* Puts keys[i] and keys[j] in order, where there is a j; i < j. */
__device__ void order_pair(uint64_t *keys, uint32_t count, uint32_t i, uint32_t j)
{
    if (j >= count)
        return;
    const uint64_t a = keys[i], b = keys[j];
    if (b < a) {
        keys[i] = b;
        keys[j] = a;
    }
}

/* The pairs (i, i + half) of blocks of 2 half keys, or, to begin a merge, (i, its mirror image). */
__device__ void order_pairs(uint64_t *keys, uint32_t count, uint32_t half, bool mirrored)
{
    const uint32_t pairs = (count + 2 * half - 1) / (2 * half) * half;
    for (uint32_t pair = threadIdx.x; pair < pairs; pair += SORT_THREADS) {
        const uint32_t i = pair / half * 2 * half + pair % half;
        order_pair(keys, count, i, mirrored ? i ^ (2 * half - 1) : i + half);
    }
    __syncthreads();
}

/* A bitonic sort (Batcher 1968) all of whose comparisons point up, so that keys beyond the count need not be there. */
__device__ void sort_keys(uint64_t *keys, uint32_t count, uint32_t sorted)
{
    for (uint32_t size = sorted; size < count; size *= 2) {
        order_pairs(keys, count, size, true);
        for (uint32_t half = size / 2; half > 0; half /= 2)
            order_pairs(keys, count, half, false);
    }
}

/* A block a tile: sorts its list, near to far, equal depths by index. */
__global__ void __launch_bounds__(SORT_THREADS) sort_lists(const __grid_constant__ frame_buffers f)
{
    __shared__ uint64_t shared[SORT_KEYS];
    const uint32_t tile = f.order[blockIdx.x], count = f.counts[tile];
    if (count < 2 || !fits(&f))
        return;
    uint64_t *list = f.entries + (f.next[tile] - count);
    for (uint32_t first = 0; first < count; first += SORT_KEYS) {
        const uint32_t part = min(count - first, SORT_KEYS);
        for (uint32_t i = threadIdx.x; i < part; i += SORT_THREADS)
            shared[i] = list[first + i];
        __syncthreads();
        sort_keys(shared, part, 1);
        for (uint32_t i = threadIdx.x; i < part; i += SORT_THREADS)
            list[first + i] = shared[i];
        __syncthreads();
    }
    sort_keys(list, count, SORT_KEYS);
}

}

#endif
