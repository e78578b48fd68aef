// shade: src/core/shade.c, a thread a Gaussian; and its codes, src/core/codes.h.

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

fn signed_byte_of(word: u32, i: u32) -> i32
{
    return bitcast<i32>(word << (24u - 8u * i)) >> 24u;
}

fn spread_11(code: u32) -> u32
{
    return (code << 5u) | (code >> 6u);
}

fn spread_scale(x: u32, y: u32, z: u32, bits: u32) -> u32
{
    return ((x << 3u) | (x >> 4u)) | (((y << 3u) | (y >> 4u)) << 10u) |
           (((z << (10u - bits)) | (z >> (2u * bits - 10u))) << 20u);
}

fn small_codes(rows: u32, g: u32) -> Codes
{
    let a = scene[rows + g];
    let b = scene[rows + CHUNK + g];
    let c = scene[rows + 2u * CHUNK + g];
    let d = byte_at(4u * rows + 12u * CHUNK + g);
    let q1 = (c >> 27u) | ((b >> 31u) << 5u) | ((d >> 7u) << 6u);
    let red = (b >> 11u) & 127u;
    let green = (b >> 18u) & 127u;
    let blue = (b >> 25u) & 63u;
    return Codes(vec3<u32>(spread_11(a & 2047u), spread_11((a >> 11u) & 2047u), spread_11(b & 2047u)),
                 spread_scale(d & 127u, q1, (c >> 20u) & 127u, 7u) | (((a >> 22u) & 3u) << 30u),
                 spread_scale(c & 127u, (c >> 7u) & 127u, (c >> 14u) & 63u, 6u),
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

fn q15_direction(record: u32, position: vec3<u32>) -> vec3<i32>
{
    var offset_q32: array<wide, 3>;
    var most = wide(1u, 0u);
    for (var i = 0u; i < 3u; i += 1u) {
        let reach = shift_left(mul_wide(memory[record + 34u + i], position[i]), memory[record + 37u]);
        offset_q32[i] = add_wide(wide_at(record + 22u + 2u * i), reach);
        most |= magnitude(offset_q32[i]);
    }
    let shift = u32(max(49 - zeros_of_wide(most), 0));
    var d: vec3<i32>;
    for (var i = 0u; i < 3u; i += 1u) {
        d[i] = low_of(shift_signed(offset_q32[i], shift));
    }
    let square = max(u32(d.x * d.x) + u32(d.y * d.y) + u32(d.z * d.z), 1u);
    let zeros = u32(zeros_of(square)) & ~1u;
    let inverse_q30 = rsqrt(square << zeros);
    var out: vec3<i32>;
    for (var i = 0u; i < 3u; i += 1u) {
        let x = round_shift(mul_mixed(d[i] * (1 << (zeros / 2u)), inverse_q30), 31);
        out[i] = clamp(low_of(x), -32767, 32767);
    }
    return out;
}

fn basis(b: ptr<function, array<i32, 15>>, d: vec3<i32>, degree: i32)
{
    let x = d.x;
    let y = d.y;
    let z = d.z;
    (*b)[0] = fxs_mul_q15(-16011, y);
    (*b)[1] = fxs_mul_q15(16011, z);
    (*b)[2] = fxs_mul_q15(-16011, x);
    if (degree < 2) {
        return;
    }
    let xx = fxs_mul_q15(x, x);
    let yy = fxs_mul_q15(y, y);
    let zz = fxs_mul_q15(z, z);
    let xy = fxs_mul_q15(x, y);
    let yz = fxs_mul_q15(y, z);
    let xz = fxs_mul_q15(x, z);
    (*b)[3] = 2 * fxs_mul_q15(17900, xy);
    (*b)[4] = -2 * fxs_mul_q15(17900, yz);
    (*b)[5] = fxs_mul_q15(10335, 2 * zz - xx - yy);
    (*b)[6] = -2 * fxs_mul_q15(17900, xz);
    (*b)[7] = fxs_mul_q15(17900, xx - yy);
    if (degree < 3) {
        return;
    }
    (*b)[8] = -2 * fxs_mul_q15(fxs_mul_q15(19335, y), divide_by(3 * xx - yy, 1u));
    (*b)[9] = 4 * fxs_mul_q15(fxs_mul_q15(23680, xy), z);
    (*b)[10] = -4 * fxs_mul_q15(fxs_mul_q15(14976, y), divide_by(4 * zz - xx - yy, 2u));
    (*b)[11] = 4 * fxs_mul_q15(fxs_mul_q15(12228, z), divide_by(2 * zz - 3 * xx - 3 * yy, 2u));
    (*b)[12] = -4 * fxs_mul_q15(fxs_mul_q15(14976, x), divide_by(4 * zz - xx - yy, 2u));
    (*b)[13] = 2 * fxs_mul_q15(fxs_mul_q15(23680, z), xx - yy);
    (*b)[14] = -2 * fxs_mul_q15(fxs_mul_q15(19335, x), divide_by(xx - 3 * yy, 1u));
}

fn sh_count(degree: i32) -> u32
{
    return u32((degree + 1) * (degree + 1) - 1);
}

fn add_bands(sum_q16: ptr<function, vec3<i32>>, b: ptr<function, array<i32, 15>>, record: u32, rows: u32, g: u32)
{
    let at = 4u * rows + 18u * CHUNK + g;
    for (var d = 1; d <= object.degree; d += 1) {
        var band_q15 = vec3<i32>(0);
        for (var k = sh_count(d - 1); k < sh_count(d); k += 1u) {
            for (var c = 0u; c < 3u; c += 1u) {
                let byte = at + (3u * k + c) * CHUNK;
                band_q15[c] += (*b)[k] * signed_byte_of(scene[byte / 4u], byte % 4u);
            }
        }
        let step_q19 = number_at(record + 43u + u32(d));
        *sum_q16 += (((band_q15 + 512) >> vec3<u32>(10u)) * step_q19 + 128) >> vec3<u32>(8u);
    }
}

// Three channels of 16 numbers, 12 words: of the chunk's mean (record), or an entry of the palette.
fn dot_16(b: ptr<function, array<i32, 15>>, words: vec4<u32>) -> i32
{
    var sum = 0;
    for (var k = 0u; k < 15u; k += 1u) {
        sum += (*b)[k] * signed_byte_of(words[k / 4u], k % 4u);
    }
    return sum;
}

fn add_mean(sum: ptr<function, vec3<i32>>, b: ptr<function, array<i32, 15>>, record: u32)
{
    for (var c = 0u; c < 3u; c += 1u) {
        let at = record + 48u + 4u * c;
        (*sum)[c] += dot_16(b, vec4<u32>(memory[at], memory[at + 1u], memory[at + 2u], memory[at + 3u]));
    }
}

fn add_entry(sum: ptr<function, vec3<i32>>, b: ptr<function, array<i32, 15>>, stage: u32, code: u32)
{
    let index = min(code & 127u, object.palette_entries - 1u);
    let sign = select(1, -1, (code & 128u) != 0u);
    for (var c = 0u; c < 3u; c += 1u) {
        let at = 12u * (stage * object.palette_entries + index) + 4u * c;
        (*sum)[c] += sign * dot_16(b, vec4<u32>(scene[at], scene[at + 1u], scene[at + 2u], scene[at + 3u]));
    }
}

// Three bits, from this one of the scene's on.
fn code_at(byte: u32, bit: u32) -> i32
{
    let at = byte + bit / 8u;
    let shift = 8u * (at % 4u) + bit % 8u;
    var code = scene[at / 4u] >> shift;
    if (shift > 29u) {
        code |= scene[at / 4u + 1u] << (32u - shift);
    }
    return i32((code & 7u) ^ 4u);
}

fn palette_sum_q16(b: ptr<function, array<i32, 15>>, record: u32, rows: u32, g: u32) -> vec3<i32>
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
    var sum = vec3<i32>(0);
    add_mean(&sum, b, record);
    for (var stage = 0u; stage < stages; stage += 1u) {
        add_entry(&sum, b, stage, byte_at(at + stage));
    }
    var out: vec3<i32>;
    for (var c = 0u; c < 3u; c += 1u) {
        out[c] = low_of(shift_signed(mul_signed(sum[c], object.palette_step_q19), 18u));
    }
    if (compact) {
        let gain = byte_at(at + 3u);
        for (var c = 0u; c < 3u; c += 1u) {
            var odd = 0;
            for (var k = 0u; k < sh_count(degree); k += 1u) {
                odd += (*b)[k] * (2 * code_at(at, 32u + 3u * (c * sh_count(degree) + k)) - 7);
            }
            let shift = 31u - (gain >> 3u);
            out[c] += (odd * i32(8u + (gain & 7u))) >> shift;
        }
    }
    return out;
}

fn shade(record: u32, rows: u32, g: u32, codes: Codes) -> vec3<i32>
{
    var sum_q16: vec3<i32>;
    for (var c = 0u; c < 3u; c += 1u) {
        let step = memory[record + 41u + c] * ((codes.colour >> (8u * c)) & 255u);
        sum_q16[c] = number_at(record + 38u + c) + i32((step + 8u) >> 4u);
    }
    if (object.degree > 0) {
        var b: array<i32, 15>;
        basis(&b, q15_direction(record, codes.position), object.degree);
        if (object.palette_entries != 0u) {
            sum_q16 += palette_sum_q16(&b, record, rows, g);
        } else {
            add_bands(&sum_q16, &b, record, rows, g);
        }
    }
    return clamp((sum_q16 + 4) >> vec3<u32>(3u), vec3<i32>(0), vec3<i32>(32767));
}
