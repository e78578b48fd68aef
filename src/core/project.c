/* Projects packed Gaussians to the picture by EWA splatting (Zwicker et al. 2001; Kerbl et al. 2023). The covariance of
 * a splat is Sigma' = J W R S S^T R^T W^T J^T + 0.3 I, with the Jacobian J, the view W, the Gaussian's rotation R and
 * its scale S. The matrix T = J W R S is in fixed point, in units of 2^E pixels. E depends on the Gaussian's size. */
#include "axes.h"
#include "codes.h"
#include <fixsplat/internal/fixed.h>

#define TENTH_Q60 (((uint64_t)1 << 60) / 10)

typedef struct projected {
    int32_t camera[3];
    int zeros;                     /* number of leading zero bits of the depth; orthographic: plane_zeros */
    uint32_t inverse_q30;
    int32_t slope_q23[2];          /* slopes x / depth and y / depth of the Gaussian's centre, clamped to +-64 */
    int32_t position_q14[2];       /* position of the centre in pixels; 0: middle of the first pixel; invalid if
                                      out_of_range is set */
    int out_of_range;
} projected;

/* Covariance of a splat, Sigma' = [[a, b], [b, c]], in units of 4^exponent pixels^2. Its determinant, with and without
   the dilation 0.3 I. */
typedef struct covariance {
    uint32_t a_q30, c_q30;
    int32_t b_q30;
    uint64_t det_q60, det_undilated_q60;
    int exponent;
} covariance;

static int project_centre(projected *out, const fxs_stage_view *view, const fxs_chunk_view *cv, const uint16_t code[3])
{
    for (int i = 0; i < 3; i++)
        out->camera[i] = (int32_t)(fxs_mul_add(cv->m_q16[i][0], code[0], fxs_mul_add(cv->m_q16[i][1], code[1],
                                   fxs_mul_add(cv->m_q16[i][2], code[2], cv->base_q16[i]))) >> 16);
    const int32_t z = out->camera[2];
    if (z <= cv->near)
        return 0;
    out->zeros = view->orthographic ? cv->plane_zeros : fxs_clz32((uint32_t)z);
    out->inverse_q30 = view->orthographic ? 1u << 30 : fxs_reciprocal((uint32_t)z << out->zeros);
    out->out_of_range = 0;
    /* limit of |x| and |y|: 64 z, saturated below 2^31, because |x| and |y| are below 2^30 */
    const int32_t side = view->orthographic ? cv->plane_side : 64 * (z >> 25 ? (1 << 25) - 1 : z);
    const int32_t f_q12[2] = {(int32_t)view->fx_q12, (int32_t)view->fy_q12};
    const int64_t c_q12[2] = {view->cx_q12, view->cy_q12};
    for (int i = 0; i < 2; i++) {
        const int32_t x = out->camera[i];
        const int off_axis = x >= side || -x >= side;
        const int64_t over_z = fxs_round_shift(fxs_mul_add(x, (int32_t)out->inverse_q30, 0), 39 - out->zeros);
        const int32_t slope = !off_axis ? (int32_t)over_z : x < 0 ? -(64 << 23) : 64 << 23;
        int64_t position = fxs_round_shift(fxs_mul_add(f_q12[i], slope, 0), 21) + c_q12[i] * 4 - (1 << 13);
        if (off_axis || position >= FXS_CENTRE_LIMIT_Q14 || position <= -FXS_CENTRE_LIMIT_Q14)
            out->out_of_range = 1;
        out->slope_q23[i] = slope;
        out->position_q14[i] = (int32_t)position;
    }
    return 1;
}

/* Computes the rows of J W, the Jacobian times the view rotation, divided by (f / z) 2^jacobian_exponent. Row i is
   row_i - slope_i * forward_i, Q15. */
static void jacobian(int32_t j_q15[2][3], const fxs_stage_view *view, const projected *centre)
{
    for (int i = 0; i < 2; i++) {
        int32_t slope = fxs_clamp(centre->slope_q23[i], view->slope_low_q23[i], view->slope_high_q23[i]);
        int32_t slope_q15 = ((slope >> (7 + view->jacobian_exponent)) + 1) >> 1;
        for (int k = 0; k < 3; k++)
            j_q15[i][k] = view->row_q15[i][k] - fxs_mul_q15(slope_q15, view->forward_q15[i][k]);
    }
}

