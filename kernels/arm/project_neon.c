/* project: four neighbours of a chunk at once; those left after culling are appended one by one. The functions are
 * those of src/project.c; a lane that is culled goes on with values that mean nothing and is dropped at the end. A
 * chunk with a veil is left to C, as they are rare, and so is the square cut-off, which is there to be measured. */
#include "arm.h"
#include "codes_neon.h"
#include "fixed_neon.h"

#define LANES 4u

typedef struct projected {
    int32x4_t z, zeros;
    uint32x4_t inverse_q30;
    int32x4_t slope_q23[2], position_q14[2];
    uint32x4_t in_range;           /* not too far off the axis and the picture */
} projected;

typedef struct covariance {
    uint32x4_t a_q30, c_q30;
    int32x4_t b_q30;
    uint64x2x2_t det_q60, det_undilated_q60;
    int32x4_t exponent;
} covariance;

/* What is written out. */
typedef struct shapes {
    uint32_t u0_q24[LANES], v0_q24[LANES];
    int32_t ux_q24[LANES], uy_q24[LANES], vy_q24[LANES], offset_q11[LANES], first_row[LANES], last_row[LANES];
    int32_t cx_q14[LANES], cy_q14[LANES], shear_q8[LANES];
    uint32_t breadth_q8[LANES], half_width_q8[LANES];
    int has_veil;                  /* then nothing else is said */
} shapes;

static inline int32x4_t camera_coordinate(const fxs_chunk_view *cv, int axis, const int32x4_t code[3])
{
    int64x2_t low = vdupq_n_s64(cv->base_q16[axis]), high = low;
    for (int j = 0; j < 3; j++) {
        const int32_t m_q16 = (int32_t)cv->m_q16[axis][j];
        low = vmlal_n_s32(low, vget_low_s32(code[j]), m_q16);
        high = vmlal_high_n_s32(high, code[j], m_q16);
    }
    return vshrn_high_n_s64(vshrn_n_s64(low, 16), high, 16);
}

/* Pixels from slope * f + c. Clears the lanes of *in_range that are 65536 pixels away. */
static inline int32x4_t pixel_q14(int32x4_t slope_q23, int64_t f_q12, int64_t c_q12, uint32x4_t *in_range)
{
    const int64x2_t c_q14 = vdupq_n_s64(c_q12 * 4 - (1 << 13)), limit = vdupq_n_s64(FXS_CENTRE_LIMIT_Q14);
    int64x2_t low = vrshrq_n_s64(vmull_n_s32(vget_low_s32(slope_q23), (int32_t)f_q12), 21);
    int64x2_t high = vrshrq_n_s64(vmull_high_n_s32(slope_q23, (int32_t)f_q12), 21);
    low = vaddq_s64(low, c_q14);
    high = vaddq_s64(high, c_q14);
    uint32x2_t near = vmovn_u64(vcltq_s64(vabsq_s64(low), limit));
    *in_range = vandq_u32(*in_range, vcombine_u32(near, vmovn_u64(vcltq_s64(vabsq_s64(high), limit))));
    return vcombine_s32(vmovn_s64(low), vmovn_s64(high));
}

/* Returns the lanes in front of the near plane. */
static inline uint32x4_t project_centre(projected *out, const fxs_view *view, const fxs_chunk_view *cv,
                                        const uint32x4_t position[3])
{
    const int32x4_t code[3] = {s32(position[0]), s32(position[1]), s32(position[2])};
    out->z = camera_coordinate(cv, 2, code);
    out->zeros = vclzq_s32(out->z);
    out->inverse_q30 = reciprocal(vshlq_u32(u32(out->z), out->zeros));
    const int64_t f_q12[2] = {view->fx_q12, view->fy_q12}, c_q12[2] = {view->cx_q12, view->cy_q12};
    out->in_range = vdupq_n_u32(~0u);
    for (int i = 0; i < 2; i++) {
        int32x4_t camera = camera_coordinate(cv, i, code);
        uint32x4_t near_axis = vcltq_s32(vshrq_n_s32(vabsq_s32(camera), 6), out->z);   /* |camera| < 64 z */
        out->in_range = vandq_u32(out->in_range, near_axis);
        out->slope_q23[i] = mul_round_shift(camera, s32(out->inverse_q30), vsubq_s32(vdupq_n_s32(39), out->zeros));
        out->position_q14[i] = pixel_q14(out->slope_q23[i], f_q12[i], c_q12[i], &out->in_range);
    }
    return vcgtq_s32(out->z, vdupq_n_s32(cv->near));
}

