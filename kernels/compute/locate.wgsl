// Transforms the bounding boxes of chunks of 256 Gaussians to camera space and culls chunks.
// Needs numbers records crop

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> object: Object;
@group(1) @binding(0) var<storage, read> scene: array<u32>;
@group(1) @binding(1) var<storage, read_write> memory: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;

var<workgroup> seen_bits: array<atomic<u32>, 4>;

const LIMIT_Q32: wide = wide(0u, 0x10000000u);

fn is_within(x: wide, most: wide) -> bool
{
    return !less(most, x) && !less(x, negate(most));
}

fn origin_of(at: u32, i: u32) -> wide
{
    return wide(scene[at + 2u * i], scene[at + 2u * i + 1u]);
}

fn step_shift_of(at: u32) -> u32
{
    return scene[at + 18u] >> 16u;
}

// Returns the largest distance along axis i between a Gaussian's centre and its chunk's origin, below 2^60.
fn reach_of(at: u32, i: u32) -> wide
{
    return shift_left(mul_wide(scene[at + 6u + i], 65535u), step_shift_of(at));
}

fn is_valid(at: u32) -> bool
{
    let codes = scene[at + 19u];
    let scale_q16 = bitcast<i32>(scene[at + 9u]);
    if (step_shift_of(at) > 12u || codes >> 16u >= 4u || abs(scale_q16) > 32 << 16u) {
        return false;
    }
    let scale_reach = low_of(shift_right(mul_wide(codes & 0xffffu, 1046529u), 8u));
    var valid = scale_q16 - scale_reach >= -(32 << 16u);
    for (var i = 0u; i < 3u; i += 1u) {
        let colour = wide_of(bitcast<i32>(scene[at + 10u + i]));
        let colour_reach = shift_right(mul_wide(scene[at + 13u + i], 255u), 4u);
        let sh_step = half_of(scene[at + 17u + i / 2u], i);
        valid = valid && is_within(origin_of(at, i), LIMIT_Q32) &&
                is_within(add_wide(origin_of(at, i), reach_of(at, i)), LIMIT_Q32) &&
                is_within(colour, wide(64u << 16u, 0u)) &&
                is_within(add_wide(colour, colour_reach), wide(64u << 16u, 0u)) && sh_step <= 32767u;
    }
    return valid;
}

struct Located {
    base_q16: array<wide, 3>,
    m_q16: array<i32, 9>,
    scale_q16: i32,
    shift: i32,
    plane_zeros: i32,
    near: i32,
}

fn locate(at: u32) -> Located
{
    var l: Located;
    var offset: array<wide, 3>;
    var most = wide(0u, 0u);
    for (var i = 0u; i < 3u; i += 1u) {
        offset[i] = sub_wide(origin_of(at, i), object.position_q32[i].xy);
        most |= add_wide(magnitude(offset[i]), reach_of(at, i));
    }
    let bits = select(0, 64 - zeros_of_wide(most), (most.x | most.y) != 0u);
    l.scale_q16 = bitcast<i32>(scene[at + 9u]);
    l.shift = max(bits - 29, 0);
    l.plane_zeros = clamp(l.shift - object.plane_exponent, -22, 38);
    let near = shift_signed(object.near_q32, u32(l.shift));
    l.near = select(0x7fffffff, low_of(near), near.y == 0u && low_of(near) >= 0);
    for (var i = 0u; i < 3u; i += 1u) {
        var base_q30 = wide(0u, 0u);
        for (var j = 0u; j < 3u; j += 1u) {
            let r_q30 = object.rotation_q30[i][j];
            base_q30 = add_wide(base_q30, mul_signed(r_q30, low_of(shift_signed(offset[j], u32(l.shift)))));
            let m = shift_signed(mul_mixed(r_q30, scene[at + 6u + j]), 14u);
            l.m_q16[3u * i + j] = low_of(shift_signed(shift_left(m, step_shift_of(at)), u32(l.shift)));
        }
        l.base_q16[i] = shift_signed(base_q30, 14u);
    }
    return l;
}

// Returns an upper bound of how far a chunk's Gaussians extend sideways from their centres, in camera units.
fn reach_across(l: ptr<function, Located>) -> wide
{
    let log2_q16 = (*l).scale_q16 + (32 - (*l).shift + object.jacobian_exponent) * 65536;
    let whole = -(-log2_q16 >> 16u);
    if (whole > 40) {
        return wide(0xffffffffu, 0x1fffffffu);
    }
    if (whole < 0) {
        return wide(4u, 0u);
    }
    let size_q15 = u32(exp2_q15((-log2_q16 & 65535) >> 1u));
    let size = shift_right(shift_left(wide(size_q15, 0u), u32(whole)), 15u);
    return add_wide(shift_right(mul_word(size, 7u), 1u), wide(4u, 0u));
}

// Returns the maximum of sign * c - slope * depth over a chunk's bounding box, where c is camera coordinate i.
fn farthest(l: ptr<function, Located>, i: u32, sign: i32, slope_q23: i32) -> wide
{
    let shift = 32 - 23 - (*l).plane_zeros;
    let z = low_of(shift_signed((*l).base_q16[2], 16u));
    var across = shift_signed(mul_signed(slope_q23, z), 23u);
    var slope_of_z_q23 = slope_q23;
    if (object.orthographic != 0) {
        across = shift_left(wide_of(slope_q23), u32(max(shift, 0)));
        if (shift < 0) {
            across = shift_signed(wide_of(slope_q23), u32(-shift));
        }
        slope_of_z_q23 = 0;
    }
    let axis = sign * low_of(shift_signed((*l).base_q16[i], 16u)) + 2;
    var sum = sub_wide(wide_of(axis), across);
    for (var j = 0u; j < 3u; j += 1u) {
        let m_q16 = sub_wide(wide_of(sign * (*l).m_q16[3u * i + j]),
                             shift_signed(mul_signed(slope_of_z_q23, (*l).m_q16[6u + j]), 23u));
        if (less(wide(0u, 0u), m_q16)) {
            let most = shift_right(sub_wide(shift_left(m_q16, 16u), m_q16), 16u);
            sum = add_wide(sum, add_wide(most, wide(1u, 0u)));
        }
    }
    return sum;
}

