// Sums along each row of pixels for a step of an exposure (src/fit/stages/exposure.h): of the gradient for an affine
// exposure, else of picture and photograph. 16 threads sum a row: each every 16th number, and then these sums as a binary
// tree.
#include "photograph.glsl"
layout(local_size_x = 256) in;

shared float sums[256];

float of_plane(uint plane, uint at) { return uintBitsToFloat(pixels[plane + at]); }

float gain_number(uint k, uint size, uint at)
{
    const uint gradient = order.at_gradient + k % 3u * size;
    if (order.is_affine != 0)
        return k < 9u ? of_plane(gradient, at) * of_plane(order.at_picture + k / 3u * size, at) : of_plane(gradient, at);
    return counts(at) ? gain_summand(int(k), of_plane(order.at_picture + k % 3u * size, at), level_of(at, k % 3u)) : 0.0;
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint width = uint(order.cameras[view].width), height = uint(order.cameras[view].height);
    const uint own = gl_GlobalInvocationID.x / 16u, lane = gl_LocalInvocationIndex % 16u;
    const uint row = min(own, uint(FXS_FIT_GAIN) * height - 1u), k = row / height;
    float sum = 0.0;
    for (uint x = lane; x < width && gain_needs(order.is_affine, int(k)) != 0; x += 16u)
        sum += gain_number(k, width * height, row % height * width + x);
    sums[gl_LocalInvocationIndex] = sum;
    for (uint apart = 8u; apart > 0u; apart /= 2u) {
        barrier();
        if (lane < apart)
            sums[gl_LocalInvocationIndex] += sums[gl_LocalInvocationIndex + apart];
    }
    if (own < uint(FXS_FIT_GAIN) * height && lane == 0u)
        pixels[order.at_gain_rows + row] = floatBitsToUint(sums[gl_LocalInvocationIndex]);
}
