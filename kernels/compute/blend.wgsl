// Blends the splats of each tile from front to back, and writes the pixels.
// Needs pixel records order pixels

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read> entries: array<u32>;
@group(1) @binding(2) var<storage, read> splats: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read_write> memory: array<u32>;

// Blends a round of up to 32 splats into the thread's two pixels, two splats per step to hide latency.
fn blend_round(p: ptr<function, Pixel>, q: ptr<function, Pixel>, place: Place, round: u32)
{
    var bits = atomicLoad(&touching[round % 2u]);
    while (bits != 0u) {
        let rest = bits & (bits - 1u);
        let taken = take(firstTrailingBit(bits), place.row);
        var other = take(firstTrailingBit(rest) % SOME, place.row);
        other.limit_q11 = select(other.limit_q11, -1, rest == 0u);
        blend_splat(p, taken, place.column);
        blend_splat(q, taken, place.column + APART);
        blend_splat(p, other, place.column);
        blend_splat(q, other, place.column + APART);
        bits = rest & (rest - 1u);
    }
}

fn blend_patch(here: Patch, thread: u32)
{
    let lane = lane_of(thread);
    let place = place_of(here, thread);
    var p = Pixel(select(0, FXS_CLEAR_Q15, place.inside.x), vec3<i32>(0));
    var q = Pixel(select(0, FXS_CLEAR_Q15, place.inside.y), vec3<i32>(0));
    var open = place.inside;
    var fetched = fetch_splat(fetch_entry(here, lane));
    var next = fetch_splat(fetch_entry(here, SOME + lane));
    var entry = fetch_entry(here, 2u * SOME + lane);
    clear_rounds(thread, place);
    for (var first = 0u; first < here.count; first += SOME) {
        let round = first / SOME + 1u;
        if (any(open)) {
            open_round = round;
        }
        place_splat(here, thread, fetched, round);
        fetched = next;
        next = fetch_splat(entry);
        entry = fetch_entry(here, first + 3u * SOME + lane);
        if (workgroupUniformLoad(&open_round) != round) {
            break;
        }
        if (thread == 0u) {
            atomicStore(&touching[(round + 1u) % 2u], 0u);
        }
        if (place.row < SIDE) {
            blend_round(&p, &q, place, round);
        }
        if (open.x && p.transmittance < FXS_CLOSED_Q15) {
            open.x = false;
            close_pixel(place, false);
        }
        if (open.y && q.transmittance < FXS_CLOSED_Q15) {
            open.y = false;
            close_pixel(place, true);
        }
        workgroupBarrier();
    }
    for (var i = 0u; i < 1u << (2u * here.shift); i += 1u) {
        if (place.inside.x) {
            put_pixel(&p, pixel_of(place.at.x, here.shift, i));
        }
        if (place.inside.y) {
            put_pixel(&q, pixel_of(place.at.y, here.shift, i));
        }
    }
}

@compute @workgroup_size(32)
fn blend_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let share = share_of(group);
    if (share.tile == NOTHING) {
        return;
    }
    blend_patch(patch_of(share, thread), thread);
}

// Writes the background to tiles with empty lists, 8x8 pixels per workgroup.
@compute @workgroup_size(64)
fn clear_pixels(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    let of_class = number >> (2u * (frame.tile_bits - 3u));
    if (of_class >= counts[CLASS_COUNTS]) {
        return;
    }
    let pixel = corner_of(counts[frame.classes + of_class], number) + vec2<u32>(thread % SIDE, thread / SIDE);
    if (any(pixel >= vec2<u32>(frame.size))) {
        return;
    }
    let at = pixel.y * u32(frame.size.x) + pixel.x;
    var p = Pixel(FXS_CLEAR_Q15, vec3<i32>(0));
    put_pixel(&p, at);
    if (frame.mean_depth != NOTHING) {
        memory[frame.mean_depth + at] = NOTHING;
    }
    if (frame.median_depth != NOTHING) {
        memory[frame.median_depth + at] = NOTHING;
    }
    if (frame.id != NOTHING) {
        memory[frame.id + 2u * at] = NOTHING;
    }
}
