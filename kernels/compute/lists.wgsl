// Assigns memory to the tiles' lists of splats, one workgroup per row of tiles.
// Needs numbers records sums

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read_write> arguments: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;

var<workgroup> first_page: u32;

// Returns the length class of a tile's list. Class 0: empty list; last class: 4096 entries and more.
fn class_of(length: u32) -> u32
{
    return select(min(34u - countLeadingZeros(length), CLASSES - 1u), 0u, length == 0u);
}

fn put_blocks(tile: u32, length: u32)
{
    let blocks = select(0u, (length - 1u) / BLOCK + 1u, length > 1u);
    if (blocks == 0u) {
        return;
    }
    var at = 0u;
    if (blocks > 1u) {
        atomicMax(&counts[LONGEST], length);
        at = frame.block_room - atomicAdd(&counts[LONG_BLOCKS], blocks) - blocks;
    } else {
        at = atomicAdd(&counts[SHORT_BLOCKS], 1u);
    }
    for (var i = 0u; i < blocks && at + i < frame.block_room; i += 1u) {
        atomicStore(&counts[frame.blocks + 2u * (at + i)], tile);
        atomicStore(&counts[frame.blocks + 2u * (at + i) + 1u], i);
    }
}

@compute @workgroup_size(128)
fn start_lists(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let across = u32(frame.tiles.x);
    let row = group.x * across;
    var tiles_before = 0u;
    var entries_before = 0u;
    for (var first = 0u; first < across; first += THREADS) {
        let column = first + thread;
        let at = list_of(row + column);
        var own = 0u;
        if (column < across) {
            own = atomicLoad(&counts[at]);
        }
        workgroupBarrier();
        var length = tiles_before + sum_before(thread, own, false) + own;
        tiles_before += sum_of_all(false);
        if (column >= across) {
            length = 0u;
        }
        workgroupBarrier();
        let end = plus(plus(entries_before, sum_before(thread, length, true), true), length, true);
        entries_before = plus(entries_before, sum_of_all(true), true);
        if (column < across) {
            atomicStore(&counts[at], length);
            atomicStore(&counts[at + 1u], end - length);
        }
    }
    if (thread == 0u) {
        if (atomicAdd(&counts[ENTRIES], entries_before) + entries_before < entries_before) {
            atomicAdd(&counts[ENTRIES + 1u], 1u);
        }
        first_page = atomicAdd(&counts[PAGES], entries_before / PAGE + 1u);
        if (group.x == 0u) {
            let larges = min(atomicLoad(&counts[LARGES]), frame.large_room);
            let at = 4u * (frame.spans + 1u);
            arguments[at] = min(larges, ROW_OF_GROUPS);
            arguments[at + 1u] = (larges + ROW_OF_GROUPS - 1u) / ROW_OF_GROUPS;
            arguments[at + 2u] = 1u;
        }
    }
    workgroupBarrier();
    for (var column = thread; column < across; column += THREADS) {
        let tile = row + column;
        let length = atomicLoad(&counts[list_of(tile)]);
        let class_number = class_of(length);
        put_blocks(tile, length);
        let place = atomicAdd(&counts[CLASS_COUNTS + class_number], 1u);
        atomicStore(&counts[frame.classes + class_number * across * u32(frame.tiles.y) + place], tile);
        atomicAdd(&counts[list_of(tile) + 1u], first_page * PAGE);
    }
}