static inline void jacobian(int32x4_t j_q15[2][3], const fxs_view *view, const projected *centre)
{
    const int32x4_t left = vdupq_n_s32(-8 - view->jacobian_exponent);
    for (int i = 0; i < 2; i++) {
        int32x4_t slope = vmaxq_s32(centre->slope_q23[i], vdupq_n_s32(view->slope_low_q23[i]));
        slope = vrshlq_s32(vminq_s32(slope, vdupq_n_s32(view->slope_high_q23[i])), left);
        for (int k = 0; k < 3; k++)
            j_q15[i][k] = vsubq_s32(vdupq_n_s32(view->row_q15[i][k]), mul_n_q15(slope, view->forward_q15[i][k]));
    }
}

static inline uint32x4_t exp2_q15(uint32x4_t x_q16)
{
    int32x4_t f_q15 = s32(vshrq_n_u32(vandq_u32(x_q16, vdupq_n_u32(65535)), 1));
    int32x4_t p = mul_n_q15(f_q15, 256);
    p = mul_q15(vsubq_s32(p, vdupq_n_s32(1820)), f_q15);
    p = mul_q15(vaddq_s32(p, vdupq_n_s32(7904)), f_q15);
    p = mul_q15(vsubq_s32(p, vdupq_n_s32(22724)), f_q15);
    return u32(vaddq_s32(vdupq_n_s32(32768), p));
}

static inline int32x4_t component(uint32x4_t code)
{
    int32x4_t odd = vsubq_s32(s32(vaddq_u32(code, code)), vdupq_n_s32(1023));
    return vrshrq_n_s32(vmulq_n_s32(odd, 23194), 10);
}

/* Returns the lanes whose three components are not longer than 1. */
static inline uint32x4_t quaternion(int32x4_t q_q15[4], uint32x4_t word)
{
    const uint32x4_t mask = vdupq_n_u32(1023), largest = vshrq_n_u32(word, 30), one_q30 = vdupq_n_u32(1u << 30);
    int32x4_t a = component(vandq_u32(vshrq_n_u32(word, 20), mask));
    int32x4_t b = component(vandq_u32(vshrq_n_u32(word, 10), mask)), c = component(vandq_u32(word, mask));
    uint32x4_t square_q30 = u32(vmlaq_s32(vmlaq_s32(vmulq_s32(a, a), b, b), c, c));
    int32x4_t rest = s32(sqrt_32(vqsubq_u32(one_q30, square_q30)));
    q_q15[0] = vbslq_s32(vceqzq_u32(largest), rest, a);
    q_q15[1] = vbslq_s32(vceqzq_u32(largest), a, vbslq_s32(vceqq_u32(largest, vdupq_n_u32(1)), rest, b));
    q_q15[2] = vbslq_s32(vcltq_u32(largest, vdupq_n_u32(2)), b,
                         vbslq_s32(vceqq_u32(largest, vdupq_n_u32(2)), rest, c));
    q_q15[3] = vbslq_s32(vceqq_u32(largest, vdupq_n_u32(3)), rest, c);
    return vcleq_u32(square_q30, one_q30);
}

/* 2 (a b + c d) and 2 (a b - c d). */
static inline int32x4_t sum_of_products(int32x4_t a, int32x4_t b, int32x4_t c, int32x4_t d)
{
    return vrshrq_n_s32(vmlaq_s32(vmulq_s32(a, b), c, d), 14);
}

static inline int32x4_t difference_of_products(int32x4_t a, int32x4_t b, int32x4_t c, int32x4_t d)
{
    return vrshrq_n_s32(vmlsq_s32(vmulq_s32(a, b), c, d), 14);
}

