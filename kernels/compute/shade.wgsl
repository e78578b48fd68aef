// Decodes Gaussians and computes their colours from spherical harmonics (SH), with the arithmetic of src/core/shade.c.

const COMPACT: u32 = 1u;
const SMALL: u32 = 2u;

struct Codes {
    position: vec3<u32>,
    rotation: u32,
    scale: u32,
    colour: u32,
}

fn byte_at(byte: u32) -> u32
{
    return (scene[byte / 4u] >> (8u * (byte % 4u))) & 255u;
}

fn spread_11(code: u32) -> u32
{
    return (code << 5u) | (code >> 6u);
}

fn spread_scale(x: u32, y: u32, z: u32) -> u32
{
    return ((x << 3u) | (x >> 4u)) | (((y << 3u) | (y >> 4u)) << 10u) | (((z << 3u) | (z >> 3u)) << 20u);
}

fn small_codes(rows: u32, g: u32) -> Codes
{
    let a = scene[rows + g];
    let b = scene[rows + CHUNK + g];
    let c = scene[rows + 2u * CHUNK + g];
    let d = byte_at(4u * rows + 12u * CHUNK + g);
    let red = (b >> 11u) & 127u;
    let green = (b >> 18u) & 127u;
    let blue = (b >> 25u) & 63u;
    return Codes(vec3<u32>(spread_11(a & 2047u), spread_11((a >> 11u) & 2047u), spread_11(b & 2047u)),
                 (c & 0xfff00000u) | (d << 12u) | (((a >> 22u) & 3u) << 10u) | ((b >> 31u) << 9u),
                 spread_scale(c & 127u, (c >> 7u) & 127u, (c >> 14u) & 63u) |
                 (((red >> 5u) & 1u) << 29u) | (((green >> 5u) & 1u) << 30u) | (((blue >> 3u) & 1u) << 31u),
                 ((red << 1u) | (red >> 6u)) | (((green << 1u) | (green >> 6u)) << 8u) |
                 (((blue << 2u) | (blue >> 4u)) << 16u) | (a & 0xff000000u));
}

fn codes_of(rows: u32, g: u32) -> Codes
{
    if (object.profile == SMALL) {
        return small_codes(rows, g);
    }
    let half = rows + g / 2u;
    return Codes(vec3<u32>(half_of(scene[half], g), half_of(scene[half + 128u], g), half_of(scene[half + 256u], g)),
                 scene[rows + 384u + g], scene[rows + 640u + g], scene[rows + 896u + g]);
}

fn from_eye(i: u32, position: u32) -> wide
{
    return add_wide(wide_at(22u + 2u * i), shift_left(mul_wide(record[34u + i], position), record[37]));
}

fn unit_q15(x: i32, zeros: u32, inverse_q30: u32) -> i32
{
    return clamp(low_of(round_shift(mul_mixed(x * (1 << (zeros / 2u)), inverse_q30), 31)), -32767, 32767);
}

fn direction_q15(position: vec3<u32>) -> vec3<i32>
{
    let x = from_eye(0u, position.x);
    let y = from_eye(1u, position.y);
    let z = from_eye(2u, position.z);
    let most = magnitude(x) | magnitude(y) | magnitude(z) | wide(1u, 0u);
    let shift = u32(max(49 - zeros_of_wide(most), 0));
    let d = vec3<i32>(low_of(shift_signed(x, shift)), low_of(shift_signed(y, shift)), low_of(shift_signed(z, shift)));
    let square = max(u32(d.x * d.x) + u32(d.y * d.y) + u32(d.z * d.z), 1u);
    let zeros = u32(zeros_of(square)) & ~1u;
    let inverse_q30 = rsqrt(square << zeros);
    return vec3<i32>(unit_q15(d.x, zeros, inverse_q30), unit_q15(d.y, zeros, inverse_q30),
                     unit_q15(d.z, zeros, inverse_q30));
}

// Values of the SH basis functions 1 to 15, and a zero as padding. Functions above the evaluated degree are zero.
struct Basis {
    a: vec4<i32>,
    b: vec4<i32>,
    c: vec4<i32>,
    d: vec4<i32>,
}

