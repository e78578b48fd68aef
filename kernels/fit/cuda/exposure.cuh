/* Exposures of photographs on a device (src/fit/stages/exposure.h), in the CPU's order of operations. */
#ifndef FXS_CUDA_FIT_EXPOSURE_CUH
#define FXS_CUDA_FIT_EXPOSURE_CUH

#include "loss.cuh"

namespace {
#define static static __host__ __device__
#include "src/fit/stages/exposure.h"
#undef static

const uint32_t GAIN_THREADS = FXS_FIT_GAIN * GAIN_PARTS;

__global__ void find_factors(step_buffers b, const fxs_fit_gain *gain, int is_affine)
{
    if (!is_stopped(b.status))
        gain_factors(gain, is_affine, b.factors);
}

cudaError_t launch_factors(const step_buffers *b, const fxs_fit_gains *gains, uint32_t number, cudaStream_t stream)
{
    find_factors<<<1, 1, 0, stream>>>(*b, &gains->of[number], gains->is_affine);
    return cudaGetLastError();
}

__global__ void sum_gain_rows(step_buffers b, fxs_fit_camera camera, int is_affine)
{
    if (is_stopped(b.status))
        return;
    const size_t height = (size_t)camera.height, all = FXS_FIT_GAIN * height, width = (size_t)camera.width;
    const size_t own = (size_t)(blockIdx.x * blockDim.x + threadIdx.x) / 16, row = own < all ? own : all - 1;
    const int k = (int)(row / height), by_colour = k < 9;
    const float *gradient = b.gradient + (k % 3 * height + row % height) * width;
    const float *picture = b.picture + ((by_colour ? k / 3 : 0) * height + row % height) * width;
    const float sum = row_sum(gain_needs(is_affine, k) ? camera.width : 0, [&](int32_t x) {
        return by_colour ? gradient[x] * picture[x] : gradient[x];
    });
    if (own < all && threadIdx.x % 16 == 0)
        b.gain_rows[row] = sum;
}

__global__ void __launch_bounds__(GAIN_THREADS)
add_gain_rows(step_buffers b, fxs_fit_camera camera, float *out)
{
    __shared__ double parts[FXS_FIT_GAIN][GAIN_PARTS];
    if (is_stopped(b.status))
        return;
    const size_t height = (size_t)camera.height, k = threadIdx.x / GAIN_PARTS, part = threadIdx.x % GAIN_PARTS;
    parts[k][part] = gain_part(b.gain_rows + k * height, 1, height, part);
    __syncthreads();
    if (part == 0)
        out[k] = gain_sum(parts[k], 3.0 * camera.width * camera.height);
}

cudaError_t launch_by_gain(const step_buffers *b, const fxs_fit_camera *camera, int is_affine, float out[FXS_FIT_GAIN],
                           cudaStream_t stream)
{
    const uint32_t rows = FXS_FIT_GAIN * (uint32_t)camera->height;
    sum_gain_rows<<<(rows + 15) / 16, 256, 0, stream>>>(*b, *camera, is_affine);
    add_gain_rows<<<1, GAIN_THREADS, 0, stream>>>(*b, *camera, out);
    return cudaGetLastError();
}

struct gain_batch {
    uint32_t count, numbers[FXS_FIT_BATCH];
    const float *by_gain[FXS_FIT_BATCH];
};

__global__ void __launch_bounds__(GAIN_THREADS)
update_gains(step_buffers b, fxs_fit_gains gains, gain_batch batch, float rate, float decay)
{
    __shared__ double parts[FXS_FIT_GAIN][GAIN_PARTS];
    __shared__ float excess[FXS_FIT_GAIN];
    if (is_stopped(b.status))
        return;
    const uint32_t k = threadIdx.x / GAIN_PARTS, part = threadIdx.x % GAIN_PARTS;
    for (uint32_t v = 0; v < batch.count && threadIdx.x == 0; v++)
        gain_step(&gains.of[batch.numbers[v]], gains.is_affine, batch.by_gain[v], rate, decay);
    __syncthreads();
    parts[k][part] = gain_part(&gains.of->at[k], GAIN_STEP, gains.count, part);
    __syncthreads();
    if (part == 0)
        excess[k] = gain_sum(parts[k], gains.count) - gain_neutral(gains.is_affine, (int)k);
    __syncthreads();
    for (uint32_t i = part; i < gains.count && (int)k < gain_numbers(gains.is_affine); i += GAIN_PARTS)
        gains.of[i].at[k] -= excess[k];
}

cudaError_t launch_update_gains(const step_buffers *b, const fxs_fit_gains *gains, const gain_batch *batch, float rate,
                                float decay, cudaStream_t stream)
{
    update_gains<<<1, GAIN_THREADS, 0, stream>>>(*b, *gains, *batch, rate, decay);
    return cudaGetLastError();
}

}

#endif
