// Copies a finished picture to the caller's framebuffer. BUFFERED: fragment shaders can read storage buffers.
layout(location = 0) uniform ivec4 place;    // x, y: pixel of fragment (0, 0); z: step per row; w: width of the picture
// x, y, z: offsets of the picture's colours, depths and ids, in words; w: log2 of the width of texture `words`
layout(location = 1) uniform ivec4 planes;
#if defined BUFFERED
layout(std430, binding = 3) readonly buffer Memory {
    uint memory[];
};
#else
layout(binding = 0) uniform highp usampler2D words;
#endif
layout(location = 0) out vec4 result;
#if defined TRACED
layout(location = 1) out uint depth_result;
layout(location = 2) out uvec2 id_result;
#endif

uint word_at(int i)
{
#if defined BUFFERED
    return memory[i];
#else
    return texelFetch(words, ivec2(i & ((1 << planes.w) - 1), i >> planes.w), 0).x;
#endif
}

void main()
{
    ivec2 fragment = ivec2(gl_FragCoord.xy);
    int at = (place.y + place.z * fragment.y) * place.w + place.x + fragment.x;
    uvec4 bytes = uvec4(word_at(planes.x + at)) >> uvec4(0, 8, 16, 24) & 255u;
    // Adding 0.25 gives the same byte, whether GL rounds down or to nearest.
    result = (vec4(bytes) + 0.25) / 255.0;
#if defined TRACED
    depth_result = word_at(planes.y + at);
    id_result = uvec2(word_at(planes.z + 2 * at), word_at(planes.z + 2 * at + 1));
#endif
}
