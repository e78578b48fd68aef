/* bin, four splats at a time: src/bin.c with the same numbers, in 32 bits. First come the boxes, and the masks of those
 * that lie whole on one tile row; other splats that fit in a box wait until there are four for the row by row pass. */
#include "arm.h"
#include "fixed_neon.h"

#define LANES 4u
/* 256 pixels. Up to it the row by row pass needs no more than 31 bits: breadth r and |shear| r are at most sqrt(A) r,
   less than 4096 half_width (Q20) <= 2^28; breadth (sqrt(r^2 - v^2) + 1) is 1 part in 91 more, as r >= 91 (Q12); the
   tangent and v half_width are at most r half_width < 2^29.6. What is larger is left to C. */
#define HALF_WIDTH_LIMIT_Q8 (1u << 16)

/* Of four splats. */
typedef struct fields {
    int32x4_t vy_q24, offset_q11, first_row, last_row, cx_q8, cy_q14, breadth_q8, shear_q8, reach_q8;
} fields;

typedef struct ellipses {
    uint32x4_t v_q24, vy_q24;      /* v on the first pixel row of a tile row, and from row to row */
    int32x4_t cx_q8, breadth_q8, shear_q8, reach_q8, r_q12, tangent;
    int32x4_t first_column, more_rows;   /* of the box; tile rows after the first */
} ellipses;

/* words[i] = word i of what the four pointers point to */
static inline void load_fours(int32x4_t words[4], const void *x, const void *y, const void *z, const void *w)
{
    const int32x4_t a = vreinterpretq_s32_u8(vld1q_u8(x)), b = vreinterpretq_s32_u8(vld1q_u8(y));
    const int32x4_t c = vreinterpretq_s32_u8(vld1q_u8(z)), d = vreinterpretq_s32_u8(vld1q_u8(w));
    const int64x2_t ab_low = vreinterpretq_s64_s32(vzip1q_s32(a, b)), ab_high = vreinterpretq_s64_s32(vzip2q_s32(a, b));
    const int64x2_t cd_low = vreinterpretq_s64_s32(vzip1q_s32(c, d)), cd_high = vreinterpretq_s64_s32(vzip2q_s32(c, d));
    words[0] = vreinterpretq_s32_s64(vzip1q_s64(ab_low, cd_low));
    words[1] = vreinterpretq_s32_s64(vzip2q_s64(ab_low, cd_low));
    words[2] = vreinterpretq_s32_s64(vzip1q_s64(ab_high, cd_high));
    words[3] = vreinterpretq_s32_s64(vzip2q_s64(ab_high, cd_high));
}

static inline fields load_fields(const fxs_splat *splats, const fxs_bounds *bounds, const uint32_t at[LANES])
{
    const fxs_splat *s[LANES] = {splats + at[0], splats + at[1], splats + at[2], splats + at[3]};
    const fxs_bounds *b[LANES] = {bounds + at[0], bounds + at[1], bounds + at[2], bounds + at[3]};
    int32x4_t from_vy[4], from_cx[4], from_breadth[4];
    load_fours(from_vy, &s[0]->vy_q24, &s[1]->vy_q24, &s[2]->vy_q24, &s[3]->vy_q24);
    load_fours(from_cx, &b[0]->cx_q14, &b[1]->cx_q14, &b[2]->cx_q14, &b[3]->cx_q14);
    load_fours(from_breadth, &b[0]->breadth_q8, &b[1]->breadth_q8, &b[2]->breadth_q8, &b[3]->breadth_q8);
    const int32x4_t low_half = vdupq_n_s32(65535);
    return (fields){from_vy[0], vandq_s32(from_vy[1], low_half),
                    vandq_s32(from_vy[3], low_half), s32(vshrq_n_u32(u32(from_vy[3]), 16)),
                    vshrq_n_s32(from_cx[0], 6), from_cx[1],
                    from_breadth[0], from_breadth[1], from_breadth[2]};
}

/* The tile columns of the pixels between two points. Returns the lanes where there is no pixel. */
static inline uint32x4_t columns_between(int32x4_t *first, int32x4_t *last, const fxs_view *view, int32x4_t left_q8,
                                         int32x4_t right_q8)
{
    int32x4_t first_pixel = vmaxq_s32(vshrq_n_s32(vaddq_s32(left_q8, vdupq_n_s32(255)), 8), vdupq_n_s32(0));
    int32x4_t last_pixel = vminq_s32(vshrq_n_s32(right_q8, 8), vdupq_n_s32(view->width - 1));
    *first = vshrq_n_s32(first_pixel, 4);
    *last = vshrq_n_s32(last_pixel, 4);
    return vcgtq_s32(first_pixel, last_pixel);
}

