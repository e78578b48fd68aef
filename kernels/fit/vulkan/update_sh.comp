// Makes a step of Adam for two coefficients of the spherical harmonics above degree 0, for each channel.
#include "views.glsl"
#include "adam.glsl"
layout(local_size_x = 128) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    const int count = (order.degree + 1) * (order.degree + 1) - 1, first = 2 * int(gl_WorkGroupID.y);
    if (status.is_full != 0u || i >= order.count)
        return;
    float gradient[6] = float[6](0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (uint v = 0u; v < order.batch; v++) {
        float direction[3], basis[15];
        for (uint k = 0u; k < 3u; k++)
            direction[k] = of_plane(v, PLANE_DIRECTION + k, i);
        basis_of(direction, order.degree, basis);
        for (int k = 0; k < 6 && first + k / 3 < count; k++)
            gradient[k] += basis[first + k / 3] * of_plane(v, PLANE_G + uint(k) % 3u, i);
    }
    for (int k = 0; k < 6 && first + k / 3 < count; k++)
        move_one(uint(FXS_FIT_SH + 3 * first + k), gradient[k], i);
}
