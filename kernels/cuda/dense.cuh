/* Long lists, which are of small splats: a block a tile, a pixel a thread. The list is first put into bins by depth;
 * then, 1024 splats at a time, a splat a thread marks the pixels that it can touch, and each pixel takes its own, in
 * order. */
#ifndef FXS_CUDA_DENSE_CUH
#define FXS_CUDA_DENSE_CUH

#include "blend.cuh"

namespace {

const uint32_t DENSE_THREADS = FXS_TILE_PIXELS, DENSE_BLOCKS = 2;   /* of a multiprocessor */
const uint32_t WORDS = ROUND_KEYS / WARP;
typedef group<DENSE_THREADS> dense_group;

struct dense_shared {
    group_keys keys;
    uint32_t ends[BINS];                   /* of the bins, in the list */
    union {
        uint32_t bins[BINS];
        uint32_t touching[WORDS][FXS_TILE_PIXELS];   /* splats of the round, a bit each */
    };
    uint16_t alpha_q15[FXS_FAINT_Q11 + 1];
    uint32_t turn;
};

/* Moves a list to `sorted`, bin after bin; shared->ends has where they end. */
__device__ void split_list(uint64_t *sorted, dense_shared *shared, const uint64_t *list, uint32_t count,
                           const dense_group *g)
{
    const rounds r = begin_rounds(&shared->keys, list, count, g);
    const int shift = bin_shift(r.low, r.high);
    const uint32_t each = BINS / DENSE_THREADS;
    uint32_t *ends = shared->ends, own;
    for (uint32_t i = g->thread; i < BINS; i += DENSE_THREADS)
        ends[i] = 0;
    g->sync();
    visit_keys(list, count, g, [&](uint64_t key) { atomicAdd(&ends[(key - r.low) >> shift], 1u); });
    g->sync();
    uint32_t start = keys_before(&shared->keys, ends, &own, g);
    for (uint32_t i = g->thread * each; i < (g->thread + 1) * each; i++) {
        const uint32_t size = ends[i];
        ends[i] = start;
        start += size;
    }
    g->sync();
    visit_keys(list, count, g, [&](uint64_t key) { sorted[atomicAdd(&ends[(key - r.low) >> shift], 1u)] = key; });
    g->sync();
}

/* The end of the bins that are within ROUND_KEYS after `first`, or of the one that begins there. */
__device__ uint32_t round_end(const uint32_t *ends, uint32_t first)
{
    uint32_t bin = 0, next = 0;                /* bins that end within, and by `first` */
    for (uint32_t step = BINS / 2; step > 0; step /= 2) {
        bin += ends[bin + step - 1] <= first + ROUND_KEYS ? step : 0;
        next += ends[next + step - 1] <= first ? step : 0;
    }
    const uint32_t end = bin ? ends[bin - 1] : 0;
    return end > first ? end : ends[next];
}

/* The pixels of a row, a bit each, that a splat can touch: |u| at most the root of what the row leaves of the level,
   widened by more than the rounding of u. */
__device__ inline uint32_t pixels_of_row(uint32_t u_q24, float inverse, float left)
{
    const float u = coordinate_q6(u_q24), reach = sqrtf(fmaxf(left, 0.0f) + 1) * 1.0001f + 0.05f;
    const int from = (int)fminf(fmaxf((-reach - u) * inverse - 0.05f, 0.0f), 31.0f);
    const int to = (int)fmaxf(fminf((reach - u) * inverse + 0.05f, FXS_TILE - 1.0f), -1.0f);
    return left >= 0 && from <= to ? (2u << to) - (1u << from) : 0;
}

/* Bit i of lane j becomes bit j of lane i. */
__device__ inline uint32_t transpose(uint32_t x)
{
    uint32_t low = 0xffff;
    for (uint32_t step = 16; step > 0; step /= 2, low ^= low << step) {
        const uint32_t other = __shfl_xor_sync(ALL_LANES, x, (int)step);
        x = lane_index() & step ? (x & ~low) | (other >> step & low) : (x & low) | (other & low) << step;
    }
    return x;
}

/* Marks the pixels of the tile at (x, y) that each lane's splat can touch. `s` is null for none. */
__device__ void mark_pixels(uint32_t touching[FXS_TILE_PIXELS], const fxs_splat *s, const fxs_view *view, int32_t x,
                            int32_t y)
{
    fxs_splat splat = {};
    float limit = 0;
    if (s) {
        splat = *s;
        limit = __int_as_float(limit_bits(s, view));
    }
    uint32_t u_q24 = splat.u0_q24 + (uint32_t)x * (uint32_t)splat.ux_q24 + (uint32_t)y * (uint32_t)splat.uy_q24;
    uint32_t v_q24 = splat.v0_q24 + (uint32_t)y * (uint32_t)splat.vy_q24;
    const float inverse = 262144.0f / (float)max(splat.ux_q24, 1);
    for (uint32_t first = 0; first < FXS_TILE_PIXELS; first += WARP) {
        uint32_t pixels = 0;
        for (uint32_t shift = 0; shift < WARP; shift += FXS_TILE) {
            pixels |= pixels_of_row(u_q24, inverse, limit - row_level(v_q24, splat.offset_q11)) << shift;
            u_q24 += (uint32_t)splat.uy_q24;
            v_q24 += (uint32_t)splat.vy_q24;
        }
        touching[first + lane_index()] = transpose(pixels);
    }
}

/* Takes the splats of a round that can touch the thread's pixel, one by one. */
struct walk {
    uint32_t word, bits;

