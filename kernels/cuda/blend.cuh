/* Blends the splats (projected Gaussians) of each tile of 16x16 pixels.
 *
 * A short list of splats is first sorted by depth. Then each warp blends a region of 8x8 or 8x4 pixels: it tests 32
 * splats per step, queues the splats that touch the region, and blends them one by one. Long lists go to blend_dense
 * (dense.cuh), or to blend_tiles, which sorts and blends one batch after another.
 *
 * A pixel's level is u^2 + v^2 + offset, where u and v are the pixel's coordinates relative to a splat. The level is
 * the index into the table of alpha. The part v^2 + offset, row_level, is equal for all pixels of a row. Levels are
 * doubled integers, stored in floats between 2^23 and 2^24, where a float has the unit 1. With c = coordinate_q13 2^-7,
 * one operation adds the square of a coordinate:
 *
 *     fma(c, c, 2^23 + 2 row_level + 1), rounded down, = 2^23 + floor(2 (coordinate_q13^2 2^-15 + 1/2 + row_level))
 *
 * The largest levels that are drawn are stored as at most 2^23 + 45395. Coordinates beyond +-4 need no clamp, as their
 * level exceeds every limit. */
#ifndef FXS_CUDA_BLEND_CUH
#define FXS_CUDA_BLEND_CUH

#include "sort.cuh"
#include "stages.cuh"

namespace {

const uint32_t LONG_MAGNITUDE = 11, SHORT_MAGNITUDE = 8;
const uint32_t SPLIT_MAGNITUDE = 13;                   /* tile lists with 2^SPLIT_MAGNITUDE splats or more are divided
                                                          into depth bins before they are sorted */
const uint32_t SORT_THREADS = 128, SORT_BLOCKS = 7;
const uint32_t GROUP_THREADS = 128, WARPS_MOST = 24;
typedef group<GROUP_THREADS> tile_group;
typedef group_keys<1024> tile_keys;
const int REGION = 8;
template <int Each>
constexpr uint32_t LANES = REGION / Each;
template <int Each>
constexpr int ROWS = WARP / LANES<Each>;
const uint32_t STEPS = 4;                  /* number of splats that a thread blends before it tests whether its pixels
                                              are opaque */
const uint32_t QUEUE = WARP + STEPS;
const int LEVEL_ONE = 0x4b000000;          /* bits of the float 2^23 */

struct queued_row {
    uint32_t u_q24;
    float level;                   /* 2^23 + 2 (v^2 + offset) + 1: the part of a pixel's level (u^2 + v^2 + offset) that
                                      is equal in the row */
};

/* A splat in a warp's queue of splats to blend. The size of 80 bytes avoids bank conflicts in shared memory. */
struct alignas(16) queued_splat {
    queued_row rows[ROWS<2>];
    uint32_t ux_q24;
    int limit;                             /* largest level (u^2 + v^2 + offset) of a pixel that is drawn, as the bits
                                              of a float */
    uint32_t red_green, blue;              /* colour of the splat in Q14; red_green holds two channels */
};

struct queued_trace {
    uint32_t key, index;                   /* depth of a splat as a sort key; index of its Gaussian among all drawn
                                              Gaussians */
};

/* A pixel while splats are blended. Each colour sum (Q13) is at most 2^15, so two sums fit in a word. */
struct pixel {
    int transmittance;
    uint32_t red_green, blue;
};

struct traced_pixel : pixel {
    uint32_t limit;                        /* depth of an opaque occluder at the pixel, as a sort key; farther splats
                                              are hidden */
    bool hidden;
    int weight;
    uint32_t largest, median;
    uint64_t depths;
};

/* Largest number of groups (4 warps each) in a thread block. More groups would leave too few registers per thread. */
template <class Pixel>
constexpr uint32_t groups_most = 6;
template <>
constexpr uint32_t groups_most<traced_pixel> = 5;

template <class Pixel, uint32_t Warps>
struct trace_queues {
    __device__ queued_trace *trace_queue(uint32_t)
    {
        return nullptr;
    }
};

template <uint32_t Warps>
struct trace_queues<traced_pixel, Warps> {
    queued_trace traces[Warps][QUEUE];