static inline uint32x4_t box_columns(int32x4_t *first, int32x4_t *last, const fxs_view *view, const fields *f)
{
    return columns_between(first, last, view, vsubq_s32(f->cx_q8, f->reach_q8), vaddq_s32(f->cx_q8, f->reach_q8));
}

/* v = ((y << 14) - cy) vy >> 26 = ((-cy vy >> 14) + y vy) >> 12, of which 32 bits are enough: the tile rows of a box
   are less than 16 pixels off the ellipse, so |v| < 4 + 16 vy < 128. */
static inline ellipses ellipses_of(const fxs_view *view, const fields *f)
{
    const int32x4_t up = vnegq_s32(f->cy_q14), first_row = vshrq_n_s32(f->first_row, 4);
    const int64x2_t low = vmull_s32(vget_low_s32(up), vget_low_s32(f->vy_q24)), high = vmull_high_s32(up, f->vy_q24);
    const int32x4_t v_q24 = vshrn_high_n_s64(vshrn_n_s64(low, 14), high, 14);
    const int32x4_t limit_q11 = vaddq_s32(f->offset_q11, vdupq_n_s32(view->cut_q11));
    const int32x4_t room_q11 = vsubq_s32(vminq_s32(limit_q11, vdupq_n_s32(FXS_FAINT_Q11)), f->offset_q11);
    const uint32x4_t square_q24 = vshlq_n_u32(u32(vaddq_s32(room_q11, vdupq_n_s32(1))), 13);
    ellipses e;
    int32x4_t last_column;
    e.v_q24 = u32(vmlaq_s32(v_q24, vshlq_n_s32(first_row, 4), f->vy_q24));
    e.vy_q24 = u32(f->vy_q24);
    e.cx_q8 = f->cx_q8;
    e.breadth_q8 = f->breadth_q8;
    e.shear_q8 = f->shear_q8;
    e.reach_q8 = f->reach_q8;
    e.r_q12 = vaddq_s32(s32(sqrt_32(square_q24)), vdupq_n_s32(1));
    const int32x4_t widest = vmulq_s32(e.shear_q8, e.r_q12);   /* over 4096, towards 0 */
    const int32x4_t up_to_0 = vandq_s32(vshrq_n_s32(widest, 31), vdupq_n_s32(4095));
    e.tangent = vmulq_s32(vshrq_n_s32(vaddq_s32(widest, up_to_0), 12), e.r_q12);
    box_columns(&e.first_column, &last_column, view, f);
    e.more_rows = vsubq_s32(vshrq_n_s32(f->last_row, 4), first_row);
    return e;
}

/* Half the width at v, about x = cx + shear v. */
static inline int32x4_t half_width_q8(const ellipses *e, int32x4_t v_q12)
{
    const uint32x4_t square_q24 = u32(vmlsq_s32(vmulq_s32(e->r_q12, e->r_q12), v_q12, v_q12));
    if (!any(vtstq_u32(square_q24, square_q24)))   /* often so above the ellipse and below it, and the root is slow */
        return vshrq_n_s32(e->breadth_q8, 12);
    return vshrq_n_s32(vmlaq_s32(e->breadth_q8, e->breadth_q8, s32(sqrt_32(square_q24))), 12);
}

static inline uint32x4_t between(int32x4_t low, int32x4_t x, int32x4_t high)
{
    return vandq_u32(vcleq_s32(low, x), vcleq_s32(x, high));
}

/* The tiles of a tile row that the ellipses touch, bit 0 for the first column of the box. */
static inline uint32x4_t tiles_of_row(const ellipses *e, const fxs_view *view)
{
    const int32x4_t r = e->r_q12, reach = e->reach_q8, slack = vaddq_s32(r, vdupq_n_s32(2));
    const int32x4_t top_q12 = vshrq_n_s32(s32(e->v_q24), 12);
    const int32x4_t bottom_q12 = vshrq_n_s32(s32(vmlaq_n_u32(e->v_q24, e->vy_q24, FXS_TILE - 1)), 12);
    const int32x4_t top = vmaxq_s32(vminq_s32(top_q12, r), vnegq_s32(r));
    const int32x4_t bottom = vmaxq_s32(vminq_s32(vaddq_s32(bottom_q12, vdupq_n_s32(1)), r), vnegq_s32(r));
    const int32x4_t x_top = vshrq_n_s32(vmulq_s32(e->shear_q8, top), 12), half_top = half_width_q8(e, top);
    const int32x4_t x_bottom = vshrq_n_s32(vmulq_s32(e->shear_q8, bottom), 12), half_bottom = half_width_q8(e, bottom);
    int32x4_t left_q8 = vmaxq_s32(vsubq_s32(half_top, x_top), vsubq_s32(half_bottom, x_bottom));
    int32x4_t right_q8 = vmaxq_s32(vaddq_s32(half_top, x_top), vaddq_s32(half_bottom, x_bottom));
    /* Is a widest point on this tile row? */
    const int32x4_t low = vmulq_s32(top, reach), high = vmulq_s32(bottom, reach);
    left_q8 = vbslq_s32(between(low, vnegq_s32(e->tangent), high), reach, left_q8);
    right_q8 = vbslq_s32(between(low, e->tangent, high), reach, right_q8);
    const int32x4_t margin_q8 = vaddq_s32(vshrq_n_s32(reach, 8), vdupq_n_s32(32));
    left_q8 = vminq_s32(vaddq_s32(left_q8, margin_q8), reach);
    right_q8 = vminq_s32(vaddq_s32(right_q8, margin_q8), reach);
    int32x4_t first, last;
    uint32x4_t none = columns_between(&first, &last, view, vsubq_s32(e->cx_q8, left_q8), vaddq_s32(e->cx_q8, right_q8));
    none = vorrq_u32(none, vorrq_u32(vcgtq_s32(top_q12, slack), vcltq_s32(bottom_q12, vnegq_s32(slack))));
    const uint32x4_t up_to_last = vshlq_u32(vdupq_n_u32(2), vsubq_s32(last, e->first_column));
    return vbicq_u32(vsubq_u32(up_to_last, vshlq_u32(vdupq_n_u32(1), vsubq_s32(first, e->first_column))), none);
}

