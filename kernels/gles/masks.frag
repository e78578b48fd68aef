// Finds which splats touch each block of 4x4 pixels in a tile. A chunk is up to 32 splats of a tile's list. The masks
// of a chunk are four texels, one per quarter of the tile, with a word per block and a bit per splat.
uniform highp usampler2D chunks;     // x: first record, and number of splats - 1 from bit 24 on; y: tile column and row
uniform ivec4 source;                // x: log2 of the width of the textures; y: cut-off level of splats
out uvec4 result;

// Returns the smallest magnitude of a splat coordinate in each of four blocks of pixels, Q13, saturated at 4.
ivec4 nearest(ivec4 least, ivec4 most)
{
    return min(max(max(least >> 11, -(most >> 11)), 0), 32768);
}

// Returns 1 for each block of 4x4 pixels that a splat touches, else 0, for four blocks. The splat coordinates u and v
// are linear in x and y; their slopes du/dx and dv/dy are not negative. Arithmetic modulo 2^32 suffices.
uvec4 touched(record r, ivec2 pixel, int cut)
{
    ivec2 uv = whitened(r, pixel);
    int ux = int(r.a.y), uy = int(r.a.z), vy = int(r.b.x), offset = low(r.b.y);
    ivec4 u = uv.x + ivec4(0, 4 * ux, 4 * uy, 4 * ux + 4 * uy), v = uv.y + ivec4(0, 0, 4 * vy, 4 * vy);
    u = nearest(u + 3 * min(uy, 0), u + 3 * ux + 3 * max(uy, 0));
    v = nearest(v, v + 3 * vy);
    ivec4 level = ((u * u + 16384) >> 15) + ((v * v + 16384) >> 15) + offset;
    return uvec4(lessThanEqual(level, ivec4(fxs_limit_q11(offset, cut))));
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    int shift = source.x, cut = source.y, quarter = at.x & 3;
    uvec2 chunk = texelFetch(chunks, texel((at.y << shift | at.x) >> 2, shift), 0).xy;
    ivec2 pixel = ivec2(low(chunk.y), high(chunk.y)) * 16 + ivec2(quarter & 1, quarter >> 1) * 8;
    int first = int(chunk.x & 0xffffffu), last = int(chunk.x >> 24);
    uvec4 masks = uvec4(0);
    for (int i = 0; i <= last; i++)
        masks |= touched(record_at(first + i, shift), pixel, cut) << i;
    result = masks;
}
