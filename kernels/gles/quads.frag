// Colour that one splat adds to one pixel; the hardware blends it.
uniform ivec4 size;
in vec2 uv;
flat in vec4 colour;
out vec4 result;

void main()
{
    float square = dot(uv, uv);
    float alpha = min(0.99, colour.a * exp(square * -0.5));
    if (square * 2048.0 > float(size.z) || alpha < 1.0 / 255.0)
        discard;
    result = vec4(colour.rgb * alpha, alpha);
}
