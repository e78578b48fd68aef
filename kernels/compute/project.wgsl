// Projects Gaussians to the screen, one per thread, with the arithmetic of src/core/project.c.

struct Projected {
    camera: vec3<i32>,
    zeros: i32,
    inverse_q30: u32,
    slope_q23: vec2<i32>,
    position_q14: vec2<i32>,
    out_of_range: bool,
}

// Covariance matrix (a, b; b, c) of a splat on the screen, in units of 4^exponent pixels^2.
struct Covariance {
    a_q30: u32,
    c_q30: u32,
    b_q30: i32,
    det_q60: wide,
    det_undilated_q60: wide,
    exponent: i32,
}

struct Root {
    m: u32,
    inverse_q30: u32,
    half: i32,
}

struct Placed {
    splat: Splat,
    bounds: Bounds,
}

const CENTRE_LIMIT_Q14: i32 = 0x40000000;
const SIDE_Q23: i32 = 0x20000000;

fn whole_tiles() -> vec2<i32>
{
    return (frame.whole + 15) >> vec2<u32>(4u);
}

fn number_at(at: u32) -> i32
{
    return bitcast<i32>(record[at]);
}

fn wide_at(at: u32) -> wide
{
    return wide(record[at], record[at + 1u]);
}

// Returns camera coordinate i of a Gaussian's centre from its position code: (base + m code) >> 16, below 2^30. Splits
// matrix m at bit 16 to avoid 64-bit products.
fn camera_of(i: u32, code: vec3<u32>) -> i32
{
    let base_q16 = wide_at(2u * i);
    let m_q16 = vec3<u32>(record[6u + 3u * i], record[7u + 3u * i], record[8u + 3u * i]);
    let below = (m_q16 & vec3<u32>(0xffffu)) * code;
    let above = (bitcast<vec3<i32>>(m_q16) >> vec3<u32>(16u)) * vec3<i32>(code);
    let rest = below & vec3<u32>(0xffffu);
    let low = (base_q16.x & 0xffffu) + rest.x + rest.y + rest.z;
    let carried = (below.x >> 16u) + (below.y >> 16u) + (below.z >> 16u) + (low >> 16u);
    return bitcast<i32>((base_q16.y << 16u) | (base_q16.x >> 16u)) + above.x + above.y + above.z + i32(carried);
}

struct Axis {
    slope_q23: i32,
    position_q14: i32,
    out_of_range: bool,
}

fn project_axis(x: i32, side: i32, zeros: i32, inverse_q30: u32, f_q12: i32, c_q12: i32) -> Axis
{
    let off_axis = x >= side || -x >= side;
    var slope = low_of(round_shift(mul_mixed(x, inverse_q30), 39 - zeros));
    if (off_axis) {
        slope = select(SIDE_Q23, -SIDE_Q23, x < 0);
    }
    let middle_q14 = sub_wide(shift_left(wide_of(c_q12), 2u), wide(8192u, 0u));
    let position = add_wide(round_shift(mul_signed(f_q12, slope), 21), middle_q14);
    return Axis(slope, low_of(position), off_axis || !less(magnitude(position), wide(u32(CENTRE_LIMIT_Q14), 0u)));
}

fn project_centre(centre: ptr<function, Projected>, code: vec3<u32>) -> bool
{
    let z = camera_of(2u, code);
    if (z <= number_at(21u)) {
        return false;
    }
    let parallel = object.orthographic != 0;
    let zeros = select(zeros_of(u32(z)), number_at(19u), parallel);
    var inverse_q30 = 0x40000000u;
    var side = number_at(20u);
    if (!parallel) {
        inverse_q30 = reciprocal(u32(z) << u32(zeros));
        side = 64 * min(z, 0x1ffffff);
    }
    (*centre).camera = vec3<i32>(camera_of(0u, code), camera_of(1u, code), z);
    (*centre).zeros = zeros;
    (*centre).inverse_q30 = inverse_q30;
    let x = project_axis((*centre).camera.x, side, zeros, inverse_q30, object.f_q12.x, object.c_q12.x);
    let y = project_axis((*centre).camera.y, side, zeros, inverse_q30, object.f_q12.y, object.c_q12.y);
    (*centre).slope_q23 = vec2<i32>(x.slope_q23, y.slope_q23);
    (*centre).position_q14 = vec2<i32>(x.position_q14, y.position_q14);
    (*centre).out_of_range = x.out_of_range || y.out_of_range;
    return true;
}

