// Compacts the visible chunks (of 256 Gaussians) into a list, and counts them per object.
// Needs numbers records sums

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read_write> arguments: array<u32>;
@group(1) @binding(1) var<storage, read_write> memory: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;

fn put_arguments(at: u32, groups: u32)
{
    arguments[4u * at] = min(groups, ROW_OF_GROUPS);
    arguments[4u * at + 1u] = (groups + ROW_OF_GROUPS - 1u) / ROW_OF_GROUPS;
    arguments[4u * at + 2u] = 1u;
}

// Returns the number of visible chunks before the drawn chunk with index `place`.
fn rank_of(place: u32) -> u32
{
    let below = atomicLoad(&counts[frame.seen + place / 32u]) & ((1u << (place % 32u)) - 1u);
    return memory[frame.ranks + place / 32u] + countOneBits(below);
}

@compute @workgroup_size(128)
fn gather_chunks(@builtin(local_invocation_index) thread: u32)
{
    let words = frame.places / 32u + 1u;
    let each = (words + THREADS - 1u) / THREADS;
    let first = min(thread * each, words);
    let end = min(first + each, words);
    var own = 0u;
    for (var i = first; i < end; i += 1u) {
        own += countOneBits(atomicLoad(&counts[frame.seen + i]));
    }
    var at = sum_before(thread, own, false);
    for (var i = first; i < end; i += 1u) {
        memory[frame.ranks + i] = at;
        for (var bits = atomicLoad(&counts[frame.seen + i]); bits != 0u; bits &= bits - 1u) {
            memory[frame.visible + at] = 32u * i + countTrailingZeros(bits);
            at += 1u;
        }
    }
    storageBarrier();
    workgroupBarrier();
    for (var i = thread; i <= frame.spans; i += THREADS) {
        let span = frame.spans_at + SPAN * i;
        let low = rank_of(memory[span]);
        let high = rank_of(memory[span + 1u]);
        memory[span + 2u] = low;
        memory[span + 3u] = high;
        put_arguments(i, max(2u * (high - low), select(0u, 1u, i == frame.spans)));
    }
    if (thread == THREADS - 1u) {
        atomicStore(&counts[VISIBLE_CHUNKS], at);
    }
}

@compute @workgroup_size(128)
fn clear_counts(@builtin(global_invocation_id) at: vec3<u32>)
{
    let i = at.y * ROW_OF_GROUPS * THREADS + at.x;
    if (i < frame.cleared) {
        atomicStore(&counts[i], 0u);
    }
}
