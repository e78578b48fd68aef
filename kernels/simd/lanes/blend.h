/* Blends the splats of a tile, or traces them with depths and ids as further outputs. The tile is cut into patches of 8
 * columns and ROWS rows of pixels. The splats of the tile's list are taken in groups of 2 * LANES. The first step, with
 * one splat per lane, finds which splats reach which patches. The second step, with one pixel per lane, blends the
 * splats of each patch. A splat has coordinates u and v, linear in the pixel position. The level of a pixel is u^2 +
 * v^2 + offset, and alpha is exp(-level / 2). */
#include "src/core/memory.h"
#include "stages.h"

#define GROUP (2 * LANES)
#define ROWS (LANES / 4)
#define PATCHES (FXS_TILE_PIXELS / GROUP)
#define AHEAD 64
#define ALWAYS_INLINE static inline __attribute__((always_inline))

#if LANES == 4                    /* instruction sets with wider vectors define their own versions of these functions */
static inline vu pattern_of(uint32_t x, uint32_t y)
{
    (void)y;
    return ramp(0, x);
}

static inline void order_levels(vh levels_q11[FXS_TILE])
{
    (void)levels_q11;
}

static inline vh spread_levels(const vh *levels_q11, uint32_t entry)
{
    return all_h(((const int16_t *)levels_q11)[entry]);
}

static inline vh rows_of(vh columns)
{
    return columns;
}

static inline vh columns_of(vh rows)
{
    return rows;
}
#endif

/* Pixels of a patch (block of pixels), stored column by column. Since a splat's v^2 + offset depends only on the row,
   one broadcast of the rows' values then serves all columns. */
typedef struct pixels {
    vh transmittance_q15, red_q13, green_q13, blue_q13;
} pixels;

typedef struct kept {
    vh depth_q15, median, weight_q15, largest, end;
} kept;

/* Splats of a group, one per lane, in two vectors of 32-bit numbers. Entry 8 i + 4 j + k is in lane 4 i + k of
   vector j, the order of the packing instructions. 16-bit values are stored twice per word, so that one broadcast
   fills a vector. */
typedef struct group {
    vu u_q24[PATCHES][2];          /* splat coordinate u at the first pixel of each patch of pixels */
    vu ux_q24[2], uy_q24[2], right_q24[2];
    vu limit_q11[2], red_q13[2], green_q13[2], blue_q13[2];
    vu pattern_q24[GROUP];
    vh levels_q11[FXS_TILE];       /* v^2 + offset of the splats on each row of pixels */
    uint32_t reached[PATCHES];     /* per patch of pixels: mask of the splats that may reach a pixel */
} group;

typedef struct outline {
    vu u_q24[2], v_q24[2], vy_q24[2];
    /* range of splat coordinate u within a patch, relative to the patch's first pixel */
    vu u_low_q24[2], u_high_q24[2];
    vh offset_q11, limit_q11;
} outline;

static inline uint32_t place_of(uint32_t entry)
{
    return (entry >> 2 & 1) * LANES + (entry >> 3) * 4 + (entry & 3);
}

static inline uint32_t word_of(const vu words[2], uint32_t place)
{
    return ((const uint32_t *)words)[place];
}

static inline vu spread(const vu words[2], uint32_t place)
{
    return (vu)all((int32_t)word_of(words, place));
}

static inline vu twice(vi x)
{
    return (vu)(x & 65535) * 0x10001;
}

/* Loads a group of entries of a tile's list. Past the end of the list, the group is filled with its first entry. */
static inline uint32_t take_entries(int32_t at[GROUP], const uint32_t *entries, uint32_t left, int square)
{
    uint32_t few[GROUP], which = ~0u >> (32 - (left < GROUP ? left : GROUP));
    for (uint32_t i = 0; i < GROUP && left < GROUP; i++)
        few[i] = entries[i < left ? i : 0];
    entries = left < GROUP ? few : entries;
    for (uint32_t i = 0; i < GROUP && square; i++)
        which &= ~(entries[i] >> 31 << i);
    for (uint32_t i = 0; i < GROUP; i += 4)
        memcpy(at + place_of(i), entries + i, 4 * sizeof *entries);
    for (int j = 0; j < GROUP; j += LANES)
        store(at + j, load(at + j) & (int32_t)~FXS_ENTRY_CUT_OFF);
    return which;
}

