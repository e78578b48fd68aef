// Needs records order
// sort: each tile's list near to far. Blocks of a list are sorted in the memory of a workgroup: the depths of 32 keys,
// sorted, bound as many ranges, each of which is 8 bins of equal width; keys go to the bins, then each counts those of
// its bin that are less. The less memory of a workgroup, the more of them a GPU has at a time. Runs of a list, blocks at first, are then merged, 16 at a time:
// each key finds its place by bisection of the other runs.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read_write> entries: array<vec2<u32>>;   // slot, depth

const SAMPLES: u32 = 32u;
const RANGE: u32 = 8u;             // bins
const BINS: u32 = 256u;

var<workgroup> keys: array<vec2<u32>, 512>;      // bin after bin
var<workgroup> bins: array<atomic<u32>, 256>;
var<workgroup> sums: array<u32, 16>;
var<workgroup> samples: array<u32, 32>;
var<workgroup> bounds: array<vec2<u32>, 32>;     // of the ranges: the least depth, and the shift that bins are wide

// By depth, then by slot.
fn is_below(a: vec2<u32>, b: vec2<u32>) -> bool
{
    return select(a.y < b.y, a.x < b.x, a.y == b.y);
}

struct Block {
    list: u32,
    count: u32,                    // of the list; 0: there is no block of this number
    first: u32,                    // of the block in the list
}

// Blocks of long lists have the first numbers.
fn block_of(number: u32) -> Block
{
    let long = counts[LONG_BLOCKS];
    if (number >= long + counts[SHORT_BLOCKS] || !fits()) {
        return Block(0u, 0u, 0u);
    }
    let at = frame.blocks + 2u * select(number - long, frame.block_room - 1u - number, number < long);
    let tile = counts[at];
    let count = counts[TILES + tile];
    return Block(counts[frame.next + tile] - count, count, BLOCK * counts[at + 1u]);
}

// From the sizes of bins to their starts.
fn place_bins(thread: u32)
{
    let group = BINS / 16u;        // of bins
    if (thread < 16u) {
        var size = 0u;
        for (var i = 0u; i < group; i += 1u) {
            size += atomicLoad(&bins[group * thread + i]);
        }
        sums[thread] = size;
    }
    workgroupBarrier();
    let bin = 2u * thread;
    var start = 0u;
    for (var i = 0u; i < bin / group; i += 1u) {
        start += sums[i];
    }
    for (var i = bin / group * group; i < bin; i += 1u) {
        start += atomicLoad(&bins[i]);
    }
    let next = start + atomicLoad(&bins[bin]);
    workgroupBarrier();
    atomicStore(&bins[bin], start);
    atomicStore(&bins[bin + 1u], next);
    workgroupBarrier();
}

// Bounds the ranges by the depths of some keys.
fn bound_ranges(thread: u32, at: u32, some: u32)
{
    var own = 0u;
    if (thread < SAMPLES) {
        own = entries[at + thread * max(some, SAMPLES) / SAMPLES % some].y;
        samples[thread] = own;
    }
    workgroupBarrier();
    if (thread < SAMPLES) {
        var place = 0u;
        for (var i = 0u; i < SAMPLES; i += 1u) {
            place += select(0u, 1u, samples[i] < own || (samples[i] == own && i < thread));
        }
        bounds[place].x = own;
    }
    workgroupBarrier();
    if (thread < SAMPLES) {
        let width = bounds[min(thread + 1u, SAMPLES - 1u)].x - bounds[thread].x;
        bounds[thread].y = max(32u - countLeadingZeros(width), 3u) - 3u;
    }
    workgroupBarrier();
}

// The range is the last that does not begin above the depth, or the first.
fn bin_of(depth: u32) -> u32
{
    var range = 0u;
    for (var step = SAMPLES / 2u; step != 0u; step >>= 1u) {
        range += select(0u, step, bounds[range + step].x <= depth);
    }
    let bound = bounds[range];
    return RANGE * range + min((max(depth, bound.x) - bound.x) >> bound.y, RANGE - 1u);
}

