/* Projects LANES Gaussians of a chunk together. The first pass over the chunk's 256 Gaussians finds the centres and
 * drops Gaussians behind the camera or outside the picture. The second pass finds the shapes of the remaining
 * Gaussians and stores them without gaps. The C version handles rare chunks with very large Gaussians. */
#include "lane_axes.h"

#ifndef AT_ONCE                    /* number of Gaussians per pass over a chunk; a smaller number needs less stack */
#define AT_ONCE FXS_CHUNK
#endif

enum row { INDEX, DEPTH, SLOPE_X, SLOPE_Y, POSITION_X, POSITION_Y, SIZE, EXPONENT, SCALE, ROTATION, OPACITY, ROWS };

typedef struct survivors {
    uint32_t count;
    int32_t rows[ROWS][AT_ONCE + LANES];
} survivors;

typedef struct centre {
    vi camera[3];
    vi zeros_of_z, zeros, inverse_q30, slope_q23[2], position_q14[2];
} centre;

static inline vi camera_axis(const fxs_chunk_view *cv, int i, const vi code[3])
{
    wide x = mul_wide(code[0], all((int32_t)cv->m_q16[i][0]));
    x = add_wide(x, mul_wide(code[1], all((int32_t)cv->m_q16[i][1])));
    x = add_wide(x, mul_wide(code[2], all((int32_t)cv->m_q16[i][2])));
    return (vi)narrow(offset_wide(x, cv->base_q16[i]), 16);
}

/* Computes the reciprocal depths of LANES Gaussians. Returns the lanes of Gaussians that are not too far off the
   camera's axis. */
static inline mask project_depth(centre *c, const fxs_stage_view *view, const fxs_chunk_view *cv)
{
    vi *x = &c->camera[0], *y = &c->camera[1], z = c->camera[2];
    c->zeros_of_z = clz((vu)z);
    if (view->orthographic) {
        const vi side = all(cv->plane_side);
        c->zeros = all(cv->plane_zeros);
        c->inverse_q30 = all(1 << 30);
        *x = clamp(*x, -side, side);
        *y = clamp(*y, -side, side);
        return greater(side, *x) & greater(side, -*x) & greater(side, *y) & greater(side, -*y);
    }
    c->zeros = c->zeros_of_z;
    c->inverse_q30 = (vi)reciprocal(shift_left((vu)z, c->zeros));
    return greater(z, *x >> 6) & greater(z, -*x >> 6) & greater(z, *y >> 6) & greater(z, -*y >> 6);
}

/* Projects LANES centres to coordinate i on the screen. Returns the lanes of centres not too far off the picture. With
   2^30 - 1 added, -2^30 < position < 2^30 is a test of the high bits. */
static inline mask project_axis(centre *c, int i, int64_t f_q12, int64_t c_q12)
{
    const int64_t up = FXS_CENTRE_LIMIT_Q14 - 1;
    c->slope_q23[i] = scale_down_wide(mul_wide(c->camera[i], c->inverse_q30), 39 - c->zeros);
    wide raised_q35 = offset_wide(mul_wide(c->slope_q23[i], all((int32_t)f_q12)),
                                  (c_q12 * 4 - (1 << 13) + up) * (1 << 21) + (1 << 20));
    vu raised_q14 = narrow(raised_q35, 21);
    c->position_q14[i] = (vi)(raised_q14 - (uint32_t)up);
    return greater(all(INT32_MAX), (vi)raised_q14) &
           equal((vi)(high_half(raised_q35) >> 21 | raised_q14 >> 31), all(0));
}

/* Computes the sizes of Gaussians on the screen, f sigma_max / z 2^jacobian_exponent, as mantissa * 2^exponent with the
   mantissa in [0.5, 1). The smallest scale code of a Gaussian has the largest sigma. */
static inline vu screen_size(const fxs_stage_view *view, const fxs_chunk_view *cv, const centre *c, vi scale_word,
                             vi *exponent)
{
    vi code = least(least(scale_word & 1023, scale_word >> 10 & 1023), scale_word >> 19 & 1022);
    vi minus_log2_q16 = fall_of(code, cv->scale_step_q24) - cv->scale_q16;
    vu size_q15 = (vu)exp2_q15((minus_log2_q16 & 65535) >> 1);
    vu over_z_q30 = narrow(mul_wide_u(size_q15, (vu)c->inverse_q30), 15);
    vu mantissa = mulhi(over_z_q30, (vu)all((int32_t)view->focal_q32));
    vi zeros = clz(mantissa);
    *exponent = c->zeros - (minus_log2_q16 >> 16) - zeros +
                (view->focal_exponent + view->jacobian_exponent + 2 - cv->shift);
    return shift_left(mantissa, zeros);
}

