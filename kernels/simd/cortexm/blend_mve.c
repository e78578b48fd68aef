/* Blends the splats of a tile with Helium, or traces them with depths and ids as further outputs. The splats of the
 * tile's list are taken in groups of 8. The first step, with one splat per lane, finds which splats reach which patches
 * of the tile. The second step, with one pixel per lane, blends the splats of each patch. A patch has 4 columns and 2
 * rows of pixels, stored column by column. A splat has coordinates u and v, linear in the pixel position. The level of
 * a pixel is u^2 + v^2 + offset, and alpha is exp(-level / 2). */
#include "lanes_mve.h"
#include "src/core/draw.h"
#include "kernels/simd/lanes/stages.h"

#define GROUP 8
#define COLUMNS 4
#define ROWS 2
#define PATCHES (FXS_TILE_PIXELS / GROUP)
#define ACROSS (FXS_TILE / COLUMNS)
#define FIRSTS 0x5555u             /* mask of the lower of the two predicate bits of each 16-bit lane */
#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* Words of a splat in a group of splats. The upper half of a word that holds a 16-bit number is undefined. */
enum word {
    U, UX, UY,     /* splat coordinate u at the tile's first pixel, minus 2^10, and its steps per column and row; Q24 */
    LIMIT, RED, GREEN, BLUE,
    LEVELS,                      /* v^2 + offset of the splat on two pixel rows per word, upper row in the lower half */
    WORDS = LEVELS + FXS_TILE / ROWS
};

typedef struct group {
    uint32_t words[WORDS][GROUP];
    /* per patch of pixels: two bits for each splat, set if the splat may reach a pixel of the patch */
    uint16_t reached[PATCHES];
} group;

typedef struct pair {
    vu even, odd;
} pair;

/* Outlines of a group of splats. The splat coordinates u and v are 2^10 less than in fxs_splat, because packing to 16
   bits rounds. */
typedef struct outline {
    pair middle_q24, four_q24, two_q24;
    pair v_q24, vy_q24;                        /* splat coordinate v on the tile's first row, and its step per row */
    vh half_q13;                   /* half the range of splat coordinate u within a patch of pixels */
    vh offset_q11, limit_q11;      /* limit_q11: largest level that is drawn; -1: the splat is not drawn */
    vh least_q11[FXS_TILE / ROWS];
} outline;

static inline vh add_cut(vh a, vh b)
{
    return (vh)vqaddq_s16((int16x8_t)a, (int16x8_t)b);
}

static inline vh pack_q13(pair q24)
{
    const int16x8_t even = vqrshrnbq_n_s32((int16x8_t)q24.even, (int32x4_t)q24.even, 11);
    return (vh)vqrshrntq_n_s32(even, (int32x4_t)q24.odd, 11);
}

static inline vh low_halves(pair x)
{
    return (vh)vsliq_n_u32((uint32x4_t)x.even, (uint32x4_t)x.odd, 16);
}

static inline pair add(pair a, pair b)
{
    return (pair){a.even + b.even, a.odd + b.odd};
}

static inline pair add_times(pair a, pair b, uint32_t n)
{
    return (pair){(vu)vmlaq_n_u32((uint32x4_t)a.even, (uint32x4_t)b.even, n),
                  (vu)vmlaq_n_u32((uint32x4_t)a.odd, (uint32x4_t)b.odd, n)};
}

static inline pair shifted(pair x, int shift)
{
    return (pair){x.even >> shift, x.odd >> shift};
}

static inline vu magnitude(vu x)
{
    return (vu)vabsq_s32((int32x4_t)x);
}

static inline void store_by_entry(uint32_t to[GROUP], pair x)
{
    store_pairs(to, (vi)x.even, (vi)x.odd);
}

/* Loads a group of entries of a tile's list. Past the end of the list, the group is filled with its first entry. */
static inline pair take_entries(const uint32_t *entries, uint32_t left, int square, uint32_t *which)
{
    uint32_t few[GROUP];
    *which = left < GROUP ? 0xffffu >> 2 * (GROUP - left) : 0xffffu;
    for (uint32_t i = 0; i < GROUP && left < GROUP; i++)
        few[i] = entries[i < left ? i : 0];
    entries = left < GROUP ? few : entries;
    for (uint32_t i = 0; i < GROUP && square; i++)
        *which &= ~(3 * (entries[i] >> 31) << 2 * i);
    const uint32x4x2_t at = vld2q_u32(entries);
    return (pair){(vu)at.val[0], (vu)at.val[1]};
}

