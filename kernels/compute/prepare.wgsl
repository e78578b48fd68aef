// Projects and shades the Gaussians of visible chunks, and finds their tiles.
// Needs pixel numbers records crop project shade animate bin

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> object: Object;
@group(1) @binding(0) var<storage, read> scene: array<u32>;
@group(1) @binding(1) var<storage, read_write> memory: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(3) var<storage, read_write> splats: array<vec4<u32>>;

var<workgroup> visible_here: atomic<u32>;
var<workgroup> record: array<u32, 64>;

fn scale_depth(key: u32) -> u32
{
    let product = mul_high((0x4000000u | (key & 0x3ffffffu)) << 5u, object.scale_mantissa);
    let zeros = zeros_of(product);
    let exponent = i32(key >> 26u) + object.scale_exponent + 1 - zeros;
    if (exponent < 0) {
        return 0u;
    }
    if (exponent > 63) {
        return 0xffffffffu;
    }
    return (u32(exponent) << 26u) | (((product << u32(zeros)) >> 5u) & 0x3ffffffu);
}

fn is_kept(position: vec3<u32>) -> bool
{
    var centre: array<wide, 3>;
    for (var i = 0u; i < 3u; i += 1u) {
        let reach = shift_left(mul_wide(record[34u + i], position[i]), record[37]);
        centre[i] = add_wide(wide_at(28u + 2u * i), reach);
    }
    return is_within_crops(&centre, &centre);
}

fn offset_of(opacity: u32, share_q8: u32) -> i32
{
    let code = CHUNK * record[17] + opacity;
    var offset_q11 = half_of(memory[code / 2u], code);
    if (share_q8 != 256u) {
        offset_q11 = share_of_q11(offset_q11, share_q8);
    }
    return i32(offset_q11) + object.offset_q11;
}

// Adds 1 to the list lengths of a range of tiles in one row. `counts` holds differences of neighbouring lengths, so
// that a later prefix sum gives the lengths.
fn count_tiles(row: i32, s: Span)
{
    if (s.first > s.last) {
        return;
    }
    let tile = u32(row * frame.tiles.x);
    atomicAdd(&counts[list_of(tile + u32(s.first))], 1u);
    if (s.last < frame.tiles.x - 1) {
        atomicAdd(&counts[list_of(tile + u32(s.last) + 1u)], 0xffffffffu);
    }
}

fn put_large(slot: u32, b: ptr<function, Bounds>, first_row: i32)
{
    let place = atomicAdd(&counts[LARGES], 1u);
    if (place < frame.large_room) {
        let at = frame.larges + LARGE * place;
        memory[at] = slot;
        memory[at + 1u] = bitcast<u32>((*b).c_q14.x);
        memory[at + 2u] = bitcast<u32>((*b).c_q14.y);
        memory[at + 3u] = (*b).breadth_q8;
        memory[at + 4u] = bitcast<u32>((*b).shear_q8);
        memory[at + 5u] = bitcast<u32>((*b).half_width_q8);
        memory[at + 6u] = (*b).square_radius;
        memory[at + 7u] = u32(first_row);
    }
}

// Returns the box of a large splat: its centre, Q3, or FAR_Q3 if the splat touches all tiles of its rows.
fn large_box(b: ptr<function, Bounds>) -> wide
{
    var centre = max((*b).c_q14 >> vec2<u32>(11u), vec2<i32>(FAR_Q3 + 1));
    if ((*b).half_width_q8 == EVERYWHERE_Q8) {
        centre = vec2<i32>(FAR_Q3);
    }
    let x = u32(centre.x) & 0x1fffffu;
    let y = u32(centre.y) & 0x1fffffu;
    return wide(x | (y << 21u), (y >> 11u) | (LARGE_BOX << 10u));
}

// Counts a splat in the lengths of its tiles' lists. Returns a mask of the tiles: bit 6 r + c for row r and column c.
// Bits from 42 on are the first tile's number. Returns 0 if the splat touches no tile. Large splats have LARGE_BOX and,
// instead of a mask, their centre.
fn list_splat(slot: u32, out: ptr<function, Placed>) -> wide
{
    var s = (*out).splat;
    var b = (*out).bounds;
    let rows = rows_of(&s, &b);
    let columns = columns_of(&b);
    let is_square = frame.cutoff == 1;
    if (!is_square && columns.first > columns.last) {
        return wide(0u, 0u);
    }
    let first_tile = u32(rows.first * frame.tiles.x + columns.first);
    if (!is_square && rows.first == rows.last && s.rows.x > 0 && s.rows.y < frame.size.y - 1 &&
        columns.last - columns.first < 4) {
        count_tiles(rows.first, columns);
        return wide((2u << u32(columns.last - columns.first)) - 1u, first_tile << 10u);
    }
    let large = is_square || columns.last - columns.first >= BOX_COLUMNS || rows.last - rows.first >= BOX_ROWS;
    let r_q12 = radius_q12(s.offset_q11);
    var box = wide(0u, 0u);
    for (var row = rows.first; row <= rows.last; row += 1) {
        let tiles = span_of(&s, &b, r_q12, row);
        count_tiles(row, tiles);
        if (!large && tiles.first <= tiles.last) {
            let bits = (2u << u32(tiles.last - columns.first)) - (1u << u32(tiles.first - columns.first));
            box |= shift_left(wide(bits, 0u), u32(BOX_COLUMNS * (row - rows.first)));
        }
    }
    for (var row = rows.first; row <= rows.last && large; row += LARGE_ROWS) {
        put_large(slot, &b, row);
    }
    if (is_square) {
        let across = square_span(b.c_q14.x, b.square_radius, frame.tiles.x);
        memory[frame.squares + 2u * slot] = u32(across.first) | (u32(across.last + 1) << 16u);
        memory[frame.squares + 2u * slot + 1u] = u32(rows.first) | (u32(rows.last + 1) << 16u);
    }
    if (large) {
        return large_box(&b);
    }
    if ((box.x | box.y) == 0u) {
        return box;
    }
    return wide(box.x, box.y | (first_tile << 10u));
}