    __device__ bool next(fxs_splat *s, const dense_shared *shared, const fxs_splat *splats)
    {
        while (!bits && word < WORDS)
            bits = shared->touching[word++][threadIdx.x];
        if (!bits)
            return false;
        *s = splats[(uint32_t)shared->keys.keys[(word - 1) * WARP + (uint32_t)__ffs((int)bits) - 1]];
        bits &= bits - 1;
        return true;
    }
};

__device__ inline void blend_splat(pixel *p, const uint16_t *alpha_q15, const fxs_splat *s, const fxs_view *view,
                                   int32_t x, int32_t y)
{
    const queued_row row = {s->u0_q24 + (uint32_t)y * (uint32_t)s->uy_q24,
                            row_level(s->v0_q24 + (uint32_t)y * (uint32_t)s->vy_q24, s->offset_q11)};
    queued_splat q;
    q.limit = limit_bits(s, view);
    q.red_green = (uint32_t)s->colour_q13[0] | (uint32_t)s->colour_q13[1] << 16;
    q.blue = (uint32_t)s->colour_q13[2];
    blend_pixel(p, alpha_q15, row, (uint32_t)x * (uint32_t)s->ux_q24, &q);
}

/* Blends shared->keys over the tile. */
__device__ void blend_round(pixel *p, dense_shared *shared, uint32_t count, const fxs_splat *splats,
                            const fxs_view *view, int32_t x, int32_t y, const dense_group *g)
{
    const int32_t px = x + (int32_t)(g->thread % FXS_TILE), py = y + (int32_t)(g->thread / FXS_TILE);
    for (uint32_t i = g->thread; i < ROUND_KEYS; i += DENSE_THREADS) {
        const uint32_t entry = i < count ? (uint32_t)shared->keys.keys[i] : FXS_ENTRY_FAR;
        mark_pixels(shared->touching[i / WARP], entry & FXS_ENTRY_FAR ? 0 : &splats[entry], view, x, y);
    }
    g->sync();
    walk w = {0, 0};
    fxs_splat ahead;
    for (bool more = w.next(&ahead, shared, splats); more && p->transmittance >= FXS_CLOSED_Q15;) {
        const fxs_splat s = ahead;
        more = w.next(&ahead, shared, splats);   /* on its way while this one is blended */
        blend_splat(p, shared->alpha_q15, &s, view, px, py);
    }
    g->sync();
}

__device__ void blend_dense_tile(pixel *p, dense_shared *shared, const frame_buffers *f, const fxs_view *view,
                                 uint32_t tile, int32_t x, int32_t y, const dense_group *g)
{
    const uint32_t count = f->counts[tile], start = f->next[tile] - count;
    uint64_t *list = f->split_entries + start;
    split_list(list, shared, f->entries + start, count, g);
    for (uint32_t first = 0; first < count;) {
        const uint32_t end = round_end(shared->ends, first);
        rounds r = {0, ~(uint64_t)0};
        if (end - first > ROUND_KEYS)
            r = begin_rounds(&shared->keys, list + first, end - first, g);
        for (uint32_t done = first; done < end;) {
            uint32_t keys = end - first;
            if (keys > ROUND_KEYS)
                keys = next_round(&r, &shared->keys, shared->bins, list + first, end - first, g);
            else
                for (uint32_t i = g->thread; i < keys; i += DENSE_THREADS)
                    shared->keys.keys[i] = list[first + i];
            g->sync();
            sort_keys(&shared->keys, keys, g);
            blend_round(p, shared, keys, f->splats, view, x, y, g);
            if (!g->any(p->transmittance >= FXS_CLOSED_Q15))
                return;
            done += keys;
        }
        first = end;
    }
}

__global__ void __launch_bounds__(DENSE_THREADS, DENSE_BLOCKS) blend_dense(const __grid_constant__ fxs_view view,
                                                                           const __grid_constant__ frame_buffers f,
                                                                           const __grid_constant__ target t)
{
    extern __shared__ __align__(16) unsigned char memory[];
    dense_shared *shared = (dense_shared *)memory;
    const dense_group g = {0, threadIdx.x};
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y);
    const turns order = turns_of(&f);
    const uint32_t dense = __shfl_sync(ALL_LANES, order.end, WARP - 1 - (31 - __clz((int)DENSE)));
    if (!fits(&f) || blockIdx.x >= dense)
        return;
    for (uint32_t level = threadIdx.x; level <= FXS_FAINT_Q11; level += DENSE_THREADS)
        shared->alpha_q15[level] = (uint16_t)fxs_alpha_q15((int)level);
    for (;;) {
        if (threadIdx.x == 0)
            shared->turn = atomicAdd(&f.status->next_dense, 1u);
        g.sync();
        if (shared->turn >= dense)
            return;
        const uint32_t tile = tile_of_turn(&f, &order, tiles, shared->turn);
        const int32_t x = (int32_t)(tile % (uint32_t)view.tiles_x) * FXS_TILE;
        const int32_t y = (int32_t)(tile / (uint32_t)view.tiles_x) * FXS_TILE;
        const int32_t px = x + (int32_t)(g.thread % FXS_TILE), py = y + (int32_t)(g.thread / FXS_TILE);
        const bool inside = px < view.width && py < view.height;
        pixel p = {inside ? FXS_CLEAR_Q15 : 0, {0, 0, 0}};
        blend_dense_tile(&p, shared, &f, &view, tile, x, y, &g);
        if (inside)
            store_pixel(&t, &p, px, py);
        g.sync();
    }
}

}

#endif
