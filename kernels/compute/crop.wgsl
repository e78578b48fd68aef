// Tests points and boxes against an object's crop boxes.

fn crop_bound(crop: u32, i: u32, high: bool) -> wide
{
    let word = 2u * i + select(0u, 6u, high);
    let four = object.crops[4u * crop + word / 4u];
    return select(four.xy, four.zw, word % 4u == 2u);
}

fn lies_in(low: ptr<function, array<wide, 3>>, high: ptr<function, array<wide, 3>>, crop: u32, any: bool) -> bool
{
    var inside = true;
    for (var i = 0u; i < 3u; i += 1u) {
        let first = select((*low)[i], (*high)[i], any);
        let last = select((*high)[i], (*low)[i], any);
        inside = inside && !less(first, crop_bound(crop, i, false)) && !less(crop_bound(crop, i, true), last);
    }
    return inside;
}

// Returns true if the crop boxes may leave a part of the box low..high visible. The result is exact for a single point.
fn is_within_crops(low: ptr<function, array<wide, 3>>, high: ptr<function, array<wide, 3>>) -> bool
{
    var kept = object.keep_count == 0u;
    for (var crop = 0u; crop < object.crop_count; crop += 1u) {
        let outside = object.crops[4u * crop + 3u].x != 0u;
        if (outside && lies_in(low, high, crop, false)) {
            return false;
        }
        kept = kept || (!outside && lies_in(low, high, crop, true));
    }
    return kept;
}
