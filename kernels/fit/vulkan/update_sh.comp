// Makes a step of Adam for one channel of the spherical harmonics above degree 0.
#include "views.glsl"
#include "adam.glsl"
layout(local_size_x = 128) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x, channel = gl_WorkGroupID.y;
    const int count = (order.degree + 1) * (order.degree + 1) - 1;
    if (status.is_full != 0u || i >= order.count)
        return;
    float gradient[15];
    for (int k = 0; k < 15; k++)
        gradient[k] = 0.0;
    for (uint v = 0u; v < order.batch; v++) {
        const float g = of_plane(v, PLANE_G + channel, i);
        float direction[3], basis[15];
        for (uint k = 0u; k < 3u; k++)
            direction[k] = of_plane(v, PLANE_DIRECTION + k, i);
        basis_of(direction, order.degree, basis);
        for (int k = 0; k < 15; k++)
            gradient[k] += k < count ? basis[k] * g : 0.0;
    }
    for (int k = 0; k < 15; k++)
        if (k < count)
            move_one(uint(FXS_FIT_SH) + 3u * uint(k) + channel, gradient[k], i);
}