// Returns a row of J W, the projection's Jacobian times the view rotation, divided by f/z 2^jacobian_exponent, Q15.
fn jacobian_row(i: u32, slope_q23: i32) -> vec3<i32>
{
    let slope = clamp(slope_q23, object.slope_low_q23[i], object.slope_high_q23[i]);
    let slope_q15 = ((slope >> u32(7 + object.jacobian_exponent)) + 1) >> 1u;
    let forward = object.forward_q15[i].xyz;
    return object.row_q15[i].xyz - ((slope_q15 * forward + vec3<i32>(16384)) >> vec3<u32>(15u));
}

struct Axes {
    axis_q15: vec3<i32>,
    side_x_q15: vec3<i32>,
    side_y_q15: vec3<i32>,
    cos_q15: i32,
    sin_q15: i32,
}

fn axis_bits(falls_q16: vec3<i32>) -> u32
{
    let small = object.profile == SMALL;
    let gap = min(abs(falls_q16.y - falls_q16.x), abs(falls_q16.z - falls_q16.x)) >> 4u;
    return u32(min(select(11, 8, small) + ((5 * gap) >> 16u), select(14, 10, small)));
}

// Returns the falls of the axes of a scale word: the chunk's scale_q16 - log2(sigma).
fn falls_of(scale_word: u32, step_q24: u32) -> vec3<i32>
{
    let code = (vec3<u32>(scale_word) >> vec3<u32>(0u, 10u, 19u)) & vec3<u32>(1023u, 1023u, 1022u);
    return vec3<i32>((code * code * step_q24 + 128u) >> vec3<u32>(8u));
}

// Computes the first axis and its sides from its two numbers in Q15.
fn axes_of(axes: ptr<function, Axes>, x: i32, y: i32) -> bool
{
    let square_q30 = u32(x * x) + u32(y * y);
    if (square_q30 > 0x40000000u) {
        return false;
    }
    let m = 0x80000000u - square_q30;
    let s_q15 = i32((mul_high(m, rsqrt(m)) + 8192u) >> 14u);
    let xx_q15 = (x * x + 16384) >> 15u;
    let yy_q15 = (y * y + 16384) >> 15u;
    let xy_q15 = (x * y + 16384) >> 15u;
    let xs_q15 = (x * s_q15 + 16384) >> 15u;
    let ys_q15 = (y * s_q15 + 16384) >> 15u;
    (*axes).axis_q15 = vec3<i32>(xs_q15, ys_q15, i32((m + 16384u) >> 15u) - 32768);
    (*axes).side_x_q15 = vec3<i32>(32768 - xx_q15, -xy_q15, -xs_q15);
    (*axes).side_y_q15 = vec3<i32>(-xy_q15, 32768 - yy_q15, -ys_q15);
    return true;
}

fn read_axes(axes: ptr<function, Axes>, word: u32, bits: u32) -> bool
{
    if (!axes_of(axes, bitcast<i32>(word) >> 16u, bitcast<i32>(word << bits) >> 16u)) {
        return false;
    }
    let u = bitcast<i32>(word << (2u * bits)) >> 16u;
    let uu_q15 = (u * u + 16384) >> 15u;
    (*axes).cos_q15 = 32768 - fxs_mul_q15(uu_q15, 40141 - fxs_mul_q15(uu_q15, 7373));
    (*axes).sin_q15 = fxs_mul_q15(u, 51317 - fxs_mul_q15(uu_q15, 20619 - fxs_mul_q15(uu_q15, 2066)));
    return true;
}

// Computes the size of a Gaussian on the screen, f sigma_max / z 2^jacobian_exponent, as mantissa 2^exponent with the
// mantissa in [0.5, 1).
fn screen_size(centre: ptr<function, Projected>, size_q16: i32, exponent: ptr<function, i32>) -> u32
{
    let whole = -(-size_q16 >> 16u);
    let size_q15 = u32(exp2_q15((-size_q16 & 65535) >> 1u));
    let over_z_q30 = shift_right(mul_wide(size_q15, (*centre).inverse_q30), 15u).x;
    let mantissa = mul_high(over_z_q30, object.focal_q32);
    let zeros = zeros_of(mantissa);
    *exponent = whole - number_at(18u) + (*centre).zeros + object.focal_exponent + object.jacobian_exponent +
                2 - zeros;
    return mantissa << u32(zeros);
}