/* Returns the lanes of Gaussians that may touch the picture. A Gaussian's radius is taken as 3.5 (2^exponent + 1)
   pixels, at most FXS_CENTRE_LIMIT_Q14. */
static inline mask on_picture(const fxs_stage_view *view, const centre *c, vi exponent)
{
    vi size = (vi)shift_left((vu)all(1), clamp(exponent, all(0), all(15)));
    vi radius_q14 = least((14 << 12) * (size + 1), all(FXS_CENTRE_LIMIT_Q14));
    const vi low_x = c->position_q14[0] - radius_q14, low_y = c->position_q14[1] - radius_q14;
    const vi high_x = c->position_q14[0] + radius_q14, high_y = c->position_q14[1] + radius_q14;
    return greater(high_x, all(-1)) & greater(all((view->tiles_x << 18) + 1), low_x) &
           greater(high_y, all(-1)) & greater(all((view->tiles_y << 18) + 1), low_y);
}

static inline vi depth_key(const fxs_chunk_view *cv, const centre *c)
{
    vu exponent = (vu)((cv->shift - 1 + FXS_DEPTH_BIAS) - c->zeros_of_z);
    return (vi)(exponent << 26 | (shift_left((vu)c->camera[2], c->zeros_of_z) >> 5 & 0x3ffffff));
}

/* Finds the screen centres of LANES Gaussians, and keeps the Gaussians that may be visible. Returns 0 if the C version
   must project the chunk. */
static inline int find_centres(survivors *s, const fxs_stage_view *view, const fxs_chunk_view *cv,
                                const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    vi code[3], opacity = load_opacities(scene, rows, i), value[ROWS];
    centre c;
    load_positions(code, scene, rows, i);
    c.camera[2] = camera_axis(cv, 2, code);
    mask alive = greater(c.camera[2], all(cv->near)) & greater(opacity, all(0));
    if (!any(alive))
        return 1;
    c.camera[0] = camera_axis(cv, 0, code);
    c.camera[1] = camera_axis(cv, 1, code);
    mask in_range = project_depth(&c, view, cv) & project_axis(&c, 0, view->fx_q12, view->cx_q12);
    in_range &= project_axis(&c, 1, view->fy_q12, view->cy_q12);
    value[SCALE] = load_scales(scene, rows, i);
    value[SIZE] = (vi)screen_size(view, cv, &c, value[SCALE], &value[EXPONENT]);
    if (any(alive & greater(value[EXPONENT], all(FXS_EXPONENT_MAX))) ||
        any(alive & ~in_range & greater(value[EXPONENT], all(view->veil_exponent - 1))))
        return 0;
    alive &= in_range & on_picture(view, &c, value[EXPONENT]);
    if (!any(alive))
        return 1;
    value[INDEX] = load(lane_numbers) + (int32_t)i;
    value[DEPTH] = depth_key(cv, &c);
    value[SLOPE_X] = c.slope_q23[0];
    value[SLOPE_Y] = c.slope_q23[1];
    value[POSITION_X] = c.position_q14[0];
    value[POSITION_Y] = c.position_q14[1];
    value[ROTATION] = load_rotations(scene, rows, i);
    value[OPACITY] = opacity;
    const uint32_t at = s->count;
    for (int row = 0; row < ROWS; row++)
        store_compressed(&s->rows[row][at], value[row], alive);
    s->count = at + lanes_of(alive);
    return 1;
}

static inline void jacobian(vi j_q15[3], const fxs_stage_view *view, int i, vi slope_q23)
{
    vi slope = clamp(slope_q23, all(view->slope_low_q23[i]), all(view->slope_high_q23[i]));
    const int32_t shift = 8 + view->jacobian_exponent, half = 1 << (shift - 1);
    vi slope_q15 = (slope + half) >> shift;
    for (int k = 0; k < 3; k++)
        j_q15[k] = view->row_q15[i][k] - mul_q15(slope_q15, all(view->forward_q15[i][k]));
}

static inline vi dot_q15(const vi a_q15[3], const vi b_q15[3])
{
    return round_shift(a_q15[0] * b_q15[0] + a_q15[1] * b_q15[1] + a_q15[2] * b_q15[2], 15);
}

static inline vi axis_length(vi below_q16, vu size_q32, vi reduce)
{
    vu ratio_q15 = (vu)exp2_q15((below_q16 & 65535) >> 1);
    return (vi)((shift_right(narrow(mul_wide_u(ratio_q15, size_q32), 31), reduce + (below_q16 >> 16)) + 1) >> 1);
}