    __device__ queued_trace *trace_queue(uint32_t warp)
    {
        return traces[warp];
    }
};

template <class Pixel>
struct group_shared : trace_queues<Pixel, GROUP_THREADS / WARP> {
    tile_keys keys;
    uint32_t entries[tile_keys::room];
    union {
        queued_splat queues[GROUP_THREADS / WARP][QUEUE];
        uint32_t bins[bins_of<tile_keys, GROUP_THREADS>];
    };
    uint64_t *room;
    uint32_t turn;
};

template <class Pixel>
struct blend_shared {
    uint16_t alpha_q15[FXS_FAINT_Q11 + 1];
    group_shared<Pixel> groups[1];
};

template <class Pixel>
size_t blend_bytes(uint32_t groups)
{
    return sizeof(blend_shared<Pixel>) - sizeof(group_shared<Pixel>) + groups * sizeof(group_shared<Pixel>);
}

/* Returns 64 times a coordinate as a float, rounded down to a multiple of 2^-7. The float 1.5 2^16 has a unit of 2^-7,
   so adding an integer to its bits converts the integer. */
__device__ inline float coordinate_q6(uint32_t coordinate_q24)
{
    return __int_as_float(((int32_t)coordinate_q24 >> 11) + 0x47c00000) - 98304.0f;
}

/* Returns the part of a pixel's level (u^2 + v^2 + offset) that is equal in its row: 2^23 + 2 (v^2 + offset) + 1. */
__device__ inline float row_level(uint32_t v_q24, int offset_q11)
{
    const float v = coordinate_q6(v_q24);
    const int twice = __float_as_int(__fmaf_rd(v, v, 8388609.0f)) & ~1;
    return __int_as_float(twice) + (float)(2 * offset_q11 + 1);
}

__device__ inline int limit_bits(const fxs_splat *s, int cut_q11)
{
    return LEVEL_ONE + 2 * fxs_limit_q11(s->offset_q11, cut_q11) + 1;
}

__device__ inline int level_bits(queued_row row, uint32_t column, uint32_t ux_q24)
{
    const float u = coordinate_q6(multiply_add(column, ux_q24, row.u_q24));
    return __float_as_int(__fmaf_rd(u, u, row.level));
}

/* Adds a splat's colour, times its weight, to a pixel's colour sums. Each term equals fxs_mul_q15(weight, colour). As
   colours are in Q14, each term is the upper half of a 32-bit product. */
__device__ inline void add_colour(pixel *p, int weight, uint32_t red_q14, uint32_t green_q14, uint32_t blue_q14)
{
    const uint32_t red = (uint32_t)weight * red_q14 + 32768, green = (uint32_t)weight * green_q14 + 32768;
    p->red_green += __byte_perm(red, green, 0x7632);
    p->blue += ((uint32_t)weight * blue_q14 + 32768) >> 16;
}

__device__ inline int blend_pixel(pixel *p, const uint16_t *alpha_q15, queued_row row, uint32_t column,
                                  const queued_splat *s, int limit)
{
    const int level = level_bits(row, column, s->ux_q24);
    const int weight = weight_product<FXS_CLOSED_Q15>(alpha_q15, level, limit, p->transmittance) >> 15;
    p->transmittance -= weight;
    add_colour(p, weight, s->red_green & 0xffff, s->red_green >> 16, s->blue);
    return weight;
}

__device__ inline void blend_queued(pixel *p, const uint16_t *alpha_q15, queued_row row, uint32_t column,
                                    const queued_splat *s, const queued_trace *, int)
{
    blend_pixel(p, alpha_q15, row, column, s, s->limit);
}

__device__ inline void blend_queued(traced_pixel *p, const uint16_t *alpha_q15, queued_row row, uint32_t column,
                                    const queued_splat *s, const queued_trace *trace, int depth_bits)
{
    const uint32_t key = trace->key;
    const int before = p->transmittance;
    const int weight = blend_pixel(p, alpha_q15, row, column, s, key <= p->limit ? s->limit : 0);
    if (!weight)
        return;
    const int behind_q15 = fxs_mul_q15(weight, fxs_depth_code_q15(key));
    p->depths += fxs_depth_sum((uint32_t)(weight + behind_q15), key, depth_bits);
    p->median = before >= FXS_HALF_Q15 ? key : p->median;
    p->largest = weight > p->weight ? trace->index : p->largest;
    p->weight = weight > p->weight ? weight : p->weight;
}

/* Fills in *q, an entry of the queue of splats to blend, except its colour. Returns true if the splat can touch one of
   the REGION x Rows pixels whose first is (x, y). */
template <int Rows>
__device__ inline bool splat_at(queued_splat *q, const fxs_splat *s, int cut_q11, int32_t x, int32_t y)
{
    uint32_t u = s->u0_q24 + (uint32_t)x * (uint32_t)s->ux_q24 + (uint32_t)y * (uint32_t)s->uy_q24;
    uint32_t v = s->v0_q24 + (uint32_t)y * (uint32_t)s->vy_q24;
    const float across = (float)((REGION - 1) * s->ux_q24) * 0x1p-18f + 0x1p-6f;
    bool touched = false;
    q->ux_q24 = (uint32_t)s->ux_q24;
    q->limit = limit_bits(s, cut_q11);
#pragma unroll
    for (int row = 0; row < Rows; row++) {
        const float left = coordinate_q6(u), least = fmaxf(fmaxf(left, -(left + across)), 0.0f);
        const queued_row placed = {u, row_level(v, s->offset_q11)};
        q->rows[row] = placed;
        touched |= __float_as_int(__fmaf_rd(least, least, placed.level)) <= q->limit;
        u += (uint32_t)s->uy_q24;
        v += (uint32_t)s->vy_q24;
    }
    return touched;
}

__device__ inline bool takes_more(const pixel *p)
{
    return p->transmittance >= FXS_CLOSED_Q15;
}

__device__ inline bool takes_more(const traced_pixel *p)
{
    return p->transmittance >= FXS_CLOSED_Q15 && !p->hidden;
}

template <class Pixel, int Each>
__device__ inline bool is_open(const Pixel (&p)[Each])
{
    return takes_more(&p[0]) || takes_more(&p[Each - 1]);
}

/* Sets p->hidden if an occluder hides the next splat at pixel p, and thus all later splats. */
__device__ inline void see_next(pixel *, const queued_trace *)
{
}

__device__ inline void see_next(traced_pixel *p, const queued_trace *next)
{
    p->hidden = next->key > p->limit;
}

__device__ inline uint32_t key_of(const pixel *, const uint32_t *, uint32_t)
{
    return 0;
}

__device__ inline uint32_t key_of(const traced_pixel *, const uint32_t *depths, uint32_t entry)
{
    return depths[entry];
}

struct queue_place {
    const queued_splat *splat;
    const queued_row *rows;
    const queued_trace *trace;

