// Projects the Gaussians to splats and colours them, and counts the tiles that each touches.
#include "splats.glsl"
#include "large.glsl"
layout(local_size_x = 128) in;

shared uint seen_count;

void put_splat(uint i, float numbers[SPLAT_NUMBERS])
{
    float colour[3];
    find_colours(order.cameras[view], order.degree, i, order.stride, numbers[SPLAT_LIMIT], colour);
    for (int c = 0; c < 3; c++)
        numbers[SPLAT_COLOUR + c] = colour[c];
    for (int k = 0; k < SPLAT_NUMBERS; k++)
        gaussians[splat_at(i) + uint(k)] = floatBitsToUint(numbers[k]);
}

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    float numbers[SPLAT_NUMBERS];
    if (status.is_full != 0u)
        return;
    if (gl_LocalInvocationIndex == 0u)
        seen_count = 0u;
    barrier();
    for (uint tile = i; tile < tile_count(); tile += gl_NumWorkGroups.x * 128u)
        pixels[order.at_starts + tile] = 0u;
    const bool is_seen = i < order.count && find_splat(order.cameras[view], i, order.stride, numbers) != 0;
    const uint tiles = is_seen ? uint(numbers[SPLAT_TILES]) : 0u;
    if (is_seen) {
        put_splat(i, numbers);
        atomicAdd(seen_count, 1u);
    } else if (i < order.count)
        gaussians[splat_at(i) + SPLAT_DEPTH] = 0u;
    if (i <= order.count)
        gaussians[order.at_bases + i] = tiles;
    if (tiles > FEW_TILES)
        gaussians[order.at_large + atomicAdd(status.large, 1u)] = i;
    barrier();
    if (gl_LocalInvocationIndex == 0u && seen_count > 0u)
        atomicAdd(status.visible, seen_count);
}
