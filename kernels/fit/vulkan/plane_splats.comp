// Replaces the colours of visible splats by the planes of their Gaussians (src/fit/stages/fit_surface.h).
#include "splats.glsl"
layout(local_size_x = 128) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (status.is_full != 0u || i >= order.count || gaussians[splat_at(i) + SPLAT_DEPTH] == 0u)
        return;
    float plane[3];
    find_plane(order.cameras[view], i, order.stride, plane);
    for (uint c = 0u; c < 3u; c++)
        gaussians[splat_at(i) + uint(SPLAT_COLOUR) + c] = floatBitsToUint(plane[c]);
}
