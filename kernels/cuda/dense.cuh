/* blend_dense: blends long lists, whose splats are mostly small. A block has a tile. It puts the list into bins by
 * depth. Then, bin after bin, it collects the splats that can touch an open pixel. Once there are enough of them, they
 * are sorted; each thread marks the pixels that its splat can touch; and each pixel takes the splats that are marked
 * for it, in order. A pixel is the work of a quad of lanes; where few pixels are open, of a warp. They
 * compute for 4 or 32 splats at once everything that does not depend on the order. */
#ifndef FXS_CUDA_DENSE_CUH
#define FXS_CUDA_DENSE_CUH

#include "blend.cuh"

namespace {

const uint32_t DENSE_THREADS = 1024, DENSE_BLOCKS = 1;  /* of a multiprocessor */
const uint32_t ROW_PAIRS = FXS_TILE / 2;               /* of a tile: 32 pixels */
typedef group<DENSE_THREADS> dense_group;
typedef group_keys<960> dense_keys;
const uint32_t FULL = 512;                 /* collected: no more are looked for */
const uint32_t REACH_MOST = 8192;          /* looked at at a time, where few are kept */
const uint32_t WORDS = dense_keys::room / WARP, BLOCKS_MOST = 16, SHARE_MAGNITUDE = 11;
const uint32_t QUAD = 4, CROWD = 96;   /* lanes; more open pixels than that take a quad each */

struct dense_shared {
    dense_keys keys;
    uint32_t entries[dense_keys::room];    /* sorted */
    uint32_t ends[dense_keys::bins];       /* of the bins, in the list */
    uint4 shapes[dense_keys::room];        /* dense_splat, of the keys sorted, near to far */
    uint4 shades[dense_keys::room];
    uint32_t masks[ROW_PAIRS][dense_keys::room];    /* of the pixels that each can touch */
    union {
        uint32_t bins[dense_keys::bins];
        uint32_t touching[WORDS][FXS_TILE_PIXELS + 1];   /* of those splats, a bit each; + 1: in different banks */
    };
    uint16_t alpha_q15[FXS_FAINT_Q11 + 1];
    uint64_t *room;
    uint32_t turn, collected;
    pixel pixels[FXS_TILE_PIXELS];
    uint32_t open[ROW_PAIRS];              /* of those, a bit each */
};

static_assert(!has_gaps<dense_keys, DENSE_THREADS>, "ends have gaps");
static_assert(sizeof(dense_shared) <= 163 << 10, "more shared memory than a block of an A100 has");

/* How many blocks share the columns of a tile whose list is of magnitude 31 - lane, so that none is late: as many as
   make its share about half of what a multiprocessor has of all lists, but for 2^SHARE_MAGNITUDE entries or more each.
   A splat is often in the columns of one or two blocks, each of which puts it into bins of its own: where there is not
   room for that, shares are twice as large, and so on. */
__device__ inline uint32_t blocks_a_tile(const frame_buffers *f)
{
    const uint32_t magnitude = WARP - 1 - lane_index();
    const uint64_t entries = magnitude >= LONG_MAGNITUDE ? f->status->class_entries[magnitude] : 0;
    const uint64_t all = __shfl_sync(ALL_LANES, warp_sum(entries), WARP - 1), shares = 2 * gridDim.x / DENSE_BLOCKS;
    const uint64_t room = f->split_capacity + spare_entries(f);
    uint32_t wanted = 1;
    uint64_t needed = UINT64_MAX;
    for (uint64_t share = all; needed > room && share <= shares * all; share *= 2) {
        wanted = 1;
        while (wanted < BLOCKS_MOST && wanted << SHARE_MAGNITUDE < 1u << magnitude &&
               ((uint64_t)2 << magnitude) * shares > wanted * share)
            wanted *= 2;
        needed = __shfl_sync(ALL_LANES, warp_sum(wanted > 1 ? entries * (wanted + 4) / 4 : entries), WARP - 1);
    }
    return magnitude < LONG_MAGNITUDE ? 0 : needed <= room ? wanted : 1;
}

/* A splat as a pixel takes it, by two reads of 16 bytes: splats side by side lie in different banks. */
struct dense_splat {
    uint32_t u_q24, ux_q24, uy_q24, v_q24; /* u and v at the tile's first pixel: a shape */
    uint32_t vy_q24, offset_red, green_blue;
    int limit;                             /* of the level's bits */

