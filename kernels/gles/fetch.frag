// Blends one splat into one pixel, with the pixel's state in the framebuffer. Avoids uniforms, because Mesa's software
// renderer fetches them per pixel.
flat in ivec4 line;
flat in ivec4 look;
#ifdef LIMITED
flat in ivec3 limits;
uniform ivec4 place;

bool outside(int at, int span)
{
    return at < (span & 0xffff) || at > span >> 16;
}
#endif
layout(location = 0) inout ivec4 state;      // pixel's transmittance, red, green and blue

void main()
{
    ivec2 fragment = ivec2(gl_FragCoord.xy);
    int u = fxs_distance_q13(line.x + fragment.x * line.y + fragment.y * line.z);
    int v = fxs_distance_q13(line.w + fragment.y * look.x);
    int level = fxs_product_q15(u, u) + fxs_product_q15(v, v) + (look.y & 32767);
    if ((u | v) > 32767 || level > look.w || state.x < FXS_CLOSED_Q15)
        discard;
#ifdef LIMITED
    ivec2 pixel = place.xy + fragment;
    if (outside(pixel.x >> 4, limits.x) || outside(pixel.y >> 4, limits.y) ||
        uint(limits.z) > limit_at(mesh_texel(pixel)))
        discard;
#endif
    int weight = fxs_product_q15(fxs_exp_q15(level), state.x);
    ivec3 colour = ivec3(look.y >> 16, look.z & 32767, look.z >> 16);
    state = ivec4(state.x - weight, min(state.y + fxs_product_q15(weight, colour.x), 32767),
                  min(state.z + fxs_product_q15(weight, colour.y), 32767),
                  min(state.w + fxs_product_q15(weight, colour.z), 32767));
}
