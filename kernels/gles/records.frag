// Reads splats of the tiles' lists. A splat has coordinates u and v, linear in the pixel position, with values u0 and
// v0 at pixel (0, 0). The record of a splat has two texels: (u0, du/dx, du/dy, v0), (dv/dy, offset and red, green and
// blue, depth key).
uniform highp usampler2D records;

struct record {
    uvec4 a, b;
};

ivec2 texel(int i, int shift)
{
    return ivec2(i & ((1 << shift) - 1), i >> shift);
}

// Reads the record of splat i. `shift` is log2 of the width of texture `records`.
record record_at(int i, int shift)
{
    return record(texelFetch(records, texel(2 * i, shift), 0), texelFetch(records, texel(2 * i + 1, shift), 0));
}

int low(uint word)
{
    return int(word & 0xffffu);
}

int high(uint word)
{
    return int(word >> 16);
}

// Returns the splat coordinates u and v at a pixel, Q24.
ivec2 whitened(record r, ivec2 pixel)
{
    return ivec2(r.a.x + uint(pixel.x) * r.a.y + uint(pixel.y) * r.a.z, r.a.w + uint(pixel.y) * r.b.x);
}
