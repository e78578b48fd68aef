/* Blends tiles with long lists of mostly small splats (projected Gaussians). A thread block has a tile of 16x16
 * pixels, or one part of a tile that several blocks share.
 *
 * The block puts the list into bins of depth. Bin after bin, it collects splats that can touch an open pixel, one
 * that is not opaque yet. A full collection is sorted by depth. Each thread marks the pixels of one splat in a bit
 * matrix; then four lanes, a quad, blend the marked splats of one pixel. */
#ifndef FXS_CUDA_DENSE_CUH
#define FXS_CUDA_DENSE_CUH

#include "share.cuh"

namespace {

const uint32_t ROW_PAIRS = FXS_TILE / 2;
typedef group_keys<960> dense_keys;
const uint32_t FULL = 512;                 /* number of collected splats above which no more splats are collected */
const uint32_t REACH_MOST = 8192;
const uint32_t WORDS = dense_keys::room / WARP;
const uint32_t QUAD = 4, FEW = 32;         /* QUAD: lanes that share a pixel; FEW: largest number of pixels for the
                                              function blend_few */
const uint32_t STEPS_MOST = 15360;

struct dense_shared {
    dense_keys keys;
    uint32_t entries[dense_keys::room];
    uint32_t ends[dense_keys::bins];
    uint4 shapes[dense_keys::room];
    uint4 shades[dense_keys::room];
    union {
        uint32_t masks[ROW_PAIRS][dense_keys::room];    /* per splat, one bit for each pixel that the splat can touch */
        uint16_t steps[STEPS_MOST];        /* element k all + i holds 1 - alpha of the k-th splat of pixel i, later its
                                              weight; `all` is the number of pixels */
    };
    struct {
        uint32_t n, count;
    } few[FEW];
    union {
        uint32_t bins[dense_keys::bins];
        uint32_t touching[WORDS][FXS_TILE_PIXELS + 1];   /* for each pixel, one bit per splat that can touch it; + 1
                                                            avoids bank conflicts */
    };
    uint16_t alpha_q15[FXS_FAINT_Q11 + 1];
    uint64_t *room;
    uint32_t turn, collected;
    pixel pixels[FXS_TILE_PIXELS];
    uint32_t open[ROW_PAIRS];              /* one bit per pixel of the tile; 1: the pixel is not opaque yet */
};

static_assert(!has_gaps<dense_keys, DENSE_THREADS>, "ends have gaps");
static_assert(sizeof(dense_shared) <= 163 << 10, "more shared memory than a block of an A100 has");

struct dense_splat {
    uint32_t u_q24, ux_q24, uy_q24, v_q24;
    uint32_t vy_q24, offset_red, green_blue;
    int limit;                     /* largest level (u^2 + v^2 + offset) of a pixel that is drawn, as the bits of a
                                      float */

    __device__ dense_splat(const uint4 &shape, const uint4 &shade)
        : u_q24(shape.x), ux_q24(shape.y), uy_q24(shape.z), v_q24(shape.w), vy_q24(shade.x), offset_red(shade.y),
          green_blue(shade.z), limit((int)shade.w)
    {
    }

    __device__ int alpha_at(const uint16_t *alpha_q15, uint32_t x, uint32_t y) const
    {
        const queued_row row = {u_q24 + y * uy_q24, row_level(v_q24 + y * vy_q24, (int)(offset_red & 0xffff))};
        const int level = level_bits(row, x, ux_q24);
        return level <= limit ? alpha_q15[(level & 0xffff) >> 1] : 0;
    }

    __device__ void add_to(pixel *p, int weight) const
    {
        add_colour(p, weight, offset_red >> 16, green_blue & 0xffff, green_blue >> 16);
    }
};

struct dense_list {
    uint64_t *keys;
    uint32_t *places;                      /* indices of the list's splats in the array `keys`; null: all keys */
    uint32_t count;

    __device__ dense_list from(uint32_t first, uint32_t some) const
    {
        return {places ? keys : keys + first, places ? places + first : nullptr, some};
    }

    __device__ uint32_t place_at(uint32_t i) const
    {
        __builtin_assume(__isGlobal(places));
        return places ? __ldcg(&places[i]) : i;
    }

    __device__ uint64_t key_at(uint32_t place) const
    {
        __builtin_assume(__isGlobal(keys));
        return __ldcg(&keys[place]);
    }

