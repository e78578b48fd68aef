// Draws tiles as GL points of 16x16 pixels in a given order, or one triangle over the whole viewport.
uniform highp usampler2D lists;      // The fourth word of entry i is the number of the i-th tile to draw.
uniform ivec4 place;
uniform ivec4 size;                  // x, y: size of the viewport; z: columns of tiles, or 0 to draw one triangle

ivec2 cell(int tile)
{
    return ivec2(tile % size.z, tile / size.z);
}

void main()
{
    vec2 at = vec2(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * 4.0 - 1.0);
    if (size.z != 0) {
        ivec2 tile = cell(int(texelFetch(lists, cell(gl_VertexID), 0).w));
        at = vec2(tile * 16 + 24) / vec2(size.xy) * 2.0 - 1.0;
        at.y *= float(place.z);
    }
    gl_Position = vec4(at, 0.0, 1.0);
    gl_PointSize = 16.0;
}