/* Returns an upper bound of a Gaussian's sigma in pixels: f sigma_max / z 2^jacobian_exponent = mantissa * 2^exponent.
   The mantissa is in [0.5, 1), Q32; sigma_max = 2^log2. */
static uint32_t screen_size(const fxs_stage_view *view, const fxs_chunk_view *cv, const projected *centre,
                            int32_t log2_q16, int *exponent)
{
    int32_t whole = -(-log2_q16 >> 16);
    uint32_t size_q15 = (uint32_t)fxs_exp2_q15((-log2_q16 & 65535) >> 1);
    uint32_t over_z_q30 = (uint32_t)((uint64_t)size_q15 * centre->inverse_q30 >> 15);
    uint32_t mantissa = fxs_mulhi(over_z_q30, view->focal_q32);
    int zeros = fxs_clz32(mantissa);
    *exponent = whole - cv->shift + centre->zeros + view->focal_exponent + view->jacobian_exponent + 2 - zeros;
    return mantissa << zeros;
}

/* Returns true if the Gaussian cannot reach the picture. Its sigma is below 2^exponent pixels, and its radius is at
   most 3.34 sqrt(sigma^2 + 0.3). */
static int off_picture(const fxs_stage_view *view, const projected *centre, int exponent)
{
    const uint32_t radius_q14 = (14u << 12) * ((1u << (exponent > 0 ? exponent : 0)) + 1);
    const int32_t x_q14 = centre->position_q14[0], y_q14 = centre->position_q14[1];
    return (uint32_t)(x_q14 < 0 ? -x_q14 : 0) > radius_q14 || (uint32_t)(y_q14 < 0 ? -y_q14 : 0) > radius_q14 ||
           (x_q14 > 0 && (uint32_t)x_q14 > ((uint32_t)view->tiles_x << 18) + radius_q14) ||
           (y_q14 > 0 && (uint32_t)y_q14 > ((uint32_t)view->tiles_y << 18) + radius_q14);
}

static int32_t dot_q15(const int32_t a_q15[3], const int32_t b_q15[3])
{
    return (a_q15[0] * b_q15[0] + a_q15[1] * b_q15[1] + a_q15[2] * b_q15[2] + 16384) >> 15;
}

/* Computes a splat's covariance Sigma' = T T^T + 0.3 I and its determinant. t0 and t1 are the rows of T, A and C the
   variances without the dilation 0.3. Then det(T T^T) = |t0 x t1|^2, and det(Sigma') = det(T T^T) + 0.3 (A + C) + 0.09.
   All terms are positive, so nothing cancels. Entries of T are at most 1. */
