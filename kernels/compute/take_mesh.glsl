// Copies the caller's depth and colour textures to device memory.
layout(local_size_x = 8, local_size_y = 8) in;
// x, y: size of the picture; z: texture row of picture row 0; w: texture rows per picture row
layout(location = 0) uniform ivec4 size;
// x, y: offsets in `memory` for the occluder's depths and the backdrop's colours, -1: none; z: fraction bits of the
// depths; w: 1: the depths come from depth_buffer
layout(location = 1) uniform ivec4 planes;
layout(location = 2) uniform vec2 inverse;   // 1 / distance at the values 0 and 1 of depth_buffer
layout(binding = 0) uniform highp usampler2D occluder;
layout(binding = 1) uniform highp sampler2D depth_buffer;
layout(binding = 2) uniform highp sampler2D backdrop;
layout(std430, binding = 3) writeonly buffer Memory {
    uint memory[];
};

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= size.x || pixel.y >= size.y)
        return;
    ivec2 texel = ivec2(pixel.x, size.z + size.w * pixel.y);
    int at = pixel.y * size.x + pixel.x;
    if (planes.x >= 0)
        memory[planes.x + at] = planes.w == 1 ? distance_of(texelFetch(depth_buffer, texel, 0).x, inverse, planes.z)
                                               : texelFetch(occluder, texel, 0).x;
    if (planes.y >= 0) {
        uvec3 bytes = uvec3(texelFetch(backdrop, texel, 0).rgb * 255.0 + 0.5);
        memory[planes.y + at] = bytes.r | bytes.g << 8 | bytes.b << 16;
    }
}