fn off_picture(centre: ptr<function, Projected>, exponent: i32) -> bool
{
    let radius_q14 = 57344u * ((1u << u32(max(exponent, 0))) + 1u);
    let position = (*centre).position_q14;
    let end = vec2<u32>(whole_tiles()) << vec2<u32>(18u);
    return any(vec2<u32>(max(-position, vec2<i32>(0))) > vec2<u32>(radius_q14)) ||
           any(vec2<u32>(max(position, vec2<i32>(0))) > end + radius_q14);
}

fn dot_i(a: vec3<i32>, b: vec3<i32>) -> i32
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn square_wide(x: i32) -> wide
{
    let size = u32(abs(x));
    return mul_wide(size, size);
}

fn covariance_of(p: vec3<i32>, q: vec3<i32>, exponent: i32, least_dilation_q30: u32) -> Covariance
{
    var out: Covariance;
    let a = u32(dot_i(p, p));
    let c = u32(dot_i(q, q));
    let undilated = add_wide(add_wide(square_wide(p.y * q.z - p.z * q.y), square_wide(p.z * q.x - p.x * q.z)),
                             square_wide(p.x * q.y - p.y * q.x));
    var dilation = least_dilation_q30;
    if (exponent < 15) {
        dilation = max(dilation, 322122547u >> u32(2 * exponent));
    }
    let sum = add_wide(add_wide(wide(a, 0u), wide(c, 0u)), wide(dilation, 0u));
    out.b_q30 = dot_i(p, q);
    out.det_undilated_q60 = undilated;
    out.det_q60 = add_wide(undilated, mul_word(sum, dilation));
    out.a_q30 = a + dilation;
    out.c_q30 = c + dilation;
    out.exponent = exponent;
    return out;
}

fn root_of_q60(x: wide) -> Root
{
    let zeros = zeros_of_wide(x) & ~1;
    let m = shift_left(x, u32(zeros)).y;
    return Root(m, rsqrt(m), 2 - zeros / 2);
}

fn root_of_q30(x: u32) -> Root
{
    let zeros = zeros_of(x) & ~1;
    let m = x << u32(zeros);
    return Root(m, rsqrt(m), 1 - zeros / 2);
}

// Returns x 2^-shift, rounded to nearest, for shift > 0 and x < 2^32 - 1.
fn scale_down(x: u32, shift: i32) -> u32
{
    if (shift > 32) {
        return 0u;
    }
    return ((x >> u32(shift - 1)) + 1u) >> 1u;
}

fn sqrt_q8(r: Root, exponent: i32) -> u32
{
    return scale_down(mul_high(r.m, r.inverse_q30), 22 - r.half - exponent);
}

fn product_shifted(a: u32, b: u32, n: u32) -> u32
{
    return shift_right(mul_wide(a, b), n).x;
}

fn whiten(out: ptr<function, Placed>, s: ptr<function, Covariance>, c: Root, centre: ptr<function, Projected>,
          r_q12: u32)
{
    let e = (*s).exponent;
    let b_q30 = (*s).b_q30;
    let d = root_of_q60((*s).det_q60);
    let a = root_of_q30((*s).a_q30);
    let root_c_q30 = mul_high(c.m, c.inverse_q30);
    let root_d_q30 = mul_high(d.m, d.inverse_q30);
    let inverse_q29 = product_shifted(c.inverse_q30, d.inverse_q30, 31u);
    let vy = i32(scale_down(c.inverse_q30, 6 + c.half + e));
    let ux = i32(scale_down(product_shifted(root_c_q30, d.inverse_q30, 30u), 6 - c.half + d.half + e));
    let uy = -low_of(round_shift(mul_mixed(b_q30, inverse_q29), 35 + c.half + d.half + e));
    let half_width = product_shifted(sqrt_q8(a, e), r_q12, 12u);
    let position = (*centre).position_q14;
    (*out).bounds = Bounds(position,
                           scale_down(product_shifted(root_d_q30, c.inverse_q30, 30u), 22 - d.half + c.half - e),
                           low_of(round_shift(mul_mixed(b_q30, c.inverse_q30), 52 + c.half - e)),
                           i32(half_width + (half_width >> 8u) + 32u), 0u);
    let u_q38 = add_wide(mul_signed(position.x, ux), mul_signed(position.y, uy));
    let v_q38 = mul_signed(position.y, vy);
    (*out).splat.u0_q24 = 1024u - shift_up(u_q38, 14u).x;
    (*out).splat.v0_q24 = 1024u - shift_up(v_q38, 14u).x;
    (*out).splat.ux_q24 = ux;
    (*out).splat.uy_q24 = uy;
    (*out).splat.vy_q24 = vy;
}

