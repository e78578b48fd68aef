// Blends splats and also writes depths and ids. An occluder hides the splats behind it.
// Needs pixel numbers records order pixels

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read> entries: array<u32>;
@group(1) @binding(2) var<storage, read> splats: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read_write> memory: array<u32>;

var<workgroup> own: array<vec2<u32>, 32>;

const HALF_Q15: i32 = 16384;

struct Traced {
    limit: u32,                    // depth key (depth as a sortable code) of the occluder; farther splats are hidden
    weight: i32,                   // largest weight of any splat so far
    largest: u32,
    median: u32,                   // depth key of the splat that takes the transmittance below 1/2
    sum: wide,                     // sum of weight * depth of the pixel's splats
}

fn key_of(depth: u32) -> u32
{
    let zeros = zeros_of(depth | 1u);
    if (depth == NOTHING || depth == 0u) {
        return depth;
    }
    return (u32(63 - zeros - frame.depth_bits) << 26u) | (((depth << u32(zeros)) >> 5u) & 0x3ffffffu);
}

fn depth_of_key(key: u32) -> u32
{
    let shift = i32(key >> 26u) - 32 + frame.depth_bits - 26;
    let mantissa = 0x4000000u | (key & 0x3ffffffu);
    if (shift > 5) {
        return NOTHING - 1u;
    }
    if (shift >= 0) {
        return mantissa << u32(shift);
    }
    if (shift > -32) {
        return mantissa >> u32(-shift);
    }
    return 0u;
}

fn depth_sum(weight: i32, key: u32) -> wide
{
    let code_q15 = min(i32(((key & 0x3ffffffu) + 1024u) >> 11u), 32767);
    let shift = min(i32(key >> 26u) - 32 + frame.depth_bits, 32) + 8;
    if (shift < 0) {
        return wide(0u, 0u);
    }
    return shift_left(wide(u32(weight + fxs_mul_q15(weight, code_q15)), 0u), u32(shift));
}

// Returns the mean depth of a pixel: the sum of weight * depth over the sum of the weights, rounded. `sum` has 8 extra
// fraction bits. Long division in 16-bit digits, because the weight has 15 bits.
fn mean_depth(sum: wide, transmittance: i32) -> u32
{
    let weight = u32(FXS_CLEAR_Q15 - transmittance);
    if (weight == 0u) {
        return NOTHING;
    }
    let dividend = shift_right(add_wide(sum, wide(weight << 7u, 0u)), 8u);
    let a = (dividend.y >> 16u) % weight;
    let b = (a << 16u) | (dividend.y & 0xffffu);
    let c = ((b % weight) << 16u) | (dividend.x >> 16u);
    let d = ((c % weight) << 16u) | (dividend.x & 0xffffu);
    if (dividend.y >= weight) {
        return NOTHING - 1u;
    }
    return min(((c / weight) << 16u) | (d / weight), NOTHING - 1u);
}

fn note(t: ptr<function, Traced>, before: i32, weight: i32, key: u32, slot: u32)
{
    (*t).sum = add_wide((*t).sum, depth_sum(weight, key));
    if (before >= HALF_Q15) {
        (*t).median = key;
    }
    if (weight > (*t).weight) {
        (*t).weight = weight;
        (*t).largest = slot;
    }
}

fn put_traces(t: ptr<function, Traced>, transmittance: i32, at: u32)
{
    if (frame.mean_depth != NOTHING) {
        memory[frame.mean_depth + at] = mean_depth((*t).sum, transmittance);
    }
    if (frame.median_depth != NOTHING) {
        memory[frame.median_depth + at] = select(depth_of_key((*t).median), NOTHING, transmittance >= HALF_Q15);
    }
    if (frame.id != NOTHING) {
        memory[frame.id + 2u * at] = (*t).largest;
    }
}

fn depth_of(entry: u32) -> u32
{
    if (entry == NOTHING) {
        return NOTHING;
    }
    return memory[frame.depths + (entry & ~CUT_OFF)];
}

fn trace_splat(p: ptr<function, Pixel>, t: ptr<function, Traced>, taken: Taken, column: u32, entry: vec2<u32>)
{
    if (entry.y <= (*t).limit) {
        let before = (*p).transmittance;
        let weight = blend_splat(p, taken, column);
        if (weight > 0) {
            note(t, before, weight, entry.y, entry.x);
        }
    }
}

fn traced_at(inside: bool, at: u32) -> Traced
{
    var t = Traced(NOTHING, 0, NOTHING, NOTHING, wide(0u, 0u));
    if (inside && frame.occluder != NOTHING) {
        t.limit = key_of(memory[frame.occluder + at]);
    }
    return t;
}

fn put_traced(p: ptr<function, Pixel>, t: ptr<function, Traced>, at: u32)
{
    put_pixel(p, at);
    put_traces(t, (*p).transmittance, at);
}

fn trace_patch(here: Patch, thread: u32)
{
    let lane = lane_of(thread);
    let place = place_of(here, thread);
    var p = Pixel(select(0, FXS_CLEAR_Q15, place.inside.x), vec3<i32>(0));
    var q = Pixel(select(0, FXS_CLEAR_Q15, place.inside.y), vec3<i32>(0));
    var s = traced_at(place.inside.x, place.at.x);
    var t = traced_at(place.inside.y, place.at.y);
    var open = place.inside;
    var fetched = fetch_splat(fetch_entry(here, lane));
    var depth = depth_of(fetched.entry);
    var entry = fetch_entry(here, SOME + lane);
    clear_rounds(thread, place);
    for (var first = 0u; first < here.count; first += SOME) {
        let round = first / SOME + 1u;
        if (any(open)) {
            open_round = round;
        }
        place_splat(here, thread, fetched, round);
        if (thread < SOME) {
            own[thread] = vec2<u32>(fetched.entry, depth);
        }
        fetched = fetch_splat(entry);
        depth = depth_of(entry);
        entry = fetch_entry(here, first + 2u * SOME + lane);
        if (workgroupUniformLoad(&open_round) != round) {
            break;
        }
        if (thread == 0u) {
            atomicStore(&touching[(round + 1u) % 2u], 0u);
        }
        for (var bits = atomicLoad(&touching[round % 2u]); bits != 0u; bits &= bits - 1u) {
            let i = firstTrailingBit(bits);
            trace_splat(&p, &s, take(i, place.row), place.column, own[i]);
            trace_splat(&q, &t, take(i, place.row), place.column + APART, own[i]);
        }
        if (open.x && (p.transmittance < FXS_CLOSED_Q15 || own[0].y > s.limit)) {
            open.x = false;
            close_pixel(place, false);
        }
        if (open.y && (q.transmittance < FXS_CLOSED_Q15 || own[0].y > t.limit)) {
            open.y = false;
            close_pixel(place, true);
        }
        workgroupBarrier();
    }
    for (var i = 0u; i < 1u << (2u * here.shift); i += 1u) {
        if (place.inside.x) {
            put_traced(&p, &s, pixel_of(place.at.x, here.shift, i));
        }
        if (place.inside.y) {
            put_traced(&q, &t, pixel_of(place.at.y, here.shift, i));
        }
    }
}

@compute @workgroup_size(32)
fn trace_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let share = share_of(group);
    if (share.tile == NOTHING) {
        return;
    }
    trace_patch(patch_of(share, thread), thread);
}
