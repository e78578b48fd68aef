// Sums each Gaussian's gradients over its tiles, in the order of the tiles, and notes whether the view sees it. Leaves
// the sums of the largest Gaussians to gather_large.
#include "splats.glsl"
#include "large.glsl"
layout(local_size_x = 256) in;

void main()
{
    if (status.is_full != 0u)
        return;
    const uint planes = order.at_planes + view * order.view_numbers +
                        is_surface * (FXS_FIT_SUMS + 1u) * order.stride;
    for (uint i = gl_GlobalInvocationID.x; i < order.count * FXS_FIT_SUMS; i += gl_NumWorkGroups.x * 256u) {
        const uint gaussian = i / FXS_FIT_SUMS, k = i % FXS_FIT_SUMS, tiles = tiles_of(gaussian);
        const uint first = order.at_sums + gaussians[order.at_bases + gaussian] * FXS_FIT_SUMS + k;
        float sum = 0.0;
        for (uint t = 0u; t < tiles && tiles <= SOME_TILES; t++)
            sum += uintBitsToFloat(slots[first + t * FXS_FIT_SUMS]);
        if (tiles <= SOME_TILES)
            gaussians[planes + k * order.stride + gaussian] = floatBitsToUint(sum);
        if (k == 0u)
            gaussians[planes + FXS_FIT_SUMS * order.stride + gaussian] =
                gaussians[splat_at(gaussian) + SPLAT_DEPTH] != 0u ? 1u : 0u;
    }
}