    __device__ dense_splat(const uint4 &shape, const uint4 &shade)
        : u_q24(shape.x), ux_q24(shape.y), uy_q24(shape.z), v_q24(shape.w), vy_q24(shade.x), offset_red(shade.y),
          green_blue(shade.z), limit((int)shade.w)
    {
    }

    /* alpha at a pixel of the tile, 0 where it does not count. */
    __device__ int alpha_at(const uint16_t *alpha_q15, uint32_t x, uint32_t y) const
    {
        const queued_row row = {u_q24 + y * uy_q24, row_level(v_q24 + y * vy_q24, (int)(offset_red & 0xffff))};
        const int level = level_bits(row, x, ux_q24);
        return level <= limit ? alpha_q15[(level & 0xffff) >> 1] : 0;
    }

    __device__ void add_to(pixel *p, int weight) const
    {
        p->sum[0] += fxs_mul_q15(weight, (int)(offset_red >> 16));
        p->sum[1] += fxs_mul_q15(weight, (int)(green_blue & 0xffff));
        p->sum[2] += fxs_mul_q15(weight, (int)(green_blue >> 16));
    }
};

/* A tile being blended; (x, y): its first pixel. */
struct dense_tile {
    const fxs_view *view;
    const fxs_splat *splats;
    int32_t x, y;
};

/* Calls visit(key) for the keys of a list that can touch a pixel of the tile; of those with `marks` for those that are
   marked, a bit each. */
template <class Visit>
__device__ void visit_near(const uint64_t *list, const uint32_t *marks, uint32_t count, const dense_group *g,
                           Visit visit)
{
    enum { FETCHES = 8 };
    for (uint32_t first = g->thread; first < count; first += FETCHES * DENSE_THREADS) {
        uint64_t k[FETCHES];
        uint32_t marked[FETCHES];
#pragma unroll
        for (uint32_t i = 0; i < FETCHES; i++) {
            const uint32_t place = first + i * DENSE_THREADS;
            k[i] = place < count ? __ldcg(&list[place]) : FXS_ENTRY_CUT_OFF;
            marked[i] = marks && place < count ? __ldcg(&marks[place / WARP]) : ALL_LANES;
        }
#pragma unroll
        for (uint32_t i = 0; i < FETCHES; i++)
            if (!(k[i] & FXS_ENTRY_CUT_OFF) && marked[i] >> lane_index() & 1)
                visit(k[i]);
    }
}

/* Moves keys of a list, as visit_near has them, to `sorted`, bin after bin; shared->ends has where they end. Returns
   how many. */
__device__ uint32_t split_list(uint64_t *sorted, dense_shared *shared, const uint64_t *list, const uint32_t *marks,
                               uint32_t count, key_range r, const dense_group *g)
{
    move_to_bins(sorted, &shared->keys, shared->ends, r, g,
                 [&](auto visit) { visit_near(list, marks, count, g, visit); });
    return shared->ends[dense_keys::bins - 1];
}

/* sqrt(x), to within 1 part in 2^22; x at least 1. */
__device__ inline float root_of_level(float x)
{
    float root;
    asm("sqrt.approx.f32 %0, %1;" : "=f"(root) : "f"(x));
    return root;
}

/* x rounded down, 0 to 31. */
__device__ inline uint32_t whole(float x)
{
    return (uint32_t)__float_as_int(__fadd_rd(fminf(fmaxf(x, 0), 31), 8388608.0f)) % 32;
}

/* The pixels of a row, a bit each, that a splat can touch: |u| at most the root of what the row leaves of the level,
   widened by more than the rounding of u. */
__device__ inline uint32_t pixels_of_row(uint32_t u_q24, float inverse, float left)
{
    const float u = coordinate_q6(u_q24), reach = root_of_level(fmaxf(left, 0) + 1) * 1.0001f + 0.05f;
    const uint32_t first = whole((-reach - u) * inverse + 0.95f);
    const uint32_t end = whole(fminf((reach - u) * inverse + 1.05f, FXS_TILE));
    return left >= 0 && first < end ? (1u << end) - (1u << first) : 0;
}

/* A splat on its way down the rows of a tile. */
struct row_walk {
    uint32_t u_q24, v_q24;                 /* at the row's first pixel */
    float inverse, limit;

