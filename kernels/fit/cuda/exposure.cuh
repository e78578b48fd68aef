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

__device__ inline float gain_number(const step_buffers &b, const loss_photograph &photograph, int is_affine, size_t k,
                                    size_t size, size_t at)
{
    const size_t channel = k % 3;
    if (is_affine)
        return k < 9 ? b.gradient[channel * size + at] * b.picture[k / 3 * size + at] : b.gradient[channel * size + at];
    if (photograph.mask && !photograph.mask[at])
        return 0;
    return gain_summand((int)k, b.picture[channel * size + at], level_of_byte(photograph.pixels[3 * at + channel]));
}

__global__ void sum_gain_rows(step_buffers b, loss_photograph photograph, fxs_fit_camera camera, int is_affine)
{
    if (is_stopped(b.status))
        return;
    const size_t height = (size_t)camera.height, all = FXS_FIT_GAIN * height, width = (size_t)camera.width;
    const size_t own = (size_t)(blockIdx.x * blockDim.x + threadIdx.x) / 16, row = own < all ? own : all - 1;
    const size_t k = row / height, first = row % height * width;
    const float sum = row_sum(gain_needs(is_affine, (int)k) ? camera.width : 0, [&](int32_t x) {
        return gain_number(b, photograph, is_affine, k, height * width, first + (size_t)x);
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

cudaError_t launch_by_gain(const step_buffers *b, loss_photograph photograph, const fxs_fit_camera *camera,
                           int is_affine, float out[FXS_FIT_GAIN], cudaStream_t stream)
{
    const uint32_t rows = FXS_FIT_GAIN * (uint32_t)camera->height;
    sum_gain_rows<<<(rows + 15) / 16, 256, 0, stream>>>(*b, photograph, *camera, is_affine);
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
    __shared__ float moved[FXS_FIT_GAIN][FXS_FIT_BASIS];
    if (is_stopped(b.status))
        return;
    if (threadIdx.x < FXS_FIT_GAIN * FXS_FIT_BASIS)
        moved[threadIdx.x / FXS_FIT_BASIS][threadIdx.x % FXS_FIT_BASIS] = 0;
    __syncthreads();
    for (uint32_t v = 0; v < batch.count && threadIdx.x == 0; v++)
        gain_step(&gains.of[batch.numbers[v]], gains.is_affine, batch.by_gain[v], rate, decay, moved);
    __syncthreads();
    for (uint32_t i = threadIdx.x; i < gains.count; i += GAIN_THREADS)
        gain_project(&gains.of[i], gains.is_affine, moved);
}

cudaError_t launch_update_gains(const step_buffers *b, const fxs_fit_gains *gains, const gain_batch *batch, float rate,
                                float decay, cudaStream_t stream)
{
    update_gains<<<1, GAIN_THREADS, 0, stream>>>(*b, *gains, *batch, rate, decay);
    return cudaGetLastError();
}

}

#endif