static inline void rotation(int32x4_t r_q15[3][3], const int32x4_t q[4])
{
    const int32x4_t w = q[0], x = q[1], y = q[2], z = q[3], one = vdupq_n_s32(32768);
    r_q15[0][0] = vsubq_s32(one, sum_of_products(y, y, z, z));
    r_q15[0][1] = difference_of_products(x, y, w, z);
    r_q15[0][2] = sum_of_products(x, z, w, y);
    r_q15[1][0] = sum_of_products(x, y, w, z);
    r_q15[1][1] = vsubq_s32(one, sum_of_products(x, x, z, z));
    r_q15[1][2] = difference_of_products(y, z, w, x);
    r_q15[2][0] = difference_of_products(x, z, w, y);
    r_q15[2][1] = sum_of_products(y, z, w, x);
    r_q15[2][2] = vsubq_s32(one, sum_of_products(x, x, y, y));
}

static inline uint32x4_t screen_size(const fxs_view *view, const fxs_chunk_view *cv, const projected *centre,
                                     int32x4_t log2_q16, int32x4_t *exponent)
{
    int32x4_t minus = vnegq_s32(log2_q16), whole = vnegq_s32(vshrq_n_s32(minus, 16));
    uint32x4_t size_q15 = exp2_q15(u32(minus)), over_z_q30 = MUL_SHIFT(size_q15, centre->inverse_q30, 15);
    uint32x4_t mantissa = mulhi(over_z_q30, vdupq_n_u32(view->focal_q32));
    int32x4_t zeros = s32(vclzq_u32(mantissa));
    int32_t common = view->focal_exponent + view->jacobian_exponent + 2 - cv->shift;
    *exponent = vaddq_s32(vsubq_s32(vaddq_s32(whole, centre->zeros), zeros), vdupq_n_s32(common));
    return vshlq_u32(mantissa, zeros);
}

/* A sigma of 2^15 pixels reaches the picture from wherever a centre may be, and keeps to 32 bits. */
static inline uint32x4_t off_picture(const fxs_view *view, const projected *centre, int32x4_t exponent)
{
    const int32x4_t x = centre->position_q14[0], y = centre->position_q14[1], one = vdupq_n_s32(1);
    int32x4_t sigma = vaddq_s32(vshlq_s32(one, vminq_s32(exponent, vdupq_n_s32(15))), one);
    int32x4_t left_top = vnegq_s32(vminq_s32(x, y));
    int32x4_t right = vsubq_s32(x, vdupq_n_s32(view->tiles_x << 18));
    int32x4_t bottom = vsubq_s32(y, vdupq_n_s32(view->tiles_y << 18));
    return vcgtq_s32(vmaxq_s32(left_top, vmaxq_s32(right, bottom)), vmulq_n_s32(sigma, 14 << 12));
}

static inline int32x4_t dot(const int32x4_t a[3], int32x4_t b0, int32x4_t b1, int32x4_t b2)
{
    return vmlaq_s32(vmlaq_s32(vmulq_s32(a[0], b0), a[1], b1), a[2], b2);
}

static inline int32x4_t minor_of(int32x4_t a, int32x4_t b, int32x4_t c, int32x4_t d)
{
    return vmlsq_s32(vmulq_s32(a, b), c, d);
}

static inline void covariance_of(covariance *out, int32x4_t t_q15[2][3], int32x4_t exponent)
{
    const int32x4_t *p = t_q15[0], *q = t_q15[1];
    const int32x4_t minor[3] = {minor_of(p[1], q[2], p[2], q[1]), minor_of(p[2], q[0], p[0], q[2]),
                                minor_of(p[0], q[1], p[1], q[0])};
    uint32x4_t a = u32(dot(p, p[0], p[1], p[2])), c = u32(dot(q, q[0], q[1], q[2]));
    uint32x4_t dilation = vshlq_u32(vdupq_n_u32(FXS_DILATION_Q30), vmulq_n_s32(exponent, -2));
    dilation = vmaxq_u32(dilation, vdupq_n_u32(FXS_DILATION_LEAST_Q30));
    out->a_q30 = vaddq_u32(a, dilation);
    out->b_q30 = dot(p, q[0], q[1], q[2]);
    out->c_q30 = vaddq_u32(c, dilation);
    out->exponent = exponent;
    int64x2_t low = vdupq_n_s64(0), high = low;
    for (int i = 0; i < 3; i++) {
        low = vmlal_s32(low, vget_low_s32(minor[i]), vget_low_s32(minor[i]));
        high = vmlal_high_s32(high, minor[i], minor[i]);
    }
    uint64x2_t d_low = vreinterpretq_u64_s64(low), d_high = vreinterpretq_u64_s64(high);
    out->det_undilated_q60 = (uint64x2x2_t){{d_low, d_high}};
    d_low = vmlal_u32(d_low, vget_low_u32(dilation), vget_low_u32(out->a_q30));   /* dilation (a + dilation + c) */
    d_high = vmlal_high_u32(d_high, dilation, out->a_q30);
    out->det_q60.val[0] = vmlal_u32(d_low, vget_low_u32(dilation), vget_low_u32(c));
    out->det_q60.val[1] = vmlal_high_u32(d_high, dilation, c);
}

