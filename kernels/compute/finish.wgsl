// Draws a frame whose lists do not fit. First bounds the tiles of each half of a chunk. Then each workgroup draws some
// of the tiles, one after the other: it gathers the tile's splats in its own part of `entries`, sorts and blends them.
// Needs pixel numbers records sums order pixels sort_functions blend_functions trace_functions

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read_write> counts: array<u32>;
@group(1) @binding(1) var<storage, read_write> entries: array<u32>;
@group(1) @binding(2) var<storage, read> splats: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read_write> memory: array<u32>;

// Distance from a splat's centre in standard deviations beyond which no pixel is drawn, with a margin for the rounding
// of the centre. The margin must be small, because a splat's u and v overflow 128 standard deviations from its centre.
const REACH: i32 = 4;

var<workgroup> bound: array<atomic<u32>, 4>;   // ~first column, ~first row, end column, end row of a half of a chunk
var<workgroup> found: atomic<u32>;
var<workgroup> near_count: atomic<u32>;
var<workgroup> near: array<u32, 128>;          // halves of chunks whose bounds contain the tile

struct Box {
    first: vec2<u32>,              // range of tiles that contains the splat
    end: vec2<u32>,
    mask: wide,                    // tiles of the range that the splat touches; unused for a large splat
    large: bool,
}

// Returns the centre of a large splat, Q3, from its box. Both coordinates are -2^20: the splat may touch all pixels.
fn centre_q3(box: wide) -> vec2<i32>
{
    let y = (box.x >> 21u) | (box.y << 11u);
    return vec2<i32>(vec2<u32>(box.x, y) << vec2<u32>(11u)) >> vec2<u32>(11u);
}

// Returns the range of columns that contains a large splat. Its half width is at most REACH (1 + |uy| / vy) / ux.
fn columns_of(slot: u32, centre: vec2<i32>) -> vec2<u32>
{
    let a = splats[2u * slot];
    let vy = max(splats[2u * slot + 1u].x, 1u);
    let ratio_q6 = (u32(abs(bitcast<i32>(a.w))) << 6u) / vy + 65u;             // |uy| is below 2^25
    let pixels = (u32(REACH) << 24u) / max(a.z, 1u) + 1u;                      // at most 2^26 + 1
    let half = i32(min((pixels * min(ratio_q6, 0x4000000u / pixels + 1u)) >> 6u, 1048575u)) + 1;
    let range = clamp((centre.x >> 3u) + vec2<i32>(-half, half), vec2<i32>(0), vec2<i32>(frame.size.x - 1));
    return (vec2<u32>(range) >> vec2<u32>(frame.tile_bits)) + vec2<u32>(0u, 1u);
}

fn large_box(slot: u32, word: wide) -> Box
{
    if (frame.cutoff == 1) {
        let range = vec2<u32>(memory[frame.squares + 2u * slot], memory[frame.squares + 2u * slot + 1u]);
        return Box(range & vec2<u32>(0xffffu), range >> vec2<u32>(16u), word, true);
    }
    let centre = centre_q3(word);
    var columns = vec2<u32>(0u, u32(frame.tiles.x));
    if (centre.x != FAR_Q3) {
        columns = columns_of(slot, centre);
    }
    let rows = splats[2u * slot + 1u].w;
    return Box(vec2<u32>(columns.x, (rows & 0xffffu) >> frame.tile_bits),
               vec2<u32>(columns.y, (rows >> (16u + frame.tile_bits)) + 1u), word, true);
}

