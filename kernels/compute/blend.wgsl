// Needs pixel records order pixels
// blend and resolve.

@compute @workgroup_size(64)
fn blend_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let q = quarter_of(group);
    if (q.tile == NOTHING) {
        return;
    }
    let place = place_of(q, thread);
    var p = Pixel(select(0, FXS_CLEAR_Q15, place.inside), vec3<i32>(0));
    var open = place.inside;
    var fetched = fetch_splat(fetch_entry(q, thread));
    var entry = fetch_entry(q, SOME + thread);
    clear_rounds(thread, open);
    for (var first = 0u; first < q.count; first += SOME) {
        let round = first / SOME + 1u;
        let words = 4u * (round % 2u);
        if (open) {
            open_round = round;
        }
        place_fetched(q, thread, fetched, words);
        fetched = fetch_splat(entry);              // while this round is blended
        entry = fetch_entry(q, first + 2u * SOME + thread);
        if (workgroupUniformLoad(&open_round) != round) {
            break;
        }
        if (thread < 4u) {
            atomicStore(&touching[4u - words + thread], 0u);
        }
        for (var word = 0u; word < 2u; word += 1u) {
            for (var bits = atomicLoad(&touching[words + thread / 32u * 2u + word]); bits != 0u; bits &= bits - 1u) {
                let i = 32u * word + countTrailingZeros(bits);
                blend_splat(&p, i, place.column, place.row);
            }
        }
        if (open && p.transmittance < FXS_CLOSED_Q15) {
            open = false;
            close_pixel(thread);
        }
        workgroupBarrier();
    }
    if (place.inside) {
        put_pixel(&p, place.at);
    }
}