/* Computes the axes of Gaussians on the screen, T = J W R S, from Jacobian J, view rotation W, rotation R and scales
   S. */
static inline mask screen_axes(vi t_q15[2][3], const fxs_stage_view *view, const fxs_chunk_view *cv,
                               enum fxs_profile profile, const survivors *s, uint32_t at)
{
    vi j_q15[2][3], fall_q16[3], k_q15[3], exponent = load(&s->rows[EXPONENT][at]);
    vi scale_word = load(&s->rows[SCALE][at]), reduce = most(exponent, all(0)) - exponent;
    axes a;
    jacobian(j_q15[0], view, 0, load(&s->rows[SLOPE_X][at]));
    jacobian(j_q15[1], view, 1, load(&s->rows[SLOPE_Y][at]));
    falls_of(fall_q16, scale_word, cv->scale_step_q24);
    const mask valid = read_axes(&a, load(&s->rows[ROTATION][at]), axis_bits(profile, fall_q16));
    vi shortest = least(least(fall_q16[0], fall_q16[1]), fall_q16[2]);
    for (int i = 0; i < 3; i++)
        k_q15[i] = axis_length(fall_q16[i] - shortest, (vu)load(&s->rows[SIZE][at]), reduce);
    for (int i = 0; i < 2; i++) {
        const vi p = dot_q15(j_q15[i], a.side_q15[0]), q = dot_q15(j_q15[i], a.side_q15[1]);
        t_q15[i][0] = mul_q15(dot_q15(j_q15[i], a.axis_q15), k_q15[0]);
        t_q15[i][1] = mul_q15(round_shift(p * a.cos_q15 + q * a.sin_q15, 15), k_q15[1]);
        t_q15[i][2] = mul_q15(round_shift(q * a.cos_q15 - p * a.sin_q15, 15), k_q15[2]);
    }
    return valid;
}

typedef struct covariance {
    vu a_q30, c_q30;
    vi b_q30, exponent;
    wide det_q60, det_undilated_q60;
} covariance;

static inline void covariance_of(covariance *out, vi t_q15[2][3], vi exponent)
{
    const vi *p = t_q15[0], *q = t_q15[1];
    vu a = (vu)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), c = (vu)(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    vi x = p[1] * q[2] - p[2] * q[1], y = p[2] * q[0] - p[0] * q[2], z = p[0] * q[1] - p[1] * q[0];
    vu dilation = (vu)most((vi)shift_right((vu)all((int32_t)FXS_DILATION_Q30), 2 * exponent),
                           all(FXS_DILATION_LEAST_Q30));
    out->b_q30 = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    out->det_undilated_q60 = add_wide(add_wide(mul_wide(x, x), mul_wide(y, y)), mul_wide(z, z));
    out->det_q60 = add_wide(out->det_undilated_q60, mul_wide_u(dilation, a + c + dilation));
    out->a_q30 = a + dilation;
    out->c_q30 = c + dilation;
    out->exponent = exponent;
}

/* A number x = m 2^-32 4^half, stored with 1 / sqrt(m). */
typedef struct mantissa {
    vu m, inverse_q30;
    vi half;
} mantissa;

static inline mantissa mantissa_of(vu x_q30)
{
    vi zeros = clz(x_q30) & ~1;
    vu m = shift_left(x_q30, zeros);
    return (mantissa){m, rsqrt(m), 1 - (zeros >> 1)};
}

static inline mantissa mantissa_of_wide(wide x_q60)
{
    vi zeros = clz_wide(x_q60) & ~1;
    vu m = top_half(x_q60, zeros);
    return (mantissa){m, rsqrt(m), 2 - (zeros >> 1)};
}

static inline vi reach_q8(const mantissa *x, vi exponent, vu r_q12)
{
    vu root_q8 = scale_down(mulhi(x->m, x->inverse_q30), 22 - x->half - exponent);
    return (vi)narrow(mul_wide_u(root_q8, r_q12), 12);
}

/* Lowers the opacity for antialiasing: adds ln(det / undilated det) of the screen covariance to the opacity offset. */
static inline mask compensate(vi *offset_q11, const covariance *s)
{
    vu high = high_half(s->det_undilated_q60), low = low_half(s->det_undilated_q60);
    vi log2 = log2_q16(s->det_q60) - log2_q16(s->det_undilated_q60);
    *offset_q11 += (vi)narrow(offset_wide(mul_wide(log2, all(45426)), 1 << 20), 21);
    return ~equal((vi)(high | low), all(0));
}

