// Writes the slots of large splats: a workgroup takes a splat, and a thread a row of tiles.
#include "splats.glsl"
#include "scan.glsl"
#include "cover.glsl"
layout(local_size_x = 256) in;

void cover(uint gaussian)
{
    const ellipses e = ellipse_of(gaussian);
    uint slot = gaussians[order.at_bases + gaussian];
    for (float rows = e.first; rows < e.end; rows += 256.0) {
        const float row = rows + float(gl_LocalInvocationIndex);
        float first = 0.0, end = 0.0;
        uint all_rows;
        if (row < e.end)
            find_columns(order.cameras[view], e, row, first, end);
        const uint before = sum_before(end > first ? uint(end - first) : 0u, all_rows);
        if (end > first)
            put_row(gaussian, row, first, end, slot + before);
        slot += all_rows;
    }
}

void main()
{
    if (status.is_full != 0u)
        return;
    for (uint i = gl_WorkGroupID.x; i < status.large; i += gl_NumWorkGroups.x)
        cover(gaussians[order.at_large + i]);
}
