// Needs records order
// sort: each tile's list near to far. Blocks of a list are sorted in the memory of a workgroup: keys go to bins by their
// depth, then each counts those of its bin that are less. Runs of a list, blocks at first, are then merged, 16 at a time:
// each key finds its place by bisection of the other runs.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read_write> entries: array<vec2<u32>>;   // slot, depth

const BINS: u32 = 512u;

var<workgroup> keys: array<vec2<u32>, 1024>;
var<workgroup> places: array<u32, 1024>;         // of keys, bin after bin
var<workgroup> bins: array<atomic<u32>, 512>;
var<workgroup> sums: array<u32, 128>;
var<workgroup> bounds: array<atomic<u32>, 2>;    // of depths

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

fn block_of(group: vec3<u32>) -> Block
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    if (number >= counts[BLOCKS] || !fits()) {
        return Block(0u, 0u, 0u);
    }
    let tile = counts[frame.blocks + 2u * number];
    let count = counts[TILES + tile];
    return Block(counts[frame.next + tile] - count, count, BLOCK * counts[frame.blocks + 2u * number + 1u]);
}

// From the sizes of bins to their starts; each thread has four.
fn place_bins(thread: u32)
{
    var own = 0u;
    for (var i = 4u * thread; i < 4u * thread + 4u; i += 1u) {
        own += atomicLoad(&bins[i]);
    }
    sums[thread] = own;
    for (var d = 1u; d < THREADS; d *= 2u) {
        workgroupBarrier();
        var below = 0u;
        if (thread >= d) {
            below = sums[thread - d];
        }
        workgroupBarrier();
        sums[thread] += below;
    }
    var start = sums[thread] - own;
    for (var i = 4u * thread; i < 4u * thread + 4u; i += 1u) {
        let size = atomicLoad(&bins[i]);
        atomicStore(&bins[i], start);
        start += size;
    }
    workgroupBarrier();
}

// Fetches a block's keys, and finds the bounds of their depths.
fn fetch(thread: u32, at: u32, some: u32)
{
    var least = NOTHING;
    var most = 0u;
    for (var i = thread; i < some; i += THREADS) {
        let key = entries[at + i];
        keys[i] = key;
        least = min(least, key.y);
        most = max(most, key.y);
    }
    atomicMin(&bounds[0], least);
    atomicMax(&bounds[1], most);
    workgroupBarrier();
}

@compute @workgroup_size(128)
fn sort_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let block = block_of(group);
    if (block.count == 0u) {
        return;
    }
    let some = min(block.count - block.first, BLOCK);
    let at = block.list + block.first;
    for (var i = thread; i < BINS; i += THREADS) {
        atomicStore(&bins[i], 0u);
    }
    if (thread == 0u) {
        atomicStore(&bounds[0], NOTHING);
        atomicStore(&bounds[1], 0u);
    }
    workgroupBarrier();
    fetch(thread, at, some);
    let low = atomicLoad(&bounds[0]);
    let bits = 32u - countLeadingZeros(atomicLoad(&bounds[1]) - low);
    let shift = max(bits, 9u) - 9u;
    for (var i = thread; i < some; i += THREADS) {
        atomicAdd(&bins[(keys[i].y - low) >> shift], 1u);
    }
    workgroupBarrier();
    place_bins(thread);
    for (var i = thread; i < some; i += THREADS) {
        places[atomicAdd(&bins[(keys[i].y - low) >> shift], 1u)] = i;
    }
    workgroupBarrier();            // bins are ends now
    for (var i = thread; i < some; i += THREADS) {
        let key = keys[i];
        let bin = (key.y - low) >> shift;
        var start = 0u;
        if (bin > 0u) {
            start = atomicLoad(&bins[bin - 1u]);
        }
        let end = atomicLoad(&bins[bin]);
        var place = start;
        for (var k = start; k < end; k += 1u) {
            place += select(0u, 1u, is_below(keys[places[k]], key));
        }
        entries[at + place] = key;
    }
}

// How many of a run's keys are below this one.
fn count_below(first: u32, length: u32, key: vec2<u32>) -> u32
{
    var low = 0u;
    var high = length;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (is_below(entries[first + middle], key)) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// The keys of a block, in a run of 2^run keys, from one half of the entries to the other.
fn merge(thread: u32, block: Block, run: u32, from_spare: bool)
{
    if (block.count <= 1u << run) {
        return;
    }
    let source = block.list + select(0u, frame.spare, from_spare);
    let target_list = block.list + select(frame.spare, 0u, from_spare);
    let end = min(block.first + BLOCK, block.count);
    for (var i = block.first + thread; i < end; i += THREADS) {
        let key = entries[source + i];
        let own = i >> run;
        let first_run = own & ~15u;
        var place = (first_run << run) + (i & ((1u << run) - 1u));
        for (var other = first_run; other < first_run + 16u; other += 1u) {
            let first = other << run;
            if (other != own && first < block.count) {
                place += count_below(source + first, min(1u << run, block.count - first), key);
            }
        }
        entries[target_list + place] = key;
    }
}

@compute @workgroup_size(128)
fn merge_10(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(thread, block_of(group), 10u, false);
}

@compute @workgroup_size(128)
fn merge_14(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(thread, block_of(group), 14u, true);
}

@compute @workgroup_size(128)
fn merge_18(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(thread, block_of(group), 18u, false);
}

@compute @workgroup_size(128)
fn merge_22(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(thread, block_of(group), 22u, true);
}

@compute @workgroup_size(128)
fn merge_26(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    merge(thread, block_of(group), 26u, false);
}