/* Returns 2^-l in Q30, for l >= 0 in Q16. */
static inline vu falling_q30(vi l_q16)
{
    return shift_right((vu)exp2_q15((l_q16 & 65535) >> 1) << 15, l_q16 >> 16);
}

/* Returns -log2(x) in Q16, for 0 < x <= 1 in Q30. */
static inline vi octaves_below_q16(vu x_q30)
{
    return most((30 << 16) - log2_of_32_q16(x_q30), all(0));
}

static inline vi share_of_q11(vi offset_q11, uint32_t share_q8)
{
    const vu opacity_q30 = falling_q30((vi)(((vu)offset_q11 * 94548 + 2048) >> 12));
    const vu clear_q30 = (1u << 30) - (vu)least((vi)opacity_q30, all((int32_t)FXS_OPAQUE_Q30));
    const vu share_q30 = (1u << 30) - falling_q30((vi)((vu)octaves_below_q16(clear_q30) * share_q8 >> 8));
    const wide offset_q32 = mul_wide(octaves_below_q16((vu)most((vi)share_q30, all(1))), all(90852));
    return least((vi)narrow(offset_wide(offset_q32, 1 << 20), 21), all(FXS_FAINT_Q11 + 1));
}

enum { U0, V0, UX, UY, VY, OFFSET, COLOUR, CLIP, CX = 0, CY, BREADTH, SHEAR, HALF_WIDTH, RADIUS, WORDS = 8 };

static inline void whiten(vi splat[WORDS], vi bounds[WORDS], const covariance *s, const mantissa *c)
{
    const vi e = s->exponent;
    const mantissa d = mantissa_of_wide(s->det_q60);
    vu root_c_q30 = mulhi(c->m, c->inverse_q30), root_d_q30 = mulhi(d.m, d.inverse_q30);
    vi inverse_q29 = (vi)narrow(mul_wide_u(c->inverse_q30, d.inverse_q30), 31);
    vi vy = (vi)scale_down(c->inverse_q30, 6 + c->half + e);
    vi ux = (vi)scale_down(narrow(mul_wide_u(root_c_q30, d.inverse_q30), 30), 6 - c->half + d.half + e);
    vi uy = -scale_down_wide(mul_wide(s->b_q30, inverse_q29), 35 + c->half + d.half + e);
    wide u_q38 = add_wide(mul_wide(-bounds[CX], ux), mul_wide(-bounds[CY], uy)), v_q38 = mul_wide(-bounds[CY], vy);
    splat[U0] = (vi)(narrow(u_q38, 14) + (1 << 10));
    splat[V0] = (vi)(narrow(v_q38, 14) + (1 << 10));
    splat[UX] = ux;
    splat[UY] = uy;
    splat[VY] = vy;
    bounds[BREADTH] = (vi)scale_down(narrow(mul_wide_u(root_d_q30, c->inverse_q30), 30), 22 - d.half + c->half - e);
    bounds[SHEAR] = scale_down_wide(mul_wide(s->b_q30, (vi)c->inverse_q30), 52 + c->half - e);
}

static inline mask clip(vi splat[WORDS], vi bounds[WORDS], const fxs_stage_view *view, vi half_height_q8)
{
    vi half_width_q8 = bounds[HALF_WIDTH], cx_q8 = bounds[CX] >> 6, cy_q8 = bounds[CY] >> 6;
    half_width_q8 += (half_width_q8 >> 8) + 32;
    half_height_q8 += (half_height_q8 >> 8) + 32;
    bounds[HALF_WIDTH] = half_width_q8;
    vi first = (cy_q8 - half_height_q8 + 255) >> 8, last = (cy_q8 + half_height_q8) >> 8;
    splat[CLIP] = most(first, all(0)) | least(last, all(view->height - 1)) << 16;
    return greater(cx_q8 + half_width_q8, all(-1)) &
           greater(half_width_q8 + (((view->width - 1) << 8) + 1), cx_q8) & greater(last, all(-1)) &
           greater(all(view->height), first) & greater(last + 1, first);
}

