// Needs pixel records order pixels
// blend and resolve.

@compute @workgroup_size(64)
fn blend_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let h = half_tile_of(group);
    if (h.tile == NOTHING) {
        return;
    }
    let place = place_of(h, thread);
    var p = Pixel(select(0, FXS_CLEAR_Q15, place.inside.x), vec3<i32>(0));
    var q = Pixel(select(0, FXS_CLEAR_Q15, place.inside.y), vec3<i32>(0));
    var open = place.inside;
    var fetched = fetch_splat(fetch_entry(h, thread));
    var entry = fetch_entry(h, SOME + thread);
    clear_rounds(thread, place);
    for (var first = 0u; first < h.count; first += SOME) {
        let round = first / SOME + 1u;
        let words = 4u * (round % 2u);
        if (any(open)) {
            open_round = round;
        }
        place_fetched(h, thread, fetched, words);
        fetched = fetch_splat(entry);              // while this round is blended
        entry = fetch_entry(h, first + 2u * SOME + thread);
        if (workgroupUniformLoad(&open_round) != round) {
            break;
        }
        if (thread < 4u) {
            atomicStore(&touching[4u - words + thread], 0u);
        }
        for (var word = 0u; word < 2u; word += 1u) {
            var bits = atomicLoad(&touching[words + thread / 32u * 2u + word]);
            var next = take(32u * word + countTrailingZeros(bits) % 32u, place.row);
            while (bits != 0u) {
                let taken = next;
                bits &= bits - 1u;
                next = take(32u * word + countTrailingZeros(bits) % 32u, place.row);
                blend_splat(&p, taken, place.column);
                blend_splat(&q, taken, place.column + APART);
            }
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
    if (place.inside.x) {
        put_pixel(&p, place.at);
    }
    if (place.inside.y) {
        put_pixel(&q, place.at + APART);
    }
}
