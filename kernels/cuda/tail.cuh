/* Draws a frame whose tile lists do not fit in memory: the kernel finish_tiles, the last kernel of each frame. If the
 * lists fit, it returns at once.
 *
 * First, warps find the tiles that each visible chunk of 256 splats covers. Then each group of threads draws one tile
 * after another. It finds the tile's splats in the chunks that cover the tile. In ascending order of depth, it sorts
 * and blends as many splats as fit into shared memory, until the tile is opaque or no splat is left. The keys of the
 * tile's splats are kept in the group's part of the memory for tile lists. If they do not fit there, they are found
 * anew for each batch. Large splats are projected again, as the frame may have lost some of their records. */
#ifndef FXS_CUDA_TAIL_CUH
#define FXS_CUDA_TAIL_CUH

#include "blend.cuh"
#include "lists.cuh"

namespace {

const uint32_t FINISH_GROUPS = 4;          /* largest number of groups in a thread block */
const uint64_t LARGE_BOX = (uint64_t)1 << 63;      /* marks an element of `boxes` that holds the rectangle of tiles of a
                                                      large splat */
const int RECT_BITS = 15;

struct tile_rect {
    uint32_t left, top, right, bottom;     /* first and last column and row of tiles; left > right: none */

    __device__ uint64_t packed() const
    {
        return left | (uint64_t)top << RECT_BITS | (uint64_t)right << 2 * RECT_BITS |
               (uint64_t)bottom << 3 * RECT_BITS;
    }

    __device__ bool has(uint32_t column, uint32_t row) const
    {
        return left <= column && column <= right && top <= row && row <= bottom;
    }
};

__device__ inline tile_rect rect_of_packed(uint64_t bits)
{
    const uint32_t most = (1u << RECT_BITS) - 1;
    return {(uint32_t)bits & most, (uint32_t)(bits >> RECT_BITS) & most, (uint32_t)(bits >> 2 * RECT_BITS) & most,
            (uint32_t)(bits >> 3 * RECT_BITS) & most};
}

/* Returns the rectangle of tiles that an element of `boxes` covers. */
__device__ inline tile_rect rect_of_box(uint64_t box, uint32_t tiles_x)
{
    const uint64_t mask = box_mask(box);
    const uint32_t first = (uint32_t)(box >> BOX_TILES), left = first % tiles_x, top = first / tiles_x;
    uint32_t columns = 0;
    if (box & LARGE_BOX)
        return rect_of_packed(box);
    if (!mask)
        return {1, 0, 0, 0};
    for (int row = 0; row < BOX_ROWS; row++)
        columns |= (uint32_t)(mask >> BOX_COLUMNS * row) & ((1u << BOX_COLUMNS) - 1);
    return {left, top, left + 31 - (uint32_t)__clz((int)columns),
            top + (63 - (uint32_t)__clzll((long long)mask)) / BOX_COLUMNS};
}

/* The splats of a frame. `only` is the scene of a frame with one object, not scaled, cropped or tinted; else null. In
   frames with a moving scene, Moving is true. */
template <bool Moving>
struct frame_splats {
    const fxs_stage_view *view;
    const frame_buffers *f;
    const fxs_scene *only;

    /* Projects Gaussian g of the visible chunk `at` again, as project_chunk does. Returns false if it is invisible. */
    __device__ bool project(fxs_splat *splat, fxs_bounds *bounds, uint32_t at, uint32_t g) const
    {
        const fxs_chunk_view *cv = &f->chunk_views[at];
        const fxs_object_view *object = only ? nullptr : &f->objects[f->chunk_objects[at]];
        const fxs_scene *scene = only ? only : &object->scene;
        const uint32_t chunk = only ? cv->chunk : chunk_at(f, cv->chunk) - object->first_chunk;
        const uint32_t share_q8 = !only && f->drawn ? f->drawn[cv->chunk].share_q8 : 256;
        const unsigned char *rows = rows_of(scene, chunk);
        fxs_codes codes = fxs_codes_of(scene, rows, g);
        if (Moving)
            move_codes(&codes, f, object, cv, rows + object->motion.at, g);
        const uint32_t offset_q11 = offset_of_code_q11[cv->opacity_law][codes.colour >> 24];
        uint32_t depth;
        if (!project_one(splat, bounds, &depth, only ? view : &object->view, cv, scene->profile, &codes,
                         fxs_share_of_q11(offset_q11, share_q8)))
            return false;
        return only || object->plain ||
               fxs_object_change(object, (const fxs_chunk *)fxs_header(scene, chunk), codes.position, &depth);
    }

