/* blend and trace, 2 * LANES pixels at a time: a step is one such vector, in the order of the tile's pixels. Steps of a
 * row or two are taken one after the other. Of shorter ones (LANES 4) those are left out that are closed, or on a row
 * that the ellipse does not reach, or have no pixel in its reach. An entry has to touch a row of the tile. */
#include "stages.h"

#define STEPS (FXS_TILE_PIXELS / (2 * LANES))
#define SKIPS (LANES < 8)
#define ALWAYS_INLINE static inline __attribute__((always_inline))
#define AHEAD (SKIPS ? 2 : 14)     /* entries: a splat is fetched that much before it is blended */

/* The pixels of a step, as pack_q13() leaves them. */
typedef struct pixels {
    vh transmittance_q15, red_q13, green_q13, blue_q13;
} pixels;

/* What trace keeps of them beside: a step of each array of fxs_trace. */
typedef struct kept {
    vh depth_q15, median, weight_q15, largest, end;
} kept;

/* A splat at a tile. */
typedef struct at_tile {
    uint32_t u_q24, v_q24;
    int first_row, last_row;
    vh limit_q11, red_q13, green_q13, blue_q13;
    vh number, depth_q15;           /* trace: of its entry, */
    unsigned which;                /* and what is kept */
} at_tile;

static inline at_tile at_tile_of(const fxs_view *view, const fxs_splat *splat, uint32_t entry, int32_t x, int32_t y)
{
    at_tile p = {splat->u0_q24 + (uint32_t)x * (uint32_t)splat->ux_q24 + (uint32_t)y * (uint32_t)splat->uy_q24,
                splat->v0_q24 + (uint32_t)y * (uint32_t)splat->vy_q24, splat->first_row - y, splat->last_row - y,
                all_h(fxs_limit_q11(splat->offset_q11, view->cut_q11)), all_h(splat->colour_q13[0]),
                all_h(splat->colour_q13[1]), all_h(splat->colour_q13[2]), all_h(0), all_h(0), 0};
    p.first_row = p.first_row < 0 ? 0 : p.first_row;
    p.last_row = fxs_min(p.last_row, FXS_TILE - 1);
    if (__builtin_expect((entry & FXS_ENTRY_FAR) != 0, 0))
        p.u_q24 = p.v_q24 = FXS_FAR_Q24;
    return p;
}

#if LANES < FXS_TILE
/* v^2 + offset of the 16 rows. */
typedef struct row_levels {
    int16_t of_row[FXS_TILE] __attribute__((aligned(32)));
} row_levels;

/* Those of 2 * LANES rows. */
static inline vh some_levels(uint32_t v_q24, uint32_t vy_q24, uint16_t offset_q11)
{
    const vh v_q13 = pack_q13(ramp(v_q24, vy_q24), ramp(v_q24 + LANES * vy_q24, vy_q24));
    return add_level(mul_h(v_q13, v_q13), all_h(offset_q11));
}

/* The lanes of a step. */
static inline vh row_level(const row_levels *levels, int step)
{
    return all_h(levels->of_row[step * 2 * LANES / FXS_TILE]);
}
#endif

/* exp(-level / 2), cut at 0.99: fxs_alpha_q15 */
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

/* Keeps track of a step; t: before the splat. */
static inline void trace_step(kept *k, const at_tile *p, vh weight_q15, vh t_q15)
{
    if (p->which & FXS_TRACE_MEAN)
        k->depth_q15 = mul_add_h(weight_q15, p->depth_q15, k->depth_q15);
    if (p->which & FXS_TRACE_MEDIAN) {
        const vh above_half = where(greater_h(t_q15, all_h(FXS_HALF_Q15 - 1)), weight_q15);
        k->median = choose_h(greater_h(above_half, all_h(0)), p->number, k->median);
    }
    if (p->which & FXS_TRACE_ID) {
        const mask_h larger = greater_h(weight_q15, k->weight_q15);
        k->weight_q15 = choose_h(larger, weight_q15, k->weight_q15);
        k->largest = choose_h(larger, p->number, k->largest);
    }
}

