// Turns the numbers of slots of the tiles into the starts of their lists, in one workgroup.
#include "scan.glsl"
layout(local_size_x = 256) in;

void main()
{
    uint start = 0u, all_threads;
    if (status.is_full != 0u)
        return;
    for (uint first = 0u; first <= tile_count(); first += 256u) {
        const uint tile = first + gl_LocalInvocationIndex;
        const uint before = sum_before(tile < tile_count() ? pixels[order.at_starts + tile] : 0u, all_threads);
        if (tile <= tile_count())
            pixels[order.at_starts + tile] = start + before;
        if (tile < tile_count())
            pixels[order.at_next + tile] = start + before;
        start += all_threads;
    }
    if (gl_LocalInvocationIndex == 0u) {
        status.listed = status.large;
        status.large = 0u;
    }
}
