// blend and resolve of one pixel, after src/pixel.h; FETCHED: resolve alone.
uniform highp usampler2D lists;      // of each tile: first record, the one after the last; (1, 0): not in this draw
// Two texels a splat: u0, ux, uy, first and last row; v0, vy, offset and r, g and b.
uniform highp usampler2D records;
uniform highp isampler2D carried;    // T, r, g, b: of a tile whose list is in parts, after the last; FETCHED: of all
uniform ivec4 place;                 // pixel of the fragment (0, 0); rows go by; 1: goes on from `carried`
// First tile of `lists`, FETCHED: first pixel of `carried`; log2 of the width of `records`; cut-off.
uniform ivec4 source;
uniform ivec4 background;            // r, g, b; 1: alpha is the coverage
uniform highp usampler2D depths;     // of each record: its depth key
uniform highp sampler2D backdrop;

#if defined STATE
out ivec4 result;
#elif defined INTEGER
out uvec4 result;
#else
out vec4 result;
#endif

ivec2 texel(int i, int shift)
{
    return ivec2(i & ((1 << shift) - 1), i >> shift);
}

int low(uint word)
{
    return int(word & 0xffffu);
}

int high(uint word)
{
    return int(word >> 16);
}

struct record {
    uvec4 a, b;
};

record record_at(int i, int shift)
{
    return record(texelFetch(records, texel(2 * i, shift), 0), texelFetch(records, texel(2 * i + 1, shift), 0));
}

// `shift` and `cut` are source.zw: Mesa on a processor fetches a uniform anew for each round of a loop.
void blend(record r, ivec2 pixel, int cut, inout ivec4 state)
{
    uvec4 a = r.a, b = r.b;
    int u = fxs_distance_q13(int(a.x + uint(pixel.x) * a.y + uint(pixel.y) * a.z));
    if (pixel.y < low(a.w) || pixel.y > high(a.w) || u > 32767 || fxs_product_q15(u, u) > cut)
        return;
    int v = fxs_distance_q13(int(b.x + uint(pixel.y) * b.y));
    int level = fxs_product_q15(u, u) + fxs_product_q15(v, v) + low(b.z);
    if (v > 32767 || level > fxs_limit_q11(low(b.z), cut))
        return;
    int weight = fxs_product_q15(fxs_exp_q15(level), state.x);
    state = ivec4(state.x - weight, min(state.y + fxs_product_q15(weight, high(b.z)), 32767),
                  min(state.z + fxs_product_q15(weight, low(b.w)), 32767),
                  min(state.w + fxs_product_q15(weight, high(b.w)), 32767));
}

// Of a list, whose depths ascend: the first record that is hidden, or its end.
uint first_hidden(uvec2 list, uint limit)
{
    while (list.x < list.y) {
        uint middle = (list.x + list.y) / 2u;
        if (texelFetch(depths, texel(int(middle), source.z), 0).x > limit)
            list.y = middle;
        else
            list.x = middle + 1u;
    }
    return list.y;
}

ivec3 background_at(ivec2 texel)
{
    if ((mesh.w & BACKDROP) == 0)
        return background.rgb;
    return (ivec3(texelFetch(backdrop, texel, 0).rgb * 255.0 + 0.5) * 8192 + 127) / 255;
}

uvec4 resolve(ivec4 state, ivec3 under)
{
    int alpha = background.a == 1 ? fxs_coverage_8bit(state.x) : 255;
    return uvec4(fxs_resolve_8bit(state.y, state.x, under.r), fxs_resolve_8bit(state.z, state.x, under.g),
                 fxs_resolve_8bit(state.w, state.x, under.b), alpha);
}

ivec4 state_of(ivec2 pixel)
{
#if defined FETCHED
    return texelFetch(carried, pixel - source.xy, 0);
#else
    uvec2 list = texelFetch(lists, (pixel >> 4) - source.xy, 0).xy;
    if (list.x > list.y)
        discard;
    ivec4 state = place.w == 1 ? texelFetch(carried, pixel & 15, 0) : ivec4(FXS_CLEAR_Q15, 0, 0, 0);
    uint limit = limit_at(mesh_texel(pixel));
    if (limit != 0xffffffffu)
        list.y = first_hidden(list, limit);
    int shift = source.z, cut = source.w;
    record r = record_at(int(list.x), shift);
    for (uint i = list.x; i < list.y && state.x >= FXS_CLOSED_Q15; i++) {
        record next = record_at(int(i) + 1, shift);      // while it is fetched, this one is blended
        blend(r, pixel, cut, state);
        r = next;
    }
    return state;
#endif
}

void main()
{
    ivec2 fragment = ivec2(gl_FragCoord.xy);
    ivec2 pixel = place.xy + ivec2(fragment.x, place.z * fragment.y);
    ivec4 state = state_of(pixel);
#if defined STATE
    result = state;
#elif defined INTEGER
    result = resolve(state, background_at(mesh_texel(pixel)));
#else
    // the same byte, rounded down or to the nearest
    result = (vec4(resolve(state, background_at(mesh_texel(pixel)))) + 0.25) / 255.0;
#endif
}
