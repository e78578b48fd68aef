// Planes of the sums of a view; after update_shapes, those of the colour gradient and of the view direction.
const uint PLANE_G = 0u, PLANE_DIRECTION = 3u;

uint plane_at(uint v, uint k, uint i) { return order.at_planes + v * order.view_numbers + k * order.stride + i; }

// Sum k of the gradient by a Gaussian's plane, over the pixels of a view.
float of_surface(uint v, uint k, uint i)
{
    return uintBitsToFloat(gaussians[plane_at(v, uint(FXS_FIT_SUMS + 1 + FXS_FIT_RED) + k, i)]);
}

float of_plane(uint v, uint k, uint i) { return uintBitsToFloat(gaussians[plane_at(v, k, i)]); }
