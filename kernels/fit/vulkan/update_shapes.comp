// Sums each Gaussian's gradients over the views of a batch, and makes a step of Adam for all parameters except the
// spherical harmonics above degree 0.
#include "views.glsl"
#include "adam.glsl"
layout(local_size_x = 64) in;

void add_view(uint v, uint i, inout float total[FXS_FIT_SH], inout float by_centre)
{
    float sums[FXS_FIT_SUMS], g[3] = float[3](0.0, 0.0, 0.0), own[FXS_FIT_SH], centre[2], by_position[3];
    look l;
    bool is_touched = false;
    for (int k = 0; k < FXS_FIT_SUMS; k++) {
        sums[k] = of_plane(v, uint(k), i);
        is_touched = is_touched || 0.0 < absolute(sums[k]);
    }
    l.direction = float[3](0.0, 0.0, 0.0);
    if (is_touched) {
        find_gradient_but_sh(order.cameras[v], order.degree, i, order.stride, sums, l, g, own, centre, by_position);
        for (int k = 0; k < FXS_FIT_SH; k++)
            is_touched = is_touched && absolute(own[k]) < FXS_FIT_FARTHEST_GRADIENT;
        for (int k = 0; k < 3 * ((order.degree + 1) * (order.degree + 1) - 1); k++)
            is_touched = is_touched && absolute(l.basis[k / 3] * g[k % 3]) < FXS_FIT_FARTHEST_GRADIENT;
    }
    if (is_touched) {
        by_centre += centre_gradient(order.cameras[v], centre);
        for (int k = 0; k < FXS_FIT_SH; k++)
            total[k] += own[k];
    }
    for (uint k = 0u; k < 3u; k++) {
        gaussians[plane_at(v, PLANE_G + k, i)] = floatBitsToUint(is_touched ? g[k] : 0.0);
        gaussians[plane_at(v, PLANE_DIRECTION + k, i)] = floatBitsToUint(is_touched ? l.direction[k] : 0.0);
    }
}

void add_regularisers(uint i, inout float gradient[FXS_FIT_SH])
{
    const float unit = unit_at(order.adam.far, i, order.stride);
    gradient[FXS_FIT_OPACITY] = opacity_regularised(order.adam, gradient[FXS_FIT_OPACITY],
                                                    load(uint(FXS_FIT_OPACITY) * order.stride + i));
    for (int k = FXS_FIT_SCALE; k < FXS_FIT_SCALE + 3; k++)
        gradient[k] = scale_regularised(order.adam, gradient[k], load(uint(k) * order.stride + i), unit);
}

void add_surfaces(uint i, inout float gradient[FXS_FIT_SH])
{
    float sums[3] = float[3](0.0, 0.0, 0.0);
    for (uint v = 0u; v < order.batch && order.surface_weight > 0.0; v++)
        for (uint k = 0u; k < 3u; k++)
            sums[k] += of_surface(v, k, i);
    add_surface(order.adam, i, order.stride, sums, gradient);
}

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    float gradient[FXS_FIT_SH];
    if (status.is_full != 0u)
        return;
    if (i == 0u)
        status.done++;
    if (i >= order.count)
        return;
    float by_centre = uintBitsToFloat(gaussians[order.at_by_centre + i]);
    float views = uintBitsToFloat(gaussians[order.at_views + i]);
    for (int k = 0; k < FXS_FIT_SH; k++)
        gradient[k] = 0.0;
    for (uint v = 0u; v < order.batch; v++) {
        views += gaussians[plane_at(v, FXS_FIT_SUMS, i)] != 0u ? 1.0 : 0.0;
        add_view(v, i, gradient, by_centre);
    }
    gaussians[order.at_by_centre + i] = floatBitsToUint(by_centre);
    gaussians[order.at_views + i] = floatBitsToUint(views);
    if (order.adam.by_opacity > 0.0)
        add_regularisers(i, gradient);
    if (order.adam.by_flat > 0.0)
        add_surfaces(i, gradient);
    for (int k = 0; k < FXS_FIT_SH; k++)
        move_one(uint(k), gradient[k], i);
}
