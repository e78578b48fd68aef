// Converts pixels in `memory` between the caller's images and the stages.
layout(local_size_x = 128) in;
layout(push_constant) uniform Conversion {
    uint kind, count, from, to;    // number of pixels; first word that is read, and first that is written
    int bits;                      // fraction bits of the stages' depths
    float inverse_0, inverse_1;    // 1 / distance at the values 0 and 1 of a depth image
};
layout(std430, set = 0, binding = 2) buffer Memory {
    uint memory[];
};

const uint SWAP = 1u, TO_FLOAT = 2u, FROM_FLOAT = 3u;   // otherwise from 16-bit depths

float depth_of(uint distance)
{
    float inverse = distance == 0xffffffffu ? min(inverse_0, inverse_1) : float(1 << bits) / float(distance);
    return clamp((inverse - inverse_0) / (inverse_1 - inverse_0), 0.0, 1.0);
}

void main()
{
    uint i = (gl_WorkGroupID.y * 32768u + gl_WorkGroupID.x) * 128u + gl_LocalInvocationID.x;
    if (i >= count)
        return;
    uint word = memory[from + (kind > FROM_FLOAT ? i >> 1 : i)];
    float depth = kind == FROM_FLOAT ? uintBitsToFloat(word) : float(word >> 16u * (i & 1u) & 0xffffu) / 65535.0;
    memory[to + i] = kind == SWAP ? word & 0xff00ff00u | word >> 16 & 0xffu | (word & 0xffu) << 16
                     : kind == TO_FLOAT ? floatBitsToUint(depth_of(word))
                                        : distance_of(depth, vec2(inverse_0, inverse_1), bits);
}