fn box_of(slot: u32) -> Box
{
    let word = wide(memory[frame.boxes + 2u * slot], memory[frame.boxes + 2u * slot + 1u]);
    let mask = wide(word.x, word.y & 1023u);
    let tile = word.y >> 10u;
    let across = u32(frame.tiles.x);
    if (tile == LARGE_BOX) {
        return large_box(slot, mask);
    }
    if ((mask.x | mask.y) == 0u) {
        return Box(vec2<u32>(0u), vec2<u32>(0u), mask, false);
    }
    var columns = 0u;
    for (var row = 0u; row < u32(BOX_ROWS); row += 1u) {
        columns |= shift_right(mask, 6u * row).x & 63u;
    }
    let first = vec2<u32>(tile % across, tile / across);
    let rows = u32(63 - zeros_of_wide(mask)) / 6u + 1u;
    return Box(first, first + vec2<u32>(32u - countLeadingZeros(columns), rows), mask, false);
}

// Returns true if |d . slope| can be at most REACH in a tile whose middle is at d, Q3, from the splat's centre.
fn is_near(d: vec2<i32>, slope_q24: vec2<i32>) -> bool
{
    let half_tile = 4u << frame.tile_bits;
    let middle = add_wide(mul_signed(d.x, slope_q24.x), mul_signed(d.y, slope_q24.y));
    let reach = add_wide(wide_of(REACH << 27u), mul_wide(u32(abs(slope_q24.x)) + u32(abs(slope_q24.y)), half_tile));
    return !less(reach, magnitude(middle));
}

// Returns true if a large splat may touch a tile.
fn reaches(slot: u32, box: wide, at: vec2<u32>) -> bool
{
    let centre = centre_q3(box);
    if (centre.x == FAR_Q3) {
        return true;
    }
    let a = splats[2u * slot];
    let d = vec2<i32>((2u * at + 1u) << vec2<u32>(frame.tile_bits + 2u)) - centre;
    return is_near(d, bitcast<vec2<i32>>(a.zw)) && is_near(d, vec2<i32>(0, bitcast<i32>(splats[2u * slot + 1u].x)));
}

fn has_tile(slot: u32, at: vec2<u32>) -> bool
{
    let box = box_of(slot);
    if (any(at < box.first) || any(at >= box.end)) {
        return false;
    }
    if (box.large) {
        return reaches(slot, box.mask, at);
    }
    let place = at - box.first;
    return (shift_right(box.mask, 6u * place.y + place.x).x & 1u) != 0u;
}

@compute @workgroup_size(128)
fn bound_slots(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let half = group.y * ROW_OF_GROUPS + group.x;
    if (thread < 4u) {
        atomicStore(&bound[thread], 0u);
    }
    workgroupBarrier();
    if (half < 2u * counts[VISIBLE_CHUNKS]) {
        let box = box_of(half * THREADS + thread);
        if (all(box.first < box.end)) {
            atomicMax(&bound[0], ~box.first.x);
            atomicMax(&bound[1], ~box.first.y);
            atomicMax(&bound[2], box.end.x);
            atomicMax(&bound[3], box.end.y);
        }
    }
    workgroupBarrier();
    if (thread < 2u && half < 2u * counts[VISIBLE_CHUNKS]) {
        // word 0: first and end column; word 1: rows. Without splats, first > end.
        let first = ~atomicLoad(&bound[thread]) & 0xffffu;
        entries[2u * half + thread] = first | (atomicLoad(&bound[2u + thread]) << 16u);
    }
}

fn bound_has(half: u32, at: vec2<u32>) -> bool
{
    let range = vec2<u32>(entries[2u * half], entries[2u * half + 1u]);
    return all(at >= (range & vec2<u32>(0xffffu))) && all(at < (range >> vec2<u32>(16u)));
}

// Writes the slots of a tile's splats to `entries`, from position `list` on. Returns their number.
fn gather_list(thread: u32, at: vec2<u32>, halves: u32, list: u32) -> u32
{
    if (thread == 0u) {
        atomicStore(&found, 0u);
    }
    for (var first = 0u; first < halves; first += THREADS) {
        if (thread == 0u) {
            atomicStore(&near_count, 0u);
        }
        workgroupBarrier();
        if (first + thread < halves) {
            if (bound_has(first + thread, at)) {
                near[atomicAdd(&near_count, 1u)] = first + thread;
            }
        }
        workgroupBarrier();
        let count = of_first(thread, atomicLoad(&near_count));
        for (var i = 0u; i < count; i += 1u) {
            let slot = near[i] * THREADS + thread;
            if (has_tile(slot, at)) {
                entries[list + atomicAdd(&found, 1u)] = slot;
            }
        }
        workgroupBarrier();
    }
    storageBarrier();
    return of_first(thread, atomicLoad(&found));
}

