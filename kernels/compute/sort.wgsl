// Sorts each tile's list by ascending depth, then by splat. A sample sort orders blocks of 512 entries: 16 sampled
// depths bound 16 ranges of 16 bins. Merge passes then join sorted runs in pairs; a binary search finds the keys of
// both runs for each block of 512 results.
// Needs records sums order

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read_write> counts: array<u32>;
@group(1) @binding(1) var<storage, read_write> entries: array<u32>;
@group(1) @binding(2) var<storage, read_write> memory: array<u32>;

const SAMPLES: u32 = 16u;
const RANGE: u32 = 16u;
const BINS: u32 = 256u;

var<workgroup> keys: array<vec2<u32>, 512>;
// sizes of the depth bins, later their start offsets; the last is the number of keys
var<workgroup> bins: array<atomic<u32>, 257>;
var<workgroup> samples: array<u32, 16>;
var<workgroup> ranks: array<atomic<u32>, 16>;
var<workgroup> bounds: array<vec2<u32>, 16>;     // per range of depth bins: smallest depth, log2 of the width of a bin

fn keyed(entry: u32) -> vec2<u32>
{
    return vec2<u32>(entry, memory[frame.depths + (entry & ~CUT_OFF)]);
}

const SPARE: u32 = 0x80000000u;    // flag of a position in the scratch space, instead of in `entries`

fn key_at(at: u32) -> vec2<u32>
{
    if ((at & SPARE) != 0u) {
        return keyed(memory[frame.spare + (at & ~SPARE)]);
    }
    return keyed(entries[at]);
}

fn put_entry(at: u32, entry: u32)
{
    if ((at & SPARE) != 0u) {
        memory[frame.spare + (at & ~SPARE)] = entry;
    } else {
        entries[at] = entry;
    }
}

fn is_below(a: vec2<u32>, b: vec2<u32>) -> bool
{
    return select(a.y < b.y, a.x < b.x, a.y == b.y);
}

const DONE: u32 = 0x100000u;

struct Block {
    list: u32,
    count: u32,
    first: u32,
    done: u32,
}

var<workgroup> own_block: Block;

// Returns the number of merge passes for a list. Each pass moves the list between `entries` and scratch space; the last
// one ends in `entries`.
fn merges_of(count: u32) -> u32
{
    return max(32u - countLeadingZeros(count - 1u), 9u) - 9u;
}

fn take_block(group: vec3<u32>, thread: u32) -> Block
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    if (thread == 0u) {
        let long = counts[LONG_BLOCKS];
        let at = frame.blocks + 2u * select(number - long, frame.block_room - 1u - number, number < long);
        own_block.count = 0u;
        if (number < long + counts[SHORT_BLOCKS]) {
            let tile = counts[at];
            let count = counts[list_of(tile)];
            own_block = Block(counts[list_of(tile) + 1u] - count, count, BLOCK * (counts[at + 1u] % DONE),
                              counts[at + 1u] / DONE);
            counts[at + 1u] += DONE;
        }
    }
    return workgroupUniformLoad(&own_block);
}

fn place_bins(thread: u32, some: u32)
{
    let bin = 2u * thread;
    let size = atomicLoad(&bins[bin]);
    let start = sum_before(thread, size + atomicLoad(&bins[bin + 1u]), false);
    atomicStore(&bins[bin], start);
    atomicStore(&bins[bin + 1u], start + size);
    if (thread == 0u) {
        atomicStore(&bins[BINS], some);
    }
    workgroupBarrier();
}

fn bound_ranges(thread: u32, at: u32, some: u32)
{
    let sample = thread % SAMPLES;
    if (thread < SAMPLES) {
        samples[thread] = key_at(at + thread * max(some, SAMPLES) / SAMPLES % some).y;
        atomicStore(&ranks[thread], 0u);
    }
    workgroupBarrier();
    let own = samples[sample];
    var below = 0u;
    for (var i = 0u; i < SAMPLES * SAMPLES / THREADS; i += 1u) {
        let other = thread / SAMPLES * (SAMPLES * SAMPLES / THREADS) + i;
        below += select(0u, 1u, samples[other] < own || (samples[other] == own && other < sample));
    }
    atomicAdd(&ranks[sample], below);
    workgroupBarrier();
    if (thread < SAMPLES) {
        bounds[atomicLoad(&ranks[thread])].x = own;
    }
    workgroupBarrier();
    if (thread < SAMPLES) {
        let width = bounds[min(thread + 1u, SAMPLES - 1u)].x - bounds[thread].x;
        bounds[thread].y = max(32u - countLeadingZeros(width), 4u) - 4u;
    }
    workgroupBarrier();
}

// Returns the bin of a depth. Its range of bins is the last one that starts at or below the depth.
fn bin_of(depth: u32) -> u32
{
    var range = 0u;
    for (var step = SAMPLES / 2u; step != 0u; step >>= 1u) {
        range += select(0u, step, bounds[range + step].x <= depth);
    }
    let bound = bounds[range];
    return RANGE * range + min((max(depth, bound.x) - bound.x) >> bound.y, RANGE - 1u);
}

