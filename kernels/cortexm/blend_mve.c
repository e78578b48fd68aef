/* blend and trace in Helium. As in kernels/lanes/blend.h, entries are taken in groups of 8: first it is found which of
 * them reach which patches of the tile, in vectors whose lanes are splats; then each patch is blended with those that
 * reach it, in vectors whose lanes are pixels. Here a patch is 4 columns of 2 rows, and pixel (c, r) of it lane 2 c + r,
 * as that is how instructions narrow; what all pixels of a patch share is a number in a general register; and while a
 * tile is blended, its arrays hold patch after patch. */
#include "lanes_mve.h"
#include "../../src/parts.h"
#include "../lanes/stages.h"

#define GROUP 8
#define COLUMNS 4
#define ROWS 2
#define PATCHES (FXS_TILE_PIXELS / GROUP)      /* in the order of their rows, four to two rows */
#define ACROSS (FXS_TILE / COLUMNS)
#define FIRSTS 0x5555u             /* the lower of the two bits that a predicate has for each lane */
#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* The splats of a group at a tile. */
typedef struct group {
    uint32_t u_q24[GROUP], ux_q24[GROUP], uy_q24[GROUP];   /* u: as in outline, at the tile's first pixel */
    int16_t limit_q11[GROUP], red_q13[GROUP], green_q13[GROUP], blue_q13[GROUP];
    uint32_t levels_q11[FXS_TILE / ROWS][GROUP];           /* v^2 + offset of two rows, the upper one below */
    uint16_t reached[PATCHES];     /* bit 2 i: entry i may have a pixel within its limit there */
} group;

/* What is needed of them only until it is found which patches they reach. In vector j is entry 2 i + j in lane i; in
   one of 16 bits, entry i in lane i. */
typedef struct outline {
    vu u_q24[2], v_q24[2], vy_q24[2];          /* u, v: at the first pixel of a row */
    vu four_q24[2], two_q24[2];                /* 4 ux, 2 uy */
    vh u_low_q13, u_high_q13;                  /* how far u goes within a patch */
    vh offset_q11, limit_q11;
} outline;

static inline vh add_cut(vh a, vh b)
{
    return (vh)vqaddq_s16((int16x8_t)a, (int16x8_t)b);
}

/* a in even lanes and b in odd ones, rounded and cut to 16 bits. (vqshrnb would round down, but the GNU assembler 2.40
   makes this of it.) */
static inline vh pack_q13(vu a_q24, vu b_q24)
{
    const int16x8_t even = vqrshrnbq_n_s32((int16x8_t)a_q24, (int32x4_t)a_q24, 11);
    return (vh)vqrshrntq_n_s32(even, (int32x4_t)b_q24, 11);
}

/* The low halves of a in even lanes, those of b in odd ones; and the high halves. */
static inline vh low_halves(vi a, vi b)
{
    return (vh)vsliq_n_s32((int32x4_t)a, (int32x4_t)b, 16);
}

static inline vh high_halves(vi a, vi b)
{
    return (vh)vsriq_n_u32((uint32x4_t)b, (uint32x4_t)a, 16);
}

static inline mask within(vh level, vh limit)
{
    return vcmpleq_s16((int16x8_t)level, (int16x8_t)limit);
}

/* ---- Which patches a group reaches ------------------------------------------------------------------------------- */

/* Entries, past the end the first again; *which: a bit of FIRSTS for each that touches something. */
static inline uint32x4x2_t take_entries(const uint32_t *entries, uint32_t left, int square, uint32_t *which)
{
    uint32_t few[GROUP];
    *which = left < GROUP ? FIRSTS >> 2 * (GROUP - left) : FIRSTS;
    for (uint32_t i = 0; i < GROUP && left < GROUP; i++)
        few[i] = entries[i < left ? i : 0];
    entries = left < GROUP ? few : entries;
    for (uint32_t i = 0; i < GROUP && square; i++)
        *which &= ~(entries[i] >> 31 << 2 * i);
    return vld2q_u32(entries);
}

static inline void load_splats(vi words[7], const fxs_splat *splats, uint32x4_t entries)
{
    const uint32x4_t at = (uint32x4_t)((vu)entries << 3);  /* in words, and FXS_ENTRY_FAR falls off */
    for (int i = 0; i < 7; i++)
        words[i] = (vi)vldrwq_gather_shifted_offset_s32((const int32_t *)(const void *)splats + i, at);
}

static inline void store_by_entry(void *to, vu even, vu odd)
{
    store_pairs(to, (vi)even, (vi)odd);
}