    __device__ queue_place after(uint32_t count) const
    {
        return {splat + count, rows + count * (sizeof *splat / sizeof *rows), trace + count};
    }
};

template <class Pixel, int Each>
struct region_blender {
    queued_splat *queue;
    queued_trace *traces;
    const uint16_t *alpha_q15;
    const frame_buffers *f;
    int cut_q11, depth_bits;
    int32_t x, y;
    const queued_row *own_rows;
    uint32_t column;

    __device__ region_blender(queued_splat *queue, queued_trace *traces, const uint16_t *alpha_q15,
                              const frame_buffers *f, const fxs_stage_view *view, int depth_bits, int32_t x, int32_t y)
        : queue(kept_shared(queue)), traces(traces), alpha_q15(kept_shared(alpha_q15)), f(f), cut_q11(view->cut_q11),
          depth_bits(depth_bits), x(x), y(y), own_rows(kept_shared(queue->rows + lane_index() / LANES<Each>)),
          column(kept(lane_index() % LANES<Each>))
    {
    }

    /* Appends to the warp's queue the splats that touch its region of pixels; each lane tests one splat. Returns the
       queue's new length. */
    __device__ uint32_t queue_splats(const Pixel *p, uint32_t entry, bool listed, uint32_t queued) const
    {
        queued_splat q;
        bool touched = false;
        if (listed && !(entry & FXS_ENTRY_CUT_OFF)) {
            const fxs_splat s = load_splat(&f->splats[entry]);
            touched = splat_at<ROWS<Each>>(&q, &s, cut_q11, x, y);
            q.red_green = (uint32_t)s.colour_q13[0] << 1 | (uint32_t)s.colour_q13[1] << 17;
            q.blue = (uint32_t)s.colour_q13[2] << 1;
        }
        const unsigned lanes = __ballot_sync(ALL_LANES, touched);
        const uint32_t place = queued + (uint32_t)__popc(lanes & ((1u << lane_index()) - 1));
        if (touched)
            queue[place] = q;
        if (traces && touched)
            traces[place] = {key_of(p, f->depths, entry), entry};
        __syncwarp();
        return queued + (uint32_t)__popc(lanes);
    }