static inline vu load_places(group *g, outline *o, int j, const fxs_stage_view *view, const fxs_splat *splats,
                             const int32_t at[LANES], int32_t x, int32_t y)
{
    vi words[4], more[4];
    load_fours(words, (const int32_t *)(const void *)&splats->u0_q24, (int)sizeof *splats / 4, at);
    load_fours(more, (const int32_t *)(const void *)&splats->vy_q24, (int)sizeof *splats / 4, at);
    const vu ux = (vu)words[2], uy = (vu)words[3], vy = (vu)more[0], offset_q11 = (vu)(more[1] & 65535);
    const vi across = (vi)(7 * ux), down = (ROWS - 1) * (vi)uy;
    o->u_q24[j] = (vu)words[0] + (uint32_t)x * ux + (uint32_t)y * uy;
    o->v_q24[j] = (vu)words[1] + (uint32_t)y * vy;
    o->vy_q24[j] = vy;
    o->u_low_q24[j] = (vu)(least(across, all(0)) + least(down, all(0)));
    o->u_high_q24[j] = (vu)(most(across, all(0)) + most(down, all(0)));
    g->ux_q24[j] = ux;
    g->uy_q24[j] = uy;
    g->right_q24[j] = (4 / ROWS) * ux;
    g->limit_q11[j] = twice(least((vi)offset_q11 + view->cut_q11, all(FXS_FAINT_Q11)));
    g->red_q13[j] = twice((vi)((vu)more[1] >> 16));
    g->green_q13[j] = twice(more[2]);
    g->blue_q13[j] = twice((vi)((vu)more[2] >> 16));
    return offset_q11;
}

/* Returns the smallest magnitude of a splat coordinate that ranges from low to high. */
static inline vh nearest(vh low, vh high)
{
    return most_h(most_h(low, ~high), all_h(0));
}

static inline vh level_at(const outline *o, vh v_q13)
{
    return add_level(mul_h(v_q13, v_q13), o->offset_q11);
}

static inline uint32_t reach(const outline *o, const vu u_q24[2], vh level_q11)
{
    const vh low = pack_q13(u_q24[0] + o->u_low_q24[0], u_q24[1] + o->u_low_q24[1]);
    const vh high = pack_q13(u_q24[0] + o->u_high_q24[0], u_q24[1] + o->u_high_q24[1]);
    const vh u_q13 = nearest(low, high);
    return bits_h(within(add_level(mul_h(u_q13, u_q13), level_q11), o->limit_q11));
}

/* Finds the splats that may reach each patch of pixels. A splat coordinate v is extreme in the first and last row of a
   patch. */
static inline void set_out_rows(group *g, outline *o, int patch)
{
    vh v_q13[ROWS];
    for (int row = 0; row < ROWS; row++) {
        v_q13[row] = pack_q13(o->v_q24[0], o->v_q24[1]);
        g->levels_q11[patch / 2 * ROWS + row] = level_at(o, v_q13[row]);
        for (int j = 0; j < 2; j++)
            o->v_q24[j] += o->vy_q24[j];
    }
    const vh first = v_q13[0], last = v_q13[ROWS - 1];
    const vh least_q11 = level_at(o, nearest(least_h(first, last), most_h(first, last)));
    for (int j = 0; j < 2; j++) {
        g->u_q24[patch][j] = o->u_q24[j];
        g->u_q24[patch + 1][j] = o->u_q24[j] + 8 * g->ux_q24[j];
        o->u_q24[j] += ROWS * g->uy_q24[j];
    }
    g->reached[patch] = reach(o, g->u_q24[patch], least_q11);
    g->reached[patch + 1] = reach(o, g->u_q24[patch + 1], least_q11);
}

