#version 450
layout(location = 0) in vec3 normal;
layout(location = 0) out vec4 colour;

void main()
{
    colour = vec4(vec3(1, 0.6, 0.2) * (0.6 - 0.4 * normalize(normal).y), 1);     // lit from above: y points down
}