static inline pair word_of(const fxs_splat *splats, pair at, int i)
{
    const uint32_t *word = (const uint32_t *)(const void *)splats + i;
    return (pair){(vu)vldrwq_gather_shifted_offset_u32(word, (uint32x4_t)at.even),
                  (vu)vldrwq_gather_shifted_offset_u32(word, (uint32x4_t)at.odd)};
}

static inline void place_across(group *g, outline *o, const fxs_splat *splats, pair at, uint32_t x, uint32_t y)
{
    const pair ux = word_of(splats, at, 2), uy = word_of(splats, at, 3);
    pair u = add_times(add_times(word_of(splats, at, 0), ux, x), uy, y);
    u = (pair){u.even - 1024, u.odd - 1024};
    store_by_entry(g->words[UX], ux);
    store_by_entry(g->words[UY], uy);
    store_by_entry(g->words[U], u);
    o->four_q24 = (pair){COLUMNS * ux.even, COLUMNS * ux.odd};
    o->two_q24 = (pair){ROWS * uy.even, ROWS * uy.odd};
    const pair down = {magnitude(uy.even) + 4096, magnitude(uy.odd) + 4096}, far = add_times(uy, ux, COLUMNS - 1);
    o->half_q13 = pack_q13(shifted(add_times(down, ux, COLUMNS - 1), 1));
    o->middle_q24 = add(u, (pair){(vu)((vi)far.even >> 1), (vu)((vi)far.odd >> 1)});
}

static inline void place(group *g, outline *o, const fxs_stage_view *view, const fxs_splat *splats, pair at,
                         uint32_t which, uint32_t y)
{
    o->vy_q24 = word_of(splats, at, 4);
    o->v_q24 = add_times(word_of(splats, at, 1), o->vy_q24, y);
    o->v_q24 = (pair){o->v_q24.even - 1024, o->v_q24.odd - 1024};
    const pair offset_red = word_of(splats, at, 5), green_blue = word_of(splats, at, 6);
    o->offset_q11 = low_halves(offset_red);
    const vh limit = least_h(add_cut(o->offset_q11, all_h(view->cut_q11)), all_h(FXS_FAINT_Q11));
    o->limit_q11 = (vh)vpselq_s16((int16x8_t)limit, vdupq_n_s16(-1), (mve_pred16_t)which);
    store_by_entry(g->words[LIMIT], (pair){(vu)limit, (vu)limit >> 16});
    store_by_entry(g->words[RED], shifted(offset_red, 16));
    store_by_entry(g->words[GREEN], green_blue);
    store_by_entry(g->words[BLUE], shifted(green_blue, 16));
}

static inline void set_out_levels(group *g, outline *o)
{
    pair v_q24 = o->v_q24;
    for (int row = 0; row < FXS_TILE / ROWS; row++) {
        vh level_q11[ROWS];
        for (int i = 0; i < ROWS; i++) {
            const vh v_q13 = pack_q13(v_q24);
            level_q11[i] = add_cut(mul_h(v_q13, v_q13), o->offset_q11);
            v_q24 = add(v_q24, o->vy_q24);
        }
        const int16x8x2_t levels = {{(int16x8_t)level_q11[0], (int16x8_t)level_q11[1]}};
        vst2q_s16((int16_t *)(void *)g->words[LEVELS + row], levels);
        o->least_q11[row] = (vh)vqsubq_s16((int16x8_t)least_h(level_q11[0], level_q11[1]), (int16x8_t)o->limit_q11);
    }
}

/* Finds the patches that each splat of a group may reach, in one row of patches. A saturated splat coordinate is nearer
   to 0 than the exact one, so no splat that reaches a patch is missed. */
static inline void set_out_rows(uint16_t reached[ACROSS], const outline *o, pair u_q24, vh least_q11)
{
    for (uint32_t i = 0; i < ACROSS; i++) {
        const uint16x8_t size_q13 = (uint16x8_t)vqabsq_s16((int16x8_t)pack_q13(u_q24));
        const vh near_q13 = (vh)vqsubq_u16(size_q13, (uint16x8_t)o->half_q13);
        reached[i] = vcmpleq_n_s16((int16x8_t)add_cut(mul_h(near_q13, near_q13), least_q11), 0);
        u_q24 = add(u_q24, o->four_q24);
    }
}