static inline void set_out(group *g, const fxs_stage_view *view, const fxs_splat *splats, const uint32_t *entries,
                           uint32_t left, int32_t x, int32_t y)
{
    outline o;
    int32_t at[GROUP];
    const uint32_t which = take_entries(at, entries, left, view->cutoff == FXS_CUTOFF_SQUARE);
    const vu first = load_places(g, &o, 0, view, splats, at, x, y);
    const vu second = load_places(g, &o, 1, view, splats, at + LANES, x, y);
    o.offset_q11 = pack_q13(first << 11, second << 11);
    o.limit_q11 = pack_q13(g->limit_q11[0] << 16 >> 5, g->limit_q11[1] << 16 >> 5);
    for (int patch = 0; patch < PATCHES; patch += 2) {
        set_out_rows(g, &o, patch);
        g->reached[patch] &= which;
        g->reached[patch + 1] &= which;
    }
    order_levels(g->levels_q11);
    for (uint32_t place = 0; place < GROUP; place++)
        g->pattern_q24[place] = pattern_of(word_of(g->ux_q24, place), word_of(g->uy_q24, place));
}

/* Returns a splat's alpha, exp(-level / 2) capped at 0.99, in Q15. The result equals that of fxs_alpha_q15. */
static inline vh alpha_of(vh level)
{
    vh p = mul_add_h(all_h(-4236), level, all_h(16016));
    p = mul_add_h(p, level, all_h(-32730));
    p = mul_add_h(p, level, all_h(32767));
    p = mul_h(p, p);
    p = mul_h(p, p);
    p = mul_h(p, p);
    return least_h(p, all_h(FXS_ALPHA_MAX_Q15));
}

static inline void trace_entry(kept *k, unsigned which, int entry, int depth_q15, vh weight_q15, vh t_q15)
{
    const vh number = all_h(entry);
    if (which & FXS_TRACE_MEAN)
        k->depth_q15 = mul_add_h(weight_q15, all_h(depth_q15), k->depth_q15);
    if (which & FXS_TRACE_MEDIAN) {
        const vh above_half = where(greater_h(t_q15, all_h(FXS_HALF_Q15 - 1)), weight_q15);
        k->median = choose_h(greater_h(above_half, all_h(0)), number, k->median);
    }
    if (which & FXS_TRACE_ID) {
        const mask_h larger = greater_h(weight_q15, k->weight_q15);
        k->weight_q15 = choose_h(larger, weight_q15, k->weight_q15);
        k->largest = choose_h(larger, number, k->largest);
    }
}

/* Blends a splat into a patch of pixels. `open` is the mask of pixels that are not yet opaque. k is null without
   auxiliary outputs (depths, ids). */
ALWAYS_INLINE void blend_entry(pixels *at, mask_h *open, kept *k, unsigned which, const group *g, int patch,
                               uint32_t entry, int number, int depth_q15)
{
    const uint32_t place = place_of(entry);
    const vu left = g->pattern_q24[place] + spread(g->u_q24[patch], place), right = left + spread(g->right_q24, place);
    const vh u_q13 = pack_q13(left, right), t = at->transmittance_q15;
    const vh level = add_level(mul_h(u_q13, u_q13), spread_levels(g->levels_q11 + patch / 2 * ROWS, entry));
    const vh alpha_q15 = where(within(level, (vh)spread(g->limit_q11, place)), alpha_of(level));
    vh weight = where(*open, mul_h(alpha_q15, t));
    if (k) {
        if (which & FXS_TRACE_END)
            weight = where(greater_h(k->end, all_h(number)), weight);
        trace_entry(k, which, number, depth_q15, weight, t);
    }
    at->transmittance_q15 = t - weight;
    *open = open_of(at->transmittance_q15);
    at->red_q13 = mul_add_cut_h(weight, (vh)spread(g->red_q13, place), at->red_q13);
    at->green_q13 = mul_add_cut_h(weight, (vh)spread(g->green_q13, place), at->green_q13);
    at->blue_q13 = mul_add_cut_h(weight, (vh)spread(g->blue_q13, place), at->blue_q13);
}

/* Blends a group of splats into a patch of pixels. Returns nonzero while a pixel of the patch is not yet opaque. */
ALWAYS_INLINE int blend_patch(pixels *at, kept *k, unsigned which, const group *g, int patch, uint32_t number,
                              const int16_t *depths_q15)
{
    pixels p = *at;
    mask_h open = open_of(p.transmittance_q15);
    kept own;
    if (k)
        own = *k;
    uint32_t reached = g->reached[patch];
    do {
#pragma GCC unroll 2
        for (int i = 0; i < 2 && reached; i++, reached &= reached - 1) {
            const uint32_t entry = (uint32_t)__builtin_ctz(reached);
            blend_entry(&p, &open, k ? &own : 0, which, g, patch, entry, (int)(number + entry),
                        k && which & FXS_TRACE_MEAN ? depths_q15[entry] : 0);
        }
    } while (reached && any_h(open));
    *at = p;
    if (k)
        *k = own;
    return any_h(open);
}

