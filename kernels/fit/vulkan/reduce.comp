// Reduces the photograph: each byte becomes the mean of divisor x divisor bytes; a pixel of the mask counts if all of
// its pixels do. A thread writes four bytes.
#include "photograph.glsl"
layout(local_size_x = 256) in;

uint reduced_byte(uint i)
{
    const uint width = 3u * uint(order.cameras[view].width), divisor = uint(order.photographs[view].divisor);
    const uint x = i % width, y = i / width, full = 3u * uint(order.photographs[view].full_width);
    const uint first = y * divisor * full + x / 3u * 3u * divisor + x % 3u;
    uint sum = divisor * divisor / 2u;
    for (uint k = 0u; k < divisor * divisor; k++)
        sum += byte_at(order.photographs[view].at_full, first + k / divisor * full + k % divisor * 3u);
    return sum / (divisor * divisor);
}

uint reduced_mask(uint i)
{
    const uint width = uint(order.cameras[view].width), divisor = uint(order.photographs[view].divisor), full = uint(order.photographs[view].full_width);
    const uint first = i / width * divisor * full + i % width * divisor;
    uint is_counted = 1u;
    for (uint k = 0u; k < divisor * divisor; k++)
        is_counted &= byte_at(order.photographs[view].at_full_mask, first + k / divisor * full + k % divisor) != 0u ? 1u : 0u;
    return is_counted;
}

void main()
{
    const uint size = uint(order.cameras[view].width * order.cameras[view].height), i = 4u * gl_GlobalInvocationID.x;
    uint word = 0u;
    for (uint k = 0u; k < 4u && i + k < 3u * size; k++)
        word |= reduced_byte(i + k) << 8u * k;
    if (i < 3u * size)
        photograph[order.photographs[view].at + i / 4u] = word;
    word = 0u;
    for (uint k = 0u; k < 4u && i + k < size && order.photographs[view].at_mask != 0xffffffffu; k++)
        word |= reduced_mask(i + k) << 8u * k;
    if (i < size && order.photographs[view].at_mask != 0xffffffffu)
        photograph[order.photographs[view].at_mask + i / 4u] = word;
}