fn basis_of(d: vec3<i32>, degree: i32) -> Basis
{
    let x = d.x;
    let y = d.y;
    let z = d.z;
    var b: Basis;
    b.a = vec4<i32>(fxs_mul_q15(-16011, y), fxs_mul_q15(16011, z), fxs_mul_q15(-16011, x), 0);
    if (degree < 2) {
        return b;
    }
    let xx = fxs_mul_q15(x, x);
    let yy = fxs_mul_q15(y, y);
    let zz = fxs_mul_q15(z, z);
    let xy = fxs_mul_q15(x, y);
    let yz = fxs_mul_q15(y, z);
    let xz = fxs_mul_q15(x, z);
    b.a.w = 2 * fxs_mul_q15(17900, xy);
    b.b = vec4<i32>(-2 * fxs_mul_q15(17900, yz), fxs_mul_q15(10335, 2 * zz - xx - yy), -2 * fxs_mul_q15(17900, xz),
                    fxs_mul_q15(17900, xx - yy));
    if (degree < 3) {
        return b;
    }
    b.c = vec4<i32>(-2 * fxs_mul_q15(fxs_mul_q15(19335, y), divide_by(3 * xx - yy, 1u)),
                    4 * fxs_mul_q15(fxs_mul_q15(23680, xy), z),
                    -4 * fxs_mul_q15(fxs_mul_q15(14976, y), divide_by(4 * zz - xx - yy, 2u)),
                    4 * fxs_mul_q15(fxs_mul_q15(12228, z), divide_by(2 * zz - 3 * xx - 3 * yy, 2u)));
    b.d = vec4<i32>(-4 * fxs_mul_q15(fxs_mul_q15(14976, x), divide_by(4 * zz - xx - yy, 2u)),
                    2 * fxs_mul_q15(fxs_mul_q15(23680, z), xx - yy),
                    -2 * fxs_mul_q15(fxs_mul_q15(19335, x), divide_by(xx - 3 * yy, 1u)), 0);
    return b;
}

// Returns SH coefficient k of red, green and blue.
fn sh_of(at: u32, k: u32) -> vec3<i32>
{
    let word = (at + 3u * k * CHUNK) / 4u;
    let up = vec3<u32>(24u - 8u * (at % 4u));
    let words = vec3<u32>(scene[word], scene[word + CHUNK / 4u], scene[word + CHUNK / 2u]);
    return bitcast<vec3<i32>>(words << up) >> vec3<u32>(24u);
}

fn band_sum_q16(band_q15: vec3<i32>, step_q19: i32) -> vec3<i32>
{
    return (((band_q15 + 512) >> vec3<u32>(10u)) * step_q19 + 128) >> vec3<u32>(8u);
}

fn bands_q16(b: Basis, rows: u32, g: u32) -> vec3<i32>
{
    let at = 4u * rows + 18u * CHUNK + g;
    var sum = band_sum_q16(b.a.x * sh_of(at, 0u) + b.a.y * sh_of(at, 1u) + b.a.z * sh_of(at, 2u), number_at(44u));
    if (object.degree > 1) {
        sum += band_sum_q16(b.a.w * sh_of(at, 3u) + b.b.x * sh_of(at, 4u) + b.b.y * sh_of(at, 5u) +
                            b.b.z * sh_of(at, 6u) + b.b.w * sh_of(at, 7u), number_at(45u));
    }
    if (object.degree > 2) {
        sum += band_sum_q16(b.c.x * sh_of(at, 8u) + b.c.y * sh_of(at, 9u) + b.c.z * sh_of(at, 10u) +
                            b.c.w * sh_of(at, 11u) + b.d.x * sh_of(at, 12u) + b.d.y * sh_of(at, 13u) +
                            b.d.z * sh_of(at, 14u), number_at(46u));
    }
    return sum;
}

fn dot_of(b: vec4<i32>, word: u32) -> i32
{
    let bytes = bitcast<vec4<i32>>(vec4<u32>(word) << vec4<u32>(24u, 16u, 8u, 0u)) >> vec4<u32>(24u);
    return b.x * bytes.x + b.y * bytes.y + b.z * bytes.z + b.w * bytes.w;
}

fn dot_16(b: Basis, a: u32, c: u32, d: u32, e: u32) -> i32
{
    return dot_of(b.a, a) + dot_of(b.b, c) + dot_of(b.c, d) + dot_of(b.d, e);
}

fn mean_dot(b: Basis, channel: u32) -> i32
{
    let at = 48u + 4u * channel;
    return dot_16(b, record[at], record[at + 1u], record[at + 2u], record[at + 3u]);
}