ALWAYS_INLINE void blend_list(pixels patches[PATCHES], kept *k, const fxs_stage_view *view, int32_t x, int32_t y,
                              const fxs_splat *splats, const uint32_t *entries, const int16_t *depths_q15,
                              unsigned which, uint32_t first, uint32_t end)
{
    group g;
    uint32_t open = 0, fetched = first + GROUP;
    for (int patch = 0; patch < PATCHES; patch++)
        open |= (uint32_t)any_h(open_of(patches[patch].transmittance_q15)) << patch;
    for (uint32_t i = first; i < end && open; i += GROUP) {
        set_out(&g, view, splats, entries + i, end - i, x, y);
        for (const uint32_t last = end - i < AHEAD + GROUP ? end : i + AHEAD + GROUP; fetched < last; fetched++)
            __builtin_prefetch(&splats[entries[fetched] & ~FXS_ENTRY_CUT_OFF]);
        for (uint32_t rest = open; rest; rest &= rest - 1) {
            const int patch = __builtin_ctz(rest);
            if (g.reached[patch] && !blend_patch(patches + patch, k ? k + patch : 0, which, &g, patch, i,
                                                 depths_q15 ? depths_q15 + (i - first) : 0))
                open &= ~(1u << patch);
        }
    }
}

static inline int start_of(int patch)
{
    return patch / 2 * ROWS * FXS_TILE + patch % 2 * 8;
}

static inline vh load_rows(const int16_t *from)
{
    int16_t rows[ROWS][8];
    for (int i = 0; i < ROWS; i++)
        memcpy(rows[i], from + i * FXS_TILE, sizeof rows[i]);
    return columns_of(load_h(rows[0]));
}

static inline void store_rows(int16_t *to, vh x)
{
    int16_t rows[ROWS][8];
    store_h(rows[0], rows_of(x));
    for (int i = 0; i < ROWS; i++)
        memcpy(to + i * FXS_TILE, rows[i], sizeof rows[i]);
}

static inline void store_tile(fxs_tile *tile, const pixels patches[PATCHES])
{
    for (int i = 0; i < PATCHES; i++) {
        const int at = start_of(i);
        store_rows(tile->transmittance_q15 + at, patches[i].transmittance_q15);
        store_rows(tile->sum_q13[0] + at, patches[i].red_q13);
        store_rows(tile->sum_q13[1] + at, patches[i].green_q13);
        store_rows(tile->sum_q13[2] + at, patches[i].blue_q13);
    }
}

FXS_BLEND(ISA)
{
    pixels patches[PATCHES];
    for (int i = 0; i < PATCHES; i++)
        patches[i] = (pixels){all_h(FXS_CLEAR_Q15), all_h(0), all_h(0), all_h(0)};
    blend_list(patches, 0, view, x, y, splats, entries, 0, 0, 0, count);
    store_tile(tile, patches);
}

FXS_TRACE(ISA)
{
    pixels patches[PATCHES];
    kept k[PATCHES];
    for (int i = 0; i < PATCHES; i++) {
        const int at = start_of(i);
        patches[i] = (pixels){load_rows(tile->transmittance_q15 + at), load_rows(tile->sum_q13[0] + at),
                              load_rows(tile->sum_q13[1] + at), load_rows(tile->sum_q13[2] + at)};
        k[i] = (kept){load_rows(trace->depth_q15 + at), load_rows(trace->median + at),
                      load_rows(trace->weight_q15 + at), load_rows(trace->largest + at), load_rows(trace->end + at)};
    }
    blend_list(patches, k, view, x, y, splats, entries, depths_q15, trace->which, first, end);
    store_tile(tile, patches);
    for (int i = 0; i < PATCHES; i++) {
        const int at = start_of(i);
        store_rows(trace->depth_q15 + at, k[i].depth_q15);
        store_rows(trace->median + at, k[i].median);
        store_rows(trace->weight_q15 + at, k[i].weight_q15);
        store_rows(trace->largest + at, k[i].largest);
    }
}