/* The masks of four splats, row by row. */
static void fill_masks(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds,
                       const uint32_t index[LANES], fxs_box *boxes)
{
    const fields f = load_fields(splats, bounds, index);
    ellipses e = ellipses_of(view, &f);
    uint32x4_t tiles = vdupq_n_u32(0), in_box;
    for (int row = 0; any(in_box = vcgeq_s32(e.more_rows, vdupq_n_s32(row))); row++) {
        uint32x4_t touched = vandq_u32(tiles_of_row(&e, view), in_box);
        tiles = vorrq_u32(tiles, vshlq_u32(touched, vdupq_n_s32(4 * row)));
        e.v_q24 = vmlaq_n_u32(e.v_q24, e.vy_q24, FXS_TILE);
    }
    uint32_t masks[LANES];
    vst1q_u32(masks, tiles);
    for (uint32_t k = 0; k < LANES; k++)
        boxes[index[k]].mask = masks[k];
}

/* The boxes of the splats i to i + 3. Returns the lanes whose masks are left for the row by row pass. */
static inline uint32x4_t find_boxes(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t i,
                                    fxs_box *boxes)
{
    const uint32_t at[LANES] = {i, i + 1, i + 2, i + 3};
    const fields f = load_fields(splats, bounds, at);
    const int32x4_t first_row = vshrq_n_s32(f.first_row, 4), last_row = vshrq_n_s32(f.last_row, 4);
    const int32x4_t more_rows = vsubq_s32(last_row, first_row);
    int32x4_t first, last;
    const uint32x4_t none = box_columns(&first, &last, view, &f);
    const int32x4_t more_columns = vsubq_s32(last, first), four = vdupq_n_s32(4);
    const uint32x4_t fits = vbicq_u32(vandq_u32(vcltq_s32(more_rows, four), vcltq_s32(more_columns, four)), none);
    const uint32x4_t inside = vandq_u32(vcgtzq_s32(f.first_row), vcltq_s32(f.last_row, vdupq_n_s32(view->height - 1)));
    const uint32x4_t whole = vandq_u32(vandq_u32(fits, inside), vceqzq_s32(more_rows));
    const int32x4_t column = vbicq_s32(first, s32(none));
    uint32x4x2_t box;
    box.val[0] = u32(vmlaq_n_s32(column, first_row, view->tiles_x));
    box.val[1] = vandq_u32(vsubq_u32(vshlq_u32(vdupq_n_u32(2), more_columns), vdupq_n_u32(1)), whole);
    vst2q_u32(&boxes[i].base, box);
    return vbicq_u32(fits, whole);
}

void fxs_bin_neon(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count,
                  fxs_box *boxes)
{
    uint32_t i = 0, waiting = 0, index[LANES], left[LANES];
    for (; !view->square && i + LANES <= count; i += LANES) {
        vst1q_u32(left, find_boxes(view, splats, bounds, i, boxes));
        for (uint32_t k = i; k < i + LANES; k++) {
            if (!left[k - i])
                continue;
            if (bounds[k].half_width_q8 > HALF_WIDTH_LIMIT_Q8)
                fxs_bin_c(view, splats + k, bounds + k, 1, boxes + k);
            else
                index[waiting++] = k;
            if (waiting == LANES) {
                fill_masks(view, splats, bounds, index, boxes);
                waiting = 0;
            }
        }
    }
    while (waiting--) {
        uint32_t k = index[waiting];
        fxs_bin_c(view, splats + k, bounds + k, 1, boxes + k);
    }
    fxs_bin_c(view, splats + i, bounds + i, count - i, boxes + i);
}