// Sorts up to BLOCK entries, from position `at` on, and writes them from position `to` on.
fn sort_block(thread: u32, at: u32, some: u32, to: u32)
{
    var own: array<vec2<u32>, 4>;
    var bin_of_own: array<u32, 4>;
    var place: array<u32, 4>;
    for (var i = thread; i < BINS; i += THREADS) {
        atomicStore(&bins[i], 0u);
    }
    for (var k = 0u; k < BLOCK / THREADS; k += 1u) {
        if (thread + k * THREADS < some) {
            own[k] = key_at(at + thread + k * THREADS);
        }
    }
    bound_ranges(thread, at, some);
    for (var k = 0u; k < BLOCK / THREADS; k += 1u) {
        if (thread + k * THREADS < some) {
            bin_of_own[k] = bin_of(own[k].y);
            place[k] = atomicAdd(&bins[bin_of_own[k]], 1u);
        }
    }
    workgroupBarrier();
    place_bins(thread, some);
    for (var k = 0u; k < BLOCK / THREADS; k += 1u) {
        if (thread + k * THREADS < some) {
            keys[atomicLoad(&bins[bin_of_own[k]]) + place[k]] = own[k];
        }
    }
    workgroupBarrier();
    for (var k = 0u; k < BLOCK / THREADS; k += 1u) {
        if (thread + k * THREADS < some) {
            let first = atomicLoad(&bins[bin_of_own[k]]);
            let end = atomicLoad(&bins[bin_of_own[k] + 1u]);
            var below = first;
            for (var i = first; i < end; i += 1u) {
                below += select(0u, 1u, is_below(keys[i], own[k]));
            }
            put_entry(to + below, own[k].x);
        }
    }
}

@compute @workgroup_size(128)
fn sort_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let block = take_block(group, thread);
    if (block.count == 0u) {
        return;
    }
    let at = block.list + block.first;
    let to = at | select(0u, SPARE, merges_of(block.count) % 2u == 1u);
    sort_block(thread, at, min(block.count - block.first, BLOCK), to);
}

var<workgroup> below_split: array<atomic<u32>, 2>;
var<workgroup> splits: array<u32, 2>;

// Splits the result of merging two sorted runs: returns how many of the d smallest keys come from the first run. The
// runs have a keys at `first` and b keys at `second`. Each half of the workgroup has its own d.
fn split(thread: u32, first: u32, a: u32, second: u32, b: u32, d: u32, run: u32) -> u32
{
    let side = thread / 64u;
    var low = d - min(d, b);
    var high = min(d, a);
    for (var i = 0u; i <= run / 6u; i += 1u) {
        let step = (high - low + 63u) / 64u;
        let place = low + thread % 64u * step;
        atomicStore(&below_split[side], 0u);
        workgroupBarrier();
        if (place < high && is_below(key_at(first + place), key_at(second + d - 1u - place))) {
            atomicAdd(&below_split[side], 1u);
        }
        workgroupBarrier();
        let below = atomicLoad(&below_split[side]);
        workgroupBarrier();
        high = min(high, low + below * step);
        low += select(0u, (below - 1u) * step + 1u, below != 0u);
    }
    return low;
}

// Counts the keys below `key` among `count` sorted keys.
fn count_below(first: u32, count: u32, key: vec2<u32>) -> u32
{
    var below = 0u;
    for (var step = BLOCK / 2u; step != 0u; step >>= 1u) {
        let next = below + step;
        if (next <= count && is_below(keys[first + next - 1u], key)) {
            below = next;
        }
    }
    return below;
}

// Merges two sorted runs of 2^run entries of the list at position `source`. Writes one block of the results, the
// entries from `block` on of the list at position `to`.
fn merge_block(thread: u32, source: u32, to: u32, count: u32, block: u32, run: u32)
{
    let start = (block >> (run + 1u)) << (run + 1u);
    let both = min(count - start, 2u << run);
    let a = min(both, 1u << run);
    let d = block - start;
    let some = min(both - d, BLOCK);
    let first = source + start;
    let second = first + a;
    splits[thread / 64u] = split(thread, first, a, second, both - a, d + thread / 64u * some, run);
    workgroupBarrier();
    let of_first = splits[1] - splits[0];
    for (var i = thread; i < some; i += THREADS) {
        let at = select(second + d - splits[0] + i - of_first, first + splits[0] + i, i < of_first);
        keys[i] = key_at(at);
    }
    workgroupBarrier();
    for (var i = thread; i < some; i += THREADS) {
        let key = keys[i];
        let is_first = i < of_first;
        let below = count_below(select(0u, of_first, is_first), select(of_first, some - of_first, is_first), key);
        put_entry(to + block + select(i - of_first, i, is_first) + below, key.x);
    }
}

@compute @workgroup_size(128)
fn merge_runs(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let block = take_block(group, thread);
    let run = 8u + block.done;
    if (block.count <= 1u << run) {
        return;
    }
    let from_spare = (merges_of(block.count) + 1u - block.done) % 2u == 1u;
    merge_block(thread, block.list | select(0u, SPARE, from_spare), block.list | select(SPARE, 0u, from_spare),
                block.count, block.first, run);
}