    __device__ void step(Pixel *p, const queue_place &place) const
    {
        const queued_row row = place.rows[0];
        for (uint32_t i = 0; i < Each; i++)
            blend_queued(&p[i], alpha_q15, row, column + i * LANES<Each>, place.splat, place.trace, depth_bits);
    }

    __device__ uint32_t keep_rest(uint32_t first, uint32_t queued) const
    {
        const uint32_t words = sizeof(queued_splat) / sizeof(uint4), lane = lane_index(), rest = queued - first;
        const bool moves = lane < rest * words;
        const uint4 word = moves ? ((const uint4 *)&queue[first])[lane] : uint4{};
        const queued_trace trace = traces && lane < rest ? traces[first + lane] : queued_trace{};
        __syncwarp();
        if (moves)
            ((uint4 *)queue)[lane] = word;
        if (traces && lane < rest)
            traces[lane] = trace;
        return rest;
    }

    __device__ void blend(Pixel (&p)[Each], const uint32_t *entries, uint32_t count) const
    {
        const queue_place start = {queue, own_rows, traces};
        const uint32_t lane = lane_index();
        uint32_t next = lane < count ? entries[lane] : 0, queued = 0;
        for (uint32_t first = 0; first < count && __any_sync(ALL_LANES, is_open(p)); first += WARP) {
            const uint32_t entry = next;
            next = first + WARP + lane < count ? entries[first + WARP + lane] : 0;
            queued = queue_splats(p, entry, first + lane < count, queued);
            queue_place at = start;
            for (uint32_t left = queued / STEPS; left > 0; left--, at = at.after(STEPS)) {
                for (Pixel &own : p)
                    see_next(&own, at.trace);
                if (!__any_sync(ALL_LANES, is_open(p)))
                    break;
#pragma unroll
                for (uint32_t i = 0; i < STEPS; i++)
                    step(p, at.after(i));
            }
            __syncwarp();
            queued = keep_rest(queued / STEPS * STEPS, queued);
        }
        __syncwarp();
#pragma unroll 1
        for (uint32_t i = 0; i < queued; i++)
            step(p, start.after(i));
        __syncwarp();
    }
};

struct target {
    fxs_targets images;
    int background_q13[3], depth_bits;
    int plain;
};

/* One clamp of a pixel's final colour sum is enough, since colour sums only increase. */
__device__ inline int sum_of_colour(const pixel *p, int c)
{
    return fxs_min((int)((c < 2 ? p->red_green >> 16 * c : p->blue) & 0xffff), 32767);
}

__device__ inline void store_bytes(const target *t, const pixel *p, int32_t x, int32_t y)
{
    uint32_t word = t->images.format == FXS_FORMAT_RGBA8 ? 255u << 24
                                                         : (uint32_t)fxs_coverage_8bit(p->transmittance) << 24;
    for (int c = 0; c < 3; c++)
        word |= (uint32_t)fxs_resolve_8bit(sum_of_colour(p, c), p->transmittance, t->background_q13[c]) << 8 * c;
    *(uint32_t *)fxs_image_at(&t->images.colour, x, y, 4) = word;
}

/* This function is not inlined, to save registers in the callers' loops. */
__device__ __noinline__ void store_colour(const target *t, pixel p, int32_t x, int32_t y)
{
    union {
        unsigned char bytes[8];
        uint32_t words[2];
        uint16_t half;
    } packed;
    const fxs_targets *images = &t->images;
    int sum[3], background_q13[3];
    for (int c = 0; c < 3; c++) {
        sum[c] = sum_of_colour(&p, c);
        background_q13[c] = t->background_q13[c];
    }
    if (images->backdrop.pixels) {
        const uint32_t rgba = *(const uint32_t *)fxs_image_at(&images->backdrop, x, y, 4);
        for (int c = 0; c < 3; c++)
            background_q13[c] = fxs_background_q13((int)(rgba >> 8 * c & 255));
    }
    resolve_pixel(packed.bytes, images->format, sum, p.transmittance, background_q13);
    unsigned char *pixel = fxs_image_at(&images->colour, x, y, fxs_pixel_bytes(images->format));
    if (images->format == FXS_FORMAT_RGB565)
        *(uint16_t *)pixel = packed.half;
    else if (images->format == FXS_FORMAT_RGBA16_COVERAGE)
        *(uint2 *)pixel = make_uint2(packed.words[0], packed.words[1]);
    else
        *(uint32_t *)pixel = packed.words[0];
}

__device__ inline void store_pixel(const target *t, const frame_buffers *, const pixel *p, int32_t x, int32_t y)
{
    const fxs_image *coverage = &t->images.coverage;
    if (t->plain)
        store_bytes(t, p, x, y);
    else if (t->images.colour.pixels)
        store_colour(t, *p, x, y);
    if (coverage->pixels)
        *fxs_image_at(coverage, x, y, 1) = (unsigned char)fxs_coverage_8bit(p->transmittance);
}

__device__ inline uint2 id_of(const frame_buffers *f, uint32_t index)
{
    if (index == FXS_NOTHING)
        return make_uint2(FXS_NOTHING, FXS_NOTHING);
    const uint32_t place = index / FXS_CHUNK, chunk = chunk_at(f, place);
    const fxs_object_view *object = &f->objects[fxs_object_of(f->objects, f->object_count, chunk)];
    const uint32_t number = f->numbers ? f->numbers[place] : chunk - object->first_chunk;
    return make_uint2(object->id, number * FXS_CHUNK + index % FXS_CHUNK);
}

__device__ inline void store_pixel(const target *t, const frame_buffers *f, const traced_pixel *p, int32_t x,
                                   int32_t y)
{
    const fxs_targets *images = &t->images;
    store_pixel(t, f, static_cast<const pixel *>(p), x, y);
    if (images->mean_depth.pixels)
        *(uint32_t *)fxs_image_at(&images->mean_depth, x, y, 4) = fxs_mean_depth(p->depths, p->transmittance);
    if (images->median_depth.pixels)
        *(uint32_t *)fxs_image_at(&images->median_depth, x, y, 4) =
            p->transmittance < FXS_HALF_Q15 ? fxs_depth_of_key(p->median, t->depth_bits) : FXS_NOTHING;
    if (images->id.pixels)
        *(uint2 *)fxs_image_at(&images->id, x, y, 8) = id_of(f, p->largest);
}

__device__ inline void clear_pixel(pixel *p, const target *, int32_t, int32_t, bool inside)
{
    *p = {inside ? FXS_CLEAR_Q15 : 0, 0, 0};
}

__device__ inline void clear_pixel(traced_pixel *p, const target *t, int32_t x, int32_t y, bool inside)
{
    const fxs_image *occluder = &t->images.occluder;
    clear_pixel(static_cast<pixel *>(p), t, x, y, inside);
    p->limit = UINT32_MAX;
    if (inside && occluder->pixels)
        p->limit = fxs_depth_key(*(const uint32_t *)fxs_image_at(occluder, x, y, 4), t->depth_bits);
    p->hidden = false;
    p->weight = 0;
    p->largest = p->median = FXS_NOTHING;
    p->depths = 0;
}

/* The order in which tiles are blended or sorted: tiles with long lists of splats first. Lane i of a warp holds the
   class of tiles with floor(log2(list length)) = 31 - i. Each tile of the class has `each` turns (pieces of work), a
   power of 2 or 0. */
struct turns {
    uint32_t start, end, each, all, tiles;
};

__device__ inline turns turns_of(const frame_buffers *f, uint32_t each)
{
    const uint32_t tiles = f->status->classes[WARP - 1 - lane_index()], end = warp_sum(each * tiles);
    return {end - each * tiles, end, each, __shfl_sync(ALL_LANES, end, WARP - 1), warp_sum(tiles) - tiles};
}

struct turn_of_tile {
    uint32_t tile, place;
    uint32_t number, turns;
};

__device__ inline turn_of_tile tile_of_turn(const frame_buffers *f, const turns *order, uint32_t tiles, uint32_t turn)
{
    const int lane = __ffs((int)__ballot_sync(ALL_LANES, turn < order->end)) - 1;
    const uint32_t i = turn - __shfl_sync(ALL_LANES, order->start, lane);
    const uint32_t each = __shfl_sync(ALL_LANES, order->each, lane), before = i >> (__ffs((int)each) - 1);
    return {f->classes[(WARP - 1 - (uint32_t)lane) * tiles + before],
            __shfl_sync(ALL_LANES, order->tiles, lane) + before, i & (each - 1), each};
}

template <class Pixel>
__device__ __noinline__ const uint64_t *split_long(const uint32_t **ends, group_shared<Pixel> *own,
                                                   const frame_buffers *f, const uint64_t *list, uint32_t count,
                                                   const tile_group *g)
{
    const uint32_t words = tile_keys::bins / 2;
    if (g->thread == 0)
        own->room = take_entries(f, words + (uint64_t)count);
    g->sync();
    if (!own->room)
        return nullptr;
    uint32_t *kept = (uint32_t *)own->room;
    uint64_t *sorted = own->room + words;
    auto visit_all = [&](auto visit) { visit_keys(list, count, g, visit); };
    move_to_bins(sorted, &own->keys, own->bins, range_of_list(&own->keys, g, visit_all), g,
                 [&](auto visit) { visit_all([&](uint64_t key) { visit(key, key); }); });
    for (uint32_t i = g->thread; i < tile_keys::bins; i += GROUP_THREADS)
        kept[i] = own->bins[slot_of<tile_keys, tile_group>(i)];
    g->sync();
    *ends = kept;
    return sorted;
}

template <class Pixel>
__device__ void blend_list(Pixel (&p)[2], group_shared<Pixel> *own, const uint16_t *alpha_q15, const frame_buffers *f,
                           const fxs_stage_view *view, int depth_bits, const tile_group *g, uint32_t tile, int32_t x,
                           int32_t y)
{
    const tile_entries list = entries_of(f, tile);
    const uint32_t warp = g->thread / WARP;
    const uint64_t *split = nullptr;
    const uint32_t *ends = nullptr;
    const region_blender<Pixel, 2> blender(own->queues[warp], own->trace_queue(warp), alpha_q15, f, view, depth_bits, x,
                                           y);
    if (list.count >> SPLIT_MAGNITUDE)
        split = split_long(&ends, own, f, list.first, list.count, g);
    take_keys(&own->keys, own->bins, split ? split : list.first, list.count, ends, g, [&](uint32_t count) {
        sort_keys(own->entries, &own->keys, own->bins, count, g);
        blender.blend(p, own->entries, count);
        return g->any(is_open(p));
    });
}

__device__ inline void make_table(uint16_t *alpha_q15)
{
    for (uint32_t level = threadIdx.x; level <= FXS_FAINT_Q11; level += blockDim.x)
        alpha_q15[level] = (uint16_t)fxs_alpha_q15((int)level);
    __syncthreads();
}

template <int Each>
struct region {
    int32_t x, y;