static inline int32x4_t log2_q16(uint64x2x2_t x)
{
    int32x4_t zeros = clz64(x);
    int32x4_t t_q15 = s32(vshrq_n_u32(vshlq_n_u32(top32(x, zeros), 1), 17));
    int32x4_t q = mul_n_q15(t_q15, -2776);
    q = mul_q15(vaddq_s32(q, vdupq_n_s32(6897)), t_q15);
    q = mul_q15(vsubq_s32(q, vdupq_n_s32(9697)), t_q15);
    q = mul_q15(vaddq_s32(q, vdupq_n_s32(14605)), vsubq_s32(vdupq_n_s32(32768), t_q15));
    q = vrshrq_n_s32(vmulq_s32(vaddq_s32(q, vdupq_n_s32(32768)), vshrq_n_s32(t_q15, 1)), 14);
    return vaddq_s32(vshlq_n_s32(vsubq_s32(vdupq_n_s32(63), zeros), 16), vshlq_n_s32(q, 1));
}

/* The anti-aliased opacity: offset += ln(det / det undilated). Clears the lanes of *alive where the latter is 0. */
static inline int32x4_t compensate(int32x4_t offset_q11, const covariance *s, uint32x4_t *alive)
{
    const uint64x2_t low = s->det_undilated_q60.val[0], high = s->det_undilated_q60.val[1];
    int32x4_t log2 = vsubq_s32(log2_q16(s->det_q60), log2_q16(s->det_undilated_q60));
    int32x2_t gain = vrshrn_n_s64(vmull_n_s32(vget_low_s32(log2), 45426), 21);          /* ln 2 = 45426 * 2^-16 */
    *alive = vbicq_u32(*alive, vcombine_u32(vmovn_u64(vceqzq_u64(low)), vmovn_u64(vceqzq_u64(high))));
    return vaddq_s32(offset_q11, vrshrn_high_n_s64(gain, vmull_high_n_s32(log2, 45426), 21));
}

typedef struct root {
    uint32x4_t m, inverse_q30;
    int32x4_t half;
} root;

static inline root root_q30(uint32x4_t x_q30)
{
    int32x4_t zeros = even_zeros(x_q30);
    uint32x4_t m = vshlq_u32(x_q30, zeros);
    return (root){m, rsqrt(m), vsubq_s32(vdupq_n_s32(1), vshrq_n_s32(zeros, 1))};
}

static inline root root_q60(uint64x2x2_t x_q60)
{
    int32x4_t zeros = vandq_s32(clz64(x_q60), vdupq_n_s32(~1));
    uint32x4_t m = top32(x_q60, zeros);
    return (root){m, rsqrt(m), vsubq_s32(vdupq_n_s32(2), vshrq_n_s32(zeros, 1))};
}

/* x * 2^-shift, rounded to nearest; shift under 128. */
static inline uint32x4_t scale_down(uint32x4_t x, int32x4_t shift)
{
    return vrshlq_u32(x, vnegq_s32(shift));
}

/* r sqrt(x) 2^exponent */
static inline uint32x4_t reach_q8(root x, int32x4_t exponent, uint32x4_t r_q12)
{
    int32x4_t shift = vsubq_s32(vdupq_n_s32(22), vaddq_s32(x.half, exponent));
    uint32x4_t root_q8 = scale_down(mulhi(x.m, x.inverse_q30), shift);
    return MUL_SHIFT(root_q8, r_q12, 12);
}

/* -(a b + c d) >> 14, plus 2^10 */
static inline uint32x4_t origin_q24(int32x4_t a, int32x4_t b, int32x4_t c, int32x4_t d)
{
    int64x2_t low = vmlal_s32(vmull_s32(vget_low_s32(a), vget_low_s32(b)), vget_low_s32(c), vget_low_s32(d));
    int64x2_t high = vmlal_high_s32(vmull_high_s32(a, b), c, d);
    int32x4_t minus = vshrn_high_n_s64(vshrn_n_s64(vnegq_s64(low), 14), vnegq_s64(high), 14);
    return u32(vaddq_s32(minus, vdupq_n_s32(1 << 10)));
}