// Puts the keys into their bins.
fn fill_bins(thread: u32, at: u32, some: u32)
{
    for (var i = thread; i < BINS; i += THREADS) {
        atomicStore(&bins[i], 0u);
    }
    workgroupBarrier();
    for (var i = thread; i < some; i += THREADS) {
        atomicAdd(&bins[bin_of(entries[at + i].y)], 1u);
    }
    workgroupBarrier();
    place_bins(thread);
    for (var i = thread; i < some; i += THREADS) {
        let key = entries[at + i];
        keys[atomicAdd(&bins[bin_of(key.y)], 1u)] = key;
    }
    workgroupBarrier();            // bins are ends now
}

@compute @workgroup_size(128)
fn sort_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let block = block_of(group.y * ROW_OF_GROUPS + group.x);
    if (block.count == 0u) {
        return;
    }
    let some = min(block.count - block.first, BLOCK);
    let at = block.list + block.first;
    bound_ranges(thread, at, some);
    fill_bins(thread, at, some);
    for (var i = thread; i < some; i += THREADS) {
        let key = keys[i];
        let bin = bin_of(key.y);
        var place = 0u;
        if (bin > 0u) {
            place = atomicLoad(&bins[bin - 1u]);
        }
        let end = atomicLoad(&bins[bin]);
        for (var k = place; k < end; k += 1u) {
            place += select(0u, 1u, is_below(keys[k], key));
        }
        entries[at + place] = key;
    }
}

// How many keys of four runs of at most 2^run are below this one: bisections side by side, as each step waits for memory.
fn count_below(first: vec4<u32>, length: vec4<u32>, run: u32, key: vec2<u32>) -> u32
{
    var count = vec4<u32>(0u);
    for (var step = 1u << run; step != 0u; step >>= 1u) {
        let next = count + step;
        let inside = next <= length;
        let at = first + select(vec4<u32>(0u), next - 1u, inside);
        let below = vec4<bool>(is_below(entries[at.x], key), is_below(entries[at.y], key),
                               is_below(entries[at.z], key), is_below(entries[at.w], key));
        count = select(count, next, inside & below);
    }
    return count.x + count.y + count.z + count.w;
}

// THREADS keys of a block, in a run of 2^run keys, from one half of the entries to the other.
fn merge(group: vec3<u32>, thread: u32, run: u32, from_spare: bool)
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    let block = block_of(number / (BLOCK / THREADS));
    let i = block.first + number % (BLOCK / THREADS) * THREADS + thread;
    if (block.count <= 1u << run || i >= block.count) {
        return;
    }
    let source = block.list + select(0u, frame.spare, from_spare);
    let target_list = block.list + select(frame.spare, 0u, from_spare);
    let key = entries[source + i];
    let start = (i >> (run + 4u)) << (run + 4u);       // of 16 runs
    var place = start;
    for (var four = 0u; four < 4u; four += 1u) {
        let first = vec4<u32>(start) + ((vec4<u32>(0u, 1u, 2u, 3u) + 4u * four) << vec4<u32>(run));
        let length = min(max(vec4<u32>(block.count), first) - first, vec4<u32>(1u << run));
        if (length.x != 0u) {
            place += count_below(source + min(first, vec4<u32>(block.count - 1u)), length, run, key);
        }
    }
    entries[target_list + place] = key;
}

@compute @workgroup_size(128)
fn merge_9(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(group, thread, 9u, false);
}

@compute @workgroup_size(128)
fn merge_13(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(group, thread, 13u, true);
}

@compute @workgroup_size(128)
fn merge_17(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(group, thread, 17u, false);
}

@compute @workgroup_size(128)
fn merge_21(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(group, thread, 21u, true);
}

@compute @workgroup_size(128)
fn merge_25(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(group, thread, 25u, false);
}