static void covariance_of(covariance *out, int32_t t_q15[2][3], int exponent, uint32_t least_dilation_q30)
{
    const int32_t *p = t_q15[0], *q = t_q15[1];
    uint32_t a = (uint32_t)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    uint32_t c = (uint32_t)(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    int64_t minor[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    uint32_t dilation = exponent < 15 ? FXS_DILATION_Q30 >> 2 * exponent : 0;
    dilation = dilation > least_dilation_q30 ? dilation : least_dilation_q30;
    out->b_q30 = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    out->det_undilated_q60 = (uint64_t)(minor[0] * minor[0] + minor[1] * minor[1] + minor[2] * minor[2]);
    out->det_q60 = out->det_undilated_q60 + (uint64_t)dilation * ((uint64_t)a + c + dilation);
    out->a_q30 = a + dilation;
    out->c_q30 = c + dilation;
    out->exponent = exponent;
}

/* A number x = m 2^-32 4^half, and the reciprocal square root of m 2^-32, which is in [1/4, 1). */
typedef struct root {
    uint32_t m, inverse_q30;
    int half;                      /* exponent of the root: sqrt(x) = sqrt(m * 2^-32) * 2^half */
} root;

static root root_of_q60(uint64_t x)
{
    int zeros = fxs_clz64(x) & ~1;
    uint32_t m = (uint32_t)(x << zeros >> 32);
    return (root){m, fxs_rsqrt(m), 2 - zeros / 2};
}

static root root_of_q30(uint32_t x)
{
    int zeros = fxs_clz32(x) & ~1;
    uint32_t m = x << zeros;
    return (root){m, fxs_rsqrt(m), 1 - zeros / 2};
}

static uint32_t scale_down(uint32_t x, int shift)
{
    return (fxs_shift_down(x, shift - 1) + 1) >> 1;
}

static uint32_t sqrt_q8(root r, int exponent)
{
    return scale_down(fxs_mulhi(r.m, r.inverse_q30), 22 - r.half - exponent);
}

/* Computes the linear map from a pixel at (dx, dy) from the centre to the splat's coordinates: v = dy / sqrt(C), u =
   (dx - (B / C) dy) / sqrt(A - B^2 / C). A, B and C are entries of the covariance, D is its determinant. The
   coefficients are vy = 1 / sqrt(C), ux = sqrt(C / D) and uy = -B / sqrt(C D). All are at most 1 / sqrt(0.3) = 1.83. */
static void whiten(fxs_splat *splat, fxs_bounds *bounds, const covariance *s, root c, const projected *centre,
                   uint32_t r_q12)
{
    const int e = s->exponent;
    root d = root_of_q60(s->det_q60), a = root_of_q30(s->a_q30);
    uint32_t root_c_q30 = fxs_mulhi(c.m, c.inverse_q30), root_d_q30 = fxs_mulhi(d.m, d.inverse_q30);
    const int32_t inverse_q29 = (int32_t)((uint64_t)c.inverse_q30 * d.inverse_q30 >> 31);
    splat->vy_q24 = (int32_t)scale_down(c.inverse_q30, 6 + c.half + e);
    splat->ux_q24 = (int32_t)scale_down((uint32_t)((uint64_t)root_c_q30 * d.inverse_q30 >> 30),
                                        6 - c.half + d.half + e);
    splat->uy_q24 = -(int32_t)fxs_round_shift(fxs_mul_add(s->b_q30, inverse_q29, 0), 35 + c.half + d.half + e);

    bounds->cx_q14 = centre->position_q14[0];
    bounds->cy_q14 = centre->position_q14[1];
    bounds->breadth_q8 = scale_down((uint32_t)((uint64_t)root_d_q30 * c.inverse_q30 >> 30),
                                    22 - d.half + c.half - e);
    bounds->shear_q8 = (int32_t)fxs_round_shift(fxs_mul_add(s->b_q30, (int32_t)c.inverse_q30, 0), 52 + c.half - e);
    bounds->half_width_q8 = (uint32_t)((uint64_t)sqrt_q8(a, e) * r_q12 >> 12);
    bounds->half_width_q8 += (bounds->half_width_q8 >> 8) + 32;
    bounds->square_radius = 0;

    int64_t u_q38 = (int64_t)bounds->cx_q14 * splat->ux_q24 + (int64_t)bounds->cy_q14 * splat->uy_q24;
    int64_t v_q38 = (int64_t)bounds->cy_q14 * splat->vy_q24;
    splat->u0_q24 = (uint32_t)(-u_q38 >> 14) + (1 << 10);
    splat->v0_q24 = (uint32_t)(-v_q38 >> 14) + (1 << 10);
}

/* Sets the pixel rows that a splat's ellipse of radius r can touch. sigma_q8 is the splat's vertical sigma; a margin of
   1/8 pixel and 1/256 of the size is added. Returns 0 if the ellipse misses the picture. */
static int clip(fxs_splat *splat, fxs_bounds *bounds, const fxs_stage_view *view, uint32_t sigma_q8, uint32_t r_q12)
{
    int32_t half_height_q8 = (int32_t)((uint64_t)sigma_q8 * r_q12 >> 12);       /* half the height is below 2^27,
                                                                                   because the exponent is at most 16 */
    const int32_t half_width_q8 = (int32_t)bounds->half_width_q8;
    half_height_q8 += (half_height_q8 >> 8) + 32;
    const int32_t cx_q8 = bounds->cx_q14 >> 6, cy_q8 = bounds->cy_q14 >> 6;
    const int32_t first = (cy_q8 - half_height_q8 + 255) >> 8, last = (cy_q8 + half_height_q8) >> 8;
    if (cx_q8 + half_width_q8 < 0 || cx_q8 - half_width_q8 > (view->width - 1) * 256 || last < 0 ||
        first >= view->height || first > last)
        return 0;
    splat->first_row = (uint16_t)(first < 0 ? 0 : first);
    splat->last_row = (uint16_t)(last >= view->height ? view->height - 1 : last);
    return 1;
}

/* Computes a splat's square cut-off as Kerbl et al. 2023: radius = ceil(3 sqrt(lambda)). lambda = mid + sqrt(max(0.1,
   mid^2 - det)), where mid is half the trace of the covariance and det its determinant. Returns 0 if the square misses
   the picture. */
static int square(fxs_splat *splat, fxs_bounds *bounds, const fxs_stage_view *view, const covariance *s)
{
    uint64_t mid_q30 = ((uint64_t)s->a_q30 + s->c_q30) / 2;
    uint64_t least_q60 = s->exponent < 15 ? TENTH_Q60 >> 4 * s->exponent : 1;
    int64_t spread_q60 = (int64_t)(mid_q30 * mid_q30 - s->det_q60);
    root spread = root_of_q60(spread_q60 < (int64_t)least_q60 ? least_q60 : (uint64_t)spread_q60);
    uint64_t lambda_q30 = mid_q30 + ((uint64_t)fxs_mulhi(spread.m, spread.inverse_q30) << 1 >> (1 - spread.half));
    uint32_t sigma_q8 = sqrt_q8(root_of_q60(lambda_q30 << 30), s->exponent);
    bounds->square_radius = (uint32_t)((3 * (uint64_t)sigma_q8 + 255) >> 8);
    int64_t x = bounds->cx_q14, y = bounds->cy_q14, radius_q14 = (int64_t)bounds->square_radius << 14;
    splat->first_row = 0;
    splat->last_row = (uint16_t)(view->height - 1);
    return x + radius_q14 + (15 << 14) >= 16 << 14 && y + radius_q14 + (15 << 14) >= 16 << 14 &&
           x - radius_q14 < (int64_t)view->tiles_x << 18 && y - radius_q14 < (int64_t)view->tiles_y << 18;
}

/* ---- Veils: Gaussians too large for a bounding box, or too far off the axis ------------------------------------- */

/* Returns the dilation (added variance) of a veil, a Gaussian too large for a bounding box. Each sigma is then at least
   1/120 of the picture's diagonal, so |u| and |v| stay below 128. */
static uint32_t veil_dilation_q30(const fxs_stage_view *view, int exponent)
{
    const uint64_t x = (uint64_t)view->tiles_x * FXS_TILE, y = (uint64_t)view->tiles_y * FXS_TILE;
    const uint64_t dilation = exponent > 31 ? 0 : (((x * x + y * y) << 30) / 14400 >> 2 * exponent) + 1;
    return dilation > FXS_DILATION_LEAST_Q30 ? (uint32_t)dilation : FXS_DILATION_LEAST_Q30;
}

static int64_t cut_to_16_q26(int64_t x)
{
    const int64_t most = (int64_t)16 << 26;
    return x < -most ? -most : x > most ? most : x;
}

/* Returns x * 2^-shift, saturated at +-16 in Q26. The shift is above -32. */
static int64_t shift_and_cut(int64_t x, int shift)
{
    return shift < 0 ? cut_to_16_q26(cut_to_16_q26(x) * ((int64_t)1 << -shift))
                     : cut_to_16_q26(x >> (shift < 62 ? shift : 62));
}

/* Returns the offset of a Gaussian's centre from the picture's middle, in units of 2^exponent pixels, Q26, clamped to
   +-16. */
static int64_t from_middle_q26(const projected *centre, int i, int64_t f_q12, int64_t c_q12, int32_t tiles,
                               int exponent)
{
    const int64_t slope = (int64_t)centre->camera[i] * centre->inverse_q30 >> 34;   /* slope x / z (or y / z) of the
                                                                                       centre, times 2^(28 - zeros) */
    const int64_t middle_q12 = ((int64_t)tiles << 15) + (1 << 11);
    return cut_to_16_q26(shift_and_cut(f_q12 * slope, 14 + exponent - centre->zeros) +
                         shift_and_cut((c_q12 - middle_q12) * (1 << 14), exponent));
}

static int64_t magnitude_of(int64_t x)
{
    return x < 0 ? -x : x;
}

/* Computes the map from pixels to u and v, as `whiten` does, for a veil (a Gaussian too large for a bounding box). The
   map is relative to the picture's middle. Returns 0 if the veil's ellipse misses the picture. */
static int veil(fxs_splat *splat, fxs_bounds *bounds, const fxs_stage_view *view, const covariance *s,
                const projected *centre, uint32_t r_q12)
{
    const int shift = (s->exponent < 60 ? s->exponent : 60) - 6;
    const int64_t half_x = view->tiles_x * (FXS_TILE / 2), half_y = view->tiles_y * (FXS_TILE / 2);
    const root c = root_of_q30(s->c_q30), d = root_of_q60(s->det_q60);
    const int64_t inverse_q29 = (int64_t)((uint64_t)c.inverse_q30 * d.inverse_q30 >> 31);
    const int64_t ratio_q30 = (int64_t)((uint64_t)fxs_mulhi(c.m, c.inverse_q30) * d.inverse_q30 >> 30);
    /* changes of u and v over a distance of 2^exponent pixels */
    const int64_t ux_q18 = fxs_round_shift(ratio_q30 * 4, 14 - c.half + d.half);
    const int64_t uy_q18 = -fxs_round_shift(s->b_q30 * inverse_q29, 41 + c.half + d.half);
    const int64_t vy_q18 = fxs_round_shift(c.inverse_q30, 12 + c.half);
    const int64_t x_q26 = from_middle_q26(centre, 0, view->fx_q12, view->cx_q12, view->tiles_x, s->exponent);
    const int64_t y_q26 = from_middle_q26(centre, 1, view->fy_q12, view->cy_q12, view->tiles_y, s->exponent);
    const int64_t u_q24 = -(x_q26 * ux_q18 + y_q26 * uy_q18) >> 20, v_q24 = -(y_q26 * vy_q18) >> 20;
    splat->ux_q24 = (int32_t)fxs_round_shift(ux_q18, shift);
    splat->uy_q24 = (int32_t)fxs_round_shift(uy_q18, shift);
    splat->vy_q24 = (int32_t)fxs_round_shift(vy_q18, shift);
    splat->u0_q24 = (uint32_t)(u_q24 - half_x * splat->ux_q24 - half_y * splat->uy_q24) + (1 << 10);
    splat->v0_q24 = (uint32_t)(v_q24 - half_y * splat->vy_q24) + (1 << 10);
    splat->first_row = 0;
    splat->last_row = (uint16_t)(view->height - 1);
    *bounds = (fxs_bounds){0, 0, 0, 0, FXS_EVERYWHERE_Q8, view->cutoff == FXS_CUTOFF_SQUARE ? 1u << 17 : 0};
    const int64_t r_q24 = ((int64_t)r_q12 + 1) * 4096;
    return magnitude_of(u_q24) <= r_q24 + half_x * splat->ux_q24 + half_y * magnitude_of(splat->uy_q24) &&
           magnitude_of(v_q24) <= r_q24 + half_y * splat->vy_q24;
}

/* ---------------------------------------------------------------------------------------------------------------- */

static int project_shape(fxs_splat *splat, fxs_bounds *bounds, const fxs_stage_view *view, const fxs_chunk_view *cv,
                         const projected *centre, enum fxs_profile profile, const fxs_codes *codes)
{
    int32_t fall_q16[3], k_q15[3], j_q15[2][3], t_q15[2][3], least = INT32_MAX;
    fxs_gaussian_axes a;
    for (int i = 0; i < 3; i++) {
        fall_q16[i] = fxs_fall_q16(fxs_scale_code(codes->scale, i), cv->scale_step_q24);
        least = fall_q16[i] < least ? fall_q16[i] : least;
    }
    int size_exponent;
    uint32_t size_q32 = screen_size(view, cv, centre, cv->scale_q16 - least, &size_exponent);
    const int is_veil = size_exponent > FXS_EXPONENT_MAX || centre->out_of_range;
    if (is_veil ? size_exponent < view->veil_exponent : off_picture(view, centre, size_exponent))
        return 0;
    int exponent = size_exponent > 0 ? size_exponent : 0;
    jacobian(j_q15, view, centre);
    if (!fxs_read_axes(&a, codes->rotation, fxs_axis_bits(profile, fall_q16)))
        return 0;
    for (int i = 0; i < 3; i++) {
        int32_t below_q16 = fall_q16[i] - least;
        uint32_t ratio_q15 = (uint32_t)fxs_exp2_q15((below_q16 & 65535) >> 1);
        k_q15[i] = (int32_t)scale_down((uint32_t)((uint64_t)ratio_q15 * size_q32 >> 31),
                                       1 + exponent - size_exponent + (below_q16 >> 16));
    }
    for (int i = 0; i < 2; i++) {
        const int32_t p_q15 = dot_q15(j_q15[i], a.side_q15[0]), q_q15 = dot_q15(j_q15[i], a.side_q15[1]);
        t_q15[i][0] = fxs_mul_q15(dot_q15(j_q15[i], a.axis_q15), k_q15[0]);
        t_q15[i][1] = fxs_mul_q15((p_q15 * a.cos_q15 + q_q15 * a.sin_q15 + 16384) >> 15, k_q15[1]);
        t_q15[i][2] = fxs_mul_q15((q_q15 * a.cos_q15 - p_q15 * a.sin_q15 + 16384) >> 15, k_q15[2]);
    }
    covariance s;
    covariance_of(&s, t_q15, exponent, is_veil ? veil_dilation_q30(view, exponent) : FXS_DILATION_LEAST_Q30);

    int32_t offset_q11 = splat->offset_q11;
    if (view->antialiased) {    /* the opacity falls by sqrt(det undilated / det), so the offset, -2 ln(opacity), gains
                                   ln(det / det undilated) */
        if (!s.det_undilated_q60)
            return 0;
        int32_t log2 = fxs_log2_q16(s.det_q60) - fxs_log2_q16(s.det_undilated_q60);
        offset_q11 += (int32_t)(((int64_t)log2 * 45426 + (1 << 20)) >> 21);   /* the factor ln 2 is 45426 in Q16 */
    }
    if (offset_q11 > FXS_FAINT_Q11)
        return 0;
    splat->offset_q11 = (uint16_t)offset_q11;
    uint32_t r2_q11 = (uint32_t)(fxs_limit_q11(offset_q11, FXS_CUT_Q11) - offset_q11);
    if (view->cutoff == FXS_CUTOFF_SQUARE)
        r2_q11 = (uint32_t)(FXS_FAINT_Q11 - offset_q11);
    uint32_t r_q12 = fxs_sqrt((r2_q11 + 1) << 13) + 1;
    if (is_veil)
        return veil(splat, bounds, view, &s, centre, r_q12);
    const root c = root_of_q30(s.c_q30);
    whiten(splat, bounds, &s, c, centre, r_q12);
    return view->cutoff == FXS_CUTOFF_SQUARE ? square(splat, bounds, view, &s)
                                             : clip(splat, bounds, view, sqrt_q8(c, exponent), r_q12);
}

/* Returns a Gaussian's depth as a key that sorts in the same order: 6 bits of exponent, 26 of mantissa. The depth z is
   1 to 2^30 - 1 units of 2^(shift - 32), with shift 0 to 33. */
static uint32_t depth_key(const fxs_chunk_view *cv, const projected *centre)
{
    const uint32_t z = (uint32_t)centre->camera[2];
    const int zeros = fxs_clz32(z);
    return (uint32_t)(cv->shift - zeros - 1 + FXS_DEPTH_BIAS) << 26 | ((z << zeros) >> 5 & 0x3ffffff);
}

static int project_one(fxs_splat *splat, fxs_bounds *bounds, uint32_t *depth, const fxs_stage_view *view,
                       const fxs_chunk_view *cv, enum fxs_profile profile, const fxs_codes *codes, uint32_t offset_q11)
{
    projected centre;
    if (!(codes->colour >> 24) || !project_centre(&centre, view, cv, codes->position))
        return 0;
    splat->offset_q11 = (uint16_t)(offset_q11 + (uint32_t)view->offset_q11);
    *depth = depth_key(cv, &centre);
    return project_shape(splat, bounds, view, cv, &centre, profile, codes);
}

int32_t fxs_project_c(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk, fxs_splat *splats,
                      fxs_bounds *bounds, uint32_t *indices, uint32_t *depths)
{
    const unsigned char *rows = fxs_rows(scene, chunk);
    fxs_chunk_view cv;
    int32_t count = 0;
    const int seen = fxs_chunk_view_init(&cv, view, scene, chunk);
    if (seen <= 0)
        return seen;
    for (uint32_t g = 0; g < FXS_CHUNK; g++) {
        const fxs_codes codes = fxs_codes_of(scene, rows, g);
        const uint32_t offset_q11 = fxs_offset_of_code_q11[cv.opacity_law][codes.colour >> 24];
        if (project_one(&splats[count], &bounds[count], &depths[count], view, &cv, scene->profile, &codes,
                        fxs_share_of_q11(offset_q11, view->share_q8)))
            indices[count++] = chunk * FXS_CHUNK + g;
    }
    return count;
}