    __device__ auto all(const dense_group *g) const
    {
        return [this, g](auto visit_key) { visit(g, [&](uint64_t key, uint32_t) { visit_key(key); }); };
    }

    template <class Visit>
    __device__ void visit(const dense_group *g, Visit visit) const
    {
        enum { FETCHES = 8 };
        for (uint32_t first = g->thread; first < count; first += FETCHES * DENSE_THREADS) {
            uint32_t place[FETCHES];
            uint64_t key[FETCHES];
#pragma unroll
            for (uint32_t i = 0; i < FETCHES; i++)
                place[i] = place_at(min(first + i * DENSE_THREADS, count - 1));
#pragma unroll
            for (uint32_t i = 0; i < FETCHES; i++)
                key[i] = first + i * DENSE_THREADS < count ? key_at(place[i]) : FXS_ENTRY_CUT_OFF;
#pragma unroll
            for (uint32_t i = 0; i < FETCHES; i++)
                if (!(key[i] & FXS_ENTRY_CUT_OFF))
                    visit(key[i], place[i]);
        }
    }
};

__device__ span open_rows(const uint32_t open[ROW_PAIRS])
{
    const uint32_t pair = open[lane_index() % ROW_PAIRS], row = 2 * (lane_index() % ROW_PAIRS);
    const uint32_t rows = __reduce_or_sync(ALL_LANES, (pair & 0xffff ? 1u : 0) << row | (pair >> 16 ? 2u : 0) << row);
    return {rows ? __ffs((int)rows) - 1 : FXS_TILE, 31 - __clz((int)rows)};
}

__device__ bool touches_open(const tile_splats *t, const fxs_splat *s, const uint32_t open[ROW_PAIRS], span rows)
{
    const int32_t first = max((int32_t)s->first_row - t->y, rows.first);
    const int32_t last = min((int32_t)s->last_row - t->y, rows.last);
    row_walk down(t, s, first);
    bool touches = false;
    for (int32_t row = first; row <= last && !touches; row++)
        touches = (down.next(s) & open[row / 2] >> row % 2 * FXS_TILE) != 0;
    return touches;
}

/* Transposes a 32x32 bit matrix: bit i of lane j becomes bit j of lane i. */
__device__ inline uint32_t transpose(uint32_t x)
{
    uint32_t low = 0xffff;
#pragma unroll
    for (uint32_t step = 16; step > 0; step /= 2, low ^= low << step) {
        const bool upper = lane_index() & step;
        const uint32_t other = __shfl_xor_sync(ALL_LANES, x, (int)step), own = upper ? ~low : low;
        x = (x & own) | (__funnelshift_l(other, other, upper ? WARP - step : step) & ~own);
    }
    return x;
}

__device__ void mark_pixels(dense_shared *shared, const tile_splats *t, const fxs_splat *s, uint32_t i, bool listed)
{
    const span rows = open_rows(shared->open);
    const int32_t first = max((int32_t)s->first_row - t->y, rows.first);
    const int32_t last = min((int32_t)s->last_row - t->y, rows.last);
    row_walk down(t, s, first);
    for (uint32_t pair = 0; pair < ROW_PAIRS; pair++)
        shared->masks[pair][i] = 0;
    for (int32_t row = first; row <= last && listed; row++)
        shared->masks[row / 2][i] |= down.next(s) << row % 2 * FXS_TILE;
    for (uint32_t pair = 0; pair < ROW_PAIRS; pair++)
        if (shared->open[pair])
            shared->touching[i / WARP][pair * WARP + lane_index()] = transpose(shared->masks[pair][i]);
}

__device__ void place_splat(dense_shared *shared, const tile_splats *t, const fxs_splat *s, uint32_t i)
{
    const row_walk at(t, s, 0);
    shared->shapes[i] = make_uint4(at.u_q24, (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, at.v_q24);
    shared->shades[i] = make_uint4((uint32_t)s->vy_q24, (uint32_t)s->offset_q11 | (uint32_t)s->colour_q13[0] << 17,
                                   (uint32_t)s->colour_q13[1] << 1 | (uint32_t)s->colour_q13[2] << 17,
                                   (uint32_t)limit_bits(s, t->cut_q11));
}

__device__ inline dense_splat splat_in(const dense_shared *shared, uint32_t i)
{
    return dense_splat(shared->shapes[i], shared->shades[i]);
}

/* Returns the transmittance behind a splat, T (1 - alpha), rounded to nearest with ties downwards. Only two dependent
   operations are used, because they limit the speed of blending. */
__device__ inline int left_q15(int transmittance_q15, int rest_q15)
{
    return (transmittance_q15 * rest_q15 + 16383) >> 15;
}

struct mark_walk {
    const dense_shared *shared;
    uint32_t n, words, word, marks, next_word, next_marks;

    __device__ mark_walk(const dense_shared *of, uint32_t pixel, uint32_t lane)
        : shared(of), n(pixel), words(0), next_word(0), next_marks(0)
    {
#pragma unroll
        for (uint32_t i = 0; i < WORDS; i += QUAD)
            words |= i + lane < WORDS && shared->touching[i + lane][n] ? 1u << i << lane : 0;
        words |= __shfl_xor_sync(ALL_LANES, words, 1);
        words |= __shfl_xor_sync(ALL_LANES, words, 2);
        fetch();
        fetch();
    }

    __device__ void fetch()
    {
        word = next_word;
        marks = next_marks;
        next_word = words ? (uint32_t)__ffs((int)words) - 1 : 0;
        next_marks = words ? shared->touching[next_word][n] : 0;
        words &= words - 1;
    }

    /* Each lane of a quad (four lanes) takes one of a pixel's next four marked splats. Returns the index of this lane's
       splat, or WORDS * WARP for none. */
    __device__ uint32_t next(uint32_t lane)
    {
        uint32_t own = 0;
#pragma unroll
        for (uint32_t i = 0; i < QUAD; i++) {
            own = i == lane ? marks : own;
            marks &= marks - 1;
        }
        const uint32_t place = own ? word * WARP + (uint32_t)__ffs((int)own) - 1 : WORDS * WARP;
        if (!marks)
            fetch();
        return place;
    }
};

/* Blends the splats that are marked for pixel n of the tile. The four lanes of a quad compute one alpha each; then the
   four weights follow in sequence. */
__device__ pixel blend_quad(const dense_shared *shared, uint32_t n, bool active)
{
    const uint32_t lane = lane_index() % QUAD;
    const pixel before = active ? shared->pixels[n] : pixel{};
    pixel p = {before.transmittance, 0, 0};                /* each of the four lanes sums the colours of its own
                                                              splats */
    mark_walk walk(shared, n, lane);
    while (__any_sync(ALL_LANES, active && walk.marks)) {
        const uint32_t place = walk.next(lane);
        const bool marked = place < WORDS * WARP;
        const dense_splat s = splat_in(shared, marked ? place : 0);
        const int alpha = marked ? s.alpha_at(shared->alpha_q15, n % FXS_TILE, n / FXS_TILE) : 0;
        int weight = 0;
#pragma unroll
        for (uint32_t i = 0; i < QUAD; i++) {
            const int left = left_q15(p.transmittance, 32768 - __shfl_sync(ALL_LANES, alpha, (int)i, QUAD));
            const bool open = p.transmittance >= FXS_CLOSED_Q15;
            weight = open && i == lane ? p.transmittance - left : weight;
            p.transmittance = open ? left : p.transmittance;
        }
        s.add_to(&p, weight);
        active = active && p.transmittance >= FXS_CLOSED_Q15;
    }
    for (int step = 1; step < (int)QUAD; step *= 2) {
        p.red_green += __shfl_xor_sync(ALL_LANES, p.red_green, step);
        p.blue += __shfl_xor_sync(ALL_LANES, p.blue, step);
    }
    return {p.transmittance, before.red_green + p.red_green, before.blue + p.blue};
}

struct open_pixels {
    uint32_t open, start, end, all;

    __device__ explicit open_pixels(const dense_shared *shared)
    {
        open = lane_index() < ROW_PAIRS ? shared->open[lane_index()] : 0;
        end = warp_sum((uint32_t)__popc(open));
        start = end - (uint32_t)__popc(open);
        all = __shfl_sync(ALL_LANES, end, WARP - 1);
    }

    /* Returns the index in the tile of the i-th pixel that is not opaque yet. If i >= all, the number of such pixels,
       the index is arbitrary. */
    __device__ uint32_t place(uint32_t i) const
    {
        uint32_t pair = 0;
        for (uint32_t step = ROW_PAIRS / 2; step > 0; step /= 2)
            pair += __shfl_sync(ALL_LANES, end, (int)(pair + step - 1)) <= i ? step : 0;
        const uint32_t before = __shfl_sync(ALL_LANES, start, (int)pair);
        const uint32_t bits = __shfl_sync(ALL_LANES, open, (int)pair);
        return pair * WARP + (i < all ? bit_of(bits, i - before) : 0);
    }
};

__device__ inline void keep_pixel(dense_shared *shared, uint32_t n, const pixel &p)
{
    shared->pixels[n] = p;
    if (p.transmittance < FXS_CLOSED_Q15)
        atomicAnd(&shared->open[n / WARP], ~(1u << n % WARP));
}

__device__ void blend_quads(dense_shared *shared, const open_pixels &pixels, const dense_group *g)
{
    for (uint32_t i = g->thread / QUAD; i - lane_index() / QUAD < pixels.all; i += DENSE_THREADS / QUAD) {
        const uint32_t n = pixels.place(i);
        const pixel p = blend_quad(shared, n, i < pixels.all);
        __syncwarp();
        if (i < pixels.all && lane_index() % QUAD == 0)
            keep_pixel(shared, n, p);
    }
}

/* Calls visit(step, splat index) for each splat that a bit mask of pixel n marks; `step` counts these splats. Returns
   the number of splats. */
template <class Visit>
__device__ uint32_t visit_steps(const dense_shared *shared, uint32_t n, uint32_t first, uint32_t words, Visit visit)
{
    const uint32_t word = first + lane_index();
    uint32_t marks = lane_index() < words && word < WORDS ? shared->touching[word][n] : 0;
    const uint32_t end = warp_sum((uint32_t)__popc(marks));
    for (uint32_t step = end - (uint32_t)__popc(marks); marks; marks &= marks - 1)
        visit(step++, word * WARP + (uint32_t)__ffs((int)marks) - 1);
    return __shfl_sync(ALL_LANES, end, WARP - 1);
}

/* Replaces 1 - alpha of each splat at a pixel by the splat's weight. Returns the number of splats until the pixel is
   opaque. */
__device__ uint32_t weigh_steps(uint16_t *steps, uint32_t each, uint32_t count, int *transmittance)
{
    enum { AT_ONCE = 16 };
    uint32_t i = 0;
    for (; i + AT_ONCE <= count && *transmittance >= FXS_CLOSED_Q15; i += AT_ONCE) {
        int left[AT_ONCE + 1] = {*transmittance};
#pragma unroll
        for (uint32_t k = 0; k < AT_ONCE; k++)
            left[k + 1] = left_q15(left[k], steps[(i + k) * each]);
        if (left[AT_ONCE] < FXS_CLOSED_Q15)
            break;
#pragma unroll
        for (uint32_t k = 0; k < AT_ONCE; k++)
            steps[(i + k) * each] = (uint16_t)(left[k] - left[k + 1]);
        *transmittance = left[AT_ONCE];
    }
    for (; i < count && *transmittance >= FXS_CLOSED_Q15; i++) {
        const int left = left_q15(*transmittance, steps[i * each]);
        steps[i * each] = (uint16_t)(*transmittance - left);
        *transmittance = left;
    }
    return i;
}

/* Blends the splats if at most FEW pixels are not opaque yet. For each pixel, a warp computes the alphas, one lane
   computes the weights, and the warp sums the colours. */
__device__ void blend_few(dense_shared *shared, const open_pixels &pixels, const dense_group *g)
{
    const uint32_t warp = g->thread / WARP, all = pixels.all, words = min(STEPS_MOST / (all * WARP), WARP);
    uint16_t *steps = shared->steps;
    for (uint32_t first = 0; first < WORDS; first += words) {
        for (uint32_t i = warp; i < all; i += DENSE_THREADS / WARP) {
            const uint32_t n = pixels.place(i);
            const uint32_t count = visit_steps(shared, n, first, words, [&](uint32_t step, uint32_t place) {
                const int alpha = splat_in(shared, place).alpha_at(shared->alpha_q15, n % FXS_TILE, n / FXS_TILE);
                steps[step * all + i] = (uint16_t)(32768 - alpha);
            });
            if (lane_index() == 0)
                shared->few[i] = {n, count};
        }
        g->sync();
        if (g->thread < all) {
            auto *own = &shared->few[g->thread];
            own->count = weigh_steps(steps + g->thread, all, own->count, &shared->pixels[own->n].transmittance);
        }
        g->sync();
        for (uint32_t i = warp; i < all; i += DENSE_THREADS / WARP) {
            const uint32_t n = shared->few[i].n, count = shared->few[i].count;
            const pixel before = shared->pixels[n];
            pixel p = {before.transmittance, 0, 0};
            visit_steps(shared, n, first, words, [&](uint32_t step, uint32_t place) {
                if (step < count)
                    splat_in(shared, place).add_to(&p, steps[step * all + i]);
            });
            p.red_green = __reduce_add_sync(ALL_LANES, p.red_green) + before.red_green;
            p.blue = __reduce_add_sync(ALL_LANES, p.blue) + before.blue;
            __syncwarp();
            if (lane_index() == 0)
                keep_pixel(shared, n, p);
        }
        g->sync();
    }
}

/* Blends the collected splats in shared->keys. Returns true if a pixel of the tile is not opaque yet. This function is
   not inlined, to leave registers to the callers' loops. */
__device__ __noinline__ bool blend_collected(dense_shared *shared, tile_splats tile, uint32_t count)
{
    const tile_splats *t = &tile;
    const dense_group own = {0, threadIdx.x}, *g = &own;
    __builtin_assume(__isShared(shared));
    sort_keys(shared->entries, &shared->keys, shared->bins, count, g);
    for (uint32_t i = g->thread; i < dense_keys::room; i += DENSE_THREADS) {
        const uint32_t entry = i < count ? shared->entries[i] : FXS_ENTRY_CUT_OFF;
        const bool listed = !(entry & FXS_ENTRY_CUT_OFF);
        fxs_splat s = {};
        if (listed) {
            s = t->splat_of(entry);
            place_splat(shared, t, &s, i);
        }
        mark_pixels(shared, t, &s, i, listed);
    }
    if (g->thread == 0)
        shared->collected = 0;
    g->sync();
    const open_pixels pixels(shared);
    g->sync();                                 /* waits until all threads have read shared->open */
    if (pixels.all > FEW)
        blend_quads(shared, pixels, g);
    else if (pixels.all)
        blend_few(shared, pixels, g);
    g->sync();
    return g->any(lane_index() < ROW_PAIRS && shared->open[lane_index()]);
}

template <class Keep>
__device__ void visit_open(const dense_shared *shared, const tile_splats *t, const dense_list &list,
                           const dense_group *g, Keep keep)
{
    enum { FETCHES = 2 };
    const span rows = open_rows(shared->open);
    for (uint32_t first = g->thread; first - g->thread < list.count; first += FETCHES * DENSE_THREADS) {
        uint64_t keys[FETCHES];
        uint32_t places[FETCHES];
        fxs_splat splats[FETCHES];
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            places[k] = list.place_at(min(first + k * DENSE_THREADS, list.count - 1));
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            keys[k] = first + k * DENSE_THREADS < list.count ? list.key_at(places[k]) : FXS_ENTRY_CUT_OFF;
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            splats[k] = t->splat_of(keys[k]);
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            keep(keys[k], places[k],
                 !(keys[k] & FXS_ENTRY_CUT_OFF) && touches_open(t, &splats[k], shared->open, rows));
    }
    g->sync();
}

__device__ uint32_t collected(const dense_shared *shared, const dense_group *g)
{
    const uint32_t count = shared->collected;
    g->sync();
    return count;
}

/* Appends to shared->keys the keys of the list's splats that can touch a pixel that is not opaque yet. Returns the
   total number of keys, which may exceed the capacity of shared->keys. */
__device__ __noinline__ uint32_t collect(dense_shared *shared, tile_splats tile, dense_list list)
{
    const tile_splats *t = &tile;
    const dense_group own = {0, threadIdx.x}, *g = &own;
    __builtin_assume(__isShared(shared));
    visit_open(shared, t, list, g, [&](uint64_t key, uint32_t, bool kept) {
        const uint32_t place = take_number(&shared->collected, 0, kept);
        if (kept && place < dense_keys::room)
            shared->keys.keys[place] = key;
    });
    return collected(shared, g);
}

/* Moves the keys of the splats that can touch a pixel that is not opaque yet to the start of the list. Returns the
   number of these splats. */
__device__ uint32_t drop_closed(dense_shared *shared, const tile_splats *t, const dense_list &list,
                                const dense_group *g)
{
    visit_open(shared, t, list, g, [&](uint64_t key, uint32_t place, bool kept) {
        const uint32_t to = take_number(&shared->collected, 0, kept);
        g->sync();                         /* waits until all threads have read the entries that are overwritten next */
        if (kept && list.places)
            list.places[to] = place;
        else if (kept)
            list.keys[to] = key;
    });
    const uint32_t left = collected(shared, g);
    if (g->thread == 0)
        shared->collected = 0;
    g->sync();
    return left;
}

__device__ uint32_t sum_of(dense_shared *shared, uint32_t own, const dense_group *g)
{
    own = __reduce_add_sync(ALL_LANES, own);
    if (lane_index() == 0)
        atomicAdd(&shared->collected, own);
    g->sync();
    const uint32_t sum = collected(shared, g);
    if (g->thread == 0)
        shared->collected = 0;
    g->sync();
    return sum;
}

__device__ bool blend_rounds(dense_shared *shared, const tile_splats *t, const dense_list &list, const dense_group *g)
{
    const auto visit_all = list.all(g);
    uint32_t own = 0;
    visit_all([&](uint64_t) { own++; });
    const uint32_t count = sum_of(shared, own, g);
    key_range r = range_of_list(&shared->keys, g, visit_all);
    bool open = true;
    for (uint32_t done = 0; done < count && open;) {
        const uint32_t keys = next_round(&r, &shared->keys, shared->bins, g, visit_all);
        open = blend_collected(shared, *t, keys);
        done += keys;
    }
    return open;
}

__device__ uint64_t *take_room(dense_shared *shared, const frame_buffers *f, uint32_t count, const dense_group *g)
{
    if (g->thread == 0)
        shared->room = take_entries(f, count);
    g->sync();
    return shared->room;
}

template <class List, class Moved>
__device__ uint32_t split_list(Moved *room, uint32_t *ends, dense_shared *shared, const List &list, key_range r,
                               const dense_group *g)
{
    move_to_bins(room, &shared->keys, ends, r, g, [&](auto visit) {
        list.visit(g, [&](uint64_t key, uint32_t place) {
            visit(key, sizeof(Moved) == sizeof key ? (Moved)key : (Moved)place);
        });
    });
    return ends[dense_keys::bins - 1];
}

template <bool Finer>
__device__ bool blend_split(dense_shared *shared, const frame_buffers *f, const tile_splats *t, const dense_list &list,
                            const uint32_t *ends, const dense_group *g);

__device__ bool blend_finer(dense_shared *shared, const frame_buffers *f, const tile_splats *t, const dense_list &list,
                            const dense_group *g)
{
    const uint32_t words = dense_keys::bins / 2;
    uint64_t *room = take_room(shared, f, words + (list.places ? (list.count + 1) / 2 : list.count), g);
    if (!room)
        return blend_rounds(shared, t, list, g);
    const key_range r = range_of_list(&shared->keys, g, list.all(g));
    dense_list finer = list;
    if (list.places)
        split_list(finer.places = (uint32_t *)(room + words), shared->bins, shared, list, r, g);
    else
        split_list(finer.keys = room + words, shared->bins, shared, list, r, g);
    for (uint32_t i = g->thread; i < dense_keys::bins; i += DENSE_THREADS)
        ((uint32_t *)room)[i] = shared->bins[i];
    g->sync();
    return blend_split<true>(shared, f, t, finer, (const uint32_t *)room, g);
}

/* Blends a list of splats, one depth bin after another. A bin that does not fit into shared memory is split into finer
   bins. */
template <bool Finer>
__device__ bool blend_split(dense_shared *shared, const frame_buffers *f, const tile_splats *t, const dense_list &list,
                            const uint32_t *ends, const dense_group *g)
{
    uint32_t have = 0, reach = 0;
    for (uint32_t first = 0, end; first < list.count; first = end) {
        const uint32_t room = dense_keys::room - have;
        end = have > FULL ? first : bins_end<dense_keys>(ends, first, max(room, reach));
        if (end == first && have) {
            if (!blend_collected(shared, *t, have))
                return false;
            have = 0;
            end = bins_end<dense_keys>(ends, first, dense_keys::room);
        }
        if (end > first) {
            const uint32_t all = collect(shared, *t, list.from(first, end - first)), kept = all - have;
            if (all <= dense_keys::room) {
                const uint32_t hoped = (dense_keys::room - all) * (end - first) / (kept + kept / 2 + 8);
                reach = min(min(hoped, 2 * (end - first)), REACH_MOST);
                have = all;
                continue;
            }
            if (g->thread == 0)                /* too many splats were collected: discards the new splats and collects
                                                  fewer */
                shared->collected = have;
            g->sync();
            reach = 0;
            end = first;
            continue;
        }
        end = bin_end<dense_keys>(ends, first);
        const dense_list left = list.from(first, drop_closed(shared, t, list.from(first, end - first), g));
        if (left.count <= dense_keys::room)
            have = collect(shared, *t, left);
        else if (!(Finer ? blend_rounds(shared, t, left, g) : blend_finer(shared, f, t, left, g)))
            return false;
    }
    return !have || blend_collected(shared, *t, have);
}

/* Sorts the splats of a tile's list into bins of depth. Returns a list with null keys if scratch memory is short. */
__device__ dense_list split_tile(dense_shared *shared, const frame_buffers *f, const dense_list &all,
                                 const dense_group *g)
{
    uint64_t *room = take_room(shared, f, all.count, g);
    if (!room)
        return {nullptr, nullptr, 0};
    return {room, nullptr, split_list(room, shared->ends, shared, all, range_of_list(&shared->keys, g, all.all(g)), g)};
}

__device__ dense_list split_part(dense_shared *shared, const frame_buffers *f, const part_list &part, key_range r,
                                 const dense_group *g)
{
    bool missing;
    const uint32_t count = sum_of(shared, part.count_own(&missing, g), g);
    uint32_t *room = g->any(missing) ? nullptr : (uint32_t *)take_room(shared, f, (count + 1) / 2, g);
    if (!room)
        return {nullptr, nullptr, 0};
    split_list(room, shared->ends, shared, part, r, g);
    return {part.keys, room, count};
}

__device__ void blend_dense_list(dense_shared *shared, const frame_buffers *f, const tile_splats *t,
                                 const turn_of_tile &turn, uint32_t parts, const dense_group *g)
{
    const tile_entries list = entries_of(f, turn.tile);
    const dense_list all = {list.first, nullptr, list.count};
    const dense_list split = turn.turns == 1
                                 ? split_tile(shared, f, all, g)
                                 : split_part(shared, f, part_list(f, turn, parts), range_of_shared(f, turn), g);
    if (split.keys)
        blend_split<false>(shared, f, t, split, shared->ends, g);
    else
        blend_rounds(shared, t, all, g);
}

__global__ void __launch_bounds__(DENSE_THREADS, DENSE_BLOCKS) blend_dense(const __grid_constant__ fxs_stage_view view,
                                                                           const __grid_constant__ frame_buffers f,
                                                                           const __grid_constant__ target t)
{
    dense_shared *shared = (dense_shared *)shared_memory();
    const dense_group g = {0, threadIdx.x};
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y);
    wait_for_last_kernel();
    if (!fits(&f))
        return;
    const uint32_t parts = parts_of_tiles(&f, gridDim.x);
    const turns order = turns_of(&f, parts);
    if (blockIdx.x >= order.all)
        return;
    for (uint32_t level = threadIdx.x; level <= FXS_FAINT_Q11; level += DENSE_THREADS)
        shared->alpha_q15[level] = (uint16_t)fxs_alpha_q15((int)level);
    for (;;) {
        if (threadIdx.x == 0) {
            shared->turn = atomicAdd(&f.status->next_dense, 1u);
            shared->collected = 0;
        }
        g.sync();
        if (shared->turn >= order.all)
            return;
        const turn_of_tile turn = tile_of_turn(&f, &order, tiles, shared->turn);
        const uint32_t tile = turn.tile;
        const tile_splats at(&view, &f, tile);
        const int32_t px = at.x + (int32_t)(g.thread % FXS_TILE), py = at.y + (int32_t)(g.thread / FXS_TILE);
        const bool inside = g.thread < FXS_TILE_PIXELS && px < view.width && py < view.height &&
                            g.thread % FXS_TILE / (FXS_TILE / turn.turns) == turn.number;
        const uint32_t open = __ballot_sync(ALL_LANES, inside);
        if (g.thread < FXS_TILE_PIXELS)
            shared->pixels[g.thread] = {FXS_CLEAR_Q15, 0, 0};
        if (g.thread < FXS_TILE_PIXELS && lane_index() == 0)
            shared->open[g.thread / WARP] = open;
        g.sync();
        blend_dense_list(shared, &f, &at, turn, parts, &g);
        if (inside)
            store_pixel(&t, &f, &shared->pixels[g.thread], px, py);
        g.sync();
    }
}

}

#endif