static __attribute__((noinline)) void set_out(group *g, const fxs_stage_view *view, const fxs_splat *splats,
                                              const uint32_t *entries, uint32_t left, int32_t x, int32_t y)
{
    outline o;
    uint32_t which;
    pair at = take_entries(entries, left, view->cutoff == FXS_CUTOFF_SQUARE, &which);
    at = (pair){at.even << 3, at.odd << 3};
    place(g, &o, view, splats, at, which, (uint32_t)y);
    place_across(g, &o, splats, at, (uint32_t)x, (uint32_t)y);
    set_out_levels(g, &o);
    for (int row = 0; row < FXS_TILE / ROWS; row++) {
        set_out_rows(g->reached + ACROSS * row, &o, o.middle_q24, o.least_q11[row]);
        o.middle_q24 = add(o.middle_q24, o.two_q24);
    }
}

static inline vh level_of(const uint32_t *splat, uint32_t x, uint32_t y)
{
    const uint32_t ux = splat[UX * GROUP], uy = splat[UY * GROUP], u = splat[0] + x * ux + y * uy;
    const vu upper = (vu)vaddq_n_u32(vmulq_n_u32((uint32x4_t)load(lane_numbers), ux), u);
    const vh u_q13 = pack_q13((pair){upper, (vu)vaddq_n_u32((uint32x4_t)upper, uy)});
    return add_cut(mul_h(u_q13, u_q13), (vh)all((int32_t)splat[(LEVELS + y / ROWS) * GROUP]));
}

typedef struct pixels {
    vh t, red, green, blue;
} pixels;

#define MOVE(constant) "movw %[k], #" constant "\n\t"
#define LOAD(to, word) "ldr %[" to "], [%[splat], %[" word "]]\n\t"
#define OFFSET(word) "i"((word) * GROUP * 4)

/* Blends a splat into the pixels that mask `counted` selects: weight = T min(0.99, exp(-level / 2)), T' = T - weight,
   where T is a pixel's transmittance. In assembly, because GCC 12 would keep the pixels in memory. */
ALWAYS_INLINE void take(pixels *p, vh level_q11, const uint32_t *splat, mve_pred16_t counted)
{
    vh alpha;
    uint32_t k, green, blue;
    __asm__(MOVE("0xef74") "vqrdmulh.s16 %q[alpha], %q[level], %[k]\n\t"
            MOVE("16016") "vadd.i16 %q[alpha], %q[alpha], %[k]\n\t"
            MOVE("0x8026") "vqrdmlash.s16 %q[alpha], %q[level], %[k]\n\t"
            MOVE("32767") "vqrdmlash.s16 %q[alpha], %q[level], %[k]\n\t"
            "vqrdmulh.s16 %q[alpha], %q[alpha], %q[alpha]\n\t"
            "vqrdmulh.s16 %q[alpha], %q[alpha], %q[alpha]\n\t"
            "vqrdmulh.s16 %q[alpha], %q[alpha], %q[alpha]\n\t"
            MOVE("327") "vqadd.s16 %q[alpha], %q[alpha], %[k]\n\t"    /* caps the splat's alpha at 32440, 0.99 in Q15 */
            "vsub.i16 %q[alpha], %q[alpha], %[k]\n\t"
            "vqrdmulh.s16 %q[alpha], %q[alpha], %q[t]\n\t"                 /* weight = alpha times transmittance */
            LOAD("k", "reds") LOAD("green", "greens") LOAD("blue", "blues")
            "vpstttt\n\t"
            "vsubt.i16 %q[t], %q[t], %q[alpha]\n\t"
            "vqrdmlaht.s16 %q[r], %q[alpha], %[k]\n\t"
            "vqrdmlaht.s16 %q[g], %q[alpha], %[green]\n\t"
            "vqrdmlaht.s16 %q[b], %q[alpha], %[blue]"
            : [t] "+w"(p->t), [r] "+w"(p->red), [g] "+w"(p->green), [b] "+w"(p->blue), [alpha] "=&w"(alpha),
              [k] "=&r"(k), [green] "=&r"(green), [blue] "=&r"(blue)
            : [level] "w"(level_q11), [splat] "r"(splat), [reds] OFFSET(RED), [greens] OFFSET(GREEN),
              [blues] OFFSET(BLUE), "Up"(counted)
            : "memory");
}

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