// Returns false if a splat's ellipse lies outside the picture.
fn clip(out: ptr<function, Placed>, sigma_q8: u32, r_q12: u32) -> bool
{
    var half_height = i32(product_shifted(sigma_q8, r_q12, 12u));
    half_height += (half_height >> 8u) + 32;
    let half_width = (*out).bounds.half_width_q8;
    let c_q8 = (*out).bounds.c_q14 >> vec2<u32>(6u);
    let first = (c_q8.y - half_height + 255) >> 8u;
    let last = (c_q8.y + half_height) >> 8u;
    let size = frame.whole;
    if (c_q8.x + half_width < 0 || c_q8.x - half_width > (size.x - 1) << 8u || last < 0 || first >= size.y ||
        first > last) {
        return false;
    }
    (*out).splat.rows = vec2<i32>(max(first, 0), min(last, size.y - 1));
    return true;
}

// Computes the radius of a square splat, 3 sigma as in Kerbl et al. 2023. Returns false if the square lies outside the
// picture.
fn square(out: ptr<function, Placed>, s: ptr<function, Covariance>) -> bool
{
    let e = (*s).exponent;
    let mid_q30 = shift_right(add_wide(wide((*s).a_q30, 0u), wide((*s).c_q30, 0u)), 1u).x;
    var least_q60 = wide(1u, 0u);
    if (e < 15) {                  // 0x0199999999999999 is 0.1 in Q60
        least_q60 = shift_right(wide(0x99999999u, 0x01999999u), u32(4 * e));
    }
    let spread_q60 = sub_wide(mul_wide(mid_q30, mid_q30), (*s).det_q60);
    var more = spread_q60;
    if (less(spread_q60, least_q60)) {
        more = least_q60;
    }
    let spread = root_of_q60(more);
    let root = shift_left(wide(mul_high(spread.m, spread.inverse_q30), 0u), 1u);
    let lambda_q30 = add_wide(wide(mid_q30, 0u), shift_right(root, u32(1 - spread.half)));
    let sigma_q8 = sqrt_q8(root_of_q60(shift_left(lambda_q30, 30u)), e);
    let radius = i32((3u * sigma_q8 + 255u) >> 8u);
    (*out).bounds.square_radius = u32(radius);
    (*out).splat.rows = vec2<i32>(0, frame.whole.y - 1);
    let pixel = (*out).bounds.c_q14 >> vec2<u32>(14u);
    return all(pixel + radius + 15 >= vec2<i32>(16)) && all(pixel < radius + 16 * whole_tiles());
}

// ---- Veils -----------------------------------------------------------------------------------------------------

fn veil_dilation_q30(exponent: i32) -> u32
{
    if (exponent > 31) {
        return 64u;
    }
    let dilation = add_wide(shift_right(object.dilation_q30, u32(2 * exponent)), wide(1u, 0u));
    return select(max(dilation.x, 64u), 0xffffffffu, dilation.y != 0u);
}

fn cut_to_16_q26(x: wide) -> i32
{
    let most = wide(0x40000000u, 0u);
    if (less(most, magnitude(x))) {
        return select(0x40000000, -0x40000000, is_negative(x));
    }
    return low_of(x);
}

fn shift_and_cut(x: wide, shift: i32) -> i32
{
    if (shift < 0) {
        return cut_to_16_q26(shift_left(wide_of(cut_to_16_q26(x)), u32(-shift)));
    }
    return cut_to_16_q26(shift_signed(x, u32(min(shift, 62))));
}

fn from_middle_q26(centre: ptr<function, Projected>, i: u32, exponent: i32) -> i32
{
    let slope = low_of(shift_signed(mul_mixed((*centre).camera[i], (*centre).inverse_q30), 34u));
    let middle_q12 = sub_wide(wide_of(object.c_q12[i]), wide_of((whole_tiles()[i] << 15u) + 2048));
    let moved = shift_and_cut(mul_signed(object.f_q12[i], slope), 14 + exponent - (*centre).zeros);
    return cut_to_16_q26(add_wide(wide_of(moved), wide_of(shift_and_cut(shift_left(middle_q12, 14u), exponent))));
}