    /* Returns the element of `boxes` of a splat that has no mask: its rectangle if the splat is large, else 0. */
    __device__ __noinline__ uint64_t large_box(uint32_t at, uint32_t g) const
    {
        fxs_splat splat;
        fxs_bounds bounds;
        if (!project(&splat, &bounds, at, g))
            return 0;
        const ellipse e = ellipse_of(view, &splat, &bounds);
        const span rows = fxs_bin_rows(view, &splat, &bounds), columns = fxs_bin_columns(view, &bounds);
        if (rows.first > rows.last || columns.first > columns.last || !is_large(&e, view))
            return 0;
        const tile_rect r = {(uint32_t)columns.first, (uint32_t)rows.first, (uint32_t)columns.last,
                             (uint32_t)rows.last};
        return LARGE_BOX | r.packed();
    }

    __device__ __noinline__ bool large_touches(uint32_t at, uint32_t g, int32_t column, int32_t row) const
    {
        fxs_splat splat;
        fxs_bounds bounds;
        project(&splat, &bounds, at, g);
        ellipse e = ellipse_of(view, &splat, &bounds);
        add_radius(&e, view);
        const span s = ellipse_span(&e, view, row);
        return s.first <= column && column <= s.last;
    }

    /* Finds the tiles that a visible chunk covers. A whole warp runs this function. */
    __device__ void cover(uint32_t at) const
    {
        uint64_t *boxes = f->boxes + (size_t)f->chunk_views[at].chunk * FXS_CHUNK;
        tile_rect r = {UINT32_MAX, UINT32_MAX, 0, 0};
        for (uint32_t g = lane_index(); g < FXS_CHUNK; g += WARP) {
            if (!box_mask(boxes[g]))
                boxes[g] = large_box(at, g);
            const tile_rect own = rect_of_box(boxes[g], (uint32_t)view->tiles_x);
            if (own.left <= own.right)
                r = {min(r.left, own.left), min(r.top, own.top), max(r.right, own.right), max(r.bottom, own.bottom)};
        }
        r = {__reduce_min_sync(ALL_LANES, r.left), __reduce_min_sync(ALL_LANES, r.top),
             __reduce_max_sync(ALL_LANES, r.right), __reduce_max_sync(ALL_LANES, r.bottom)};
        if (lane_index() == 0)
            f->covers[at] = r.left > r.right ? tile_rect{1, 0, 0, 0}.packed() : r.packed();
    }
};

/* Calls visit(key) for each splat that tile (column, row) lists, in any order. */
template <bool Moving, class Visit>
__device__ void visit_splats(const frame_splats<Moving> *s, const tile_group *group, uint32_t column, uint32_t row,
                             Visit visit)
{
    const frame_buffers *f = s->f;
    const uint32_t chunks = f->status->chunks;
    for (uint32_t first = group->thread - lane_index(); first < chunks; first += GROUP_THREADS) {
        const uint32_t own = first + lane_index();
        unsigned covering = __ballot_sync(ALL_LANES, own < chunks &&
                                                         rect_of_packed(__ldcg(&f->covers[own])).has(column, row));
        for (; covering; covering &= covering - 1) {
            const uint32_t at = first + (uint32_t)__ffs((int)covering) - 1;
            for (uint32_t g = lane_index(); g < FXS_CHUNK; g += WARP) {
                const uint32_t index = f->chunk_views[at].chunk * FXS_CHUNK + g;
                const uint64_t box = __ldcg(&f->boxes[index]);
                const tile_rect r = rect_of_box(box, (uint32_t)s->view->tiles_x);
                if (!r.has(column, row))
                    continue;
                const bool listed = box & LARGE_BOX
                                        ? s->large_touches(at, g, (int32_t)column, (int32_t)row)
                                        : box >> ((row - r.top) * BOX_COLUMNS + column - r.left) & 1;
                if (listed)
                    visit(FXS_KEY(f->depths[index], index));
            }
        }
    }
}

/* Finds the tiles that the visible chunks cover. Returns when all thread blocks are done. A block waits only for blocks
   that already run, since a chunk is taken by a running warp. */
template <bool Moving>
__device__ void cover_chunks(const frame_splats<Moving> *s)
{
    frame_status *status = s->f->status;
    const uint32_t chunks = status->chunks;
    for (;;) {
        const uint32_t at = __shfl_sync(ALL_LANES, lane_index() == 0 ? atomicAdd(&status->next_cover, 1u) : 0, 0);
        if (at >= chunks)
            break;
        s->cover(at);
        __threadfence();
        __syncwarp();
        if (lane_index() == 0)
            atomicAdd(&status->covered, 1u);
    }
    __syncthreads();
    if (threadIdx.x == 0)
        while (*(volatile uint32_t *)&status->covered < chunks) {
        }
    __syncthreads();
}

/* Blends the splats of tile (column, row). `kept` has room for `room` keys. */
template <bool Moving, class Pixel>
__device__ void blend_found(Pixel (&p)[2], group_shared<Pixel> *own, const region_blender<Pixel, 2> &blender,
                            const frame_splats<Moving> *s, const tile_group *g, uint32_t column, uint32_t row,
                            uint64_t *kept, uint64_t room)
{
    if (g->thread == 0)
        own->keys.count = 0;
    g->sync();
    visit_splats(s, g, column, row, [&](uint64_t key) {
        const uint32_t place = atomicAdd(&own->keys.count, 1u);
        if (place < room)
            kept[place] = key;
    });
    g->sync();
    const uint32_t count = own->keys.count;
    g->sync();
    auto visit_all = [&](auto visit) {
        if (count <= room)
            visit_keys(kept, count, g, visit);
        else
            visit_splats(s, g, column, row, visit);
    };
    key_range range = range_of_list(&own->keys, g, visit_all);
    bool more = true;
    for (uint32_t done = 0; done < count && more;) {
        const uint32_t some = next_round(&range, &own->keys, own->bins, g, visit_all);
        sort_keys(own->entries, &own->keys, own->bins, some, g);
        blender.blend(p, own->entries, some);
        more = g->any(is_open(p));
        done += some;
    }
}

template <class Pixel, bool Moving>
__global__ void __launch_bounds__(FINISH_GROUPS *GROUP_THREADS, 1)
finish_tiles(const __grid_constant__ fxs_stage_view view, const __grid_constant__ frame_buffers f,
             const __grid_constant__ target t, const __grid_constant__ fxs_scene scene, bool plain)
{
    blend_shared<Pixel> *shared = (blend_shared<Pixel> *)shared_memory();
    const tile_group g = {threadIdx.x / GROUP_THREADS, threadIdx.x % GROUP_THREADS};
    group_shared<Pixel> *own = &shared->groups[g.number];
    wait_for_last_kernel();
    if (fits(&f))
        return;
    const frame_splats<Moving> splats = {&view, &f, plain ? &scene : nullptr};
    const uint32_t groups = blockDim.x / GROUP_THREADS, part = g.thread / WARP, across = (uint32_t)view.tiles_x;
    const uint64_t room = f.capacity / (gridDim.x * groups);
    make_table(shared->alpha_q15);
    cover_chunks(&splats);
    for (;;) {
        if (g.thread == 0)
            own->turn = atomicAdd(&f.status->next_tile, 1u);
        g.sync();
        const uint32_t tile = own->turn;
        if (tile >= across * (uint32_t)view.tiles_y)
            return;
        const region<2> r(&view, tile, part);
        const region_blender<Pixel, 2> blender(own->queues[part], own->trace_queue(part), shared->alpha_q15, &f, &view,
                                               t.depth_bits, r.x, r.y);
        Pixel p[2];
        r.clear(p, &view, &t);
        blend_found(p, own, blender, &splats, &g, tile % across, tile / across,
                    f.entries + room * (blockIdx.x * groups + g.number), room);
        r.store(p, &view, &f, &t);
        g.sync();
    }
}

}

#endif