/* Blends the pixels of a step that count. k: null without a trace, here and below. */
static inline void blend_step(pixels *at, kept *k, const at_tile *p, vh level, mask_h counted)
{
    const vh t = at->transmittance_q15;
    vh weight = mul_h(where(counted, alpha_of(level)), t);
    if (k) {
        if (p->which & FXS_TRACE_END)
            weight = where(greater_h(k->end, p->number), weight);
        trace_step(k, p, weight, t);
    }
    at->transmittance_q15 = t - weight;
    at->red_q13 = mul_add_cut_h(weight, p->red_q13, at->red_q13);
    at->green_q13 = mul_add_cut_h(weight, p->green_q13, at->green_q13);
    at->blue_q13 = mul_add_cut_h(weight, p->blue_q13, at->blue_q13);
}

#if SKIPS
/* In bits_of(): the lowest bit of each of 16 rows. */
#define ALL_ROWS ((~(uint64_t)0 >> (64 - FXS_TILE * LANE_BITS)) / ((1 << LANE_BITS) - 1))

/* v^2 + offset of the 16 rows. Returns the rows within the limit. */
static inline uint64_t rows_reached(row_levels *levels, const at_tile *p, const fxs_splat *splat)
{
    const uint32_t vy = (uint32_t)splat->vy_q24;
    const vh upper = some_levels(p->v_q24, vy, splat->offset_q11);
    const vh lower = some_levels(p->v_q24 + 8 * vy, vy, splat->offset_q11);
    store_h(levels->of_row, upper);
    store_h(levels->of_row + 8, lower);
    return bits_of(within(upper, p->limit_q11), within(lower, p->limit_q11)) & ALL_ROWS << LANE_BITS * p->first_row &
           ALL_ROWS >> LANE_BITS * (FXS_TILE - 1 - p->last_row);
}

static inline vh level_of(vu first_q24, vu second_q24, vh row_level_q11)
{
    const vh u_q13 = pack_q13(first_q24, second_q24);
    return add_level(mul_h(u_q13, u_q13), row_level_q11);
}

/* Blends a row, of which a to d are the coordinates. Returns 0 where it is found closed. */
static inline int blend_row(pixels at[2], kept *k, const at_tile *p, vu a_q24, vu b_q24, vu c_q24, vu d_q24,
                            vh row_level_q11)
{
    const vh left = level_of(a_q24, b_q24, row_level_q11), right = level_of(c_q24, d_q24, row_level_q11);
    const mask_h open_left = open_of(at[0].transmittance_q15), open_right = open_of(at[1].transmittance_q15);
    const mask_h on_left = within(left, p->limit_q11) & open_left, on_right = within(right, p->limit_q11) & open_right;
    const uint64_t counted = bits_of(on_left, on_right);
    if (!counted)
        return bits_of(open_left, open_right) != 0;
    if (counted & (((uint64_t)1 << 8 * LANE_BITS) - 1))
        blend_step(at, k, p, left, on_left);
    if (counted >> 8 * LANE_BITS)
        blend_step(at + 1, k ? k + 1 : 0, p, right, on_right);
    return 1;
}

/* Blends a splat over the rows in `open`, and takes out of it those that are found closed. */
ALWAYS_INLINE void blend_splat(pixels tile[STEPS], kept *k, uint64_t *open, const at_tile *p, const fxs_splat *splat)
{
    row_levels levels;
    uint64_t rows = p->first_row > p->last_row ? 0 : *open & rows_reached(&levels, p, splat);
    const uint32_t ux = (uint32_t)splat->ux_q24, uy = (uint32_t)splat->uy_q24;
    const vu a = ramp(p->u_q24, ux), b = a + LANES * ux, c = b + LANES * ux, d = c + LANES * ux;
    for (; rows; rows &= rows - 1) {
        const int row = __builtin_ctzll(rows) / LANE_BITS;
        const vu down = (vu)all((int32_t)((uint32_t)row * uy));
        if (!blend_row(tile + 2 * row, k ? k + 2 * row : 0, p, a + down, b + down, c + down, d + down,
                       row_level(&levels, 2 * row)))
            *open &= ~(rows & (0 - rows));
    }
}
#else
#if LANES < FXS_TILE
static inline row_levels row_levels_of(uint32_t v_q24, uint32_t vy_q24, uint16_t offset_q11)
{
    row_levels levels;
    store_in_order(levels.of_row, some_levels(v_q24, vy_q24, offset_q11));
    return levels;
}
#endif

#define ALL_ROWS (~(uint64_t)0 >> (64 - STEPS))