fn veil(out: ptr<function, Placed>, s: ptr<function, Covariance>, centre: ptr<function, Projected>, r_q12: u32) -> bool
{
    let e = (*s).exponent;
    let shift = min(e, 60) - 6;
    let middle = whole_tiles() * 8;
    let c = root_of_q30((*s).c_q30);
    let d = root_of_q60((*s).det_q60);
    let inverse_q29 = product_shifted(c.inverse_q30, d.inverse_q30, 31u);
    let ratio_q30 = shift_right(mul_wide(mul_high(c.m, c.inverse_q30), d.inverse_q30), 30u);
    let ux_q18 = low_of(round_shift(shift_left(ratio_q30, 2u), 14 - c.half + d.half));
    let uy_q18 = -low_of(round_shift(mul_mixed((*s).b_q30, inverse_q29), 41 + c.half + d.half));
    let vy_q18 = low_of(round_shift(wide(c.inverse_q30, 0u), 12 + c.half));
    let x_q26 = from_middle_q26(centre, 0u, e);
    let y_q26 = from_middle_q26(centre, 1u, e);
    let u_q44 = add_wide(mul_signed(x_q26, ux_q18), mul_signed(y_q26, uy_q18));
    let u_q24 = shift_up(u_q44, 20u);
    let v_q24 = shift_up(mul_signed(y_q26, vy_q18), 20u);
    let ux = low_of(round_shift(wide_of(ux_q18), shift));
    let uy = low_of(round_shift(wide_of(uy_q18), shift));
    let vy = low_of(round_shift(wide_of(vy_q18), shift));
    (*out).splat.u0_q24 = 1024u - u_q24.x - bitcast<u32>(middle.x * ux) - bitcast<u32>(middle.y * uy);
    (*out).splat.v0_q24 = 1024u - v_q24.x - bitcast<u32>(middle.y * vy);
    (*out).splat.ux_q24 = ux;
    (*out).splat.uy_q24 = uy;
    (*out).splat.vy_q24 = vy;
    (*out).splat.rows = vec2<i32>(0, frame.whole.y - 1);
    (*out).bounds = Bounds(vec2<i32>(0), 0u, 0, EVERYWHERE_Q8, select(0u, 0x20000u, frame.cutoff == 1));
    let r_q24 = wide((r_q12 + 1u) * 4096u, 0u);
    let across = add_wide(mul_signed(middle.x, ux), mul_signed(middle.y, abs(uy)));
    return !less(add_wide(r_q24, across), magnitude(u_q24)) &&
           !less(add_wide(r_q24, mul_signed(middle.y, vy)), magnitude(v_q24));
}

// ----------------------------------------------------------------------------------------------------------------

// Returns the length of an axis of a Gaussian in Q15. The axis is 2^-below times as long as the longest axis.
fn axis_size_q15(below_q16: i32, size_q32: u32, shift: i32) -> i32
{
    let ratio_q15 = u32(exp2_q15((below_q16 & 65535) >> 1u));
    return i32(scale_down(product_shifted(ratio_q15, size_q32, 31u), shift + (below_q16 >> 16u)));
}

fn dot_q15(a: vec3<i32>, b: vec3<i32>) -> i32
{
    return (dot_i(a, b) + 16384) >> 15u;
}

// Returns a row of the splatting matrix T = J W R S, Q15: Jacobian, view rotation, Gaussian's rotation and scales.
fn screen_axes(row: vec3<i32>, axes: Axes, sizes_q15: vec3<i32>) -> vec3<i32>
{
    let p = dot_q15(row, axes.side_x_q15);
    let q = dot_q15(row, axes.side_y_q15);
    return vec3<i32>(fxs_mul_q15(dot_q15(row, axes.axis_q15), sizes_q15.x),
                     fxs_mul_q15((p * axes.cos_q15 + q * axes.sin_q15 + 16384) >> 15u, sizes_q15.y),
                     fxs_mul_q15((q * axes.cos_q15 - p * axes.sin_q15 + 16384) >> 15u, sizes_q15.z));
}