static inline void whiten(shapes *out, const covariance *s, const projected *centre, root c)
{
    const root d = root_q60(s->det_q60);
    const int32x4_t e = s->exponent, c_e = vaddq_s32(c.half, e), d_c = vsubq_s32(d.half, c.half);
    const int32x4_t cx_q14 = centre->position_q14[0], cy_q14 = centre->position_q14[1];
    uint32x4_t root_c_q30 = mulhi(c.m, c.inverse_q30), root_d_q30 = mulhi(d.m, d.inverse_q30);
    int32x4_t inverse_q29 = s32(MUL_SHIFT(c.inverse_q30, d.inverse_q30, 31));
    int32x4_t vy_q24 = s32(scale_down(c.inverse_q30, vaddq_s32(c_e, vdupq_n_s32(6))));
    int32x4_t ux_q24 = s32(scale_down(MUL_SHIFT(root_c_q30, d.inverse_q30, 30),
                                      vaddq_s32(vaddq_s32(d_c, e), vdupq_n_s32(6))));
    int32x4_t uy_q24 = vnegq_s32(mul_round_shift(s->b_q30, inverse_q29,
                                                 vaddq_s32(vaddq_s32(c_e, d.half), vdupq_n_s32(35))));
    vst1q_s32(out->vy_q24, vy_q24);
    vst1q_s32(out->ux_q24, ux_q24);
    vst1q_s32(out->uy_q24, uy_q24);
    vst1q_u32(out->u0_q24, origin_q24(cx_q14, ux_q24, cy_q14, uy_q24));
    vst1q_u32(out->v0_q24, origin_q24(vdupq_n_s32(0), vdupq_n_s32(0), cy_q14, vy_q24));
    vst1q_s32(out->cx_q14, cx_q14);
    vst1q_s32(out->cy_q14, cy_q14);
    vst1q_u32(out->breadth_q8, scale_down(MUL_SHIFT(root_d_q30, c.inverse_q30, 30),
                                          vsubq_s32(vdupq_n_s32(22), vaddq_s32(d_c, e))));
    int32x4_t shear_shift = vsubq_s32(vaddq_s32(c.half, vdupq_n_s32(52)), e);
    vst1q_s32(out->shear_q8, mul_round_shift(s->b_q30, s32(c.inverse_q30), shear_shift));
}

/* x / 128 + 1/8 pixel more */
static inline int32x4_t with_margin_q8(uint32x4_t x_q8)
{
    return s32(vaddq_u32(vsraq_n_u32(x_q8, x_q8, 8), vdupq_n_u32(32)));
}

/* Returns the lanes whose ellipse does not miss the picture. */
static inline uint32x4_t clip(shapes *out, const fxs_view *view, const covariance *s, const projected *centre, root c,
                              uint32x4_t r_q12)
{
    const int32x4_t bottom = vdupq_n_s32(view->height - 1);
    int32x4_t half_width_q8 = with_margin_q8(reach_q8(root_q30(s->a_q30), s->exponent, r_q12));
    int32x4_t half_height_q8 = with_margin_q8(reach_q8(c, s->exponent, r_q12));
    int32x4_t cx_q8 = vshrq_n_s32(centre->position_q14[0], 6), cy_q8 = vshrq_n_s32(centre->position_q14[1], 6);
    int32x4_t first = vshrq_n_s32(vaddq_s32(vsubq_s32(cy_q8, half_height_q8), vdupq_n_s32(255)), 8);
    int32x4_t last = vshrq_n_s32(vaddq_s32(cy_q8, half_height_q8), 8);
    uint32x4_t in = vandq_u32(vcgezq_s32(vaddq_s32(cx_q8, half_width_q8)),
                              vcleq_s32(vsubq_s32(cx_q8, half_width_q8), vdupq_n_s32((view->width - 1) << 8)));
    in = vandq_u32(in, vandq_u32(vcgezq_s32(last), vcleq_s32(first, vminq_s32(last, bottom))));
    vst1q_u32(out->half_width_q8, u32(half_width_q8));
    vst1q_s32(out->first_row, vmaxq_s32(first, vdupq_n_s32(0)));
    vst1q_s32(out->last_row, vminq_s32(last, bottom));
    return in;
}

