// Sums along each row of pixels for the gradient by an exposure: of dL/da_c a_k, and of dL/da_c. 16 threads sum a row:
// each every 16th number, and then these sums as a binary tree.
layout(local_size_x = 256) in;

shared float sums[256];

void main()
{
    if (status.is_full != 0u)
        return;
    const uint width = uint(order.cameras[view].width), height = uint(order.cameras[view].height);
    const uint own = gl_GlobalInvocationID.x / 16u, lane = gl_LocalInvocationIndex % 16u;
    const uint row = min(own, uint(FXS_FIT_GAIN) * height - 1u), k = row / height;
    const uint gradient = order.at_gradient + (k % 3u * height + row % height) * width;
    const uint picture = order.at_picture + ((k < 9u ? k / 3u : 0u) * height + row % height) * width;
    float sum = 0.0;
    for (uint x = lane; x < width && gain_needs(order.is_affine, int(k)) != 0; x += 16u) {
        const float g = uintBitsToFloat(pixels[gradient + x]);
        sum += k < 9u ? g * uintBitsToFloat(pixels[picture + x]) : g;
    }
    sums[gl_LocalInvocationIndex] = sum;
    for (uint apart = 8u; apart > 0u; apart /= 2u) {
        barrier();
        if (lane < apart)
            sums[gl_LocalInvocationIndex] += sums[gl_LocalInvocationIndex + apart];
    }
    if (own < uint(FXS_FIT_GAIN) * height && lane == 0u)
        pixels[order.at_gain_rows + row] = floatBitsToUint(sums[gl_LocalInvocationIndex]);
}
