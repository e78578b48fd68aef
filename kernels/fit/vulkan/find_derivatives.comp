// SSIM of picture and photograph and its derivatives, for each pixel and channel (src/fit/stages/loss.h).
#include "photograph.glsl"
#define PATCHES 2
#define ROWS FXS_FIT_ROWS
#include "window.glsl"
layout(local_size_x = 256) in;

void load_patch(uint channel)
{
    for (int i = int(gl_LocalInvocationIndex); i < PATCH * PATCH; i += 256) {
        const ivec2 at = corner() + ivec2(i % PATCH, i / PATCH) - REACH;
        const bool is_seen = is_within(at) && counts(index_of(at));
        const float level = is_seen ? level_of(index_of(at), channel) : 0.0;
        const float number = is_seen ? uintBitsToFloat(pixels[order.at_picture + channel * size() + index_of(at)]) : 0.0;
        patches[0][i] = is_seen ? seen_as(number, level) : 0.0;
        patches[1][i] = level;
    }
}

void sum_rows()
{
    for (int i = int(gl_LocalInvocationIndex); i < PATCH * FXS_FIT_TILE; i += 256) {
        const int first = i / FXS_FIT_TILE * PATCH + i % FXS_FIT_TILE;
        float sums[FXS_FIT_ROWS];
        for (int k = 0; k < FXS_FIT_WINDOW; k++) {
            const float p = patches[0][first + k], q = patches[1][first + k], weight = window_weight(k);
            const float numbers[FXS_FIT_ROWS] = float[FXS_FIT_ROWS](p, q, p * p, q * q, p * q);
            for (int n = 0; n < FXS_FIT_ROWS; n++)
                sums[n] = k == 0 ? numbers[n] * weight : sums[n] + numbers[n] * weight;
        }
        for (int n = 0; n < FXS_FIT_ROWS; n++)
            rows[n][i] = sums[n];
    }
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint channel = gl_WorkGroupID.z;
    const ivec2 at = corner() + place();
    load_patch(channel);
    barrier();
    sum_rows();
    barrier();
    if (!is_within(at))
        return;
    const similarity s = similarity_of(column_sum(0), column_sum(1), column_sum(2), column_sum(3), column_sum(4));
    const bool is_counted = counts(index_of(at));
    const float found[3] = float[3](s.by_mean, s.by_square, s.by_product);
    for (uint k = 0u; k < 3u; k++)
        pixels[order.at_derivatives + (3u * channel + k) * size() + index_of(at)] =
            floatBitsToUint(is_counted ? found[k] : 0.0);
    pixels[order.at_dissimilar + channel * size() + index_of(at)] = floatBitsToUint(is_counted ? 1.0 - s.value : 0.0);
}
