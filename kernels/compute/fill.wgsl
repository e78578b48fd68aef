// Fills each tile's list with the indices of its splats, unsorted.
// Needs pixel numbers records bin

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> splats: array<vec4<u32>>;
@group(1) @binding(0) var<storage, read_write> later: array<u32>;
@group(1) @binding(1) var<storage, read> memory: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(3) var<storage, read_write> entries: array<u32>;

var<workgroup> spans: array<vec4<i32>, 8>;

fn fits() -> bool
{
    return atomicLoad(&counts[PAGES]) <= frame.page_room && atomicLoad(&counts[LARGES]) <= frame.large_room &&
           atomicLoad(&counts[LONGEST]) <= BLOCK << frame.merges;
}

fn put_entry(tile: u32, entry: u32)
{
    entries[atomicAdd(&counts[list_of(tile) + 1u], 1u)] = entry;
}

fn fill_box(slot: u32)
{
    var bits = wide(memory[frame.boxes + 2u * slot], memory[frame.boxes + 2u * slot + 1u]);
    let first_tile = bits.y >> 10u;
    let across = u32(frame.tiles.x);
    bits.y &= 1023u;
    if (first_tile == LARGE_BOX) {
        return;
    }
    while ((bits.x | bits.y) != 0u) {
        var bit = 0u;
        if (bits.x != 0u) {
            bit = countTrailingZeros(bits.x);
            bits.x &= bits.x - 1u;
        } else {
            bit = 32u + countTrailingZeros(bits.y);
            bits.y &= bits.y - 1u;
        }
        put_entry(first_tile + bit / 6u * across + bit % 6u, slot);
    }
}

fn put_arguments(at: u32, groups: u32)
{
    later[4u * at] = min(groups, ROW_OF_GROUPS);
    later[4u * at + 1u] = (groups + ROW_OF_GROUPS - 1u) / ROW_OF_GROUPS;
    later[4u * at + 2u] = 1u;
}

// Writes the numbers of workgroups of the later shaders. If the frame does not fit, the shaders bound_slots and finish
// replace all others.
fn put_later()
{
    let patches = 2u * (frame.tile_bits - 3u);
    let tiles = u32(frame.tiles.x * frame.tiles.y);
    let empty = atomicLoad(&counts[CLASS_COUNTS]);
    let longest = atomicLoad(&counts[CLASS_COUNTS + CLASSES - 1u]);
    let long = min(atomicLoad(&counts[LONG_BLOCKS]), frame.block_room);
    let fit = fits();
    put_arguments(0u, select(0u, (tiles - empty + 7u * longest) << patches, fit));
    put_arguments(2u + MERGES, select(0u, empty << patches, fit));
    put_arguments(1u, select(0u, min(atomicLoad(&counts[SHORT_BLOCKS]) + long, frame.block_room), fit));
    for (var i = 0u; i < frame.merges; i += 1u) {
        put_arguments(2u + i, select(0u, long, fit && atomicLoad(&counts[LONGEST]) > BLOCK << i));
    }
    let stride = list_room(atomicLoad(&counts[LONGEST]), atomicLoad(&counts[LARGES]), atomicLoad(&counts[VISIBLE]));
    let at_once = min((frame.scratch - bound_words()) / (2u * stride), tiles);
    put_arguments(3u + MERGES, select(2u * atomicLoad(&counts[VISIBLE_CHUNKS]), 0u, fit));
    for (var i = 0u; i < frame.finishes; i += 1u) {
        put_arguments(4u + MERGES + i, select(min(at_once, ROW_OF_GROUPS), 0u, fit));
        later[4u * (4u + MERGES + i) + 2u] = i + 1u;       // tells the step its number
    }
}

@compute @workgroup_size(128)
fn fill_lists(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let half = group.y * ROW_OF_GROUPS + group.x;
    if (half == 0u && thread == 0u) {
        put_later();
    }
    if (half / 2u < atomicLoad(&counts[VISIBLE_CHUNKS]) && fits()) {
        fill_box(half * THREADS + thread);
    }
}

fn large_splat(slot: u32) -> Splat
{
    let a = splats[2u * slot];
    let b = splats[2u * slot + 1u];
    return Splat(a.x, a.y, bitcast<i32>(a.z), bitcast<i32>(a.w), bitcast<i32>(b.x), i32(b.y & 0xffffu),
                 vec2<i32>(i32(b.w & 0xffffu), i32(b.w >> 16u)));
}

// Adds a large splat to its tiles' lists, one workgroup per LARGE_ROWS rows of tiles.
@compute @workgroup_size(128)
fn fill_large(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    let at = frame.larges + LARGE * min(number, frame.large_room - 1u);
    let slot = memory[at];
    var s = large_splat(slot);
    var b = Bounds(vec2<i32>(bitcast<i32>(memory[at + 1u]), bitcast<i32>(memory[at + 2u])), memory[at + 3u],
                   bitcast<i32>(memory[at + 4u]), bitcast<i32>(memory[at + 5u]), memory[at + 6u]);
    let first = i32(memory[at + 7u]);
    let listed = number < min(atomicLoad(&counts[LARGES]), frame.large_room) && fits();
    if (i32(thread) < LARGE_ROWS) {
        let row = first + i32(thread);
        var own = vec4<i32>(0, -1, 0, -1);
        if (listed && row <= rows_of(&s, &b).last) {
            let r_q12 = radius_q12(s.offset_q11);
            let list = span_of(&s, &b, r_q12, row);
            var touched = list;
            if (frame.cutoff == 1) {
                touched = ellipse_span(&s, &b, r_q12, row);
            }
            own = vec4<i32>(list.first, list.last, touched.first, touched.last);
        }
        spans[thread] = own;
    }
    workgroupBarrier();
    let row = thread / 16u;
    let of_row = spans[row];
    for (var column = of_row.x + i32(thread % 16u); column <= of_row.y; column += 16) {
        let cut_off = column < of_row.z || column > of_row.w;
        put_entry(u32((first + i32(row)) * frame.tiles.x + column), slot | select(0u, CUT_OFF, cut_off));
    }
}
