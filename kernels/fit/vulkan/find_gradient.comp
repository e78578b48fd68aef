// The loss gradient by each pixel and channel (src/fit/stages/loss.h).
#include "photograph.glsl"
#define PATCHES FXS_FIT_DERIVATIVES
#define ROWS FXS_FIT_DERIVATIVES
#include "window.glsl"
layout(local_size_x = 256) in;

void load_patches(uint channel)
{
    for (int i = int(gl_LocalInvocationIndex); i < PATCH * PATCH; i += 256) {
        const ivec2 at = corner() + ivec2(i % PATCH, i / PATCH) - REACH;
        for (uint k = 0u; k < 3u; k++)
            patches[k][i] = is_within(at) ? uintBitsToFloat(pixels[order.at_derivatives + (3u * channel + k) * size() +
                                                                   index_of(at)]) : 0.0;
    }
}

void sum_rows()
{
    for (int i = int(gl_LocalInvocationIndex); i < PATCH * FXS_FIT_TILE; i += 256) {
        const int first = i / FXS_FIT_TILE * PATCH + i % FXS_FIT_TILE;
        for (int n = 0; n < FXS_FIT_DERIVATIVES; n++) {
            float sum = patches[n][first] * window_weight(0);
            for (int k = 1; k < FXS_FIT_WINDOW; k++)
                sum += patches[n][first + k] * window_weight(k);
            rows[n][i] = sum;
        }
    }
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint channel = gl_WorkGroupID.z;
    const ivec2 at = corner() + place();
    load_patches(channel);
    barrier();
    sum_rows();
    barrier();
    if (!is_within(at))
        return;
    const uint own = channel * size() + index_of(at);
    const float a = uintBitsToFloat(pixels[order.at_picture + own]), level = level_of(index_of(at), channel);
    const float gradient = gradient_of(a, level, column_sum(0), column_sum(1), column_sum(2));
    const bool is_kept = counts(index_of(at)) && !is_clipped(a, level);
    pixels[order.at_gradient + own] = floatBitsToUint(is_kept ? gradient : 0.0);
}