    __device__ region(const fxs_stage_view *view, uint32_t tile, uint32_t part)
        : x((int32_t)(tile % (uint32_t)view->tiles_x * FXS_TILE + part % 2 * REGION)),
          y((int32_t)(tile / (uint32_t)view->tiles_x * FXS_TILE + part / 2 * ROWS<Each>))
    {
    }

    __device__ int32_t row() const
    {
        return y + (int32_t)(lane_index() / LANES<Each>);
    }

    __device__ int32_t column(int i) const
    {
        return x + (int32_t)(lane_index() % LANES<Each>) + i * (int32_t)LANES<Each>;
    }

    __device__ bool inside(const fxs_stage_view *view, int i) const
    {
        return column(i) < view->width && row() < view->height;
    }

    template <class Pixel>
    __device__ void clear(Pixel (&p)[Each], const fxs_stage_view *view, const target *t) const
    {
        for (int i = 0; i < Each; i++)
            clear_pixel(&p[i], t, column(i), row(), inside(view, i));
    }

    template <class Pixel>
    __device__ void store(const Pixel (&p)[Each], const fxs_stage_view *view, const frame_buffers *f,
                          const target *t) const
    {
        for (int i = 0; i < Each; i++)
            if (inside(view, i))
                store_pixel(t, f, &p[i], column(i), row());
    }
};

/* Sorts tile lists of fewer than 2^Magnitude splats by depth, in up to 2^Bits bins. */
template <uint32_t T, uint32_t Magnitude, int Bits>
struct list_sorter {
    typedef group<T> group_type;
    group_keys<1u << Magnitude, Bits> keys;
    uint32_t bins[bins_of<group_keys<1u << Magnitude, Bits>, T>];
    uint32_t turn;

