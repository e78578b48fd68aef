// Writes the slots of splats that touch few tiles, and counts the slots of each tile.
#include "splats.glsl"
#include "large.glsl"
#include "cover.glsl"
layout(local_size_x = 128) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (status.is_full != 0u || i >= order.count)
        return;
    uint slot = gaussians[order.at_bases + i];
    const uint tiles = tiles_of(i);
    if (tiles == 0u || tiles > FEW_TILES)
        return;
    const ellipses e = ellipse_of(i);
    for (float row = e.first; row < e.end; row += 1.0) {
        float first, end;
        find_columns(order.cameras[view], e, row, first, end);
        put_row(i, row, first, end, slot);
        slot += end > first ? uint(end - first) : 0u;
    }
}
