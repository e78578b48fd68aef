// Needs records order
// sort: each tile's list near to far, by a bitonic sort (Batcher 1968) whose comparisons all go one way, so that a list
// may end anywhere. What is too long for a workgroup's memory is sorted in blocks that fit, then merged.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read_write> entries: array<vec2<u32>>;

const ROOM: u32 = 2048u;

var<workgroup> keys: array<vec2<u32>, 2048>;

// By depth, then by slot.
fn is_above(a: vec2<u32>, b: vec2<u32>) -> bool
{
    return select(a.y > b.y, a.x > b.x, a.y == b.y);
}

// The lower one of pair number i at a distance of 2^log, and its partner; the first step of a merge turns the second
// half over.
fn pair_of(i: u32, log: u32, turned: bool) -> vec2<u32>
{
    let distance = 1u << log;
    let within = i & (distance - 1u);
    let low = ((i >> log) << (log + 1u)) + within;
    return vec2<u32>(low, select(low + distance, low + 2u * distance - 1u - 2u * within, turned));
}

fn order_here(i: u32, log: u32, turned: bool)
{
    let pair = pair_of(i, log, turned);
    let a = keys[pair.x];
    let b = keys[pair.y];
    if (is_above(a, b)) {
        keys[pair.x] = b;
        keys[pair.y] = a;
    }
}

// Merges of 2^first keys to 2^end in the workgroup's memory, or the last `first` steps of one.
fn merge_here(thread: u32, first: u32, end: u32, half: u32, turns: bool)
{
    for (var size = first; size <= end; size += 1u) {
        for (var log = size; log > 0u; log -= 1u) {
            workgroupBarrier();
            for (var i = thread; i < half; i += THREADS) {
                order_here(i, log - 1u, turns && log == size);
            }
        }
    }
    workgroupBarrier();
}

fn fetch(thread: u32, at: u32, count: u32, room: u32)
{
    for (var i = thread; i < room; i += THREADS) {
        var key = vec2<u32>(NOTHING, NOTHING);
        if (i < count) {
            key = entries[at + i];
        }
        keys[i] = key;
    }
}

fn put_back(thread: u32, at: u32, count: u32)
{
    for (var i = thread; i < count; i += THREADS) {
        entries[at + i] = keys[i];
    }
    workgroupBarrier();
}

// log2, rounded up
fn bits_of(count: u32) -> u32
{
    return 32u - countLeadingZeros(count - 1u);
}

fn order_there(i: u32, at: u32, count: u32, log: u32, turned: bool)
{
    let pair = pair_of(i, log, turned);
    if (pair.y < count) {
        let a = entries[at + pair.x];
        let b = entries[at + pair.y];
        if (is_above(a, b)) {
            entries[at + pair.x] = b;
            entries[at + pair.y] = a;
        }
    }
}

fn sort_blocks(thread: u32, at: u32, count: u32, first: u32, turns: bool)
{
    for (var block = 0u; block < count; block += ROOM) {
        let some = min(count - block, ROOM);
        fetch(thread, at + block, some, ROOM);
        merge_here(thread, first, 11u, ROOM / 2u, turns);
        put_back(thread, at + block, some);
    }
    storageBarrier();
}

@compute @workgroup_size(128)
fn sort_lists(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let tile = tile_at(group.y * ROW_OF_GROUPS + group.x);
    if (tile == NOTHING || !fits()) {
        return;
    }
    let count = counts[TILES + tile];
    let at = counts[frame.next + tile] - count;
    if (count < 2u) {
        return;
    }
    let bits = bits_of(count);
    if (count <= ROOM) {
        fetch(thread, at, count, 1u << bits);
        merge_here(thread, 1u, bits, (1u << bits) / 2u, true);
        put_back(thread, at, count);
        return;
    }
    sort_blocks(thread, at, count, 1u, true);
    for (var size = 12u; size <= bits; size += 1u) {
        for (var log = size; log > 11u; log -= 1u) {
            for (var i = thread; i < (1u << bits) / 2u; i += THREADS) {
                order_there(i, at, count, log - 1u, log == size);
            }
            storageBarrier();
        }
        sort_blocks(thread, at, count, 11u, false);
    }
}
