// Sums the loss gradient by a camera's pose over each part of 256 Gaussians, as a binary tree.
#include "views.glsl"
layout(local_size_x = 256) in;

shared float numbers[FXS_FIT_POSE][256];

void main()
{
    const uint i = gl_GlobalInvocationID.x, place = gl_LocalInvocationIndex;
    float own[FXS_FIT_POSE], sums[FXS_FIT_SUMS];
    bool is_touched = false;
    if (status.is_full != 0u)
        return;
    for (int k = 0; k < FXS_FIT_SUMS; k++) {
        sums[k] = i < order.count ? of_plane(view, uint(k), i) : 0.0;
        is_touched = is_touched || 0.0 < absolute(sums[k]);
    }
    if (is_touched)
        find_pose_gradient(order.cameras[view], order.degree, i, order.stride, sums, own);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        is_touched = is_touched && absolute(own[k]) < FXS_FIT_FARTHEST_GRADIENT;
    for (int k = 0; k < FXS_FIT_POSE; k++)
        numbers[k][place] = is_touched ? own[k] : 0.0;
    for (uint apart = 128u; apart > 0u; apart /= 2u) {
        barrier();
        for (int k = 0; k < FXS_FIT_POSE && place < apart; k++)
            numbers[k][place] += numbers[k][place + apart];
    }
    for (int k = 0; k < FXS_FIT_POSE && place == 0u; k++)
        pixels[order.at_pose_parts + uint(k) * gl_NumWorkGroups.x + gl_WorkGroupID.x] = floatBitsToUint(numbers[k][0]);
}