    __device__ row_walk(const dense_tile *t, const fxs_splat *s, int32_t row)
    {
        const uint32_t y = (uint32_t)(t->y + row);
        u_q24 = s->u0_q24 + (uint32_t)t->x * (uint32_t)s->ux_q24 + y * (uint32_t)s->uy_q24;
        v_q24 = s->v0_q24 + y * (uint32_t)s->vy_q24;
        inverse = __fdividef(262144, (float)max(s->ux_q24, 1));
        limit = __int_as_float(limit_bits(s, t->view));
    }

    /* The pixels that it can touch of this row; goes on to the next one. */
    __device__ uint32_t next(const fxs_splat *s)
    {
        const uint32_t pixels = pixels_of_row(u_q24, inverse, limit - row_level(v_q24, s->offset_q11));
        u_q24 += (uint32_t)s->uy_q24;
        v_q24 += (uint32_t)s->vy_q24;
        return pixels;
    }
};

/* The rows with an open pixel, from the first to the last. */
__device__ span open_rows(const uint32_t open[ROW_PAIRS])
{
    const uint32_t pair = open[lane_index() % ROW_PAIRS], row = 2 * (lane_index() % ROW_PAIRS);
    const uint32_t rows = __reduce_or_sync(ALL_LANES, (pair & 0xffff ? 1u : 0) << row | (pair >> 16 ? 2u : 0) << row);
    return {rows ? __ffs((int)rows) - 1 : FXS_TILE, 31 - __clz((int)rows)};
}

/* Whether a splat can touch an open pixel; rows: those with one. */
__device__ bool touches_open(const dense_tile *t, const fxs_splat *s, const uint32_t open[ROW_PAIRS], span rows)
{
    const int32_t first = max((int32_t)s->first_row - t->y, rows.first);
    const int32_t last = min((int32_t)s->last_row - t->y, rows.last);
    row_walk down(t, s, first);
    bool touches = false;
    for (int32_t row = first; row <= last && !touches; row++)
        touches = (down.next(s) & open[row / 2] >> row % 2 * FXS_TILE) != 0;
    return touches;
}

/* Bit i of lane j becomes bit j of lane i. */
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

/* Marks the pixels that each thread's splat, the one in place i, can touch, in pairs of rows with an open one. */
__device__ void mark_pixels(dense_shared *shared, const dense_tile *t, const fxs_splat *s, uint32_t i, bool listed)
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

/* Keeps a splat for blending, in place i. */
__device__ void place_splat(dense_shared *shared, const dense_tile *t, const fxs_splat *s, uint32_t i)
{
    const row_walk at(t, s, 0);
    shared->shapes[i] = make_uint4(at.u_q24, (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, at.v_q24);
    shared->shades[i] = make_uint4((uint32_t)s->vy_q24, (uint32_t)s->offset_q11 | (uint32_t)s->colour_q13[0] << 16,
                                   (uint32_t)s->colour_q13[1] | (uint32_t)s->colour_q13[2] << 16,
                                   (uint32_t)limit_bits(s, t->view));
}

__device__ inline dense_splat splat_in(const dense_shared *shared, uint32_t i)
{
    return dense_splat(shared->shapes[i], shared->shades[i]);
}

/* T - fxs_weight_q15(alpha, T) = (T (1 - alpha) + 1/2) rounded down, but for a half. In two steps, as each splat of a
   pixel waits for the one before it. T of a closed pixel stays. */
__device__ inline int left_q15(int transmittance_q15, int alpha_q15)
{
    const int left = (transmittance_q15 * (32768 - alpha_q15) + 16383) >> 15;
    return transmittance_q15 >= FXS_CLOSED_Q15 ? left : transmittance_q15;
}

/* Blends the lanes' splats in order over one pixel, the same for all lanes: their weights one after the other, then the
   colours at once. */
__device__ inline void blend_lanes(pixel *p, int alpha, const dense_splat &s)
{
    enum { AT_ONCE = 4 };                      /* alphas fetched */
    pixel own = {0, {0, 0, 0}};
    int weight = 0;
    for (unsigned lanes = __ballot_sync(ALL_LANES, alpha > 0); lanes && p->transmittance >= FXS_CLOSED_Q15;) {
        int lane[AT_ONCE], alphas[AT_ONCE];
#pragma unroll
        for (int i = 0; i < AT_ONCE; i++) {
            lane[i] = __ffs((int)lanes) - 1;   /* -1: none is left */
            const int of_lane = __shfl_sync(ALL_LANES, alpha, lane[i] & 31);
            alphas[i] = lanes ? of_lane : 0;
            lanes &= lanes - 1;
        }
#pragma unroll
        for (int i = 0; i < AT_ONCE; i++) {
            const int left = left_q15(p->transmittance, alphas[i]);
            weight = (int)lane_index() == lane[i] ? p->transmittance - left : weight;
            p->transmittance = left;
        }
    }
    s.add_to(&own, weight);
    for (int c = 0; c < 3; c++)
        p->sum[c] += __reduce_add_sync(ALL_LANES, own.sum[c]);
}

/* Blends the splats that are marked at pixel n of the tile, by a warp. */
__device__ pixel blend_warp(const dense_shared *shared, uint32_t n)
{
    const uint32_t marks = lane_index() < WORDS ? shared->touching[lane_index()][n] : 0;
    pixel p = shared->pixels[n];
    share_out((uint32_t)__popc(marks), [&](int lane, uint32_t item, bool active) {
        const uint32_t place = (uint32_t)lane * WARP + bit_of(__shfl_sync(ALL_LANES, marks, lane), item);
        const dense_splat s = splat_in(shared, active ? place : 0);
        blend_lanes(&p, active ? s.alpha_at(shared->alpha_q15, n % FXS_TILE, n / FXS_TILE) : 0, s);
    });
    return p;
}

/* The marks of a pixel, four at a time, of one word. */
struct mark_walk {
    const dense_shared *shared;
    uint32_t n, words, word, marks, next_word, next_marks;   /* words: with marks, those still to fetch */

    /* By the four lanes of a quad. */
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

    /* The place of a lane's splat, of the next four; WORDS * WARP where there is none. */
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

/* The same by a quad of lanes, each of a warp for its own pixel: four splats at a time, an alpha a lane, then their
   weights one after the other. Quads that are not active have none. */
__device__ pixel blend_quad(const dense_shared *shared, uint32_t n, bool active)
{
    const uint32_t lane = lane_index() % QUAD;
    const pixel before = active ? shared->pixels[n] : pixel{};
    pixel p = {before.transmittance, {0, 0, 0}};           /* each lane adds up its own */
    mark_walk walk(shared, n, lane);
    while (__any_sync(ALL_LANES, active && walk.marks)) {
        const uint32_t place = walk.next(lane);
        const bool marked = place < WORDS * WARP;
        const dense_splat s = splat_in(shared, marked ? place : 0);
        const int alpha = marked ? s.alpha_at(shared->alpha_q15, n % FXS_TILE, n / FXS_TILE) : 0;
        int weight = 0;
#pragma unroll
        for (uint32_t i = 0; i < QUAD; i++) {
            const int left = left_q15(p.transmittance, __shfl_sync(ALL_LANES, alpha, (int)i, QUAD));
            weight = i == lane ? p.transmittance - left : weight;
            p.transmittance = left;
        }
        s.add_to(&p, weight);
        active = active && p.transmittance >= FXS_CLOSED_Q15;
    }
    for (int c = 0; c < 3; c++) {
        p.sum[c] += __shfl_xor_sync(ALL_LANES, p.sum[c], 1);
        p.sum[c] += __shfl_xor_sync(ALL_LANES, p.sum[c], 2) + before.sum[c];
    }
    return p;
}

/* Blends the open pixels: by a quad each where there are many, else by a warp each. */
__device__ void blend_pixels(dense_shared *shared, const dense_group *g)
{
    const uint32_t warp = g->thread / WARP;
    const uint32_t open = lane_index() < ROW_PAIRS ? shared->open[lane_index()] : 0, own = (uint32_t)__popc(open);
    const uint32_t end = warp_sum(own), all = __shfl_sync(ALL_LANES, end, WARP - 1);
    const bool crowd = all > CROWD;
    const uint32_t each = crowd ? QUAD : WARP;             /* lanes of a pixel */
    g->sync();                                 /* all have read what is open */
    for (uint32_t i = g->thread / each; i - lane_index() / each < all; i += DENSE_THREADS / each) {
        uint32_t pair = 0;                     /* of rows, that has the i-th open pixel */
        for (uint32_t step = ROW_PAIRS / 2; step > 0; step /= 2)
            pair += __shfl_sync(ALL_LANES, end, (int)(pair + step - 1)) <= i ? step : 0;
        const uint32_t before = __shfl_sync(ALL_LANES, end - own, (int)pair);
        const uint32_t bits = __shfl_sync(ALL_LANES, open, (int)pair);
        const uint32_t n = pair * WARP + (i < all ? bit_of(bits, i - before) : 0);
        const pixel p = crowd ? blend_quad(shared, n, i < all) : blend_warp(shared, n);
        __syncwarp();
        if (i < all && lane_index() % each == 0) {
            shared->pixels[n] = p;
            if (p.transmittance < FXS_CLOSED_Q15)
                atomicAnd(&shared->open[pair], ~(1u << n % WARP));
        }
    }
}

/* Blends shared->keys, `count` of them. Returns whether any pixel is open. */
__device__ bool blend_collected(dense_shared *shared, const dense_tile *t, uint32_t count, const dense_group *g)
{
    sort_keys(shared->entries, &shared->keys, shared->bins, count, g);
    for (uint32_t i = g->thread; i < dense_keys::room; i += DENSE_THREADS) {
        const uint32_t entry = i < count ? shared->entries[i] : FXS_ENTRY_CUT_OFF;
        const bool listed = !(entry & FXS_ENTRY_CUT_OFF);
        fxs_splat s = {};
        if (listed) {
            s = t->splats[entry];
            place_splat(shared, t, &s, i);
        }
        mark_pixels(shared, t, &s, i, listed);
    }
    if (g->thread == 0)
        shared->collected = 0;
    g->sync();
    blend_pixels(shared, g);
    g->sync();
    return g->any(lane_index() < ROW_PAIRS && shared->open[lane_index()]);
}

/* Calls keep(i, key, whether its splat can touch an open pixel) for the keys of a list, with all threads. */
template <class Keep>
__device__ void visit_open(const dense_shared *shared, const dense_tile *t, const uint64_t *list, uint32_t count,
                           const dense_group *g, Keep keep)
{
    enum { FETCHES = 2 };
    const span rows = open_rows(shared->open);
    for (uint32_t first = g->thread; first - g->thread < count; first += FETCHES * DENSE_THREADS) {
        uint64_t keys[FETCHES];
        fxs_splat splats[FETCHES];
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            keys[k] = first + k * DENSE_THREADS < count ? __ldcg(&list[first + k * DENSE_THREADS]) : FXS_ENTRY_CUT_OFF;
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            splats[k] = t->splats[keys[k] & FXS_ENTRY_CUT_OFF ? 0 : (uint32_t)keys[k]];
#pragma unroll
        for (uint32_t k = 0; k < FETCHES; k++)
            keep(first + k * DENSE_THREADS, keys[k],
                 !(keys[k] & FXS_ENTRY_CUT_OFF) && touches_open(t, &splats[k], shared->open, rows));
    }
    g->sync();
}

/* How many are collected, read by all threads before any adds to it. */
__device__ uint32_t collected(const dense_shared *shared, const dense_group *g)
{
    const uint32_t count = shared->collected;
    g->sync();
    return count;
}

/* Adds a list to shared->keys; there is room for all of it. Returns how many there are. */
__device__ uint32_t collect(dense_shared *shared, const dense_tile *t, const uint64_t *list, uint32_t count,
                            const dense_group *g)
{
    visit_open(shared, t, list, count, g, [&](uint32_t, uint64_t key, bool kept) {
        const uint32_t place = take_number(&shared->collected, 0, kept);
        if (kept && place < dense_keys::room)
            shared->keys.keys[place] = key;
    });
    return collected(shared, g);
}

/* Moves the keys of a list whose splats can touch an open pixel to its start; none are collected. Returns how many. */
__device__ uint32_t drop_closed(dense_shared *shared, const dense_tile *t, uint64_t *list, uint32_t count,
                                const dense_group *g)
{
    visit_open(shared, t, list, count, g, [&](uint32_t, uint64_t key, bool kept) {
        const uint32_t place = take_number(&shared->collected, 0, kept);
        g->sync();                         /* what is written over has been read */
        if (kept)
            list[place] = key;
    });
    const uint32_t left = collected(shared, g);
    if (g->thread == 0)
        shared->collected = 0;
    g->sync();
    return left;
}

/* Blends a list in rounds. Returns whether any pixel is open. */
__device__ bool blend_rounds(dense_shared *shared, const dense_tile *t, const uint64_t *list, uint32_t count,
                             const dense_group *g)
{
    key_range r = range_of_list(&shared->keys, list, count, g);
    bool open = true;
    for (uint32_t done = 0; done < count && open;) {
        const uint32_t keys = next_round(&r, &shared->keys, shared->bins, list, count, g);
        open = blend_collected(shared, t, keys, g);
        done += keys;
    }
    return open;
}

/* Room for `count` entries, null where there is none left. */
__device__ uint64_t *take_room(dense_shared *shared, const frame_buffers *f, uint32_t count, const dense_group *g)
{
    if (g->thread == 0)
        shared->room = take_entries(f, count);
    g->sync();
    return shared->room;
}

/* Blends a list that split_list has put into bins. */
__device__ void blend_split(dense_shared *shared, const dense_tile *t, uint64_t *list, uint32_t count,
                            const dense_group *g)
{
    uint32_t have = 0, reach = 0;              /* collected; how far to look where few are kept */
    for (uint32_t first = 0, end; first < count; first = end) {
        const uint32_t room = dense_keys::room - have;
        end = have > FULL ? first : bins_end<dense_keys>(shared->ends, first, max(room, reach));
        if (end == first && have) {
            if (!blend_collected(shared, t, have, g))
                return;
            have = 0;
            end = bins_end<dense_keys>(shared->ends, first, dense_keys::room);
        }
        if (end > first) {
            const uint32_t all = collect(shared, t, list + first, end - first, g), kept = all - have;
            if (all <= dense_keys::room) {
                const uint32_t hoped = (dense_keys::room - all) * (end - first) / (kept + kept / 2 + 8);
                reach = min(min(hoped, 2 * (end - first)), REACH_MOST);
                have = all;
                continue;
            }
            if (g->thread == 0)                /* it was too far */
                shared->collected = have;
            g->sync();
            reach = 0;
            end = first;
            continue;
        }
        end = bin_end<dense_keys>(shared->ends, first);    /* a bin too large */
        const uint32_t left = drop_closed(shared, t, list + first, end - first, g);
        if (left <= dense_keys::room)
            have = collect(shared, t, list + first, left, g);
        else if (!blend_rounds(shared, t, list + first, left, g))
            return;
    }
    if (have)
        blend_collected(shared, t, have, g);
}

/* Marks the keys of a list that can touch an open pixel; *range: of their depths. Returns how many. */
__device__ uint32_t mark_keys(uint32_t *marks, key_range *range, dense_shared *shared, const dense_tile *t,
                              const uint64_t *list, uint32_t count, const dense_group *g)
{
    uint32_t least = UINT32_MAX, most = 0, own = 0;
    visit_open(shared, t, list, count, g, [&](uint32_t i, uint64_t key, bool kept) {
        const uint32_t lanes = __ballot_sync(ALL_LANES, kept);
        if (lane_index() == 0 && i < count)
            marks[i / WARP] = lanes;
        least = kept ? min(least, depth_of(key)) : least;
        most = kept ? max(most, depth_of(key)) : most;
        own += kept ? 1 : 0;
    });
    *range = range_of(&shared->keys, least, most, g);
    own = __reduce_add_sync(ALL_LANES, own);
    if (lane_index() == 0)
        atomicAdd(&shared->collected, own);
    g->sync();
    const uint32_t all = collected(shared, g);
    if (g->thread == 0)
        shared->collected = 0;
    g->sync();
    return all;
}

/* Blends a list over the open pixels: all of the tile's, or, where it is shared with other blocks, some. */
__device__ void blend_dense_list(dense_shared *shared, const frame_buffers *f, const dense_tile *t,
                                 const uint64_t *list, uint32_t count, bool is_shared, const dense_group *g)
{
    uint32_t *marks = nullptr, wanted = count;
    key_range range;
    if (is_shared) {
        marks = (uint32_t *)take_room(shared, f, (count + 63) / 64, g);
        wanted = marks ? mark_keys(marks, &range, shared, t, list, count, g) : 0;
        if (marks && !wanted)
            return;
    } else {
        range = range_of_list(&shared->keys, list, count, g);
    }
    uint64_t *room = wanted ? take_room(shared, f, wanted, g) : nullptr;
    if (room)
        blend_split(shared, t, room, split_list(room, shared, list, marks, count, range, g), g);
    else
        blend_rounds(shared, t, list, count, g);
}

__global__ void __launch_bounds__(DENSE_THREADS, DENSE_BLOCKS) blend_dense(const __grid_constant__ fxs_view view,
                                                                           const __grid_constant__ frame_buffers f,
                                                                           const __grid_constant__ target t)
{
    extern __shared__ __align__(16) unsigned char memory[];
    dense_shared *shared = (dense_shared *)memory;
    const dense_group g = {0, threadIdx.x};
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y);
    if (!fits(&f))
        return;
    const turns order = turns_of(&f, blocks_a_tile(&f));
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
        const dense_tile at = {&view, f.splats, (int32_t)(tile % (uint32_t)view.tiles_x) * FXS_TILE,
                               (int32_t)(tile / (uint32_t)view.tiles_x) * FXS_TILE};
        const int32_t px = at.x + (int32_t)(g.thread % FXS_TILE), py = at.y + (int32_t)(g.thread / FXS_TILE);
        const bool inside = g.thread < FXS_TILE_PIXELS && px < view.width && py < view.height &&
                            g.thread % FXS_TILE / (FXS_TILE / turn.turns) == turn.number;
        const uint32_t open = __ballot_sync(ALL_LANES, inside);
        if (g.thread < FXS_TILE_PIXELS)
            shared->pixels[g.thread] = {FXS_CLEAR_Q15, {0, 0, 0}};
        if (g.thread < FXS_TILE_PIXELS && lane_index() == 0)
            shared->open[g.thread / WARP] = open;
        g.sync();
        const uint32_t count = f.counts[tile];
        blend_dense_list(shared, &f, &at, f.entries + (f.next[tile] - count), count, turn.turns > 1, &g);
        if (inside)
            store_pixel(&t, &f, &shared->pixels[g.thread], px, py);
        g.sync();
    }
}

}

#endif
