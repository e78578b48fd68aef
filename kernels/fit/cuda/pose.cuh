/* Poses of photographs on a device (src/fit/stages/pose.h), with the CPU's order of floating-point operations. */
#ifndef FXS_CUDA_FIT_POSE_CUH
#define FXS_CUDA_FIT_POSE_CUH

#include "exposure.cuh"
#include "update.cuh"

namespace {
#define static static __host__ __device__
#include "src/fit/stages/pose.h"
#undef static

const uint32_t POSE_THREADS = FXS_FIT_POSE * GAIN_PARTS;

struct pose_batch {
    uint32_t count, numbers[FXS_FIT_BATCH];
    fxs_fit_camera given[FXS_FIT_BATCH];
    const float *by_pose[FXS_FIT_BATCH];
};

__global__ void pose_cameras(const __grid_constant__ pose_batch batch, fxs_fit_poses poses, posed_camera *posed)
{
    const uint32_t v = threadIdx.x;
    if (v >= batch.count)
        return;
    fxs_fit_camera camera = batch.given[v];
    pose_camera(&camera, &poses.of[batch.numbers[v]]);
    memcpy(posed[v].rotation, camera.rotation, sizeof camera.rotation);
    memcpy(posed[v].eye, camera.eye, sizeof camera.eye);
}

cudaError_t launch_pose_cameras(const pose_batch *batch, const fxs_fit_poses *poses, posed_camera *posed,
                                cudaStream_t stream)
{
    pose_cameras<<<1, FXS_FIT_BATCH, 0, stream>>>(*batch, *poses, posed);
    return cudaGetLastError();
}

template <int Degree>
__device__ inline void find_own_pose(const fxs_fit_camera *camera, const device_model &m, const float *planes,
                                     uint32_t i, float own[FXS_FIT_POSE])
{
    float sums[FXS_FIT_SUMS];
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        sums[k] = planes[(size_t)k * m.stride + i];
    bool is_touched = is_any(sums);
    if (is_touched)
        find_pose_gradient(camera, Degree, m.parameters + i, m.stride, sums, own);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        is_touched = is_touched && absolute(own[k]) < FXS_FIT_FARTHEST_GRADIENT;
    for (int k = 0; k < FXS_FIT_POSE && !is_touched; k++)
        own[k] = 0;
}

template <int Degree>
__global__ void __launch_bounds__(FXS_FIT_PART)
    sum_pose_parts(step_buffers b, device_model m, const float *planes, const __grid_constant__ fxs_fit_camera given,
                   const posed_camera *posed, float *parts)
{
    __shared__ float numbers[FXS_FIT_POSE][FXS_FIT_PART];
    if (is_stopped(b.status))
        return;
    const uint32_t place = threadIdx.x, i = blockIdx.x * FXS_FIT_PART + place;
    float own[FXS_FIT_POSE] = {0};
    if (i < m.count) {
        const fxs_fit_camera camera = with_pose(given, posed);
        find_own_pose<Degree>(&camera, m, planes, i, own);
    }
    for (int k = 0; k < FXS_FIT_POSE; k++)
        numbers[k][place] = own[k];
    for (uint32_t half = FXS_FIT_PART / 2; half; half /= 2) {
        __syncthreads();
        for (int k = 0; k < FXS_FIT_POSE && place < half; k++)
            numbers[k][place] += numbers[k][place + half];
    }
    for (int k = 0; k < FXS_FIT_POSE && place == 0; k++)
        parts[k * gridDim.x + blockIdx.x] = numbers[k][0];
}

__global__ void __launch_bounds__(POSE_THREADS)
    sum_pose(step_buffers b, const float *of_parts, uint32_t count, double values, float *out)
{
    __shared__ double parts[FXS_FIT_POSE][GAIN_PARTS];
    if (is_stopped(b.status))
        return;
    const uint32_t k = threadIdx.x / GAIN_PARTS, part = threadIdx.x % GAIN_PARTS;
    parts[k][part] = gain_part(of_parts + (size_t)k * count, 1, count, part);
    __syncthreads();
    if (part == 0)
        out[k] = gain_sum(parts[k], values);
}

/* Computes the loss gradient by a camera's pose. `parts` is scratch memory: FXS_FIT_POSE floats for every FXS_FIT_PART
   Gaussians. */
cudaError_t launch_by_pose(const step_buffers *b, const device_model *m, const float *planes,
                           const fxs_fit_camera *given, const posed_camera *posed, int degree, float *parts,
                           float out[FXS_FIT_POSE], cudaStream_t stream)
{
    by_degree(degree, [&](auto d) {
        constexpr int Degree = d.value;
        sum_pose_parts<Degree><<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, planes, *given, posed, parts);
    });
    sum_pose<<<1, POSE_THREADS, 0, stream>>>(*b, parts, part_count(m), 3.0 * given->width * given->height, out);
    return cudaGetLastError();
}

__global__ void update_poses(step_buffers b, fxs_fit_poses poses, const __grid_constant__ pose_batch batch,
                             float rate)
{
    if (is_stopped(b.status))
        return;
    for (uint32_t v = 0; v < batch.count; v++)
        pose_step(&poses.of[batch.numbers[v]], &batch.given[v], batch.by_pose[v], rate);
}

cudaError_t launch_update_poses(const step_buffers *b, const fxs_fit_poses *poses, const pose_batch *batch,
                                float rate, cudaStream_t stream)
{
    update_poses<<<1, 1, 0, stream>>>(*b, *poses, *batch, rate);
    return cudaGetLastError();
}

}

#endif
