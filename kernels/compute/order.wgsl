// Returns the tile that a workgroup draws: tiles with longer lists of splats come first, in 16 classes by length.

fn classes_before(number: u32, sizes: vec4<u32>, start: ptr<function, u32>, all: ptr<function, u32>) -> u32
{
    let w = *all + sizes.w;
    let z = w + sizes.z;
    let y = z + sizes.y;
    let x = y + sizes.x;
    let ends = vec4<u32>(x, y, z, w);
    let before = select(vec4<u32>(0u), vec4<u32>(1u), vec4<u32>(number) >= ends);
    let last = before * ends;
    *all = x;
    *start = max(*start, max(max(last.x, last.y), max(last.z, last.w)));
    return before.x + before.y + before.z + before.w;
}

fn class_sizes(first: u32) -> vec4<u32>
{
    let at = CLASS_COUNTS + first;
    return vec4<u32>(counts[at], counts[at + 1u], counts[at + 2u], counts[at + 3u]);
}

// Returns the tile at place `number` of the drawing order. The sizes of all 16 length classes are loaded at once,
// because a loop would wait for each load.
fn tile_at(number: u32) -> u32
{
    let a = class_sizes(12u);
    let b = class_sizes(8u);
    let c = class_sizes(4u);
    let d = class_sizes(0u);
    var start = 0u;
    var all = 0u;
    let before = classes_before(number, a, &start, &all) + classes_before(number, b, &start, &all) +
                 classes_before(number, c, &start, &all) + classes_before(number, d, &start, &all);
    if (before == CLASSES) {
        return NOTHING;
    }
    return counts[frame.classes + (CLASSES - 1u - before) * u32(frame.tiles.x * frame.tiles.y) + number - start];
}