fn sort_list(thread: u32, list: u32, count: u32, spare: u32)
{
    let merges = merges_of(count);
    var source = select(list, spare, merges % 2u == 1u);
    var to = list + spare - source;
    for (var block = 0u; block < count; block += BLOCK) {
        sort_block(thread, list + block, min(count - block, BLOCK), source + block);
        workgroupBarrier();
    }
    for (var i = 0u; i < merges; i += 1u) {
        storageBarrier();
        workgroupBarrier();
        for (var block = 0u; block < count; block += BLOCK) {
            merge_block(thread, source, to, count, block, 9u + i);
            workgroupBarrier();
        }
        source = to;
        to = list + spare - source;
    }
    storageBarrier();
    workgroupBarrier();
}

struct Lists {
    halves: u32,                   // number of halves of visible chunks
    list: u32,
    room: u32,
}

fn lists_of(group: u32, thread: u32) -> Lists
{
    let halves = of_first(thread, 2u * counts[VISIBLE_CHUNKS]);
    let room = of_first(thread, list_room(counts[LONGEST], counts[LARGES], counts[VISIBLE]));
    return Lists(halves, bound_words() + 2u * room * group, room);
}

// Makes the list of a tile, near to far. Returns its length.
fn list_tile(thread: u32, tile: u32, lists: Lists) -> u32
{
    let across = u32(frame.tiles.x);
    let count = gather_list(thread, vec2<u32>(tile % across, tile / across), lists.halves, lists.list);
    sort_list(thread, lists.list, count, lists.list + lists.room);
    return count;
}

fn whole_patch(thread: u32, tile: u32, number: u32, list: u32, count: u32) -> Patch
{
    return patch_at(thread, tile, number, vec2<u32>(0u, SIDE - 1u), list, count);
}

fn patches() -> u32
{
    return 1u << (2u * (frame.tile_bits - 3u));
}

// Returns the number of tiles that steps before step `step` draw.
fn tiles_before(step: u32) -> u32
{
    return u32(frame.tiles.x * frame.tiles.y) / frame.finishes * step +
           u32(frame.tiles.x * frame.tiles.y) % frame.finishes * step / frame.finishes;
}

struct Turn {
    lists: Lists,
    first: u32,                    // the workgroup draws every groups.x-th tile from `first` to `end`
    end: u32,
}

fn turn_of(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> Turn
{
    if (group.z + 1u != groups.z) {
        return Turn(Lists(0u, 0u, 0u), 0u, 0u);
    }
    return Turn(lists_of(group.x, thread), tiles_before(group.z) + group.x, tiles_before(groups.z));
}

@compute @workgroup_size(128)
fn finish_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) thread: u32)
{
    let turn = turn_of(group, groups, thread);
    for (var tile = turn.first; tile < turn.end; tile += groups.x) {
        let count = list_tile(thread, tile, turn.lists);
        for (var i = 0u; i < patches(); i += 1u) {
            blend_patch(whole_patch(thread, tile, i, turn.lists.list, count), thread);
            workgroupBarrier();
        }
    }
}

@compute @workgroup_size(128)
fn finish_traced(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                 @builtin(local_invocation_index) thread: u32)
{
    let turn = turn_of(group, groups, thread);
    for (var tile = turn.first; tile < turn.end; tile += groups.x) {
        let count = list_tile(thread, tile, turn.lists);
        for (var i = 0u; i < patches(); i += 1u) {
            trace_patch(whole_patch(thread, tile, i, turn.lists.list, count), thread);
            workgroupBarrier();
        }
    }
}
