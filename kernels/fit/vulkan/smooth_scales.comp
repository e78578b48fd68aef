// Raises the scales of the Gaussians to their lower limit.
#define LOADED(at) masters[at]
layout(local_size_x = 128) in;

fxs_fit_camera camera_at(uint n)
{
    const uint at = order.at_cameras + 26u * n;
    fxs_fit_camera c;
    for (uint k = 0u; k < 9u; k++)
        c.rotation[k] = uintBitsToFloat(gaussians[at + k]);
    for (uint k = 0u; k < 3u; k++)
        c.eye[k] = uintBitsToFloat(gaussians[at + 9u + k]);
    for (uint k = 0u; k < 2u; k++) {
        c.focal[k] = uintBitsToFloat(gaussians[at + 12u + k]);
        c.middle[k] = uintBitsToFloat(gaussians[at + 14u + k]);
    }
    c.near = uintBitsToFloat(gaussians[at + 18u]);
    c.width = int(gaussians[at + 19u]);
    c.height = int(gaussians[at + 20u]);
    return c;
}

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (status.is_full != 0u || i >= order.count)
        return;
    const float place[3] = float[3](place_along(i, order.stride, 0), place_along(i, order.stride, 1),
                                    place_along(i, order.stride, 2));
    float finest = FXS_FIT_FARTHEST_PLACE;
    for (uint n = 0u; n < order.camera_count; n++)
        finest = finest_of(camera_at(n), place, finest);
    raise_scales(finest, order.smooths, i, order.stride);
}
