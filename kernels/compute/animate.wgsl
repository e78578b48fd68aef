// Moves the codes of a Gaussian of a moving scene to the time of a frame, with the arithmetic of src/core/animate.h and
// src/core/axes.h.

const ROW: u32 = 128u;             // words of a row of motion, 256 numbers of 16 bits

struct Moment {
    power_q15: vec3<i32>,          // u, u^2, u^3, of the chunk's time u
    shift: i32,
}

fn signed_half(word: u32, i: u32) -> i32
{
    return bitcast<i32>(word << (16u - 16u * (i % 2u))) >> 16u;
}

fn moment_of(place: u32) -> Moment
{
    let low = memory[frame.moments + 2u * place];
    let high = memory[frame.moments + 2u * place + 1u];
    return Moment(vec3<i32>(signed_half(low, 0u), signed_half(low, 1u), signed_half(high, 0u)),
                  bitcast<i32>(high << 8u) >> 24u);
}

fn motion_code(row: u32, g: u32) -> i32
{
    return signed_half(scene[row + g / 2u], g);
}

fn motion_codes(row: u32, g: u32) -> vec3<i32>
{
    return vec3<i32>(motion_code(row, g), motion_code(row + ROW, g), motion_code(row + 2u * ROW, g));
}

fn drifted(code: vec3<u32>, row: u32, g: u32, moment: Moment) -> vec3<u32>
{
    var sum = vec3<i32>(0);
    for (var k = 0u; k < object.motion_degree; k += 1u) {
        sum += (motion_codes(row + 3u * ROW * k, g) * moment.power_q15[k] + 16384) >> vec3<u32>(15u);
    }
    if (moment.shift >= 0) {
        sum *= 1 << u32(moment.shift);
    } else {
        sum = (sum + (1 << u32(-moment.shift - 1))) >> vec3<u32>(u32(-moment.shift));
    }
    return vec3<u32>(clamp(vec3<i32>(code) + sum, vec3<i32>(0), vec3<i32>(65535)));
}

// Returns a unit quaternion, Q15.
fn turn_at(row: u32, g: u32, u_q15: i32) -> vec4<i32>
{
    let codes = vec4<i32>(motion_code(row, g), motion_codes(row + ROW, g));
    let q_q13 = ((codes * u_q15 + 32768) >> vec4<u32>(16u)) + vec4<i32>(8192, 0, 0, 0);
    let squares_q26 = vec4<u32>(q_q13 * q_q13);
    let square_q26 = max(squares_q26.x + squares_q26.y + squares_q26.z + squares_q26.w, 1u);
    let zeros = u32(zeros_of(square_q26)) & ~1u;
    let inverse_q14 = i32(rsqrt(square_q26 << zeros) >> 16u);
    return (2 * q_q13 * inverse_q14 + (1 << (15u - zeros / 2u))) >> vec4<u32>(16u - zeros / 2u);
}

fn products_q15(a: vec3<i32>, b: vec3<i32>) -> vec3<i32>
{
    return (a * b + 16384) >> vec3<u32>(15u);
}

fn sum_of_products_q15(a: vec3<i32>, b: vec3<i32>) -> i32
{
    let products = products_q15(a, b);
    return products.x + products.y + products.z;
}

fn cross_q15(a: vec3<i32>, b: vec3<i32>) -> vec3<i32>
{
    return products_q15(a.yzx, b.zxy) - products_q15(a.zxy, b.yzx);
}

fn turned(v_q15: vec3<i32>, turn_q15: vec4<i32>) -> vec3<i32>
{
    let c_q15 = cross_q15(turn_q15.yzw, v_q15);
    return v_q15 + 2 * (products_q15(vec3<i32>(turn_q15.x), c_q15) + cross_q15(turn_q15.yzw, c_q15));
}

fn axis_code(x_q15: i32, rest: u32, bits: u32) -> u32
{
    let most = (1 << (bits - 1u)) - 1;
    let code = (x_q15 - i32(rest >> (16u + bits)) + (1 << (15u - bits))) >> (16u - bits);
    return bitcast<u32>(clamp(code, -most - 1, most));
}

fn axis_towards_0(code: u32) -> u32
{
    let x = bitcast<i32>(code);
    return bitcast<u32>(select(select(x, x + 1, x < -1), x - 1, x > 0));
}

// Returns the roll of the second axis about the first, Q15.
fn roll_of(axes: ptr<function, Axes>, second_q15: vec3<i32>) -> i32
{
    let c = sum_of_products_q15(second_q15, (*axes).side_x_q15);
    let d = sum_of_products_q15(second_q15, (*axes).side_y_q15) * select(1, -1, c < 0);
    let inverse_q15 = i32(reciprocal(u32(32768 + min(abs(c), 32767)) << 16u) >> 16u);
    let t_q15 = clamp(fxs_mul_q15(clamp(d, -32768, 32768), inverse_q15), -32767, 32767);
    let w_q15 = fxs_mul_q15(t_q15, t_q15);
    let factor_q15 = 41689 - fxs_mul_q15(w_q15, 13400 - fxs_mul_q15(w_q15, 6102 - fxs_mul_q15(w_q15, 1627)));
    return clamp(fxs_mul_q15(t_q15, factor_q15), -32768, 32767);
}

