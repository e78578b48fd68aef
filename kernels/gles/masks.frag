// Finds the blocks of 4x4 pixels that each splat of a tile's list may touch. A chunk is up to 32 records of a list. Its
// masks are four texels, one per quarter of the tile. A texel has a word per block of the quarter, and a word a bit per
// record.
uniform highp usampler2D chunks;     // first record and, from bit 24 on, count - 1; column and row of the tile
uniform ivec4 source;                // log2 of the width of `records`, `chunks` and this target; cut-off
out uvec4 result;

// Smallest magnitudes of u or v in blocks where it ranges from least to most. 32768 stands for 4; no splat reaches
// beyond.
ivec4 nearest(ivec4 least, ivec4 most)
{
    return min(max(max(least >> 11, -(most >> 11)), 0), 32768);
}

// For each block of a quarter, whether a splat may touch it. u and v are linear; ux and vy are not negative. Computes
// modulo 2^32, which is enough, because u and v are within +-128 in a touched block.
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
