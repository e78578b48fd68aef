// Places the corners of a splat's triangles: one triangle around the ellipse, two for the rectangle of a large splat,
// two over the whole window for a veil (a huge splat). A splat has coordinates u and v, linear in the pixel position,
// with values u0 and v0 at pixel (0, 0). The record of a triangle has three texels: (u0, du/dx, du/dy, v0), (dv/dy,
// offset and red, green and blue, columns), (centre x, centre y, shape and rows, depth key).
uniform highp usampler2D records;
uniform ivec4 size;  // x, y: width and height of the window; z: cut-off, Q11; w: log2 of the width of texture `records`
uniform ivec4 place;                 // x, y: first pixel of the window; z: size of the viewport relative to the window
flat out ivec4 line;               // u, du/dx, du/dy, v: splat coordinates at the window's first pixel, and slopes, Q24
flat out ivec4 look;          // (dv/dy; offset, Q11, and red; green and blue, Q13; largest drawn level, Q11) of a splat
#ifdef LIMITED
flat out ivec3 limits;               // splat's first and last tile column; first and last tile row; depth key
#endif
const int TRIANGLE = 0, VEIL = 4;    // shapes of splats; shape 2: rectangle; odd: second triangle

ivec4 texel(int i)
{
    return ivec4(texelFetch(records, ivec2(i & ((1 << size.w) - 1), i >> size.w), 0));
}

void main()
{
    int record = gl_VertexID / 3, number = gl_VertexID - 3 * record;
    ivec4 a = texel(3 * record), b = texel(3 * record + 1), c = texel(3 * record + 2);
    int shape = c.z & 15, offset = b.y & 0xffff, limit = min(offset + size.z, 22697);
    line = ivec4(a.x + place.x * a.y + place.y * a.z, a.y, a.z, a.w + place.y * b.x);
    look = ivec4(b.xyz, limit);
#ifdef LIMITED
    limits = ivec3(b.w, c.z >> 4, c.w);
#endif
    number += shape & 1;
    vec2 corner = vec2(float(number & 1), float(number >> 1)) * 2.0 - 1.0, pixel;
    if (shape >= VEIL) {
        pixel = (corner * 0.5 + 0.5) * vec2(size.xy);
    } else {
        // Pixel position from splat coordinates u, v: x = cx + sx u + k v, y = cy + sy v. e: direction of the ellipse's
        // longer axis.
        float sx = 16777216.0 / float(a.y), sy = 16777216.0 / float(b.x), k = float(-a.z) / float(a.y) * sy;
        float h = 0.5 * (sx * sx + k * k - sy * sy), m = k * sy, l = length(vec2(h, m));
        vec2 e = l > 0.0 ? normalize(h >= 0.0 ? vec2(h + l, m) : vec2(m, l - h)) : vec2(1.0, 0.0);
        float r = sqrt(float(max(limit - offset, 0) + 2) / 2048.0);
        vec2 reach = r * vec2(length(vec2(sx * e.x, k * e.x + sy * e.y)), length(vec2(sx * e.y, k * e.y - sy * e.x)));
        reach += 0.125 + reach.x / 16384.0;
        if (shape == TRIANGLE)
            corner = number == 0 ? vec2(-1.0, 1.7320509) : number == 1 ? vec2(-1.0, -1.7320509) : vec2(2.0, 0.0);
        corner *= reach;
        pixel = vec2(c.xy) / 16384.0 + 0.5 - vec2(place.xy) + corner.x * e + corner.y * vec2(-e.y, e.x);
    }
    gl_Position = vec4((pixel / vec2(size.xy) * 2.0 - 1.0) / float(place.z), 0.0, 1.0);
}