fn put_splat(slot: u32, s: ptr<function, Splat>, colour_q13: vec3<i32>)
{
    splats[2u * slot] = vec4<u32>((*s).u0_q24, (*s).v0_q24, bitcast<u32>((*s).ux_q24), bitcast<u32>((*s).uy_q24));
    splats[2u * slot + 1u] = vec4<u32>(bitcast<u32>((*s).vy_q24), u32((*s).offset_q11) | (u32(colour_q13.x) << 16u),
                                       u32(colour_q13.y) | (u32(colour_q13.z) << 16u),
                                       u32((*s).rows.x) | (u32((*s).rows.y) << 16u));
}

fn project_gaussian(rows: u32, slot: u32) -> wide
{
    let g = slot % CHUNK;
    var codes = codes_of(rows, g);
    if (object.motion_at != 0u) {
        let moved = splats[2u * slot];
        codes.position = vec3<u32>(half_of(moved.x, 0u), half_of(moved.x, 1u), half_of(moved.y, 0u));
        codes.rotation = moved.z;
        codes.colour = (codes.colour & 0xffffffu) | (half_of(moved.y, 1u) << 24u);
    }
    let opacity = codes.colour >> 24u;
    var centre: Projected;
    var out: Placed;
    if (opacity == 0u) {
        return wide(0u, 0u);
    }
    if (!project_centre(&centre, codes.position)) {
        return wide(0u, 0u);
    }
    out.splat.offset_q11 = offset_of(opacity, record[47]);
    if (!project_shape(&out, &centre, codes.scale, codes.rotation) || !enter_window(&out)) {
        return wide(0u, 0u);
    }
    if (object.crop_count != 0u && !is_kept(codes.position)) {
        return wide(0u, 0u);
    }
    var key = depth_key(centre.camera.z);
    if (object.plain == 0) {
        key = scale_depth(key);
    }
    let colour = min((shade(rows, g, codes) * object.tint_q13.xyz + 4096) >> vec3<u32>(13u), vec3<i32>(32767));
    var splat = out.splat;         // copied, because some SPIR-V versions reject a pointer to a struct member
    put_splat(slot, &splat, colour);
    memory[frame.depths + slot] = key;
    atomicAdd(&visible_here, 1u);
    return list_splat(slot, &out);
}

// Half a visible chunk of the span, which a workgroup works on.
struct Half {
    first_slot: u32,
    place: u32,
    index: u32,                    // of the chunk in the object's buffers
    inside: bool,                  // false: there is no such chunk in these buffers
}

fn half_of_chunk(group: vec3<u32>) -> Half
{
    let span = frame.spans_at + SPAN * object.span;
    let half = group.y * ROW_OF_GROUPS + group.x;
    let ordinal = memory[span + 2u] + half / 2u;
    var here = Half(THREADS * (2u * ordinal + half % 2u), 0u, 0u, ordinal < memory[span + 3u]);
    if (here.inside) {
        here.place = memory[frame.visible + ordinal];
        here.index = here.place - object.first_chunk;
        if (frame.drawn != 0u) {
            here.index = memory[frame.drawn + DRAWN * here.place];
        }
        // the other chunks of a scene in parts are in other buffers
        here.inside = here.index - object.part_chunk < object.part_chunks;
    }
    return here;
}

fn rows_at(index: u32) -> u32
{
    return object.rows_at + (index - object.part_chunk) * object.chunk_words;
}

// Writes the codes of the Gaussians of visible chunks at the time of the frame to their splats, which project_chunk
// overwrites.
@compute @workgroup_size(128)
fn animate_chunk(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let here = half_of_chunk(group);
    if (here.inside) {
        let slot = here.first_slot + thread;
        let scale_step_q24 = memory[frame.records + RECORD * here.place + 16u];
        splats[2u * slot] = animated(rows_at(here.index), slot % CHUNK, moment_of(here.place), scale_step_q24);
    }
}

@compute @workgroup_size(128)
fn project_chunk(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let here = half_of_chunk(group);
    if (thread == 0u) {
        atomicStore(&visible_here, 0u);
    }
    if (thread < RECORD) {
        record[thread] = memory[frame.records + RECORD * here.place + thread];
    }
    workgroupBarrier();
    if (here.inside) {
        let slot = here.first_slot + thread;
        let box = project_gaussian(rows_at(here.index), slot);
        memory[frame.boxes + 2u * slot] = box.x;
        memory[frame.boxes + 2u * slot + 1u] = box.y;
    }
    workgroupBarrier();
    if (thread == 0u) {
        atomicAdd(&counts[VISIBLE], atomicLoad(&visible_here));
    }
}
