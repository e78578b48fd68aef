// Sums the gradients of Gaussians that touch many tiles: a workgroup takes a Gaussian, and loads the numbers of a batch
// of tiles at once. Then a thread for each sum adds them in the order of the tiles.
#include "splats.glsl"
#include "large.glsl"
layout(local_size_x = 256) in;

const uint BATCH = 256u, AT_ONCE = 8u;     // tiles of a batch, and numbers that a thread reads before it adds them
shared float batch[BATCH * FXS_FIT_SUMS];

float added_to(float sum, uint k)
{
    for (uint t = 0u; t < BATCH; t += AT_ONCE) {
        float some[AT_ONCE];
        for (uint i = 0u; i < AT_ONCE; i++)
            some[i] = batch[(t + i) * FXS_FIT_SUMS + k];
        for (uint i = 0u; i < AT_ONCE; i++)
            sum += some[i];
    }
    return sum;
}

void gather(uint gaussian, uint tiles, uint planes)
{
    const uint first = order.at_sums + gaussians[order.at_bases + gaussian] * FXS_FIT_SUMS;
    const uint end = tiles * FXS_FIT_SUMS, thread = gl_LocalInvocationIndex;
    float sum = 0.0;
    for (uint at = 0u; at < end; at += BATCH * FXS_FIT_SUMS) {
        barrier();
        for (uint i = thread; i < BATCH * FXS_FIT_SUMS; i += 256u)
            batch[i] = at + i < end ? uintBitsToFloat(slots[first + at + i]) : 0.0;
        barrier();
        if (thread < FXS_FIT_SUMS)
            sum = added_to(sum, thread);
    }
    if (thread < FXS_FIT_SUMS)
        gaussians[planes + thread * order.stride + gaussian] = floatBitsToUint(sum);
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint planes = order.at_planes + view * order.view_numbers +
                        is_surface * (FXS_FIT_SUMS + 1u) * order.stride;
    for (uint i = gl_WorkGroupID.x; i < status.listed; i += gl_NumWorkGroups.x) {
        const uint gaussian = gaussians[order.at_large + i], tiles = tiles_of(gaussian);
        if (tiles > SOME_TILES)
            gather(gaussian, tiles, planes);
    }
}