// Returns the rotation word of X, Y and U, with `bits` bits for X and Y and `roll` bits for U.
fn rotation_word(x_q15: i32, y_q15: i32, u_q15: i32, bits: u32, roll: u32) -> u32
{
    let behind_y = bitcast<u32>((u_q15 + (1 << (15u - roll))) >> (16u - roll)) << (32u - roll);
    let y_code = axis_code(y_q15, behind_y, bits);
    let behind_x = (y_code << (32u - bits)) | (behind_y >> bits);
    let x_code = axis_code(x_q15, behind_x, bits);
    let word = (x_code << (32u - bits)) | (behind_x >> bits);
    let x_read = bitcast<i32>(word) >> 16u;
    let y_read = bitcast<i32>(behind_x) >> 16u;
    if (u32(x_read * x_read) + u32(y_read * y_read) <= 0x40000000u) {
        return word;
    }
    return (axis_towards_0(x_code) << (32u - bits)) |
           (((axis_towards_0(y_code) << (32u - bits)) | (behind_y >> bits)) >> bits);
}

fn write_axes(first_q15: vec3<i32>, second_q15: vec3<i32>, bits: u32) -> u32
{
    let z_q15 = min(abs(first_q15.z), 32767);
    let inverse_q14 = i32(rsqrt(u32(32768 + z_q15) << 15u) >> 16u);
    var xy_q15 = (select(1, -1, first_q15.z < 0) * first_q15.xy * inverse_q14 + 16384) >> vec2<u32>(15u);
    var axes: Axes;
    if (!axes_of(&axes, xy_q15.x, xy_q15.y)) {
        xy_q15 -= xy_q15 >> vec2<u32>(10u);
        if (!axes_of(&axes, xy_q15.x, xy_q15.y)) {
            return 0u;
        }
    }
    let roll = select(32u, 23u, object.profile == SMALL) - 2u * bits;
    return rotation_word(xy_q15.x, xy_q15.y, roll_of(&axes, second_q15), bits, roll);
}

fn turned_word(word: u32, bits: u32, turn_q15: vec4<i32>) -> u32
{
    var axes: Axes;
    if (!read_axes(&axes, word, bits)) {
        return word;
    }
    let second_q15 = (axes.side_x_q15 * axes.cos_q15 + axes.side_y_q15 * axes.sin_q15 + 16384) >> vec3<u32>(15u);
    return write_axes(turned(axes.axis_q15, turn_q15), turned(second_q15, turn_q15), bits);
}

fn faded(code: u32, row: u32, g: u32, u_q15: i32) -> u32
{
    let distance_q13 = u32(abs(((u_q15 + 2) >> 2u) - motion_code(row, g)));
    let width = half_of(scene[row + ROW + g / 2u], g);
    let product_q13 = (distance_q13 * u32(exp2_q15(i32(width & 4095u) << 3u))) >> 15u;
    let octaves = width >> 12u;
    let widths_q13 = (product_q13 << (8u - min(octaves, 8u))) >> (max(octaves, 8u) - 8u);
    let widths_q12 = min(widths_q13, 32766u) >> 1u;
    let octaves_q16 = (widths_q12 * widths_q12) >> 8u;
    if (octaves_q16 > object.motion_cut_q16) {
        return 0u;
    }
    let left_q15 = u32(exp2_q15(i32((octaves_q16 & 65535u) >> 1u))) >> (octaves_q16 >> 16u);
    return (code * left_q15 + 16384u) >> 15u;
}

// Returns the codes of a Gaussian at a moment: x, y; z, opacity; rotation word.
fn animated(rows: u32, g: u32, moment: Moment, scale_step_q24: u32) -> vec4<u32>
{
    let codes = codes_of(rows, g);
    var row = rows + object.motion_at;
    var position = drifted(codes.position, row, g, moment);
    var rotation = codes.rotation;
    var opacity = codes.colour >> 24u;
    row += 3u * ROW * object.motion_degree;
    if (object.profile == SMALL) {
        position = vec3<u32>(spread_11(position.x >> 5u), spread_11(position.y >> 5u), spread_11(position.z >> 5u));
    }
    if ((object.motion_flags & MOTION_TURNS) != 0u) {
        let bits = axis_bits(falls_of(codes.scale, scale_step_q24));
        rotation = turned_word(rotation, bits, turn_at(row, g, moment.power_q15.x));
        row += 4u * ROW;
    }
    if ((object.motion_flags & MOTION_FADES) != 0u) {
        opacity = faded(opacity, row, g, moment.power_q15.x);
    }
    return vec4<u32>(position.x | (position.y << 16u), position.z | (opacity << 16u), rotation, 0u);
}