fn entry_dot(b: Basis, at: u32) -> i32
{
    return dot_16(b, scene[at], scene[at + 1u], scene[at + 2u], scene[at + 3u]);
}

fn entry_sum(b: Basis, stage: u32, code: u32) -> vec3<i32>
{
    let index = min(code & 127u, object.palette_entries - 1u);
    let at = 12u * (stage * object.palette_entries + index);
    return select(1, -1, (code & 128u) != 0u) *
           vec3<i32>(entry_dot(b, at), entry_dot(b, at + 4u), entry_dot(b, at + 8u));
}

fn bits_at(byte: u32, bit: u32) -> u32
{
    let at = byte + bit / 8u;
    let shift = 8u * (at % 4u) + bit % 8u;
    let low = scene[at / 4u] >> shift;
    if (shift == 0u) {
        return low;
    }
    return low | (scene[at / 4u + 1u] << (32u - shift));
}

// Returns the dot product of four SH basis values with the numbers 2 c + 1, for four signed 3-bit codes c.
fn odd_dot(b: vec4<i32>, bits: u32) -> i32
{
    let code = vec4<i32>(((vec4<u32>(bits) >> vec4<u32>(0u, 3u, 6u, 9u)) & vec4<u32>(7u)) ^ vec4<u32>(4u));
    let odd = 2 * code - 7;
    return b.x * odd.x + b.y * odd.y + b.z * odd.z + b.w * odd.w;
}

fn residual_q16(b: Basis, record_at: u32, channel: u32, gain: u32) -> i32
{
    let first = 32u + 3u * channel * sh_count(object.scene_degree);
    let low = bits_at(record_at, first);
    let high = bits_at(record_at, first + 24u);
    let odd = odd_dot(b.a, low) + odd_dot(b.b, low >> 12u) + odd_dot(b.c, high) + odd_dot(b.d, high >> 12u);
    return (odd * i32(8u + (gain & 7u))) >> (31u - (gain >> 3u));
}

fn sh_count(degree: i32) -> u32
{
    return u32((degree + 1) * (degree + 1) - 1);
}

fn scaled_q16(sum: i32) -> i32
{
    return low_of(shift_signed(mul_signed(sum, object.palette_step_q19), 18u));
}

fn palette_q16(b: Basis, rows: u32, g: u32) -> vec3<i32>
{
    let degree = object.scene_degree;
    let compact = object.profile == COMPACT;
    var stages = select(6u, 4u, degree == 1);
    var bytes = stages;
    var at = 4u * rows + 13u * CHUNK;
    if (compact) {
        stages = 3u;
        bytes = select(select(21u, 13u, degree == 2), 8u, degree == 1);
        at = 4u * rows + 18u * CHUNK;
    }
    at += g * bytes;
    var sum = vec3<i32>(mean_dot(b, 0u), mean_dot(b, 1u), mean_dot(b, 2u));
    for (var stage = 0u; stage < stages; stage += 1u) {
        sum += entry_sum(b, stage, byte_at(at + stage));
    }
    var out = vec3<i32>(scaled_q16(sum.x), scaled_q16(sum.y), scaled_q16(sum.z));
    if (compact) {
        let gain = byte_at(at + 3u);
        out += vec3<i32>(residual_q16(b, at, 0u, gain), residual_q16(b, at, 1u, gain), residual_q16(b, at, 2u, gain));
    }
    return out;
}

fn shade(rows: u32, g: u32, codes: Codes) -> vec3<i32>
{
    let upper = (vec3<u32>(codes.colour) >> vec3<u32>(0u, 8u, 16u)) & vec3<u32>(255u);
    let code = (upper << vec3<u32>(1u)) | ((vec3<u32>(codes.scale) >> vec3<u32>(29u, 30u, 31u)) & vec3<u32>(1u));
    let step = vec3<u32>(record[41], record[42], record[43]) * code;
    var sum_q16 = vec3<i32>(number_at(38u), number_at(39u), number_at(40u)) +
                  vec3<i32>((step + 8u) >> vec3<u32>(4u));
    if (object.degree > 0) {
        let b = basis_of(direction_q15(codes.position), object.degree);
        if (object.palette_entries != 0u) {
            sum_q16 += palette_q16(b, rows, g);
        } else {
            sum_q16 += bands_q16(b, rows, g);
        }
    }
    return clamp((sum_q16 + 4) >> vec3<u32>(3u), vec3<i32>(0), vec3<i32>(32767));
}
