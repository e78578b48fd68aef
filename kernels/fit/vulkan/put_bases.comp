// Replaces the tiles of each Gaussian by the number of its first slot.
#include "scan.glsl"
layout(local_size_x = 256) in;

void main()
{
    const uint first = (gl_WorkGroupID.x * 256u + gl_LocalInvocationIndex) * 8u;
    uint tiles[8], sum = 0u, all_threads;
    if (status.is_full != 0u)
        return;
    for (uint k = 0u; k < 8u; k++) {
        tiles[k] = first + k < order.count ? gaussians[order.at_bases + first + k] : 0u;
        sum += tiles[k];
    }
    uint base = sum_before(sum, all_threads) + gaussians[order.at_parts + gl_WorkGroupID.x];
    for (uint k = 0u; k < 8u && first + k <= order.count; k++) {
        gaussians[order.at_bases + first + k] = base;
        base += tiles[k];
    }
}
