/* Fills the list of splats (projected Gaussians) of each tile of 16x16 pixels, unsorted. A thread block projects and
 * shades one chunk of 256 packed Gaussians. If a frame has one object without scale, crop and tint, its view and scene
 * are kernel parameters. Otherwise the template parameter Many is true, and the objects are in device memory. With a
 * moving scene among the objects, Moving is true too, and the Gaussians of such scenes are first moved to the frame's
 * moment. */
#ifndef FXS_CUDA_LISTS_CUH
#define FXS_CUDA_LISTS_CUH

#include <cuda/ptx>
#include <cuda_pipeline_primitives.h>

#include "pool.cuh"
#include "stages.cuh"

namespace {

const uint32_t LARGE_BLOCKS = 792;
const int LARGE_ROWS = 8;
const int BOX_COLUMNS = 6, BOX_ROWS = 7, BOX_TILES = BOX_COLUMNS * BOX_ROWS;
const uint32_t CHUNK_BYTES_MOST = FXS_ROW_SH + 3 * FXS_SH_COUNT(3) * FXS_CHUNK;     /* without the rows of motion */
const uint32_t MOTION_BYTES_MOST = (3 * 2 * FXS_MOTION_DEGREE + 4 * 2 + 2 * 2) * FXS_CHUNK;

__device__ inline int place_in_object(fxs_chunk_view *cv, const fxs_object_view *object, uint32_t chunk,
                                      uint32_t grow_q8)
{
    fxs_stage_view view = object->view;
    fxs_chunk header;
    if (!object->visible)
        return 0;
    view.grow_q16 = (int32_t)grow_q8 << 8;
    const int seen = fxs_chunk_view_init(cv, &view, &object->scene, chunk);
    if (seen <= 0 || !object->crop_count)
        return seen;
    const int error = fxs_chunk_read(&header, &object->scene, chunk);
    return error ? error : fxs_object_has_chunk(object, &header);
}

/* Stores the chunks (256 Gaussians each) that the camera sees, transformed to camera space. Sets status->damaged for an
   invalid chunk header. */
template <bool Many>
__global__ void locate_chunks(const __grid_constant__ fxs_stage_view view, const __grid_constant__ fxs_scene scene,
                              const __grid_constant__ frame_buffers f, uint32_t chunks)
{
    const uint32_t at = blockIdx.x * blockDim.x + threadIdx.x;
    fxs_chunk_view cv;
    uint32_t object = 0;
    int seen = 0;
    wait_for_last_kernel();
    if (Many && f.drawn_count)
        chunks = *f.drawn_count;
    if (Many && at < chunks) {
        const uint32_t chunk = chunk_at(&f, at);
        object = fxs_object_of(f.objects, f.object_count, chunk);
        seen = place_in_object(&cv, &f.objects[object], chunk - f.objects[object].first_chunk,
                               f.drawn ? f.drawn[at].grow_q8 : 0);
        cv.chunk = at;
    } else if (at < chunks) {
        seen = fxs_chunk_view_init(&cv, &view, &scene, at);
    }
    if (seen < 0)
        f.status->damaged = 1;
    const uint32_t place = take_number(&f.status->chunks, 0, seen > 0);
    if (seen > 0)
        f.chunk_views[place] = cv;
    if (Many && seen > 0) {
        const fxs_object_view *o = &f.objects[object];
        f.chunk_objects[place] = object;
        keep_place(&o->scene, chunk_at(&f, at) - o->first_chunk, f.number);
    }
}

/* Packs the set of tiles that a small splat touches. Bit BOX_COLUMNS r + c of `mask` stands for the tile with the
   number base + r tiles_x + c. */
__device__ inline uint64_t box_of(uint32_t base, uint64_t mask)
{
    return (uint64_t)base << BOX_TILES | mask;
}

__device__ inline uint64_t box_mask(uint64_t box)
{
    return box & (((uint64_t)1 << BOX_TILES) - 1);
}

struct block_splats {
    alignas(64) unsigned char rows[CHUNK_BYTES_MOST];
    alignas(16) fxs_chunk header;
    alignas(16) fxs_chunk_view view;
    uint64_t arrived[2];
    fxs_splat splats[FXS_CHUNK];
    fxs_bounds bounds[FXS_CHUNK];
    uint32_t row_ends[FXS_CHUNK];          /* inclusive prefix sum of the numbers of tile rows that the splats cover */
    uint8_t masks[FXS_CHUNK][BOX_ROWS];
    uint32_t warp_rows[FXS_CHUNK / WARP];
};

struct moving_splats : block_splats {
    alignas(64) unsigned char motion[MOTION_BYTES_MOST];
};

template <bool Moving>
using splats_of_block = typename std::conditional<Moving, moving_splats, block_splats>::type;

__device__ inline void fetch_bytes(block_splats *b, uint32_t part, void *to, const void *from, uint32_t bytes)
{
#if __CUDA_ARCH__ >= 900
    if (bytes)
        cuda::ptx::cp_async_bulk(cuda::ptx::space_cluster, cuda::ptx::space_global, to, from, bytes,
                                 &b->arrived[part]);
#else
    for (uint32_t at = 16 * threadIdx.x; at < bytes; at += 16 * FXS_CHUNK)
        __pipeline_memcpy_async((unsigned char *)to + at, (const unsigned char *)from + at, 16);
#endif
}

/* The rows of motion of a chunk, which are behind its other rows, and their place in shared memory. */
struct motion_part {
    unsigned char *to;
    uint32_t bytes;
};

/* Starts to copy a chunk of Gaussians to shared memory: part 1 is the spherical harmonics, part 0 the rest. `bytes` are
   those of the rows without motion. From compute capability 9.0 on, one thread issues bulk copies; before, all threads
   copy. */
__device__ inline void fetch_chunk(block_splats *b, const fxs_chunk_view *view, const unsigned char *header,
                                   const unsigned char *rows, uint32_t bytes, motion_part motion)
{
    static_assert(sizeof b->view % 16 == 0 && sizeof b->header % 16 == 0, "copied by 16 bytes");
    const uint32_t early = bytes < FXS_ROW_SH ? bytes : FXS_ROW_SH;
#if __CUDA_ARCH__ >= 900
    if (threadIdx.x > 0)
        return;
    const uint32_t parts[2] = {early + motion.bytes + (uint32_t)(sizeof b->view + sizeof b->header), bytes - early};
    for (uint32_t part = 0; part < 2; part++) {
        cuda::ptx::mbarrier_init(&b->arrived[part], 1);
        cuda::ptx::fence_proxy_async(cuda::ptx::space_shared);
        cuda::ptx::mbarrier_arrive_expect_tx(cuda::ptx::sem_release, cuda::ptx::scope_cta, cuda::ptx::space_shared,
                                             &b->arrived[part], parts[part]);
    }
#endif
    fetch_bytes(b, 0, &b->view, view, sizeof b->view);
    fetch_bytes(b, 0, &b->header, header, sizeof b->header);
    fetch_bytes(b, 0, b->rows, rows, early);
    fetch_bytes(b, 0, motion.to, rows + bytes, motion.bytes);
    __pipeline_commit();
    fetch_bytes(b, 1, b->rows + early, rows + early, bytes - early);
    __pipeline_commit();
}

__device__ inline void await_part(block_splats *b, uint32_t part)
{
#if __CUDA_ARCH__ >= 900
    if (part == 0)
        __syncthreads();                   /* makes the initialised memory barriers visible to all threads */
    while (!cuda::ptx::mbarrier_try_wait_parity(&b->arrived[part], 0)) {
    }
#else
    if (part == 0)
        __pipeline_wait_prior(1);
    else
        __pipeline_wait_prior(0);
    __syncthreads();
#endif
}

/* Moves the codes of Gaussian g of a visible chunk to the frame's moment, if its scene moves. `rows` are the chunk's
   rows of motion. */
__device__ inline void move_codes(fxs_codes *codes, const frame_buffers *f, const fxs_object_view *object,
                                  const fxs_chunk_view *cv, const unsigned char *rows, uint32_t g)
{
    const fxs_moment moment = f->drawn[cv->chunk].moment;
    fxs_motion_rows motion = object->motion;
    motion.at = 0;
    if (moment.moves)
        fxs_animate_codes(codes, &motion, rows, g, &moment, object->scene.profile, cv->scale_step_q24);
}

/* Sets row_ends to the inclusive prefix sum of the numbers of tile rows that the threads' splats cover. Returns the
   total number of rows. */
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

__device__ uint32_t splat_of_row(const block_splats *b, uint32_t item)
{
    uint32_t splat = 0;
    for (uint32_t step = FXS_CHUNK / 2; step > 0; step /= 2)
        splat += b->row_ends[splat + step - 1] <= item ? step : 0;
    return splat;
}

__device__ bool is_large(const ellipse *e, const fxs_stage_view *view)
{
    return view->cutoff == FXS_CUTOFF_SQUARE || e->columns.last - e->columns.first >= BOX_COLUMNS ||
           e->rows.last - e->rows.first >= BOX_ROWS;
}

/* Returns true for a splat on one tile row and at most 4 tiles that the picture's upper and lower edges do not cut. */
__device__ bool is_whole(const ellipse *e, const fxs_stage_view *view)
{
    return view->cutoff != FXS_CUTOFF_SQUARE && e->rows.first == e->rows.last && e->splat->first_row > 0 &&
           e->splat->last_row < view->height - 1 && e->columns.last - e->columns.first < 4;
}

/* Counts a splat in consecutive tiles of a row: adds 1 at the first tile and -1 after the last. The kernel start_lists
   later sums these differences along each row. */
__device__ void count_tiles(const frame_buffers *f, const fxs_stage_view *view, int32_t row, span s)
{
    const bool listed = s.first <= s.last;
    const uint32_t first = (uint32_t)(row * view->tiles_x + s.first), end = first + (uint32_t)(s.last + 1 - s.first);
    add_at(&f->lists->count, number_of(f, first), 1, listed);
    add_at(&f->lists->count, number_of(f, end), ~0u, listed && s.last < view->tiles_x - 1);
}

__device__ uint32_t mask_of_span(span s, int32_t first_column)
{
    return s.first <= s.last ? (2u << (s.last - first_column)) - (1u << (s.first - first_column)) : 0;
}

__device__ void count_rows(block_splats *b, const frame_buffers *f, const fxs_stage_view *view, uint32_t items)
{
    for (uint32_t first = 0; first < items; first += FXS_CHUNK) {
        const uint32_t item = first + threadIdx.x;
        span s = {0, -1};
        int32_t row = 0;
        if (first + threadIdx.x - lane_index() >= items)
            break;
        if (item < items) {
            const uint32_t i = splat_of_row(b, item);
            ellipse e = ellipse_of(view, &b->splats[i], &b->bounds[i]);
            add_radius(&e, view);
            const int32_t down = (int32_t)(item - (i ? b->row_ends[i - 1] : 0));
            row = fxs_bin_rows(view, e.splat, e.bounds).first + down;
            s = span_of(&e, view, row);
            if (!is_large(&e, view))
                b->masks[i][down] = (uint8_t)mask_of_span(s, e.columns.first);
        }
        count_tiles(f, view, row, s);
    }
    __syncthreads();
}

__device__ void store_large(const frame_buffers *f, const fxs_bounds *bounds, uint32_t index, span rows)
{
    const uint32_t records = (uint32_t)(rows.last - rows.first + LARGE_ROWS) / LARGE_ROWS, end = warp_sum(records);
    uint32_t place = 0;
    if (lane_index() == WARP - 1 && end)
        place = atomicAdd(&f->status->larges, end);
    place = __shfl_sync(ALL_LANES, place, WARP - 1) + end - records;
    for (int32_t first = rows.first; first <= rows.last; first += LARGE_ROWS, place++)
        if (place < f->large_capacity)
            f->larges[place] = {*bounds, index, first};
}

__device__ void list_splats(block_splats *b, const frame_buffers *f, const fxs_stage_view *view, uint32_t index,
                            const ellipse *e, bool visible)
{
    const span none = {0, -1};
    const bool whole = visible && is_whole(e, view);
    span rows = none;
    if (visible && !whole) {
        b->splats[threadIdx.x] = *e->splat;
        b->bounds[threadIdx.x] = *e->bounds;
        rows = fxs_bin_rows(view, e->splat, e->bounds);
    }
    count_tiles(f, view, whole ? e->rows.first : 0, whole ? e->columns : none);
    count_rows(b, f, view, place_rows(b, rows.last < rows.first ? 0 : (uint32_t)(rows.last - rows.first + 1)));
    const bool large = rows.first <= rows.last && is_large(e, view);
    uint64_t mask = whole ? mask_of_span(e->columns, e->columns.first) : 0;
    for (int32_t row = rows.first; row <= rows.last && !large; row++)
        mask |= (uint64_t)b->masks[threadIdx.x][row - rows.first] << BOX_COLUMNS * (row - rows.first);
    f->boxes[index] = mask ? box_of((uint32_t)(e->rows.first * view->tiles_x + e->columns.first), mask) : 0;
    store_large(f, e->bounds, index, large ? rows : none);
}

template <bool Many, bool Moving>
__global__ void __launch_bounds__(FXS_CHUNK, 4) project_chunk(const __grid_constant__ fxs_stage_view view,
                                                              const __grid_constant__ fxs_scene only_scene,
                                                              const __grid_constant__ frame_buffers f)
{
    __shared__ splats_of_block<Moving> b;
    wait_for_last_kernel();
    const fxs_chunk_view *cv = &f.chunk_views[blockIdx.x];
    const uint32_t place = cv->chunk;      /* this value is loaded before the test below, so that both loads overlap */
    if (blockIdx.x >= f.status->chunks)
        return;
    const fxs_object_view *object = Many ? &f.objects[f.chunk_objects[blockIdx.x]] : nullptr;
    const fxs_scene *scene = Many ? &object->scene : &only_scene;
    const fxs_stage_view *camera = Many ? &object->view : &view;
    const uint32_t chunk = Many ? chunk_at(&f, place) - object->first_chunk : place, g = threadIdx.x;
    const uint32_t index = place * FXS_CHUNK + g;
    const uint32_t share_q8 = Many && f.drawn ? f.drawn[place].share_q8 : 256;
    const unsigned char *rows = (const unsigned char *)__builtin_assume_aligned(b.rows, 64);
    motion_part motion = {nullptr, 0};
    if constexpr (Moving)
        motion = {b.motion, object->motion.at ? scene->chunk_bytes - object->motion.at : 0};
    fetch_chunk(&b, cv, fxs_header(scene, chunk), Many ? rows_of(scene, chunk) : fxs_rows(scene, chunk),
                scene->chunk_bytes - motion.bytes, motion);
    await_part(&b, 0);
    fxs_codes codes = fxs_codes_of(scene, rows, g);
    if constexpr (Moving)
        move_codes(&codes, &f, object, &b.view, b.motion, g);
    const uint32_t offset_q11 = offset_of_code_q11[b.view.opacity_law][codes.colour >> 24];
    fxs_splat splat;
    fxs_bounds bounds;
    uint32_t depth;
    bool visible = project_one(&splat, &bounds, &depth, camera, &b.view, scene->profile, &codes,
                               fxs_share_of_q11(offset_q11, share_q8));
    if (Many && visible && !object->plain)
        visible = fxs_object_change(object, &b.header, codes.position, &depth);
    await_part(&b, 1);
    ellipse e;
    if (visible) {
        if (Moving)
            shade_codes(&splat, camera, scene, &b.header, rows, g, &codes);
        else
            shade_one(&splat, camera, scene, &b.header, rows, g);
        if (Many)
            fxs_object_tint(object, &splat);
        f.depths[index] = depth;
        store_splat(&f.splats[index], splat);
        e = ellipse_of(&view, &splat, &bounds);
    }
    list_splats(&b, &f, &view, index, &e, visible);
    const int of_block = __syncthreads_count(visible);
    if (g == 0)
        atomicAdd(&f.status->visible, (uint32_t)of_block);
}

const uint32_t START_ROWS = 8;

struct started {
    uint32_t classes[WARP], class_entries[WARP], first[WARP];
    uint64_t sums[START_ROWS];
};

template <class Visit>
__device__ inline void visit_row(const frame_buffers *f, uint32_t row, uint32_t tiles_x, Visit visit)
{
    const uint32_t first = row * tiles_x;
    uint32_t next = lane_index() < tiles_x ? list_of(f, first + lane_index())->count : 0;
    for (uint32_t column = lane_index(); column - lane_index() < tiles_x; column += WARP) {
        const uint32_t x = next;
        next = column + WARP < tiles_x ? list_of(f, first + column + WARP)->count : 0;
        visit(first + column, x, column < tiles_x);
    }
}

/* Computes the length and start of each tile's list of splats, and sorts the tiles by floor(log2(length)). */
__global__ void __launch_bounds__(START_ROWS *WARP) start_lists(const __grid_constant__ frame_buffers f,
                                                                uint32_t tiles_x, uint32_t tiles_y)
{
    __shared__ started s;
    wait_for_last_kernel();
    const uint32_t warp = threadIdx.x / WARP, row = blockIdx.x * START_ROWS + warp;
    if (warp == 0)
        s.classes[lane_index()] = s.class_entries[lane_index()] = 0;
    __syncthreads();
    uint32_t carry = 0;
    uint64_t sum = 0;
    if (row < tiles_y)
        visit_row(&f, row, tiles_x, [&](uint32_t tile, uint32_t difference, bool inside) {
            const uint32_t along = carry + warp_sum(difference), magnitude = list_magnitude(along);
            const uint32_t place = take_number(s.classes, magnitude, inside);
            carry = __shfl_sync(ALL_LANES, along, WARP - 1);
            if (!inside)
                return;
            atomicAdd(&s.class_entries[magnitude], along);
            *list_of(&f, tile) = {along, place};
            sum += along;
        });
    sum = __shfl_sync(ALL_LANES, warp_sum(sum), WARP - 1);
    s.sums[warp] = sum;
    __syncthreads();
    if (warp == 0) {
        const uint32_t lane = lane_index();
        const uint64_t of_row = lane < START_ROWS ? s.sums[lane] : 0, end = warp_sum(of_row);
        unsigned long long start = 0;
        if (lane == START_ROWS - 1)
            start = atomicAdd((unsigned long long *)&f.status->entries, (unsigned long long)end);
        start = __shfl_sync(ALL_LANES, start, START_ROWS - 1);
        if (lane < START_ROWS)
            s.sums[lane] = start + end - of_row;
        s.first[lane] = s.classes[lane] ? atomicAdd(&f.status->classes[lane], s.classes[lane]) : 0;
        if (s.class_entries[lane])
            atomicAdd(&f.status->class_entries[lane], s.class_entries[lane]);
    }
    __syncthreads();
    uint64_t start = s.sums[warp];
    if (row < tiles_y)
        visit_row(&f, row, tiles_x, [&](uint32_t tile, uint32_t count, bool inside) {
            const uint64_t end = start + warp_sum((uint64_t)count);
            const uint32_t magnitude = list_magnitude(count);
            start = __shfl_sync(ALL_LANES, end, WARP - 1);
            if (!inside)
                return;
            f.classes[magnitude * tiles_x * tiles_y + s.first[magnitude] + list_of(&f, tile)->next] = tile;
            list_of(&f, tile)->next = (uint32_t)(end - count);
        });
}

/* Enters one large splat into the lists of the tiles that it touches. A whole warp runs this function. */
__device__ void fill_large(const fxs_stage_view *view, const frame_buffers *f, const large_splat *large)
{
    ellipse e = ellipse_of(view, &f->splats[large->index], &large->bounds);
    add_radius(&e, view);
    const uint32_t depth = f->depths[large->index];
    const int32_t row = large->first + (int32_t)lane_index();
    span s = {0, -1}, touched = s;
    if (lane_index() < LARGE_ROWS && row <= fxs_bin_rows(view, e.splat, e.bounds).last) {
        s = span_of(&e, view, row);
        touched = view->cutoff == FXS_CUTOFF_SQUARE ? ellipse_span(&e, view, row) : s;
    }
    share_out(s.last < s.first ? 0 : (uint32_t)(s.last - s.first + 1), [&](int lane, uint32_t item, bool active) {
        const int32_t column = __shfl_sync(ALL_LANES, s.first, lane) + (int32_t)item;
        const int32_t touched_first = __shfl_sync(ALL_LANES, touched.first, lane);
        const int32_t touched_last = __shfl_sync(ALL_LANES, touched.last, lane);
        const bool cut_off = column < touched_first || column > touched_last;
        if (active)
            f->entries[atomicAdd(&list_of(f, (uint32_t)((large->first + lane) * view->tiles_x + column))->next, 1u)] =
                FXS_KEY(depth, large->index | (cut_off ? FXS_ENTRY_CUT_OFF : 0));
    });
}

/* Enters all splats into the lists of their tiles. The first LARGE_BLOCKS thread blocks take the large splats. */
__global__ void __launch_bounds__(FXS_CHUNK) fill_lists(const __grid_constant__ fxs_stage_view view,
                                                        const __grid_constant__ frame_buffers f)
{
    const uint32_t warps = LARGE_BLOCKS * FXS_CHUNK / WARP;
    wait_for_last_kernel();
    if (!fits(&f) || blockIdx.x >= LARGE_BLOCKS + f.status->chunks)
        return;
    if (blockIdx.x < LARGE_BLOCKS) {
        for (uint32_t i = (blockIdx.x * FXS_CHUNK + threadIdx.x) / WARP; i < f.status->larges; i += warps)
            fill_large(&view, &f, &f.larges[i]);
        return;
    }
    const uint32_t chunk = f.chunk_views[blockIdx.x - LARGE_BLOCKS].chunk;
    const uint32_t index = chunk * FXS_CHUNK + threadIdx.x, depth = f.depths[index];
    const uint64_t box = f.boxes[index];
    share_out((uint32_t)__popcll(box_mask(box)), [&](int lane, uint32_t item, bool active) {
        const uint64_t of_lane = __shfl_sync(ALL_LANES, box, lane);
        const uint32_t bit = bit_of(box_mask(of_lane), item);
        const uint32_t tile = (uint32_t)(of_lane >> BOX_TILES) + bit / BOX_COLUMNS * (uint32_t)view.tiles_x +
                              bit % BOX_COLUMNS;
        const uint32_t key_depth = __shfl_sync(ALL_LANES, depth, lane);
        const uint32_t key_index = index - lane_index() + (uint32_t)lane;
        const uint32_t place = take_number(&f.lists->next, number_of(&f, tile), active);
        if (active)
            f.entries[place] = FXS_KEY(key_depth, key_index);
    });
}

}

#endif