/* Blends a splat over its rows, and takes the steps out of `open` that are found closed. */
ALWAYS_INLINE void blend_splat(pixels tile[STEPS], kept *k, uint64_t *open, const at_tile *p, const fxs_splat *splat)
{
    const int first = p->first_row * STEPS / FXS_TILE, last = ((p->last_row + 1) * STEPS - 1) / FXS_TILE;
    const uint32_t ux = (uint32_t)splat->ux_q24, uy = (uint32_t)splat->uy_q24, rows = FXS_TILE / STEPS;
    const row_levels levels = row_levels_of(p->v_q24, (uint32_t)splat->vy_q24, splat->offset_q11);
    vu a = ramp(p->u_q24 + (uint32_t)first * rows * uy, ux), b = a + (LANES < FXS_TILE ? LANES * ux : uy);
    const vu down = (vu)all((int32_t)(rows * uy));
    for (int step = first; step <= last; step++, a += down, b += down) {
        const vh u_q13 = pack_q13(a, b), level = add_level(mul_h(u_q13, u_q13), row_level(&levels, step));
        const mask_h open_here = open_of(tile[step].transmittance_q15);
        const mask_h counted = within(level, p->limit_q11) & open_here;
        if (!any_h(open_here))
            *open &= ~((uint64_t)1 << step);
        else if (!k || any_h(counted))           /* without k, it is faster not to ask */
            blend_step(tile + step, k ? k + step : 0, p, level, counted);
    }
}
#endif

/* Blends a list; depths_q15: null without a trace. */
ALWAYS_INLINE void blend_list(pixels steps[STEPS], kept *k, const fxs_view *view, int32_t x, int32_t y,
                              const fxs_splat *splats, const uint32_t *entries, const int16_t *depths_q15,
                              unsigned which, uint32_t first, uint32_t end)
{
    uint64_t open = ALL_ROWS;
    for (uint32_t i = first; i < end && open; i++) {
        if (i + AHEAD < end)
            __builtin_prefetch(&splats[entries[i + AHEAD] & ~FXS_ENTRY_FAR]);
        const fxs_splat *splat = &splats[entries[i] & ~FXS_ENTRY_FAR];
        at_tile p = at_tile_of(view, splat, entries[i], x, y);
        if (k) {
            p.number = all_h((int)i);
            p.depth_q15 = all_h(which & FXS_TRACE_MEAN ? depths_q15[i - first] : 0);
            p.which = which;
        }
        blend_splat(steps, k, &open, &p, splat);
    }
}

static inline void store_tile(fxs_tile *tile, const pixels steps[STEPS])
{
    for (int s = 0; s < STEPS; s++) {
        const int at = s * 2 * LANES;
        store_in_order(tile->transmittance_q15 + at, steps[s].transmittance_q15);
        store_in_order(tile->sum_q13[0] + at, steps[s].red_q13);
        store_in_order(tile->sum_q13[1] + at, steps[s].green_q13);
        store_in_order(tile->sum_q13[2] + at, steps[s].blue_q13);
    }
}

FXS_BLEND(ISA)
{
    pixels steps[STEPS];
    for (int s = 0; s < STEPS; s++)
        steps[s] = (pixels){all_h(FXS_CLEAR_Q15), all_h(0), all_h(0), all_h(0)};
    blend_list(steps, 0, view, x, y, splats, entries, 0, 0, 0, count);
    store_tile(tile, steps);
}

FXS_TRACE(ISA)
{
    pixels steps[STEPS];
    kept k[STEPS];
    for (int s = 0; s < STEPS; s++) {
        const int at = s * 2 * LANES;
        steps[s] = (pixels){load_in_order(tile->transmittance_q15 + at), load_in_order(tile->sum_q13[0] + at),
                            load_in_order(tile->sum_q13[1] + at), load_in_order(tile->sum_q13[2] + at)};
        k[s] = (kept){load_in_order(trace->depth_q15 + at), load_in_order(trace->median + at),
                      load_in_order(trace->weight_q15 + at), load_in_order(trace->largest + at),
                      load_in_order(trace->end + at)};
    }
    blend_list(steps, k, view, x, y, splats, entries, depths_q15, trace->which, first, end);
    store_tile(tile, steps);
    for (int s = 0; s < STEPS; s++) {
        const int at = s * 2 * LANES;
        store_in_order(trace->depth_q15 + at, k[s].depth_q15);
        store_in_order(trace->median + at, k[s].median);
        store_in_order(trace->weight_q15 + at, k[s].weight_q15);
        store_in_order(trace->largest + at, k[s].largest);
    }
}
