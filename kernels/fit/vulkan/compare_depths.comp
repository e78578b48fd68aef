// Writes the gradient by the normals or the positions of splats, from the depths of a picture. Reads up to two rows and
// two pixels beyond the planes of depths, and drops these numbers; other planes of the step lie there.
#define LOADED(at) uintBitsToFloat(pixels[at])
layout(local_size_x = 256) in;

void main()
{
    const fxs_fit_camera camera = order.cameras[view];
    const uint width = uint(camera.width), size = width * uint(camera.height), at = gl_GlobalInvocationID.x;
    if (status.is_full != 0u || at >= size)
        return;
    const uint first = order.at_derivatives;
    const depth_map d = depth_map(first, first + size, first + 2u * size, first + 3u * size, camera.width);
    const float x = float(at % width), y = float(at / width);
    float found[3];
    if (order.adam.is_depth != 0)
        depth_gradient(camera, x, y, d, int(at), order.surface_weight, found);
    else
        depth_normal(camera, x, y, d, int(at), order.surface_weight, found);
    for (uint c = 0u; c < 3u; c++)
        pixels[order.at_gradient + c * size + at] = floatBitsToUint(found[c]);
}
