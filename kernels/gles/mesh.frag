// Reads the depth of the caller's occluder at a pixel.
uniform highp usampler2D occluder;
uniform highp sampler2D depth_buffer;        // GL depth buffer, used instead of texture `occluder`
// x, y: texel of pixel (0, 0) in the caller's textures; z: step per row; w: fraction bits of depths, flags of the
// textures in use
uniform ivec4 mesh;
const int OCCLUDER = 256, BUFFER = 512, BACKDROP = 1024;
uniform vec2 planes;                 // 1 / distance at the values 0 and 1 of depth_buffer

ivec2 mesh_texel(ivec2 pixel)
{
    return ivec2(mesh.x + pixel.x, mesh.y + mesh.z * pixel.y);
}

uint depth_key(uint depth, int bits)
{
    if (depth == 0u || depth == 0xffffffffu)
        return depth;
    int zeros = 0;
    for (int step = 16; step > 0; step /= 2)
        if (depth >> (32 - step) == 0u) {
            depth <<= step;
            zeros += step;
        }
    return uint(63 - zeros - bits) << 26 | (depth >> 5 & 0x3ffffffu);
}

// Returns the depth key (depth as a sortable code) of the occluder at a pixel. Splats with larger keys are hidden.
uint limit_at(ivec2 texel)
{
    int bits = mesh.w & 255;
    if ((mesh.w & OCCLUDER) != 0)
        return depth_key(texelFetch(occluder, texel, 0).x, bits);
    if ((mesh.w & BUFFER) == 0)
        return 0xffffffffu;
    return depth_key(distance_of(texelFetch(depth_buffer, texel, 0).x, planes, bits), bits);
}
