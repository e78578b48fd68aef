#version 450
// Draws a panel from its pixels, RGBA with 8 bits a channel.
layout(push_constant) uniform Panel {
    ivec2 at, extent, size;        // place in the window; size of the panel's picture
    int first;                     // word of the first pixel
};
layout(std430, set = 0, binding = 0) readonly buffer Pixels {
    uint pixels[];
};
layout(location = 0) out vec4 colour;

void main()
{
    ivec2 pixel = (ivec2(gl_FragCoord.xy) - at) * size / extent;
    colour = unpackUnorm4x8(pixels[first + pixel.y * size.x + pixel.x]);
}
