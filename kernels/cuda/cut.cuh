/* Chooses the level of detail on the device, with the same result as src/core/cut.c. The leaves of a scene's binary
 * tree are chunks of 256 Gaussians; a node stands for its two children.
 *
 * A node's key is the gain of opening the node, which replaces it by its children. Nodes are opened in descending
 * order of key until the budget of drawn chunks ends. A child's key is at most its parent's, so the opened nodes are
 * a prefix of that order. Prefix sums over a histogram of all keys give the key where the budget ends. The nodes
 * with that key, the candidates, are sorted and added one by one. */
#ifndef FXS_CUDA_CUT_CUH
#define FXS_CUDA_CUT_CUH

#include "pool.cuh"
#include "stages.cuh"

namespace {

const int32_t KEY_MOST_Q8 = (1 << 17) - 1, KEY_LEAST_Q8 = -(1 << 18);
const uint32_t KEYS = (uint32_t)(KEY_MOST_Q8 - KEY_LEAST_Q8) + 1;
const uint32_t CUT_THREADS = 256, STOP_THREADS = 512, KEYS_OF_THREAD = 8;
const uint32_t LIST_CHUNKS = 1024;
const uint32_t SORT_MOST = 4096;
const uint32_t DEPTH_MOST = 96;
const int16_t UNSEEN = -1;

struct alignas(8) node_sight {
    int32_t key_q8;
    int16_t room_q8;               /* log2(size of the node / wanted detail), 0 to FXS_FADE_MOST_Q8; UNSEEN: the node is
                                      invisible */
    uint16_t seen_children;        /* bits 0 and 1: the camera sees the node's first and second child */
};

struct alignas(16) key_count {
    uint32_t nodes, children;
    uint32_t no_more;
    uint32_t fewer;
};

struct cut_sums {
    uint32_t nodes, children, no_more;
};

struct cut_status {
    uint32_t roots;
    uint32_t last_key, first_key;  /* largest and smallest used index in the histogram `keys`; first_key is stored as
                                      KEYS - 1 - index */
    uint32_t blocks_done[2];
    uint32_t stops;                /* 1: the budget of drawn chunks may end before all tree nodes are opened (replaced
                                      by their children) */
    uint32_t stop_first, stop_last;        /* first and last index in the histogram `keys` where the budget of drawn
                                              chunks may end */
    cut_sums before, all;
    uint32_t candidates;
    uint64_t stop;                 /* sort key of the first tree node that is not opened (replaced by its children);
                                      UINT64_MAX: all nodes are opened */
    fxs_fading fading;
    uint32_t drawn;
};

struct cut_buffers {
    cut_status *status;
    uint32_t *block_counts;
    uint32_t *marks;               /* one bit per chunk (256 Gaussians); 1: the chunk is drawn */
    key_count *keys;               /* histogram of the tree nodes' keys (gain of replacing a node by its children),
                                      largest key first */
    uint16_t *shares_q8;
    node_sight *sights;
    uint64_t *candidates;
    fxs_drawn *drawn;
    const fxs_stage_view *views;   /* `eyes` views of each object */
    uint32_t eyes;
    uint32_t chunks;
    uint32_t whole_chunks;
    uint32_t room, detail_q8;
};

/* Stores the parent of each node of the level-of-detail tree. Sets wrong_tree if a node is damaged or two nodes share a
   child. */
__global__ void find_parents(const __grid_constant__ fxs_scene scene)
{
    const uint32_t chunk = blockIdx.x * blockDim.x + threadIdx.x;
    fxs_chunk header;
    fxs_node node;
    if (chunk >= 2 * scene.chunk_count - 1)
        return;
    if (fxs_chunk_read(&header, &scene, chunk))
        head_of(&scene)->wrong_tree = 1;
    if (chunk < scene.chunk_count)
        return;
    if (fxs_node_read(&node, &scene, chunk - scene.chunk_count)) {
        head_of(&scene)->wrong_tree = 1;
        return;
    }
    for (int i = 0; i < 2; i++)
        if (atomicExch(&parents_of(&scene)[node.children[i]], chunk) != FXS_NOTHING)
            head_of(&scene)->wrong_tree = 1;
}

__global__ void measure_depths(const __grid_constant__ fxs_scene scene)
{
    uint32_t chunk = blockIdx.x * blockDim.x + threadIdx.x, depth = 0;
    if (chunk >= 2 * scene.chunk_count - 1)
        return;
    while (depth <= DEPTH_MOST && (chunk = parents_of(&scene)[chunk]) != FXS_NOTHING)
        depth++;
    if (depth > DEPTH_MOST)
        head_of(&scene)->wrong_tree = 1;
}

__device__ inline fxs_sight sight_of(node_sight s)
{
    return {s.key_q8, s.room_q8, 0};
}

__device__ inline node_sight stored(const fxs_sight *sight, bool seen, uint32_t seen_children)
{
    const int32_t room_q8 = seen ? fxs_clamp(sight->room_q8, 0, FXS_FADE_MOST_Q8) : UNSEEN;
    return {sight->key_q8, (int16_t)room_q8, (uint16_t)seen_children};
}

/* Loads an element by one 8-byte access, as another thread may be writing the element. */
__device__ inline node_sight load(const node_sight *from)
{
    const unsigned long long bits = *(const volatile unsigned long long *)from;
    node_sight s;
    memcpy(&s, &bits, sizeof s);
    return s;
}

__device__ inline void store(node_sight *to, node_sight s)
{
    unsigned long long bits;
    memcpy(&bits, &s, sizeof bits);
    *(volatile unsigned long long *)to = bits;
}

__device__ inline uint32_t place_of_key(int32_t key_q8)
{
    return (uint32_t)(KEY_MOST_Q8 - key_q8);
}

/* Returns a number that orders tree nodes. Nodes with smaller numbers are replaced by their children first. */
__device__ inline uint64_t order_of(int32_t key_q8, uint32_t chunk)
{
    return (uint64_t)place_of_key(key_q8) << 32 | chunk;
}

__global__ void __launch_bounds__(CUT_THREADS) see_chunks(const __grid_constant__ frame_buffers f,
                                                          const __grid_constant__ cut_buffers c)
{
    const uint32_t chunk = blockIdx.x * CUT_THREADS + threadIdx.x;
    wait_for_last_kernel();
    if (chunk >= c.chunks)
        return;
    const uint32_t object = fxs_object_of(f.objects, f.object_count, chunk);
    const fxs_object_view *o = &f.objects[object];
    if (!o->visible || !o->scene.nodes)
        return;
    fxs_sight sight;
    const int seen = fxs_see(&sight, &c.views[object * c.eyes], c.eyes, &o->scene, chunk - o->first_chunk,
                             c.detail_q8);
    store(&c.sights[chunk], stored(&sight, seen > 0, 0));
    if (seen > 0 && chunk - o->first_chunk == o->scene.chunk_count)
        atomicAdd(&c.status->roots, 1);
}

/* Returns true only in the thread block that calls this function last. That block then sees all writes of the other
   blocks. */
__device__ inline bool is_last_block(uint32_t *blocks_done)
{
    __shared__ uint32_t place;
    __threadfence();
    __syncthreads();
    if (threadIdx.x == 0)
        place = atomicAdd(blocks_done, 1);
    __syncthreads();
    __threadfence();
    return place == gridDim.x - 1;
}

__device__ inline cut_sums operator+(cut_sums a, cut_sums b)
{
    return {a.nodes + b.nodes, a.children + b.children, a.no_more + b.no_more};
}

/* Returns the sum of `own` over all earlier threads of a thread block. *all receives the sum over all threads. */
__device__ cut_sums sums_before(cut_sums own, cut_sums *all)
{
    __shared__ cut_sums warps[STOP_THREADS / WARP];
    const uint32_t warp = threadIdx.x / WARP;
    const cut_sums end = {warp_sum(own.nodes), warp_sum(own.children), warp_sum(own.no_more)};
    __syncthreads();
    if (lane_index() == WARP - 1)
        warps[warp] = end;
    __syncthreads();
    cut_sums before = {end.nodes - own.nodes, end.children - own.children, end.no_more - own.no_more};
    *all = {0, 0, 0};
    for (uint32_t i = 0; i < STOP_THREADS / WARP; i++) {
        before = i < warp ? before + warps[i] : before;
        *all = *all + warps[i];
    }
    return before;
}

__device__ inline uint32_t most_drawn(const cut_buffers *c)
{
    return c->room - c->room / FADING;
}

__device__ inline int64_t drawn_after(const cut_buffers *c, cut_sums s)
{
    return (int64_t)c->whole_chunks + c->status->roots + s.children - s.no_more;
}

/* Returns true if replacing the counted tree nodes by their children would draw too many chunks or visit too many
   nodes. */
__device__ inline bool is_over(const cut_buffers *c, cut_sums s, uint32_t fewer)
{
    return drawn_after(c, s) + fewer > most_drawn(c) ||
           (uint64_t)c->status->roots + s.children > VISITS * (uint64_t)c->room + MORE_VISITS;
}

/* Nodes are opened (replaced by their children) in descending order of their keys. Finds the first key where the budget
   of drawn chunks may end, and the first where it certainly ends. The two keys can differ, because opening some nodes
   reduces the number of drawn chunks. */
__device__ void find_keys(const cut_buffers *c)
{
    __shared__ uint32_t may_stop, does_stop;
    cut_status *status = c->status;
    const uint32_t first = KEYS - 1 - status->first_key, last = status->last_key;
    cut_sums before = {0, 0, 0};
    if (threadIdx.x == 0)
        may_stop = does_stop = FXS_NOTHING;
    __syncthreads();
    for (uint32_t from = first; from <= last && does_stop == FXS_NOTHING; from += STOP_THREADS * KEYS_OF_THREAD) {
        const uint32_t own_first = from + threadIdx.x * KEYS_OF_THREAD;
        key_count counts[KEYS_OF_THREAD];
        cut_sums own = {0, 0, 0}, all;
        for (uint32_t i = 0; i < KEYS_OF_THREAD; i++) {
            counts[i] = own_first + i <= last ? c->keys[own_first + i] : key_count{0, 0, 0, 0};
            own = own + cut_sums{counts[i].nodes, counts[i].children, counts[i].no_more};
        }
        cut_sums end = before + sums_before(own, &all);
        cut_sums before_stop = end;
        uint32_t own_stop = FXS_NOTHING;
        for (uint32_t i = 0; i < KEYS_OF_THREAD; i++) {
            const cut_sums start = end;
            end = end + cut_sums{counts[i].nodes, counts[i].children, counts[i].no_more};
            if (!counts[i].nodes)
                continue;
            if (own_stop == FXS_NOTHING && is_over(c, end, counts[i].fewer)) {
                own_stop = own_first + i;
                before_stop = start;
                atomicMin(&may_stop, own_stop);
            }
            if (is_over(c, end, 0))
                atomicMin(&does_stop, own_first + i);
        }
        before = before + all;
        __syncthreads();
        if (own_stop != FXS_NOTHING && may_stop == own_stop)
            status->before = before_stop;
    }
    if (threadIdx.x == 0) {
        status->all = before;
        status->stops = may_stop != FXS_NOTHING;
        status->stop_first = may_stop;
        status->stop_last = min(does_stop, last);
    }
}

/* Lowers each tree node's key to the smallest key of its ancestors, and counts the nodes by key. Lowering a key twice
   is harmless. */
__global__ void __launch_bounds__(STOP_THREADS) rank_nodes(const __grid_constant__ frame_buffers f,
                                                           const __grid_constant__ cut_buffers c)
{
    const uint32_t chunk = blockIdx.x * STOP_THREADS + threadIdx.x;
    uint32_t place = 0;
    bool openable = false;
    wait_for_last_kernel();
    if (chunk < c.chunks) {
        const fxs_object_view *o = &f.objects[fxs_object_of(f.objects, f.object_count, chunk)];
        const uint32_t own = chunk - o->first_chunk, leaves = o->scene.chunk_count;
        if (o->visible && o->scene.nodes && own >= leaves) {
            const uint32_t *parents = parents_of(&o->scene);
            node_sight *sights = c.sights + o->first_chunk;
            fxs_sight sight = sight_of(load(&sights[own]));
            for (uint32_t above = parents[own]; above != FXS_NOTHING && fxs_is_openable(&sight);
                 above = parents[above]) {
                const fxs_sight of_above = sight_of(load(&sights[above]));
                fxs_see_below(&sight, &of_above);
            }
            openable = fxs_is_openable(&sight);
            uint32_t seen = 0;
            if (openable) {
                fxs_node node;
                fxs_node_read(&node, &o->scene, own - leaves);
                for (int i = 0; i < 2; i++)
                    seen |= load(&sights[node.children[i]]).room_q8 != UNSEEN ? 1u << i : 0;
                place = place_of_key(sight.key_q8);
                const uint32_t no_more = fxs_drawn_no_more(&sight);
                unsigned long long *counts = (unsigned long long *)&c.keys[place];
                atomicAdd(&counts[0], (unsigned long long)__popc(seen) << 32 | 1);
                if (no_more)
                    atomicAdd(&counts[1], (unsigned long long)(seen == 0) << 32 | 1);
            }
            store(&sights[own], stored(&sight, sight.room_q8 != UNSEEN, seen));
        }
    }
    const uint32_t last = __reduce_max_sync(ALL_LANES, openable ? place : 0);
    const uint32_t first = __reduce_max_sync(ALL_LANES, openable ? KEYS - 1 - place : 0);
    if (lane_index() == 0 && last > *(volatile uint32_t *)&c.status->last_key)
        atomicMax(&c.status->last_key, last);
    if (lane_index() == 0 && first > *(volatile uint32_t *)&c.status->first_key)
        atomicMax(&c.status->first_key, first);
    if (is_last_block(&c.status->blocks_done[0]))
        find_keys(&c);
}

/* Sorts values by a bitonic sort in one thread block. Each round begins with mirrored pairs, so missing elements act as
   +infinity. */
__device__ void sort_candidates(uint64_t *values, uint32_t count)
{
    for (uint32_t size = 2; size < 2 * count; size *= 2)
        for (uint32_t step = size / 2; step > 0; step /= 2) {
            __syncthreads();
            for (uint32_t i = threadIdx.x; i < count; i += STOP_THREADS) {
                const uint32_t with = step == size / 2 ? i ^ (size - 1) : i ^ step;
                if (with <= i || with >= count || values[i] <= values[with])
                    continue;
                const uint64_t value = values[i];
                values[i] = values[with];
                values[with] = value;
            }
        }
    __syncthreads();
}

__device__ uint32_t find_first_over(const cut_buffers *c, const uint64_t *candidates, uint32_t count)
{
    __shared__ uint32_t over;
    cut_sums before = c->status->before;
    if (threadIdx.x == 0)
        over = count;
    __syncthreads();
    for (uint32_t from = 0; from < count && over == count; from += STOP_THREADS) {
        const uint32_t i = from + threadIdx.x;
        cut_sums own = {0, 0, 0}, all;
        if (i < count) {
            const node_sight s = c->sights[(uint32_t)candidates[i]];
            const fxs_sight sight = sight_of(s);
            own = {1, (uint32_t)__popc(s.seen_children), fxs_drawn_no_more(&sight)};
        }
        const cut_sums end = before + sums_before(own, &all) + own;
        if (i < count && is_over(c, end, 0))
            atomicMin(&over, i);
        before = before + all;
        __syncthreads();
    }
    return over;
}

/* Computes the range of keys over which tree nodes fade into their children. `last` is the index of the last key with
   opened nodes (nodes replaced by their children). `of_last` is the number of these nodes. */
__device__ void find_width(const cut_buffers *c, uint32_t opened, uint32_t of_last, uint32_t last, bool all)
{
    __shared__ uint32_t width;
    const uint32_t room = c->room / FADING;
    const int64_t left = all ? (int64_t)most_drawn(c) - drawn_after(c, c->status->all) : 0;
    const uint32_t count = left < 0 ? room : left < room ? room - (uint32_t)left : 0;
    if (threadIdx.x == 0)
        width = count ? FXS_FADE_MOST_Q8 : 0;
    __syncthreads();
    uint32_t key = 0;
    if (threadIdx.x > 0 && threadIdx.x < FXS_FADE_MOST_Q8 && threadIdx.x <= last)
        key = c->keys[last - threadIdx.x].nodes;
    cut_sums whole;
    const cut_sums above = sums_before({threadIdx.x == 0 ? of_last : key, 0, 0}, &whole);
    const uint32_t up_to = above.nodes + (threadIdx.x == 0 ? of_last : key);
    if (count && count < opened && threadIdx.x < FXS_FADE_MOST_Q8 && up_to > count)
        atomicMin(&width, threadIdx.x);
    __syncthreads();
    if (threadIdx.x == 0)
        c->status->fading.width_q8 = (int32_t)width;
}

__device__ void find_end(const cut_buffers *c)
{
    __shared__ uint64_t few[SORT_MOST];
    __shared__ uint32_t same;
    cut_status *status = c->status;
    const uint32_t count = status->stops ? status->candidates : 0;
    uint64_t *candidates = count <= SORT_MOST ? few : c->candidates;
    for (uint32_t i = threadIdx.x; i < count && candidates == few; i += STOP_THREADS)
        few[i] = c->candidates[i];
    sort_candidates(candidates, count);
    const uint32_t over = find_first_over(c, candidates, count);
    const bool all = over == count;
    const uint32_t opened = all ? status->all.nodes : status->before.nodes + over;
    const uint32_t last = all ? status->last_key : (uint32_t)(candidates[over] >> 32);
    if (threadIdx.x == 0)
        same = 0;
    __syncthreads();
    for (uint32_t i = threadIdx.x; i < over && !all; i += STOP_THREADS)
        if (candidates[i] >> 32 == last)
            atomicAdd(&same, 1);
    __syncthreads();
    find_width(c, opened, all ? c->keys[last].nodes : same, last, all);
    if (threadIdx.x == 0) {
        status->stop = all ? UINT64_MAX : candidates[over];
        status->fading.last_key_q8 = status->all.nodes || !all ? KEY_MOST_Q8 - (int32_t)last : 0;
    }
}

__global__ void __launch_bounds__(STOP_THREADS) find_stop(const __grid_constant__ frame_buffers f,
                                                          const __grid_constant__ cut_buffers c)
{
    const uint32_t chunk = blockIdx.x * STOP_THREADS + threadIdx.x;
    wait_for_last_kernel();
    if (chunk < c.chunks && c.status->stops) {
        const fxs_object_view *o = &f.objects[fxs_object_of(f.objects, f.object_count, chunk)];
        if (o->visible && o->scene.nodes && chunk - o->first_chunk >= o->scene.chunk_count) {
            const node_sight s = c.sights[chunk];
            const uint32_t place = place_of_key(s.key_q8);
            if (s.room_q8 > 0 && place >= c.status->stop_first && place <= c.status->stop_last)
                c.candidates[atomicAdd(&c.status->candidates, 1)] = order_of(s.key_q8, chunk);
        }
    }
    if (is_last_block(&c.status->blocks_done[1]))
        find_end(&c);
}

__device__ inline bool is_opened(const cut_buffers *c, node_sight s, uint32_t chunk)
{
    return s.room_q8 > 0 && order_of(s.key_q8, chunk) < c->status->stop;
}

__device__ inline void add_drawn(const cut_buffers *c, uint32_t chunk, uint32_t share_q8)
{
    if (!share_q8)
        return;
    c->shares_q8[chunk] = (uint16_t)share_q8;
    atomicOr(&c->marks[chunk / 32], 1u << chunk % 32);
    atomicAdd(&c->block_counts[chunk / LIST_CHUNKS], 1);
}

/* Returns the share of its optical depth that a tree node draws while its ancestors fade: the product of their
   faded_q8. The walk ends at an ancestor with faded_q8 = 256, as all ancestors above it have 256 too. */
__device__ uint32_t share_below(const cut_buffers *c, const uint32_t *parents, const node_sight *sights, uint32_t own)
{
    uint8_t faded[DEPTH_MOST + 1];
    uint32_t count = 0, share_q8 = 256;
    for (uint32_t above = parents[own]; above != FXS_NOTHING; above = parents[above]) {
        const fxs_sight sight = sight_of(sights[above]);
        const uint32_t faded_q8 = fxs_faded_q8(&sight, c->status->fading);
        if (faded_q8 == 256)
            break;
        faded[count++] = (uint8_t)faded_q8;
    }
    while (count-- > 0)
        share_q8 = share_q8 * faded[count] >> 8;
    return share_q8;
}

__device__ void share_node(const cut_buffers *c, const fxs_object_view *o, uint32_t own)
{
    const uint32_t *parents = parents_of(&o->scene), above = parents[own], first = o->first_chunk;
    const node_sight *sights = c->sights + first, s = sights[own];
    if (s.room_q8 == UNSEEN || (above != FXS_NOTHING && !is_opened(c, sights[above], first + above)))
        return;
    const uint32_t share_q8 = share_below(c, parents, sights, own);
    if (!is_opened(c, s, first + own)) {
        add_drawn(c, first + own, share_q8);
        return;
    }
    fxs_node node;
    fxs_node_read(&node, &o->scene, own - o->scene.chunk_count);
    const fxs_sight sight = sight_of(s);
    const uint32_t faded_q8 = fxs_faded_q8(&sight, c->status->fading);
    add_drawn(c, first + own, share_q8 * (256 - faded_q8) >> 8);
    for (int i = 0; i < 2; i++)
        if (node.children[i] < o->scene.chunk_count && s.seen_children >> i & 1)
            add_drawn(c, first + node.children[i], share_q8 * faded_q8 >> 8);
}

__global__ void __launch_bounds__(CUT_THREADS) share_chunks(const __grid_constant__ frame_buffers f,
                                                            const __grid_constant__ cut_buffers c)
{
    const uint32_t chunk = blockIdx.x * CUT_THREADS + threadIdx.x;
    wait_for_last_kernel();
    if (chunk >= c.chunks)
        return;
    const fxs_object_view *o = &f.objects[fxs_object_of(f.objects, f.object_count, chunk)];
    if (!o->scene.nodes)
        add_drawn(&c, chunk, 256);
    else if (o->visible && chunk - o->first_chunk >= o->scene.chunk_count)
        share_node(&c, o, chunk - o->first_chunk);
}

__global__ void __launch_bounds__(CUT_THREADS) list_drawn_chunks(const __grid_constant__ frame_buffers f,
                                                                 const __grid_constant__ cut_buffers c)
{
    __shared__ uint32_t before;
    wait_for_last_kernel();
    if (threadIdx.x == 0)
        before = 0;
    __syncthreads();
    uint32_t own = 0;
    for (uint32_t i = threadIdx.x; i < blockIdx.x; i += CUT_THREADS)
        own += c.block_counts[i];
    own = __reduce_add_sync(ALL_LANES, own);
    if (lane_index() == 0)
        atomicAdd(&before, own);
    __syncthreads();
    const uint32_t *marks = c.marks + blockIdx.x * (LIST_CHUNKS / 32);
    for (uint32_t i = threadIdx.x; i < LIST_CHUNKS; i += CUT_THREADS) {
        const uint32_t chunk = blockIdx.x * LIST_CHUNKS + i, mark = marks[i / 32];
        if (!(mark >> i % 32 & 1))
            continue;
        uint32_t place = before + (uint32_t)__popc(mark & ((1u << i % 32) - 1));
        for (uint32_t k = 0; k < i / 32; k++)
            place += (uint32_t)__popc(marks[k]);
        const uint32_t object = fxs_object_of(f.objects, f.object_count, chunk);
        const fxs_object_view *o = &f.objects[object];
        fxs_sight sight = {0, 0, 0};
        if (o->scene.nodes && chunk - o->first_chunk >= o->scene.chunk_count)
            fxs_see(&sight, &c.views[object * c.eyes], c.eyes, &o->scene, chunk - o->first_chunk, c.detail_q8);
        if (place < c.room)
            c.drawn[place] = fxs_drawn_of(chunk, c.shares_q8[chunk], sight.swell_q8);
    }
    if (threadIdx.x == 0 && blockIdx.x == gridDim.x - 1)
        c.status->drawn = min(before + c.block_counts[blockIdx.x], c.room);
}

}

#endif