fn lies_beyond(l: ptr<function, Located>, i: u32, sign: i32, slope_q23: i32, reach: wide) -> bool
{
    return is_negative(add_wide(farthest(l, i, sign, slope_q23), reach));
}

fn can_be_seen(l: ptr<function, Located>) -> bool
{
    var z_q16 = (*l).base_q16[2];
    for (var j = 6u; j < 9u; j += 1u) {
        z_q16 = add_wide(z_q16, mul_signed(max((*l).m_q16[j], 0), 65535));
    }
    if (!less(wide_of((*l).near), shift_signed(z_q16, 16u))) {
        return false;
    }
    if (frame.cutoff == 1) {
        return true;
    }
    let reach = reach_across(l);
    for (var i = 0u; i < 2u; i += 1u) {
        if (lies_beyond(l, i, 1, object.edge_low_q23[i], reach) ||
            lies_beyond(l, i, -1, -object.edge_high_q23[i], reach)) {
            return false;
        }
    }
    return true;
}

fn has_chunk(at: u32) -> bool
{
    var low: array<wide, 3>;
    var high: array<wide, 3>;
    for (var i = 0u; i < 3u; i += 1u) {
        low[i] = origin_of(at, i);
        high[i] = add_wide(low[i], reach_of(at, i));
    }
    return object.crop_count == 0u || is_within_crops(&low, &high);
}

fn put_wide(at: u32, x: wide)
{
    memory[at] = x.x;
    memory[at + 1u] = x.y;
}

fn put_record(to: u32, at: u32, l: ptr<function, Located>, share_q8: u32)
{
    let plane_side = select(0x7fffffff, 1 << u32(38 - min((*l).plane_zeros, 38)), (*l).plane_zeros > 7);
    for (var i = 0u; i < 3u; i += 1u) {
        put_wide(to + 2u * i, (*l).base_q16[i]);
        put_wide(to + 22u + 2u * i, sub_wide(origin_of(at, i), object.eye_q32[i].xy));
        put_wide(to + 28u + 2u * i, origin_of(at, i));
        memory[to + 34u + i] = scene[at + 6u + i];
        memory[to + 38u + i] = scene[at + 10u + i];
        memory[to + 41u + i] = scene[at + 13u + i];
        memory[to + 44u + i] = half_of(scene[at + 17u + i / 2u], i);
    }
    for (var i = 0u; i < 9u; i += 1u) {
        memory[to + 6u + i] = bitcast<u32>((*l).m_q16[i]);
    }
    memory[to + 15u] = bitcast<u32>((*l).scale_q16);
    memory[to + 16u] = scene[at + 19u] & 0xffffu;
    memory[to + 17u] = scene[at + 19u] >> 16u;
    memory[to + 18u] = u32((*l).shift);
    memory[to + 19u] = bitcast<u32>((*l).plane_zeros);
    memory[to + 20u] = bitcast<u32>(plane_side);
    memory[to + 21u] = bitcast<u32>((*l).near);
    memory[to + 37u] = step_shift_of(at);
    memory[to + 47u] = share_q8;
    for (var i = 0u; i < 12u; i += 1u) {
        memory[to + 48u + i] = scene[at + 20u + i];
    }
}

fn look_at(place: u32) -> bool
{
    var index = place - object.first_chunk;
    // low half: share of the chunk's optical depth that is drawn, Q8; high half: growth of its sigmas, log2
    var drawn = 256u;
    if (frame.drawn != 0u) {
        index = memory[frame.drawn + DRAWN * place];
        drawn = memory[frame.drawn + DRAWN * place + 1u];
    }
    let at = 32u * index;
    if (!is_valid(at)) {
        atomicStore(&counts[DAMAGED], 1u);
        return false;
    }
    var l = locate(at);
    l.scale_q16 += i32(drawn >> 16u) << 8u;
    if (!can_be_seen(&l) || !has_chunk(at)) {
        return false;
    }
    put_record(frame.records + RECORD * place, at, &l, drawn & 0xffffu);
    return true;
}

// Marks the visible chunks, one bit per chunk. An atomic OR is needed, because chunks of two objects may share a word.
@compute @workgroup_size(128)
fn locate_chunks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let place = object.first_place / 32u * 32u + (group.y * ROW_OF_GROUPS + group.x) * THREADS + thread;
    let inside = place >= object.first_place && place < object.end_place;
    if (thread < 4u) {
        atomicStore(&seen_bits[thread], 0u);
    }
    workgroupBarrier();
    if (inside) {
        if (look_at(place)) {
            atomicOr(&seen_bits[thread / 32u], 1u << (thread % 32u));
        }
    }
    workgroupBarrier();
    if (thread < 4u) {
        let bits = atomicLoad(&seen_bits[thread]);
        if (bits != 0u) {
            atomicOr(&counts[frame.seen + (place - thread) / 32u + thread], bits);
        }
    }
}