    __device__ void run(const frame_buffers *f, uint32_t tiles, turns order, uint32_t *counter, group<T> g)
    {
        uint32_t next = g.thread == 0 ? atomicAdd(counter, 1u) : 0;
        for (;;) {
            if (g.thread == 0) {
                turn = next;
                next = atomicAdd(counter, 1u);
            }
            g.sync();
            if (turn >= order.all)
                return;
            const uint32_t tile = tile_of_turn(f, &order, tiles, turn).tile;
            const tile_entries list = entries_of(f, tile);
            for (uint32_t i = g.thread; i < list.count; i += T)
                keys.keys[i] = list.first[i];
            g.sync();
            sort_keys_by_count((uint32_t *)list.first, &keys, bins, list.count, &g);
        }
    }
};

union sort_shared {
    list_sorter<SORT_THREADS, LONG_MAGNITUDE, 11> block;
    list_sorter<WARP, SHORT_MAGNITUDE, 8> warps[SORT_THREADS / WARP];
};

/* Sorts tile lists by depth: medium lists by thread blocks, then short lists by warps. */
__global__ void __launch_bounds__(SORT_THREADS, SORT_BLOCKS) sort_lists(const __grid_constant__ frame_buffers f,
                                                                        uint32_t tiles)
{
    sort_shared *shared = (sort_shared *)shared_memory();
    wait_for_last_kernel();
    const uint32_t magnitude = WARP - 1 - lane_index();
    if (blockIdx.x == 0 && threadIdx.x == 0)
        *f.needs = *f.status;
    if (!fits(&f))
        return;
    shared->block.run(&f, tiles, turns_of(&f, magnitude >= SHORT_MAGNITUDE && magnitude < LONG_MAGNITUDE ? 1 : 0),
                      &f.status->next_sort[0], {0, threadIdx.x});
    __syncthreads();
    shared->warps[threadIdx.x / WARP].run(&f, tiles, turns_of(&f, magnitude < SHORT_MAGNITUDE ? 1 : 0),
                                          &f.status->next_sort[1], {0, lane_index()});
}

template <class Pixel>
struct warp_shared : trace_queues<Pixel, 1> {
    queued_splat queue[QUEUE];
};

template <class Pixel>
struct sorted_shared {
    uint16_t alpha_q15[FXS_FAINT_Q11 + 1];
    turns order[WARP];
    warp_shared<Pixel> warps[1];
};

template <class Pixel>
size_t sorted_bytes(uint32_t warps)
{
    return sizeof(sorted_shared<Pixel>) - sizeof(warp_shared<Pixel>) + warps * sizeof(warp_shared<Pixel>);
}

/* Returns the number of warps that blend a tile: 8 for lists longer than half a warp's average load, else 4. */
__device__ inline uint32_t regions_of_tiles(const frame_buffers *f, bool alone)
{
    const uint32_t magnitude = WARP - 1 - lane_index(), warps = gridDim.x * (blockDim.x / WARP);
    const uint32_t tiles = f->status->classes[magnitude];
    const uint32_t entries = magnitude < LONG_MAGNITUDE ? f->status->class_entries[magnitude] : 0;
    const uint32_t load = __reduce_add_sync(ALL_LANES, entries) * 4 / warps;
    const bool late = alone && entries / max(tiles, 1) > load / 2;
    return magnitude >= LONG_MAGNITUDE ? 0 : late ? 8 : 4;
}

template <int Each, class Pixel>
__device__ inline void blend_region(sorted_shared<Pixel> *shared, const fxs_stage_view *view, const frame_buffers *f,
                                    const target *t, const turn_of_tile &turn)
{
    warp_shared<Pixel> *own = &shared->warps[threadIdx.x / WARP];
    const region<Each> r(view, turn.tile, turn.number);
    const tile_entries list = entries_of(f, turn.tile);
    const region_blender<Pixel, Each> blender(own->queue, own->trace_queue(0), shared->alpha_q15, f, view,
                                              t->depth_bits, r.x, r.y);
    Pixel p[Each];
    r.clear(p, view, t);
    blender.blend(p, (const uint32_t *)list.first, list.count);
    r.store(p, view, f, t);
}

/* Blends the tiles that have sorted lists of splats. `alone` is true if no other frame is in flight. */
template <class Pixel>
__global__ void __launch_bounds__(WARPS_MOST * WARP, 1)
blend_sorted(const __grid_constant__ fxs_stage_view view, const __grid_constant__ frame_buffers f,
             const __grid_constant__ target t, bool alone)
{
    sorted_shared<Pixel> *shared = (sorted_shared<Pixel> *)shared_memory();
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y);
    make_table(shared->alpha_q15);
    wait_for_last_kernel();
    if (!fits(&f))
        return;
    if (threadIdx.x < WARP)
        shared->order[threadIdx.x] = turns_of(&f, regions_of_tiles(&f, alone));
    __syncthreads();
    uint32_t next = lane_index() == 0 ? atomicAdd(&f.status->next_turn, 1u) : 0;
    for (;;) {
        const uint32_t i = __shfl_sync(ALL_LANES, next, 0);
        if (i >= shared->order[0].all)
            return;
        next = lane_index() == 0 ? atomicAdd(&f.status->next_turn, 1u) : 0;
        const turns order = shared->order[lane_index()];
        const turn_of_tile turn = tile_of_turn(&f, &order, tiles, i);
        if (turn.turns == 4)
            blend_region<2>(shared, &view, &f, &t, turn);
        else
            blend_region<1>(shared, &view, &f, &t, turn);
    }
}