/* log2 of the three sigmas. Returns the largest. */
static inline int32x4_t sigmas(int32x4_t log2_q16_out[3], const fxs_chunk_view *cv, uint32x4_t word)
{
    for (int i = 0; i < 3; i++) {
        uint32x4_t code = vandq_u32(vshlq_u32(word, vdupq_n_s32(-10 * i)), vdupq_n_u32(1023));
        uint32x4_t below = vrshrq_n_u32(vmulq_n_u32(vmulq_u32(code, code), cv->scale_step_q24), 8);
        log2_q16_out[i] = vsubq_s32(vdupq_n_s32(cv->scale_q16), s32(below));
    }
    return vmaxq_s32(vmaxq_s32(log2_q16_out[0], log2_q16_out[1]), log2_q16_out[2]);
}

/* ratio of a sigma to the largest, times that one's size / 2^exponent: Q15 */
static inline int32x4_t column_size_q15(int32x4_t below_q16, uint32x4_t size_q32, int32x4_t exponent_gap)
{
    uint32x4_t ratio_q15 = exp2_q15(u32(below_q16));
    int32x4_t shift = vaddq_s32(vaddq_s32(exponent_gap, vshrq_n_s32(below_q16, 16)), vdupq_n_s32(32));
    int32x4_t left = vnegq_s32(vminq_s32(shift, vdupq_n_s32(63)));
    uint64x2_t low = vmull_u32(vget_low_u32(ratio_q15), vget_low_u32(size_q32));
    uint64x2_t high = vmull_high_u32(ratio_q15, size_q32);
    return s32(vcombine_u32(vmovn_u64(vrshlq_u64(low, vmovl_s32(vget_low_s32(left)))),
                            vmovn_u64(vrshlq_u64(high, vmovl_high_s32(left)))));
}

/* Size, shape and opacity of the lanes in `alive`. Returns those that touch a pixel. */
static inline uint32x4_t project_shape(shapes *out, const fxs_view *view, const fxs_chunk_view *cv,
                                       const projected *centre, uint32x4_t scale_word, uint32x4_t rotation_word,
                                       int32x4_t offset_q11, uint32x4_t alive)
{
    int32x4_t log2_q16[3], q_q15[4], r_q15[3][3], j_q15[2][3], t_q15[2][3], size_exponent;
    int32x4_t most = sigmas(log2_q16, cv, scale_word);
    uint32x4_t size_q32 = screen_size(view, cv, centre, most, &size_exponent);
    int32x4_t exponent = vmaxq_s32(size_exponent, vdupq_n_s32(0));
    uint32x4_t veils = vcgeq_s32(size_exponent, vdupq_n_s32(view->veil_exponent));
    veils = vorrq_u32(vbicq_u32(veils, centre->in_range), vcgtq_s32(exponent, vdupq_n_s32(FXS_EXPONENT_MAX)));
    out->has_veil = any(vandq_u32(alive, veils));
    alive = vbicq_u32(vandq_u32(alive, centre->in_range), off_picture(view, centre, exponent));
    if (!any(alive))
        return alive;
    jacobian(j_q15, view, centre);
    alive = vandq_u32(alive, quaternion(q_q15, rotation_word));
    rotation(r_q15, q_q15);
    for (int i = 0; i < 3; i++) {
        int32x4_t k_q15 = column_size_q15(vsubq_s32(most, log2_q16[i]), size_q32, vsubq_s32(exponent, size_exponent));
        for (int row = 0; row < 2; row++) {
            int32x4_t d = vrshrq_n_s32(dot(j_q15[row], r_q15[0][i], r_q15[1][i], r_q15[2][i]), 15);
            t_q15[row][i] = mul_q15(d, k_q15);
        }
    }
    covariance s;
    covariance_of(&s, t_q15, exponent);
    if (view->antialiased)
        offset_q11 = compensate(offset_q11, &s, &alive);
    const int32x4_t faint_q11 = vdupq_n_s32(FXS_FAINT_Q11);
    alive = vandq_u32(alive, vcleq_s32(offset_q11, faint_q11));
    int32x4_t r2_q11 = vminq_s32(vsubq_s32(faint_q11, offset_q11), vdupq_n_s32(FXS_CUT_Q11));
    uint32x4_t r_q12 = vaddq_u32(sqrt_32(vshlq_n_u32(vaddq_u32(u32(r2_q11), vdupq_n_u32(1)), 13)), vdupq_n_u32(1));
    const root c = root_q30(s.c_q30);
    vst1q_s32(out->offset_q11, offset_q11);
    whiten(out, &s, centre, c);
    return vandq_u32(alive, clip(out, view, &s, centre, c, r_q12));
}

