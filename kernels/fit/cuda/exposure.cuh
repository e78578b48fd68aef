/* The exposures of photographs on a device: src/fit/exposure.h, in the order of src/fit/stepper.c. */
#ifndef FXS_CUDA_FIT_EXPOSURE_CUH
#define FXS_CUDA_FIT_EXPOSURE_CUH

#include "loss.cuh"

namespace {
#define static static __host__ __device__
#include "src/fit/exposure.h"
#undef static

const uint32_t GAIN_THREADS = 3 * GAIN_PARTS;    /* a thread has a part of a sum, of a channel or a number */

__global__ void find_factors(step_buffers b, const fxs_fit_gain *gain)
{
    if (!is_stopped(b.status))
        gain_factors(gain, b.factors);
}

/* Of the photograph's exposure, before blend. */
cudaError_t launch_factors(const step_buffers *b, const fxs_fit_gain *gain, cudaStream_t stream)
{
    find_factors<<<1, 1, 0, stream>>>(*b, gain);
    return cudaGetLastError();
}

__global__ void sum_gain_rows(step_buffers b, fxs_fit_camera camera)
{
    if (is_stopped(b.status))
        return;
    const size_t all = 3 * (size_t)camera.height, own = (size_t)(blockIdx.x * blockDim.x + threadIdx.x) / 16;
    const size_t row = own < all ? own : all - 1, width = (size_t)camera.width;
    const float *gradient = b.gradient + row * width, *picture = b.picture + row * width;
    const float sum = row_sum(camera.width, [&](int32_t x) { return gradient[x] * picture[x]; });
    if (own < all && threadIdx.x % 16 == 0)
        b.gain_rows[row] = sum;
}

__global__ void sum_channels(step_buffers b, fxs_fit_camera camera, float *out)
{
    __shared__ double parts[3][GAIN_PARTS];
    if (is_stopped(b.status))
        return;
    const size_t height = (size_t)camera.height, channel = threadIdx.x / GAIN_PARTS, part = threadIdx.x % GAIN_PARTS;
    parts[channel][part] = gain_part(b.gain_rows + channel * height, 1, height, part);
    __syncthreads();
    if (part == 0)
        out[channel] = gain_sum(parts[channel], 3.0 * camera.width * camera.height);
}

/* Writes the numbers that gain_step takes, of the pixels' gradients. */
cudaError_t launch_by_gain(const step_buffers *b, const fxs_fit_camera *camera, float out[3], cudaStream_t stream)
{
    sum_gain_rows<<<(3 * (uint32_t)camera->height + 15) / 16, 256, 0, stream>>>(*b, *camera);
    sum_channels<<<1, GAIN_THREADS, 0, stream>>>(*b, *camera, out);
    return cudaGetLastError();
}

/* Of a batch's photographs, in order: their numbers, and what launch_by_gain wrote of each. */
struct gain_batch {
    uint32_t count, numbers[FXS_FIT_BATCH];
    const float *by_gain[FXS_FIT_BATCH];
};

__global__ void __launch_bounds__(GAIN_THREADS)
update_gains(step_buffers b, fxs_fit_gains gains, gain_batch batch, float rate)
{
    __shared__ double parts[3][GAIN_PARTS];
    __shared__ float means[3];
    if (is_stopped(b.status))
        return;
    const uint32_t k = threadIdx.x / GAIN_PARTS, part = threadIdx.x % GAIN_PARTS;
    for (uint32_t v = 0; v < batch.count && threadIdx.x == 0; v++)
        gain_step(&gains.of[batch.numbers[v]], batch.by_gain[v], rate);
    __syncthreads();
    parts[k][part] = gain_part(&gains.of->at[k], GAIN_STEP, gains.count, part);
    __syncthreads();
    if (part == 0)
        means[k] = gain_sum(parts[k], gains.count);
    __syncthreads();
    for (uint32_t i = part; i < gains.count; i += GAIN_PARTS)
        gains.of[i].at[k] -= means[k];
}

cudaError_t launch_update_gains(const step_buffers *b, const fxs_fit_gains *gains, const gain_batch *batch, float rate,
                                cudaStream_t stream)
{
    update_gains<<<1, GAIN_THREADS, 0, stream>>>(*b, *gains, *batch, rate);
    return cudaGetLastError();
}

}

#endif