template <class Pixel>
__global__ void __launch_bounds__(groups_most<Pixel> * GROUP_THREADS, 1)
blend_tiles(const __grid_constant__ fxs_stage_view view, const __grid_constant__ frame_buffers f,
            const __grid_constant__ target t)
{
    blend_shared<Pixel> *shared = (blend_shared<Pixel> *)shared_memory();
    const tile_group g = {threadIdx.x / GROUP_THREADS, threadIdx.x % GROUP_THREADS};
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y), part = g.thread / WARP;
    group_shared<Pixel> *own = &shared->groups[g.number];
    if (!fits(&f))
        return;
    make_table(shared->alpha_q15);
    const turns order = turns_of(&f, WARP - 1 - lane_index() < LONG_MAGNITUDE ? 0 : 1);
    uint32_t next = g.thread == 0 ? atomicAdd(&f.status->next_long, 1u) : 0;
    for (;;) {
        if (g.thread == 0) {
            own->turn = next;
            next = atomicAdd(&f.status->next_long, 1u);
        }
        g.sync();
        if (own->turn >= order.all)
            return;
        const uint32_t tile = tile_of_turn(&f, &order, tiles, own->turn).tile;
        const region<2> r(&view, tile, part);
        Pixel p[2];
        r.clear(p, &view, &t);
        blend_list(p, own, shared->alpha_q15, &f, &view, t.depth_bits, &g, tile, r.x, r.y);
        r.store(p, &view, &f, &t);
        g.sync();
    }
}

}

#endif