/* ux and vy are not below 0. */
static inline void place(group *g, outline *o, const fxs_view *view, const vi words[2][7], int32_t x, int32_t y)
{
    vu low[2], high[2];
    for (int j = 0; j < 2; j++) {
        const vu ux = (vu)words[j][2], uy = (vu)words[j][3], vy = (vu)words[j][4];
        o->u_q24[j] = (vu)words[j][0] - 1024 + (uint32_t)x * ux + (uint32_t)y * uy;
        o->v_q24[j] = (vu)words[j][1] - 1024 + (uint32_t)y * vy;
        o->vy_q24[j] = vy;
        o->four_q24[j] = COLUMNS * ux;
        o->two_q24[j] = ROWS * uy;
        low[j] = (vu)least((vi)uy, all(0)) - 1024;
        high[j] = (COLUMNS - 1) * ux + (vu)most((vi)uy, all(0)) + 1024;
    }
    store_by_entry(g->u_q24, o->u_q24[0], o->u_q24[1]);
    store_by_entry(g->ux_q24, (vu)words[0][2], (vu)words[1][2]);
    store_by_entry(g->uy_q24, (vu)words[0][3], (vu)words[1][3]);
    o->u_low_q13 = pack_q13(low[0], low[1]);
    o->u_high_q13 = pack_q13(high[0], high[1]);
    o->offset_q11 = low_halves(words[0][5], words[1][5]);
    o->limit_q11 = least_h(add_cut(o->offset_q11, all_h(view->cut_q11)), all_h(FXS_FAINT_Q11));
    store_h(g->limit_q11, o->limit_q11);
    store_h(g->red_q13, high_halves(words[0][5], words[1][5]));
    store_h(g->green_q13, low_halves(words[0][6], words[1][6]));
    store_h(g->blue_q13, high_halves(words[0][6], words[1][6]));
}

/* The least size of a coordinate between two that it has: that of one of them, or 0. */
static inline vh nearest(vh low, vh high)
{
    return most_h(most_h(low, ~high), all_h(0));
}

/* v of the next row. */
static inline vh next_row(outline *o)
{
    const vh v_q13 = pack_q13(o->v_q24[0], o->v_q24[1]);
    for (int j = 0; j < 2; j++)
        o->v_q24[j] += o->vy_q24[j];
    return v_q13;
}

/* Fills in the levels of the next two rows. Returns the least level that a splat has on them. */
static inline vh set_out_levels(uint32_t levels_q11[GROUP], outline *o)
{
    const vh upper = next_row(o), lower = next_row(o), v_q13 = nearest(upper, lower);
    const int16x8x2_t levels = {{(int16x8_t)add_cut(mul_h(upper, upper), o->offset_q11),
                                 (int16x8_t)add_cut(mul_h(lower, lower), o->offset_q11)}};
    vst2q_s16((int16_t *)(void *)levels_q11, levels);
    return add_cut(mul_h(v_q13, v_q13), o->offset_q11);
}

/* The patches of the next two rows. Cut coordinates are nearer to 0, so none is missed. Returns which entries reach
   one. */
static inline uint32_t set_out_rows(uint16_t reached[ACROSS], outline *o, vh least_q11, uint32_t which)
{
    vu u_q24[2] = {o->u_q24[0], o->u_q24[1]};
    uint32_t some = 0;
    for (int i = 0; i < ACROSS; i++) {
        const vh u_q13 = pack_q13(u_q24[0], u_q24[1]);
        const vh near_q13 = nearest(add_cut(u_q13, o->u_low_q13), add_cut(u_q13, o->u_high_q13));
        const vh level_q11 = add_cut(mul_h(near_q13, near_q13), least_q11);
        reached[i] = (uint16_t)(within(level_q11, o->limit_q11) & which);
        some |= reached[i];
        for (int j = 0; j < 2; j++)
            u_q24[j] += o->four_q24[j];
    }
    for (int j = 0; j < 2; j++)
        o->u_q24[j] += o->two_q24[j];
    return some;
}

/* Returns whether any reaches a patch. */
static __attribute__((noinline)) int set_out(group *g, const fxs_view *view, const fxs_splat *splats,
                                             const uint32_t *entries, uint32_t left, int32_t x, int32_t y)
{
    outline o;
    uint32_t which, some = 0;
    vi words[2][7];
    const uint32x4x2_t at = take_entries(entries, left, view->square, &which);
    load_splats(words[0], splats, at.val[0]);
    load_splats(words[1], splats, at.val[1]);
    place(g, &o, view, (const vi (*)[7])words, x, y);
    for (int row = 0; row < FXS_TILE / ROWS; row++) {
        const vh least_q11 = set_out_levels(g->levels_q11[row], &o);
        some |= set_out_rows(g->reached + ACROSS * row, &o, least_q11, which);
    }
    return some != 0;
}