fn project_shape(out: ptr<function, Placed>, centre: ptr<function, Projected>, scale_word: u32,
                 rotation_word: u32) -> bool
{
    let falls_q16 = falls_of(scale_word, record[16]);
    let least_q16 = min(min(falls_q16.x, falls_q16.y), falls_q16.z);
    var size_exponent: i32;
    let size_q32 = screen_size(centre, number_at(15u) - least_q16, &size_exponent);
    let is_veil = size_exponent > 16 || (*centre).out_of_range;
    if (is_veil) {
        if (size_exponent < object.veil_exponent) {
            return false;
        }
    } else if (off_picture(centre, size_exponent)) {
        return false;
    }
    let exponent = max(size_exponent, 0);
    var axes: Axes;
    if (!read_axes(&axes, rotation_word, axis_bits(falls_q16))) {
        return false;
    }
    let row_x = jacobian_row(0u, (*centre).slope_q23.x);
    let row_y = jacobian_row(1u, (*centre).slope_q23.y);
    let shift = 1 + exponent - size_exponent;
    let sizes_q15 = vec3<i32>(axis_size_q15(falls_q16.x - least_q16, size_q32, shift),
                              axis_size_q15(falls_q16.y - least_q16, size_q32, shift),
                              axis_size_q15(falls_q16.z - least_q16, size_q32, shift));
    let t_x = screen_axes(row_x, axes, sizes_q15);
    let t_y = screen_axes(row_y, axes, sizes_q15);
    var least = 64u;
    if (is_veil) {
        least = veil_dilation_q30(exponent);
    }
    var s = covariance_of(t_x, t_y, exponent, least);
    var offset_q11 = (*out).splat.offset_q11;
    if (object.antialiased != 0) {
        if ((s.det_undilated_q60.x | s.det_undilated_q60.y) == 0u) {
            return false;
        }
        let log2 = log2_q16(s.det_q60) - log2_q16(s.det_undilated_q60);
        offset_q11 += low_of(shift_signed(add_wide(mul_signed(log2, 45426), wide(0x100000u, 0u)), 21u));
    }
    if (offset_q11 > FXS_FAINT_Q11) {
        return false;
    }
    (*out).splat.offset_q11 = offset_q11;
    var r2_q11 = u32(fxs_limit_q11(offset_q11, FXS_CUT_Q11) - offset_q11);
    if (frame.cutoff == 1) {
        r2_q11 = u32(FXS_FAINT_Q11 - offset_q11);
    }
    let r_q12 = sqrt_of((r2_q11 + 1u) << 13u) + 1u;
    if (is_veil) {
        return veil(out, &s, centre, r_q12);
    }
    let root_c = root_of_q30(s.c_q30);
    whiten(out, &s, root_c, centre, r_q12);
    if (frame.cutoff == 1) {
        return square(out, &s);
    }
    return clip(out, sqrt_q8(root_c, exponent), r_q12);
}

// Moves a splat from the picture to the window that the frame draws. Returns false if it is above or below the window.
fn enter_window(out: ptr<function, Placed>) -> bool
{
    if (all(frame.size == frame.whole)) {
        return true;
    }
    let first = vec2<u32>(frame.first);
    let rows = (*out).splat.rows - frame.first.y;
    (*out).splat.u0_q24 += first.x * bitcast<u32>((*out).splat.ux_q24) + first.y * bitcast<u32>((*out).splat.uy_q24);
    (*out).splat.v0_q24 += first.y * bitcast<u32>((*out).splat.vy_q24);
    (*out).splat.rows = clamp(rows, vec2<i32>(0), vec2<i32>(frame.size.y - 1));
    if ((*out).bounds.half_width_q8 != EVERYWHERE_Q8) {
        (*out).bounds.c_q14 -= frame.first << vec2<u32>(14u);
    }
    return rows.y >= 0 && rows.x < frame.size.y;
}

fn depth_key(z: i32) -> u32
{
    let zeros = zeros_of(u32(z));
    return (u32(number_at(18u) - zeros - 1 + 32) << 26u) | (((u32(z) << u32(zeros)) >> 5u) & 0x3ffffffu);
}

fn falling_q30(l_q16: u32) -> u32
{
    let whole = l_q16 >> 16u;
    if (whole > 30u) {
        return 0u;
    }
    return (u32(exp2_q15(i32(l_q16 & 65535u) >> 1u)) << 15u) >> whole;
}

fn octaves_below_q16(x_q30: u32) -> u32
{
    return u32(max((30 << 16u) - log2_q16(wide(x_q30, 0u)), 0));
}

fn share_of_q11(offset_q11: u32, share_q8: u32) -> u32
{
    let faint = u32(FXS_FAINT_Q11);
    if (offset_q11 > faint) {
        return faint + 1u;
    }
    let opacity_q30 = falling_q30((offset_q11 * 94548u + 2048u) >> 12u);
    let clear_q30 = 0x40000000u - min(opacity_q30, 1063004406u);
    let share_q30 = 0x40000000u - falling_q30((octaves_below_q16(clear_q30) * share_q8) >> 8u);
    if (share_q30 == 0u) {
        return faint + 1u;
    }
    let offset = shift_right(add_wide(mul_wide(octaves_below_q16(share_q30), 90852u), wide(0x100000u, 0u)), 21u).x;
    return min(offset, faint + 1u);
}