/* -2 ln(opacity) */
static inline int32x4_t offset_q11_of(const fxs_chunk_view *cv, const uint32_t *opacity)
{
    int32_t offset_q11[LANES];
    for (uint32_t lane = 0; lane < LANES; lane++)
        offset_q11[lane] = fxs_offset_of_code_q11[cv->opacity_law][opacity[lane]];
    return vld1q_s32(offset_q11);
}

static inline uint32x4_t depth_key(const fxs_chunk_view *cv, const projected *centre)
{
    int32x4_t exponent = vsubq_s32(vdupq_n_s32(cv->shift - 1 + FXS_DEPTH_BIAS), centre->zeros);
    uint32x4_t mantissa = vandq_u32(vshrq_n_u32(vshlq_u32(u32(centre->z), centre->zeros), 5), vdupq_n_u32(0x3ffffff));
    return vorrq_u32(vshlq_n_u32(u32(exponent), 26), mantissa);
}

static inline void store(fxs_splat *splat, fxs_bounds *bounds, const shapes *s, uint32_t lane)
{
    splat->u0_q24 = s->u0_q24[lane];
    splat->v0_q24 = s->v0_q24[lane];
    splat->ux_q24 = s->ux_q24[lane];
    splat->uy_q24 = s->uy_q24[lane];
    splat->vy_q24 = s->vy_q24[lane];
    splat->offset_q11 = (uint16_t)s->offset_q11[lane];
    splat->first_row = (uint16_t)s->first_row[lane];
    splat->last_row = (uint16_t)s->last_row[lane];
    bounds->cx_q14 = s->cx_q14[lane];
    bounds->cy_q14 = s->cy_q14[lane];
    bounds->breadth_q8 = s->breadth_q8[lane];
    bounds->shear_q8 = s->shear_q8[lane];
    bounds->half_width_q8 = s->half_width_q8[lane];
    bounds->radius = 0;
}

int32_t fxs_project_neon(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, fxs_splat *splats,
                         fxs_bounds *bounds, uint32_t *indices, uint32_t *depths)
{
    if (view->square || view->orthographic)
        return fxs_project_c(view, scene, chunk, splats, bounds, indices, depths);
    const unsigned char *rows = fxs_rows(scene, chunk);
    fxs_chunk_view cv;
    int32_t count = 0;
    const int seen = fxs_chunk_view_init(&cv, view, scene, chunk);
    if (seen <= 0)
        return seen;
    for (uint32_t i = 0; i < FXS_CHUNK; i += LANES) {
        projected centre;
        shapes s;
        uint32_t touches[LANES], depth[LANES], opacity[LANES];
        codes_neon codes = load_codes(scene, rows, i);
        uint32x4_t alive = project_centre(&centre, view, &cv, codes.position);
        alive = vandq_u32(alive, vcgtq_u32(vshrq_n_u32(codes.colour, 24), vdupq_n_u32(0)));
        if (!any(alive))
            continue;
        vst1q_u32(opacity, vshrq_n_u32(codes.colour, 24));
        alive = project_shape(&s, view, &cv, &centre, codes.scale, codes.rotation, offset_q11_of(&cv, opacity), alive);
        if (s.has_veil)
            return fxs_project_c(view, scene, chunk, splats, bounds, indices, depths);
        if (!any(alive))
            continue;
        vst1q_u32(touches, alive);
        vst1q_u32(depth, depth_key(&cv, &centre));
        for (uint32_t lane = 0; lane < LANES; lane++) {
            if (!touches[lane])
                continue;
            store(&splats[count], &bounds[count], &s, lane);
            indices[count] = chunk * FXS_CHUNK + i + lane;
            depths[count++] = depth[lane];
        }
    }
    return count;
}
