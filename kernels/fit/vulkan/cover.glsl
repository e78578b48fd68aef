// Slots of a splat: the tiles that its ellipse touches, row by row.
ellipses ellipse_of(uint gaussian)
{
    ellipses e;
    e.x = splat_number(gaussian, 0u);
    e.y = splat_number(gaussian, 1u);
    e.ux = splat_number(gaussian, 2u);
    e.uy = splat_number(gaussian, 3u);
    e.vy = splat_number(gaussian, 4u);
    e.radius2 = splat_number(gaussian, 11u);
    e.half_y = splat_number(gaussian, 12u);
    e.tip = splat_number(gaussian, 13u);
    find_rows(order.cameras[view], 1, e);
    return e;
}

void put_row(uint gaussian, float row, float first, float end, uint slot)
{
    const uint tile = uint(row) * uint(order.cameras[view].tiles_x);
    for (uint x = uint(first); x < uint(end); x++, slot++) {
        slots[order.at_tiles + slot] = tile + x;
        slots[order.at_splat_of + slot] = gaussian;
        atomicAdd(pixels[order.at_starts + tile + x], 1u);
    }
}