/* ---- Blending a patch -------------------------------------------------------------------------------------------- */

/* p level + c */
static inline vh step(vh p, vh level, int16_t c)
{
    return (vh)vqrdmlashq_n_s16((int16x8_t)p, (int16x8_t)level, c);
}

/* exp(-level / 2), cut at 0.99: fxs_alpha_q15 */
static inline vh alpha_of(vh level)
{
    vh p = (vh)vqrdmulhq_n_s16((int16x8_t)level, -4236) + 16016;
    p = step(p, level, -32730);
    p = step(p, level, 32767);
    p = mul_h(p, p);
    p = mul_h(p, p);
    p = mul_h(p, p);
    return least_h(p, all_h(FXS_ALPHA_MAX_Q15));
}

/* The level of the pixels of patch (x, y), in pixels of the tile. */
static inline vh level_of(const group *g, uint32_t entry, uint32_t x, uint32_t y)
{
    const uint32_t ux = g->ux_q24[entry], uy = g->uy_q24[entry], u = g->u_q24[entry] + x * ux + y * uy;
    const vu upper = (vu)all((int32_t)u) + ux * (vu)load(lane_numbers), lower = upper + uy;
    const vh u_q13 = pack_q13(upper, lower), levels = (vh)all((int32_t)g->levels_q11[y / ROWS][entry]);
    return add_cut(mul_h(u_q13, u_q13), levels);
}

/* The pixels of a patch. */
typedef struct pixels {
    vh t, red, green, blue;
} pixels;

ALWAYS_INLINE void take(pixels *p, vh weight, const group *g, uint32_t entry, mve_pred16_t counted)
{
    p->t = (vh)vsubq_m_s16((int16x8_t)p->t, (int16x8_t)p->t, (int16x8_t)weight, counted);
    weight = (vh)vpselq_s16((int16x8_t)weight, vdupq_n_s16(0), counted);
    p->red = (vh)vqrdmlahq_n_s16((int16x8_t)p->red, (int16x8_t)weight, g->red_q13[entry]);
    p->green = (vh)vqrdmlahq_n_s16((int16x8_t)p->green, (int16x8_t)weight, g->green_q13[entry]);
    p->blue = (vh)vqrdmlahq_n_s16((int16x8_t)p->blue, (int16x8_t)weight, g->blue_q13[entry]);
}

/* Keeps track of the patch whose first pixel is `at` in the arrays of `trace`; t: before the entry. */
static inline void trace_entry(fxs_trace *trace, int at, int number, int depth_q15, vh weight_q15, vh t)
{
    if (trace->which & FXS_TRACE_MEAN) {
        const vh depth = load_h(trace->depth_q15 + at);
        store_h(trace->depth_q15 + at, mul_add_cut_h(weight_q15, all_h(depth_q15), depth));
    }
    const mve_pred16_t some = vcmpgtq_n_s16((int16x8_t)weight_q15, 0);
    if (trace->which & FXS_TRACE_MEDIAN)
        vstrhq_p_s16(trace->median + at, vdupq_n_s16((int16_t)number),
                     vcmpgeq_m_n_s16((int16x8_t)t, FXS_HALF_Q15, some));
    if (trace->which & FXS_TRACE_ID) {
        const mve_pred16_t larger = vcmpgtq_s16((int16x8_t)weight_q15, (int16x8_t)load_h(trace->weight_q15 + at));
        vstrhq_p_s16(trace->weight_q15 + at, (int16x8_t)weight_q15, larger);
        vstrhq_p_s16(trace->largest + at, vdupq_n_s16((int16_t)number), larger);
    }
}

/* Blends a group, from entry `number` on, into a patch that some reach. trace, depths_q15: null without a trace.
   Returns whether it is still open. */
