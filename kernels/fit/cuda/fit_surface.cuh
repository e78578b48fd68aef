/* Fits Gaussians to surfaces (src/fit/stages/fit_surface.h) on a device: planes of splats, and gradients by depths. */
#ifndef FXS_CUDA_FIT_SURFACE_CUH
#define FXS_CUDA_FIT_SURFACE_CUH

#include "bin.cuh"

namespace {

/* Replaces the colours of visible splats by the planes of their Gaussians. */
__global__ void __launch_bounds__(BIN_THREADS)
    plane_splats(step_buffers b, device_model m, const __grid_constant__ fxs_fit_camera camera,
                 const posed_camera *posed)
{
    const uint32_t i = blockIdx.x * BIN_THREADS + threadIdx.x;
    if (is_stopped(b.status) || i >= m.count || !(b.splats[i].depth > 0))
        return;
    const fxs_fit_camera own = posed ? with_pose(camera, posed) : camera;
    find_plane(&own, m.parameters + i, m.stride, b.splats[i].colour);
}

cudaError_t launch_planes(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera,
                          const posed_camera *posed, cudaStream_t stream)
{
    plane_splats<<<bin_grid(m->count), BIN_THREADS, 0, stream>>>(*b, *m, *camera, posed);
    return cudaGetLastError();
}

/* Writes the gradient by the normals or the positions of splats. Reads up to two rows and two pixels beyond the planes
   of depths, and drops these numbers; other buffers of the step lie there. */
template <bool IsDepth>
__global__ void __launch_bounds__(BIN_THREADS)
    compare_depths(step_buffers b, const __grid_constant__ fxs_fit_camera camera, const posed_camera *posed,
                   float weight)
{
    const size_t at = (size_t)blockIdx.x * BIN_THREADS + threadIdx.x, width = (size_t)camera.width;
    const size_t size = width * (size_t)camera.height;
    if (is_stopped(b.status) || at >= size)
        return;
    const fxs_fit_camera own = posed ? with_pose(camera, posed) : camera;
    const float *const planes = b.derivatives;
    const depth_map d = {planes, planes + size, planes + 2 * size, planes + 3 * size, (ptrdiff_t)width};
    const float x = (float)(at % width), y = (float)(at / width);
    float out[3];
    if (IsDepth)
        depth_gradient(&own, x, y, &d, (ptrdiff_t)at, weight, out);
    else
        depth_normal(&own, x, y, &d, (ptrdiff_t)at, weight, out);
    for (int c = 0; c < 3; c++)
        b.gradient[c * size + at] = out[c];
}

cudaError_t launch_depths(const step_buffers *b, const fxs_fit_camera *camera, const posed_camera *posed, int is_depth,
                          float weight, cudaStream_t stream)
{
    const auto kernel = is_depth ? compare_depths<true> : compare_depths<false>;
    kernel<<<bin_grid((uint64_t)camera->width * (uint64_t)camera->height), BIN_THREADS, 0, stream>>>(*b, *camera, posed,
                                                                                                     weight);
    return cudaGetLastError();
}

}

#endif