static inline mask shape(vi splat[WORDS], vi bounds[WORDS], const fxs_stage_view *view, const fxs_chunk_view *cv,
                         enum fxs_profile profile, const survivors *s, uint32_t at)
{
    vi t_q15[2][3], offset_q11 = load(&s->rows[OPACITY][at]);
    if (view->share_q8 != 256)
        offset_q11 = share_of_q11(offset_q11, view->share_q8);
    offset_q11 += view->offset_q11;
    covariance cov;
    mask alive = greater((int32_t)(s->count - at) - load(lane_numbers), all(0));
    alive &= screen_axes(t_q15, view, cv, profile, s, at);
    covariance_of(&cov, t_q15, most(load(&s->rows[EXPONENT][at]), all(0)));
    if (view->antialiased)
        alive &= compensate(&offset_q11, &cov);
    alive &= greater(all(FXS_FAINT_Q11 + 1), offset_q11);
    vi r2_q11 = least(all(FXS_CUT_Q11), FXS_FAINT_Q11 - offset_q11);
    const vu r_q12 = (vu)radius_q12(r2_q11);
    const mantissa a = mantissa_of(cov.a_q30), c = mantissa_of(cov.c_q30);
    bounds[CX] = load(&s->rows[POSITION_X][at]);
    bounds[CY] = load(&s->rows[POSITION_Y][at]);
    bounds[HALF_WIDTH] = reach_q8(&a, cov.exponent, r_q12);
    bounds[RADIUS] = all(0);
    splat[OFFSET] = offset_q11;
    splat[COLOUR] = all(0);
    whiten(splat, bounds, &cov, &c);
    return alive & clip(splat, bounds, view, reach_q8(&c, cov.exponent, r_q12));
}

/* Appends the splats of the lanes in mask `which` to arrays. Every lane is written, but the next write overwrites an
   unwanted lane. */
static inline void append(fxs_splat *splats, fxs_bounds *bounds, const vi splat[WORDS], const vi bound[WORDS],
                          unsigned which)
{
    for (int lane = 0; lane < LANES; lane += 4) {
        octet of_splat[4], of_bound[4];
        transpose(of_splat, splat, lane);
        transpose(of_bound, bound, lane);
        for (int i = 0; i < 4; i++) {
            store_8(splats, of_splat[i]);
            store_6(bounds, of_bound[i]);
            splats += which >> (lane + i) & 1;
            bounds += which >> (lane + i) & 1;
        }
    }
}

typedef struct outputs {
    fxs_splat *splats;
    fxs_bounds *bounds;
    uint32_t *indices, *depths, count;
} outputs;

static inline void shape_survivors(outputs *out, const fxs_stage_view *view, const fxs_chunk_view *cv,
                                   enum fxs_profile profile, survivors *s, uint32_t chunk)
{
    const uint16_t *offsets_q11 = fxs_offset_of_code_q11[cv->opacity_law];
    for (uint32_t i = 0; i < s->count; i++)
        s->rows[OPACITY][i] = offsets_q11[s->rows[OPACITY][i]];
    for (int row = 0; row < ROWS; row++)
        store(&s->rows[row][s->count], all(0));
    for (uint32_t at = 0; at < s->count; at += LANES) {
        vi splat[WORDS], bound[WORDS] = {{0}};
        const mask visible = shape(splat, bound, view, cv, profile, s, at);
        append(out->splats + out->count, out->bounds + out->count, splat, bound, bits(visible));
        store_compressed(out->indices + out->count, load(&s->rows[INDEX][at]) + (int32_t)(chunk * FXS_CHUNK), visible);
        store_compressed(out->depths + out->count, load(&s->rows[DEPTH][at]), visible);
        out->count += lanes_of(visible);
    }
}

#define LEFT_TO_C (FXS_CHUNK + 1)

/* Projects a chunk of Gaussians. Not inlined, so that the function's stack is free again before the C version runs. */
static __attribute__((noinline)) int32_t project_chunk(const fxs_stage_view *view, const fxs_scene *scene,
                                                       uint32_t chunk, outputs out)
{
    fxs_chunk_view cv;
    survivors s;
    const int seen = fxs_chunk_view_init(&cv, view, scene, chunk);
    if (seen <= 0)
        return seen;
    for (uint32_t first = 0; first < FXS_CHUNK; first += AT_ONCE) {
        s.count = 0;
        for (uint32_t i = first; i < first + AT_ONCE; i += LANES)
            if (!find_centres(&s, view, &cv, scene, fxs_rows(scene, chunk), i))
                return LEFT_TO_C;
        shape_survivors(&out, view, &cv, scene->profile, &s, chunk);
    }
    return (int32_t)out.count;
}

FXS_PROJECT(ISA)
{
    const outputs out = {splats, bounds, indices, depths, 0};
    const int32_t count = view->cutoff == FXS_CUTOFF_SQUARE ? LEFT_TO_C : project_chunk(view, scene, chunk, out);
    return count == LEFT_TO_C ? fxs_project_c(view, scene, chunk, splats, bounds, indices, depths) : count;
}