/* Makes a splat transparent in the pixels where an occluder hides the tile's list entries from `number` on. */
static inline vh hide(vh level, const fxs_trace *trace, int at, int number)
{
    const mve_pred16_t seen = vcmpgtq_n_s16((int16x8_t)load_h(trace->end + at), (int16_t)number);
    return (vh)vpselq_s16((int16x8_t)level, vdupq_n_s16(FXS_LEVEL_MAX_Q11), seen);
}

ALWAYS_INLINE int blend_patch(fxs_tile *tile, fxs_trace *trace, const group *g, uint32_t patch, int number,
                              const int16_t *depths_q15)
{
    const int at = (int)patch * GROUP;
    const uint32_t x = patch % ACROSS * COLUMNS, y = patch / ACROSS * ROWS;
    pixels p = {(vh)vldrhq_s16(tile->transmittance_q15 + at), (vh)vldrhq_s16(tile->sum_q13[0] + at),
                (vh)vldrhq_s16(tile->sum_q13[1] + at), (vh)vldrhq_s16(tile->sum_q13[2] + at)};
    for (uint32_t reached = g->reached[patch] & FIRSTS; reached;) {
        const uint32_t entry = (uint32_t)__builtin_ctz(reached) / 2;
        reached &= reached - 1;
        const uint32_t *splat = g->words[0] + entry;
        const vh t = p.t;
        vh level = level_of(splat, x, y);
        if (trace && trace->which & FXS_TRACE_END)
            level = hide(level, trace, at, number + (int)entry);
        mve_pred16_t counted = vcmpgeq_n_s16((int16x8_t)t, FXS_CLOSED_Q15);
        counted = vcmpleq_m_n_s16((int16x8_t)level, (int16_t)splat[LIMIT * GROUP], counted);
        if (!counted)
            continue;
        take(&p, level, splat, counted);
        if (trace)
            trace_entry(trace, at, number + (int)entry, trace->which & FXS_TRACE_MEAN ? depths_q15[entry] : 0,
                        t - p.t, t);
    }
    store_h(tile->transmittance_q15 + at, p.t);
    store_h(tile->sum_q13[0] + at, p.red);
    store_h(tile->sum_q13[1] + at, p.green);
    store_h(tile->sum_q13[2] + at, p.blue);
    return vcmpgeq_n_s16((int16x8_t)p.t, FXS_CLOSED_Q15) != 0;
}

static inline uint32_t bits_of(const uint16_t numbers[16])
{
    const uint32_t low = vcmpneq_n_u16(vldrhq_u16(numbers), 0), high = vcmpneq_n_u16(vldrhq_u16(numbers + 8), 0);
    return (low | high << 16) & (FIRSTS | FIRSTS << 16);
}

static uint32_t open_patches(const fxs_tile *tile, uint32_t first)
{
    uint16_t open[16];
    for (uint32_t i = 0; i < 16; i++)
        open[i] = vcmpgeq_n_s16(vldrhq_s16(tile->transmittance_q15 + GROUP * (first + i)), FXS_CLOSED_Q15);
    return bits_of(open);
}

ALWAYS_INLINE void blend_list(fxs_tile *tile, fxs_trace *trace, const fxs_stage_view *view, int32_t x, int32_t y,
                              const fxs_splat *splats, const uint32_t *entries, const int16_t *depths_q15,
                              uint32_t first, uint32_t end)
{
    group g;
    uint32_t open[2] = {open_patches(tile, 0), open_patches(tile, 16)};
    for (uint32_t i = first; i < end && (open[0] | open[1]); i += GROUP) {
        set_out(&g, view, splats, entries + i, end - i, x, y);
        for (uint32_t half = 0; half < 2; half++)
            for (uint32_t rest = open[half] & bits_of(g.reached + 16 * half); rest; rest &= rest - 1) {
                const uint32_t bit = (uint32_t)__builtin_ctz(rest), patch = 16 * half + bit / 2;
                if (!blend_patch(tile, trace, &g, patch, (int)i, depths_q15 ? depths_q15 + (i - first) : 0))
                    open[half] &= ~(1u << bit);
            }
    }
}

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
