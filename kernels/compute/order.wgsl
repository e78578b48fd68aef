// Tiles in the order of their lists' classes, the longest first. One is NOTHING behind the last.

fn tile_at(number: u32) -> u32
{
    let tiles = u32(frame.tiles.x * frame.tiles.y);
    var rest = number;
    for (var class_number = CLASSES; class_number > 0u; class_number -= 1u) {
        let count = counts[CLASS_COUNTS + class_number - 1u];
        if (rest < count) {
            return counts[frame.classes + (class_number - 1u) * tiles + rest];
        }
        rest -= count;
    }
    return NOTHING;
}

fn fits() -> bool
{
    return counts[PAGES] <= frame.page_room && counts[LARGES] <= frame.large_room &&
           counts[VISIBLE_CHUNKS] <= frame.chunk_room;
}
