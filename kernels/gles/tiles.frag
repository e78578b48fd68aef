// Blends the splats of one pixel and resolves its colour, with the arithmetic of src/include/fixsplat/internal/pixel.h.
// With FETCHED, only resolves. With TRACED, also writes depth and id.
uniform highp usampler2D lists;    // per tile: first record and end of its list, its first chunk; (1, 0): not drawn now
uniform highp usampler2D masks;      // per chunk of up to 32 splats: which pixels the splats touch; see masks.frag
// Transmittance, red, green, blue of a tile's pixels after part of its list; with FETCHED, of all pixels.
uniform highp isampler2D carried;
uniform ivec4 place;         // x, y: picture's pixel at fragment (0, 0); z: step per row; w: 1: continue from `carried`
// x, y: first tile of texture `lists`, or with FETCHED first pixel of `carried`; z: log2 of the width of texture
// `records`; w: cut-off level of splats
uniform ivec4 source;
uniform ivec4 background;            // red, green, blue of the background; w: 1: alpha is coverage
uniform highp sampler2D backdrop;

#if defined TRACED
uniform highp usampler2D ids;
// pixels' traces after part of the list: depth key of the median splat, largest weight, splat's id
uniform highp usampler2D traces;
const int HALF_Q15 = 16384;
// median: last record blended while the transmittance >= 1/2. weight_q15: largest weight of a splat. largest: first
// record with that weight. -1: none.
int median, weight_q15, largest;
#if defined STATE
layout(location = 1) out uvec4 trace_result;
#else
layout(location = 1) out uint depth_result;
layout(location = 2) out uvec2 id_result;
#endif
#endif
#if defined STATE
layout(location = 0) out ivec4 result;
#elif defined INTEGER
layout(location = 0) out uvec4 result;
#else
layout(location = 0) out vec4 result;
#endif

// Blends the splat of record i into a pixel. The cut-off level `cut` is a parameter, because Mesa's software renderer
// fetches uniforms again in each iteration.
void blend(record r, int i, ivec2 pixel, int cut, inout ivec4 state)
{
    ivec2 uv = whitened(r, pixel);
    int u = fxs_distance_q13(uv.x), v = fxs_distance_q13(uv.y), offset = low(r.b.y);
    int level = fxs_product_q15(u, u) + fxs_product_q15(v, v) + offset;
    if ((u | v) > 32767 || level > fxs_limit_q11(offset, cut))
        return;
    int weight = fxs_product_q15(fxs_exp_q15(level), state.x);
#if defined TRACED
    median = weight > 0 && state.x >= HALF_Q15 ? i : median;
    largest = weight > weight_q15 ? i : largest;
    weight_q15 = max(weight_q15, weight);
#endif
    state = ivec4(state.x - weight, min(state.y + fxs_product_q15(weight, high(r.b.y)), 32767),
                  min(state.z + fxs_product_q15(weight, low(r.b.z)), 32767),
                  min(state.w + fxs_product_q15(weight, high(r.b.z)), 32767));
}

uint mask_of(uint chunk, ivec2 pixel, int shift)
{
    int quarter = (pixel.y >> 3 & 1) * 2 + (pixel.x >> 3 & 1);
    uvec4 blocks = texelFetch(masks, texel(int(chunk) * 4 + quarter, shift), 0);
    uvec2 row = (pixel.y & 4) == 0 ? blocks.xy : blocks.zw;
    return (pixel.x & 4) == 0 ? row.x : row.y;
}

int lowest(uint word)
{
    return (floatBitsToInt(float(word & (~word + 1u))) >> 23) - 127;
}

// Returns the first record of a tile's list that is behind the occluder, or the end of the list.
uint first_hidden(uvec2 list, uint limit)
{
    while (list.x < list.y) {
        uint middle = (list.x + list.y) / 2u;
        if (texelFetch(records, texel(2 * int(middle) + 1, source.z), 0).w > limit)
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

#if defined TRACED
uvec4 trace_of(uvec4 before)
{
    int shift = source.z;
    if (median >= 0)
        before.x = texelFetch(records, texel(2 * median + 1, shift), 0).w;
    if (largest >= 0)
        before.yzw = uvec3(weight_q15, texelFetch(ids, texel(largest, shift), 0).xy);
    return before;
}

uint depth_of_key(uint key, int bits)
{
    int shift = int(key >> 26) - 58 + bits;
    uint mantissa = 1u << 26 | (key & 0x3ffffffu);
    return shift > 5 ? 0xfffffffeu : shift >= 0 ? mantissa << shift : shift > -32 ? mantissa >> -shift : 0u;
}
#endif

ivec4 state_of(ivec2 pixel)
{
#if defined FETCHED
    return texelFetch(carried, pixel - source.xy, 0);
#else
    uvec3 list = texelFetch(lists, (pixel >> 4) - source.xy, 0).xyz;
    if (list.x > list.y)
        discard;
    ivec4 state = place.w == 1 ? texelFetch(carried, pixel & 15, 0) : ivec4(FXS_CLEAR_Q15, 0, 0, 0);
    uint limit = limit_at(mesh_texel(pixel));
    if (limit != 0xffffffffu)
        list.y = first_hidden(list.xy, limit);
    int shift = source.z, cut = source.w;
    for (; list.x < list.y && state.x >= FXS_CLOSED_Q15; list += uvec3(32, 0, 1)) {
        uint mask = mask_of(list.z, pixel, shift);
        if (list.y - list.x < 32u)
            mask &= (1u << (list.y - list.x)) - 1u;      // the occluder may end the list within a chunk of 32 splats
        for (; mask != 0u && state.x >= FXS_CLOSED_Q15; mask &= mask - 1u) {
            int i = int(list.x) + lowest(mask);
            blend(record_at(i, shift), i, pixel, cut, state);
        }
    }
    return state;
#endif
}

void main()
{
    ivec2 fragment = ivec2(gl_FragCoord.xy);
    ivec2 pixel = place.xy + ivec2(fragment.x, place.z * fragment.y);
#if defined TRACED
    uvec4 trace = place.w == 1 ? texelFetch(traces, pixel & 15, 0) : uvec4(0u, 0u, 0xffffffffu, 0xffffffffu);
    median = largest = -1;
    weight_q15 = int(trace.y);
#endif
    ivec4 state = state_of(pixel);
#if defined TRACED
    trace = trace_of(trace);
#if defined STATE
    trace_result = trace;
#else
    depth_result = state.x >= HALF_Q15 ? 0xffffffffu : depth_of_key(trace.x, mesh.w & 255);
    id_result = trace.zw;
#endif
#endif
#if defined STATE
    result = state;
#elif defined INTEGER
    result = resolve(state, background_at(mesh_texel(pixel)));
#else
    // Adding 0.25 gives the same byte, whether GL rounds down or to nearest.
    result = (vec4(resolve(state, background_at(mesh_texel(pixel)))) + 0.25) / 255.0;
#endif
}
