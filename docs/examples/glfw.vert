#version 450
/* The ball of glfw.cpp: two triangles for each of the 96 x 48 cells between its meridians and parallels. */
layout(push_constant) uniform Push { mat4 to_clip; };
layout(location = 0) out vec3 normal;

void main()
{
    const int cell = gl_VertexIndex / 6, corner = int[](0, 1, 2, 2, 1, 3)[gl_VertexIndex % 6];
    const float u = radians(3.75) * float(cell / 48 + corner / 2), v = radians(3.75) * float(cell % 48 + corner % 2);
    normal = vec3(cos(u) * sin(v), cos(v), sin(u) * sin(v));
    gl_Position = to_clip * vec4(normal, 1);
}
