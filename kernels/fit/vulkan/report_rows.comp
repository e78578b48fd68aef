// For a progress report: sums of |picture - photograph| and of 1 - SSIM for each row of pixels and channel. 16 threads
// sum a row: each every 16th number, and then these sums as a binary tree.
#include "photograph.glsl"
layout(local_size_x = 256) in;

shared float sums[2][256];

void main()
{
    if (status.is_full != 0u)
        return;
    const uint width = uint(order.cameras[view].width), height = uint(order.cameras[view].height);
    const uint own = gl_GlobalInvocationID.x / 16u, lane = gl_LocalInvocationIndex % 16u;
    const uint row = min(own, 3u * height - 1u), channel = row / height, y = row % height;
    float difference = 0.0, unlike = 0.0;
    for (uint x = lane; x < width; x += 16u) {
        const uint at = y * width + x;
        const float level = level_of(at, channel);
        const float a = seen_as(uintBitsToFloat(pixels[order.at_picture + row * width + x]), level);
        difference += counts(at) ? absolute(a - level) : 0.0;
        unlike += uintBitsToFloat(pixels[order.at_dissimilar + row * width + x]);
    }
    sums[0][gl_LocalInvocationIndex] = difference;
    sums[1][gl_LocalInvocationIndex] = unlike;
    for (uint apart = 8u; apart > 0u; apart /= 2u) {
        barrier();
        for (int k = 0; k < 2 && lane < apart; k++)
            sums[k][gl_LocalInvocationIndex] += sums[k][gl_LocalInvocationIndex + apart];
    }
    if (own >= 3u * height || lane != 0u)
        return;
    const uint out_at = order.at_rows + 2u * channel * height + y;
    pixels[out_at] = floatBitsToUint(sums[0][gl_LocalInvocationIndex]);
    pixels[out_at + height] = floatBitsToUint(sums[1][gl_LocalInvocationIndex]);
}
