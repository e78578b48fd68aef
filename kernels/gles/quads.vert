// Quad of a splat in whitened coordinates: X = cx + (u - v uy / vy) / ux, Y = cy + v / vy. A veil covers the picture: u
// = u0 + X ux + Y uy, v = v0 + Y vy.
in ivec4 shape;                      // cx, cy (Q14), for a veil u0, v0 (Q24); ux, uy (Q24)
in uvec4 look;                       // vy (Q24); offset (Q11) and r; g and b (Q13); 1 for a veil
uniform ivec4 size;                  // width and height in pixels; cut-off (Q11)
out vec2 uv;
flat out vec4 colour;

void main()
{
    float offset = float(look.y & 0xffffu);
    float limit = min(offset + float(size.z), 22697.0);
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)), pixel;
    vec3 axes = vec3(shape.z, shape.w, int(look.x)) / 16777216.0;
    if (look.w == 1u) {
        pixel = corner * vec2(size.xy);
        uv = vec2(shape.xy) / 16777216.0 + vec2(dot(axes.xy, pixel - 0.5), axes.z * (pixel.y - 0.5));
    } else {
        uv = (corner * 2.0 - 1.0) * sqrt(max(limit - offset, 0.0) / 2048.0);
        pixel = vec2(shape.xy) / 16384.0 + vec2((uv.x - uv.y * axes.y / axes.z) / axes.x, uv.y / axes.z) + 0.5;
    }
    colour = vec4(vec3(look.y >> 16, look.z & 0xffffu, look.z >> 16) / 8192.0, exp(offset / -4096.0));
    gl_Position = vec4(pixel / vec2(size.xy) * 2.0 - 1.0, 0.0, 1.0);
}
