// Needs pixel records order pixels
// blend and resolve.

const CROWD: u32 = 2048u;          // splats of a tile of 8x8: small ones, so each pixel takes those alone that touch it

var<workgroup> masks: array<atomic<u32>, 128>;   // two of each pixel of the tile, row by row: which of the round touch it

// Blends what is marked in the words of a round.
fn blend_round(p: ptr<function, Pixel>, q: ptr<function, Pixel>, place: Place, words: u32)
{
    for (var word = 0u; word < 2u; word += 1u) {
        var bits = atomicLoad(&touching[words + place.words + word]);
        var next = take(32u * word + countTrailingZeros(bits) % 32u, place.row);
        while (bits != 0u) {
            let taken = next;
            bits &= bits - 1u;
            next = take(32u * word + countTrailingZeros(bits) % 32u, place.row);   // while this one is blended
            blend_splat(p, taken, place.column);
            if (frame.tile_bits > 3u) {
                blend_splat(q, taken, place.column + APART);
            }
        }
    }
}

// The same in a crowd: each open pixel that a splat touches is marked,
fn mark_pixels(h: Half, thread: u32, f: Fetched)
{
    if ((f.entry.x & CUT_OFF) != 0u) {
        return;
    }
    put_splat(h, thread, f);
    let limit = i32(shades[thread].w);
    let first = max(f.b.w & 0xffffu, h.y) - h.y;
    let last = min(max(f.b.w >> 16u, h.y) - h.y, SIDE - 1u);
    for (var row = first; row <= last; row += 1u) {
        let t = take(thread, row);
        var open = (atomicLoad(&open_pixels[row / 2u]) >> (16u * (row % 2u))) & 0xffu;
        for (; open != 0u && t.level <= limit; open &= open - 1u) {
            let column = countTrailingZeros(open);
            if (fxs_level_q11(fxs_coordinate_q13(bitcast<i32>(t.u + column * t.ux)), t.level) <= limit) {
                atomicOr(&masks[2u * (SIDE * row + column) + thread / 32u], 1u << (thread % 32u));
            }
        }
    }
}

// and takes its own.
fn blend_crowd(p: ptr<function, Pixel>, place: Place)
{
    for (var word = 0u; word < 2u; word += 1u) {
        for (var bits = atomicExchange(&masks[2u * (SIDE * place.row + place.column) + word], 0u); bits != 0u;
             bits &= bits - 1u) {
            blend_splat(p, take(32u * word + countTrailingZeros(bits), place.row), place.column);
        }
    }
}

@compute @workgroup_size(64)
fn blend_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let h = half_tile_of(group);
    if (h.tile == NOTHING) {
        return;
    }
    let place = place_of(h, thread);
    let crowded = frame.tile_bits == 3u && h.count >= CROWD;
    var p = Pixel(select(0, FXS_CLEAR_Q15, place.inside.x), vec3<i32>(0));
    var q = Pixel(select(0, FXS_CLEAR_Q15, place.inside.y), vec3<i32>(0));
    var open = place.inside;
    var fetched = fetch_splat(fetch_entry(h, thread));
    var entry = fetch_entry(h, SOME + thread);
    atomicStore(&masks[thread], 0u);
    atomicStore(&masks[64u + thread], 0u);
    clear_rounds(thread, place);
    for (var first = 0u; first < h.count; first += SOME) {
        let round = first / SOME + 1u;
        let words = 4u * (round % 2u);
        if (any(open)) {
            open_round = round;
        }
        if (crowded) {
            mark_pixels(h, thread, fetched);
        } else {
            place_splat(h, thread, fetched, words);
        }
        fetched = fetch_splat(entry);              // while this round is blended
        entry = fetch_entry(h, first + 2u * SOME + thread);
        if (workgroupUniformLoad(&open_round) != round) {
            break;
        }
        if (thread < 4u) {
            atomicStore(&touching[4u - words + thread], 0u);
        }
        if (crowded) {
            blend_crowd(&p, place);
        } else {
            blend_round(&p, &q, place, words);
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

// The pixels of empty lists, a thread each: what trace_tiles gives where there is no splat, too.
@compute @workgroup_size(128)
fn clear_pixels(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let at = (group.y * ROW_OF_GROUPS + group.x) * THREADS + thread;
    let size = vec2<u32>(frame.size);
    let tile = vec2<u32>(at % size.x, at / size.x) >> vec2<u32>(frame.tile_bits);
    if (at >= size.x * size.y || !fits() || counts[TILES + tile.y * u32(frame.tiles.x) + tile.x] != 0u) {
        return;
    }
    var p = Pixel(FXS_CLEAR_Q15, vec3<i32>(0));
    put_pixel(&p, at);
    if (frame.mean_depth != NOTHING) {
        picture[frame.mean_depth + at] = NOTHING;
    }
    if (frame.median_depth != NOTHING) {
        picture[frame.median_depth + at] = NOTHING;
    }
    if (frame.id != NOTHING) {
        picture[frame.id + 2u * at] = NOTHING;
    }
}