ALWAYS_INLINE int blend_patch(fxs_tile *tile, fxs_trace *trace, const group *g, uint32_t patch, int number,
                              const int16_t *depths_q15)
{
    const int at = (int)patch * GROUP;
    const uint32_t x = patch % ACROSS * COLUMNS, y = patch / ACROSS * ROWS;
    pixels p = {load_h(tile->transmittance_q15 + at), load_h(tile->sum_q13[0] + at), load_h(tile->sum_q13[1] + at),
                load_h(tile->sum_q13[2] + at)};
    for (uint32_t reached = g->reached[patch]; reached; reached &= reached - 1) {
        const uint32_t entry = (uint32_t)__builtin_ctz(reached) / 2;
        const vh level = level_of(g, entry, x, y), t = p.t, weight = mul_h(alpha_of(level), t);
        mve_pred16_t counted = vcmpgeq_n_s16((int16x8_t)t, FXS_CLOSED_Q15);
        counted = vcmpleq_m_n_s16((int16x8_t)level, g->limit_q11[entry], counted);
        if (trace && trace->which & FXS_TRACE_END)
            counted = vcmpgtq_m_n_s16((int16x8_t)load_h(trace->end + at), (int16_t)(number + (int)entry), counted);
        take(&p, weight, g, entry, counted);
        if (trace)
            trace_entry(trace, at, number + (int)entry, trace->which & FXS_TRACE_MEAN ? depths_q15[entry] : 0,
                        (vh)vpselq_s16((int16x8_t)weight, vdupq_n_s16(0), counted), t);
    }
    store_h(tile->transmittance_q15 + at, p.t);
    store_h(tile->sum_q13[0] + at, p.red);
    store_h(tile->sum_q13[1] + at, p.green);
    store_h(tile->sum_q13[2] + at, p.blue);
    return vcmpgeq_n_s16((int16x8_t)p.t, FXS_CLOSED_Q15) != 0;
}

static uint32_t open_patches(const fxs_tile *tile)
{
    uint32_t open = 0;
    for (uint32_t i = 0; i < PATCHES; i++)
        open |= (uint32_t)(vcmpgeq_n_s16(vldrhq_s16(tile->transmittance_q15 + GROUP * i), FXS_CLOSED_Q15) != 0) << i;
    return open;
}

/* Blends a list into a tile by patches. */
ALWAYS_INLINE void blend_list(fxs_tile *tile, fxs_trace *trace, const fxs_view *view, int32_t x, int32_t y,
                              const fxs_splat *splats, const uint32_t *entries, const int16_t *depths_q15,
                              uint32_t first, uint32_t end)
{
    group g;
    uint32_t open = open_patches(tile);
    for (uint32_t i = first; i < end && open; i += GROUP) {
        if (!set_out(&g, view, splats, entries + i, end - i, x, y))
            continue;
        for (uint32_t rest = open; rest; rest &= rest - 1) {
            const uint32_t patch = (uint32_t)__builtin_ctz(rest);
            if (g.reached[patch] &&
                !blend_patch(tile, trace, &g, patch, (int)i, depths_q15 ? depths_q15 + (i - first) : 0))
                open &= ~(1u << patch);
        }
    }
}

/* ---- Tiles ------------------------------------------------------------------------------------------------------- */

/* An array of a tile: 4 patches are as long as their two rows. */
static void rows_of_patches(int16_t array[FXS_TILE_PIXELS])
{
    for (int i = 0; i < FXS_TILE_PIXELS; i += ROWS * FXS_TILE) {
        const int16x8x2_t left = vld2q_s16(array + i), right = vld2q_s16(array + i + FXS_TILE);
        store_h(array + i, (vh)left.val[0]);
        store_h(array + i + 8, (vh)right.val[0]);
        store_h(array + i + FXS_TILE, (vh)left.val[1]);
        store_h(array + i + FXS_TILE + 8, (vh)right.val[1]);
    }
}

static void patches_of_rows(int16_t array[FXS_TILE_PIXELS])
{
    for (int i = 0; i < FXS_TILE_PIXELS; i += ROWS * FXS_TILE) {
        const int16x8x2_t left = {{vldrhq_s16(array + i), vldrhq_s16(array + i + FXS_TILE)}};
        const int16x8x2_t right = {{vldrhq_s16(array + i + 8), vldrhq_s16(array + i + FXS_TILE + 8)}};
        vst2q_s16(array + i, left);
        vst2q_s16(array + i + FXS_TILE, right);
    }
}

static void all_arrays(fxs_tile *tile, fxs_trace *trace, void (*turn)(int16_t array[FXS_TILE_PIXELS]))
{
    turn(tile->transmittance_q15);
    for (int c = 0; c < 3; c++)
        turn(tile->sum_q13[c]);
    if (!trace)
        return;
    turn(trace->depth_q15);
    turn(trace->median);
    turn(trace->weight_q15);
    turn(trace->largest);
    turn(trace->end);
}

FXS_BLEND(ISA)
{
    fxs_tile_clear(tile);
    blend_list(tile, 0, view, x, y, splats, entries, 0, 0, count);
    all_arrays(tile, 0, rows_of_patches);
}

FXS_TRACE(ISA)
{
    all_arrays(tile, trace, patches_of_rows);
    blend_list(tile, trace, view, x, y, splats, entries, depths_q15, first, end);
    all_arrays(tile, trace, rows_of_patches);
}
