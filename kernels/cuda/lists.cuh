/* project, shade and bin: from the packed scene to a list of splats for each tile, in no order yet. */
#ifndef FXS_CUDA_LISTS_CUH
#define FXS_CUDA_LISTS_CUH

#include "stages.cuh"

namespace {

const uint32_t LARGE_BLOCKS = 792;
const int LARGE_ROWS = 8;
const int MASK_TILES = 8;                  /* across and down */

/* Takes a place at counters[i] for each lane with `active`; lanes that share a counter share one atomic. */
__device__ inline uint32_t take_place(uint32_t *counters, uint32_t i, bool active)
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

/* Adds `by` to counters[i] for each lane with `active`. */
__device__ inline void add_at(uint32_t *counters, uint32_t i, uint32_t by, bool active)
{
    const unsigned lanes = __ballot_sync(ALL_LANES, active);
    if (active) {
        const unsigned same = __match_any_sync(lanes, i);
        if (lane_index() == (uint32_t)__ffs((int)same) - 1)
            atomicAdd(&counters[i], by * (uint32_t)__popc(same));
    }
}

/* Shares out `own` items of each lane: calls visit(lane, item of it, active) with all lanes, until all were visited. */
template <class Visit>
__device__ inline void share_out(uint32_t own, Visit visit)
{
    const uint32_t end = warp_sum(own), start = end - own, all = __shfl_sync(ALL_LANES, end, WARP - 1);
    for (uint32_t first = 0; first < all; first += WARP) {
        const uint32_t item = first + lane_index();
        uint32_t lane = 0;
        for (uint32_t step = WARP / 2; step > 0; step /= 2)
            lane += __shfl_sync(ALL_LANES, end, (int)(lane + step - 1)) <= item ? step : 0;
        visit((int)lane, item - __shfl_sync(ALL_LANES, start, (int)lane), item < all);
    }
}

/* The place of the n-th bit, from 0 on. */
__device__ inline uint32_t bit_of(uint64_t mask, uint32_t n)
{
    uint32_t place = 0;
    for (uint32_t step = 32; step > 0; step /= 2) {
        const uint32_t below = (uint32_t)__popcll(mask >> place & (((uint64_t)1 << step) - 1));
        place += below <= n ? step : 0;
        n -= below <= n ? below : 0;
    }
    return place;
}

/* A thread a chunk: where it lies, if anything of it can be seen. */
__global__ void place_chunks(const __grid_constant__ fxs_view view, const __grid_constant__ fxs_scene scene,
                             const __grid_constant__ frame_buffers f)
{
    const uint32_t chunk = blockIdx.x * blockDim.x + threadIdx.x;
    fxs_chunk_view cv;
    const bool visible = chunk < scene.chunk_count && fxs_chunk_view_init(&cv, &view, &scene.chunks[chunk]);
    const uint32_t place = take_place(&f.status->chunks, 0, visible);
    if (visible)
        f.chunk_views[place] = cv;
}

/* A block's splats on their way to tiles. */
struct block_splats {
    fxs_splat splats[FXS_CHUNK];
    fxs_bounds bounds[FXS_CHUNK];
    uint32_t row_ends[FXS_CHUNK];          /* tile rows of the splats up to this one */
    uint8_t masks[FXS_CHUNK][MASK_TILES];
    uint32_t warp_rows[FXS_CHUNK / WARP];
};

/* row_ends, from the tile rows of each thread's splat. Returns those of all. */
__device__ uint32_t place_rows(block_splats *b, uint32_t rows)
{
    const uint32_t sum = warp_sum(rows), warp = threadIdx.x / WARP;
    if (lane_index() == WARP - 1)
        b->warp_rows[warp] = sum;
    __syncthreads();
    uint32_t before = 0, all = 0;
    for (uint32_t i = 0; i < FXS_CHUNK / WARP; i++) {
        before += i < warp ? b->warp_rows[i] : 0;
        all += b->warp_rows[i];
    }
    b->row_ends[threadIdx.x] = before + sum;
    __syncthreads();
    return all;
}

/* The splat that has tile row `item` of the block's. */
__device__ uint32_t splat_of_row(const block_splats *b, uint32_t item)
{
    uint32_t splat = 0;
    for (uint32_t step = FXS_CHUNK / 2; step > 0; step /= 2)
        splat += b->row_ends[splat + step - 1] <= item ? step : 0;
    return splat;
}

__device__ bool is_large(const ellipse *e, const fxs_view *view)
{
    return view->square || e->columns.last - e->columns.first >= MASK_TILES ||
           e->rows.last - e->rows.first >= MASK_TILES;
}

/* The tiles of a tile row, as fxs_bin_c finds them: of an ellipse that is whole on one, all its columns. */
__device__ span tiles_of_row(const ellipse *e, const fxs_view *view, int32_t row)
{
    const fxs_splat *s = e->splat;
    const bool whole = e->rows.first == e->rows.last && s->first_row > 0 && s->last_row < view->height - 1;
    return !view->square && whole && e->columns.last - e->columns.first < 4 ? e->columns : span_of(e, view, row);
}

/* A tile row of a splat a thread: fills in the masks, and adds 1 to counts where its tiles begin, takes it where they
   have ended; place_lists sums up. */
__device__ void count_rows(block_splats *b, const frame_buffers *f, const fxs_view *view, uint32_t items)
{
    for (uint32_t first = 0; first < items; first += FXS_CHUNK) {
        const uint32_t item = first + threadIdx.x;
        uint32_t tile = 0, end = 0;
        bool listed = false, ends = false;
        if (item < items) {
            const uint32_t i = splat_of_row(b, item);
            const ellipse e = ellipse_of(view, &b->splats[i], &b->bounds[i]);
            const int32_t down = (int32_t)(item - (i ? b->row_ends[i - 1] : 0)), row = rows_of(&e, view).first + down;
            const span s = tiles_of_row(&e, view, row);
            listed = s.first <= s.last;
            ends = listed && s.last < view->tiles_x - 1;
            tile = (uint32_t)(row * view->tiles_x + s.first);
            end = (uint32_t)(row * view->tiles_x + s.last + 1);
            if (!is_large(&e, view))
                b->masks[i][down] = listed ? (uint8_t)((2u << (s.last - e.columns.first)) -
                                                       (1u << (s.first - e.columns.first))) : 0;
        }
        add_at(f->counts, tile, 1, listed);
        add_at(f->counts, end, ~0u, ends);
    }
    __syncthreads();
}

/* The mask of a thread's splat, or its place among the large ones. */
__device__ void store_tiles(const block_splats *b, const frame_buffers *f, const fxs_view *view, uint32_t index,
                            bool listed)
{
    const uint32_t i = threadIdx.x;
    uint64_t mask = 0;
    bool large = false;
    if (listed) {
        const ellipse e = ellipse_of(view, &b->splats[i], &b->bounds[i]);
        large = is_large(&e, view);
        for (int32_t row = 0; row <= e.rows.last - e.rows.first && !large; row++)
            mask |= (uint64_t)b->masks[i][row] << 8 * row;
        f->bases[index] = (uint32_t)(e.rows.first * view->tiles_x + e.columns.first);
    }
    f->masks[index] = mask;
    span rows = {0, -1};
    if (large)
        rows = fxs_bin_rows(view, &b->splats[i], &b->bounds[i]);
    const uint32_t records = (uint32_t)(rows.last - rows.first + LARGE_ROWS) / LARGE_ROWS, end = warp_sum(records);
    uint32_t place = 0;
    if (lane_index() == WARP - 1 && end)
        place = atomicAdd(&f->status->larges, end);
    place = __shfl_sync(ALL_LANES, place, WARP - 1) + end - records;
    for (int32_t first = rows.first; first <= rows.last; first += LARGE_ROWS, place++)
        if (place < f->large_capacity)
            f->larges[place] = {b->bounds[i], index, first};
}

/* A block a chunk that can be seen: its splats and colours, their tiles, and the lengths of the lists. */
__global__ void __launch_bounds__(FXS_CHUNK) project_chunk(const __grid_constant__ fxs_view view,
                                                           const __grid_constant__ fxs_scene scene,
                                                           const __grid_constant__ frame_buffers f)
{
    __shared__ block_splats b;
    if (blockIdx.x >= f.status->chunks)
        return;
    const fxs_chunk_view *cv = &f.chunk_views[blockIdx.x];
    const uint32_t chunk = (uint32_t)(cv->chunk - scene.chunks), g = threadIdx.x, index = chunk * FXS_CHUNK + g;
    const fxs_codes codes = fxs_codes_of(&scene, fxs_rows(&scene, chunk), g);
    fxs_splat splat;
    fxs_bounds bounds;
    uint32_t depth, rows = 0;
    const int visible = project_one(&splat, &bounds, &depth, &view, cv, &codes, offset_of_code_q11);
    if (visible) {
        shade_one(&splat, &view, &scene, chunk, g);
        f.splats[index] = b.splats[g] = splat;
        f.depths[index] = depth;
        b.bounds[g] = bounds;
        const span s = fxs_bin_rows(&view, &splat, &bounds);
        rows = s.last < s.first ? 0 : (uint32_t)(s.last - s.first + 1);
    }
    const uint32_t items = place_rows(&b, rows);
    count_rows(&b, &f, &view, items);
    store_tiles(&b, &f, &view, index, rows > 0);
    const int of_block = __syncthreads_count(visible);
    if (g == 0)
        atomicAdd(&f.status->visible, (uint32_t)of_block);
}

/* A warp a tile row: the lengths of its lists, where they start, and their places among those of their magnitude. */
__global__ void place_lists(const __grid_constant__ frame_buffers f, uint32_t tiles_x, uint32_t tiles)
{
    uint32_t carry = 0;
    for (uint32_t first = 0; first < tiles_x; first += WARP) {
        const uint32_t column = first + lane_index(), tile = blockIdx.x * tiles_x + column;
        const bool inside = column < tiles_x;
        const uint32_t along = carry + warp_sum(inside ? f.counts[tile] : 0), count = inside ? along : 0;
        const uint32_t sum = warp_sum(count), magnitude = count ? 31 - (uint32_t)__clz((int)count) : 0;
        carry = __shfl_sync(ALL_LANES, along, WARP - 1);
        unsigned long long start = 0;
        if (lane_index() == WARP - 1 && sum)
            start = atomicAdd((unsigned long long *)&f.status->entries, (unsigned long long)sum);
        start = __shfl_sync(ALL_LANES, start, WARP - 1);
        const uint32_t place = take_place(f.status->classes, magnitude, inside);
        if (inside) {
            f.counts[tile] = count;
            f.next[tile] = (uint32_t)start + sum - count;
            f.classes[magnitude * tiles + place] = tile;
        }
    }
}

/* A warp some rows of a large splat: a tile row a lane, then their tiles shared out. */
__device__ void fill_large(const fxs_view *view, const frame_buffers *f, const large_splat *large)
{
    const ellipse e = ellipse_of(view, &f->splats[large->index], &large->bounds);
    const uint32_t depth = f->depths[large->index];
    const int32_t row = large->first + (int32_t)lane_index();
    span s = {0, -1}, touched = s;
    if (lane_index() < LARGE_ROWS && row <= rows_of(&e, view).last) {
        s = span_of(&e, view, row);
        touched = view->square ? ellipse_span(&e, view, row) : s;
    }
    share_out(s.last < s.first ? 0 : (uint32_t)(s.last - s.first + 1), [&](int lane, uint32_t item, bool active) {
        const int32_t column = __shfl_sync(ALL_LANES, s.first, lane) + (int32_t)item;
        const int32_t touched_first = __shfl_sync(ALL_LANES, touched.first, lane);
        const int32_t touched_last = __shfl_sync(ALL_LANES, touched.last, lane);
        const bool far = column < touched_first || column > touched_last;
        if (active)
            f->entries[atomicAdd(&f->next[(large->first + lane) * view->tiles_x + column], 1u)] =
                FXS_KEY(depth, large->index | (far ? FXS_ENTRY_FAR : 0));
    });
}

/* The entries. The first LARGE_BLOCKS blocks are for large splats, then a block for each chunk that can be seen. */
__global__ void __launch_bounds__(FXS_CHUNK) fill_lists(const __grid_constant__ fxs_view view,
                                                        const __grid_constant__ fxs_scene scene,
                                                        const __grid_constant__ frame_buffers f)
{
    const uint32_t warps = LARGE_BLOCKS * FXS_CHUNK / WARP;
    if (!fits(&f) || blockIdx.x >= LARGE_BLOCKS + f.status->chunks)
        return;
    if (blockIdx.x < LARGE_BLOCKS) {
        for (uint32_t i = (blockIdx.x * FXS_CHUNK + threadIdx.x) / WARP; i < f.status->larges; i += warps)
            fill_large(&view, &f, &f.larges[i]);
        return;
    }
    const uint32_t chunk = (uint32_t)(f.chunk_views[blockIdx.x - LARGE_BLOCKS].chunk - scene.chunks);
    const uint32_t index = chunk * FXS_CHUNK + threadIdx.x, base = f.bases[index], depth = f.depths[index];
    const uint64_t mask = f.masks[index];
    share_out((uint32_t)__popcll(mask), [&](int lane, uint32_t item, bool active) {
        const uint32_t bit = bit_of(__shfl_sync(ALL_LANES, mask, lane), item);
        const uint32_t tile = __shfl_sync(ALL_LANES, base, lane) + bit / MASK_TILES * (uint32_t)view.tiles_x +
                              bit % MASK_TILES;
        const uint32_t key_depth = __shfl_sync(ALL_LANES, depth, lane);
        const uint32_t key_index = index - lane_index() + (uint32_t)lane;
        const uint32_t place = take_place(f.next, tile, active);
        if (active)
            f.entries[place] = FXS_KEY(key_depth, key_index);
    });
}

}

#endif
