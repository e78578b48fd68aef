// Sums the tiles of each part of 2048 Gaussians.
#include "scan.glsl"
layout(local_size_x = 256) in;

void main()
{
    uint sum = 0u, all_threads;
    if (status.is_full != 0u)
        return;
    for (uint k = 0u; k < 8u; k++) {
        const uint i = (gl_WorkGroupID.x * 256u + gl_LocalInvocationIndex) * 8u + k;
        sum = added(sum, i < order.count ? gaussians[order.at_bases + i] : 0u);
    }
    sum_before(sum, all_threads);
    if (gl_LocalInvocationIndex == 0u)
        gaussians[order.at_parts + gl_WorkGroupID.x] = all_threads;
}
