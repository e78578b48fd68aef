/* The loss between a rendered picture and its photograph (L1 and SSIM, src/fit/stages/loss.h) and its gradient by the
 * pixels. */
#ifndef FXS_CUDA_FIT_LOSS_CUH
#define FXS_CUDA_FIT_LOSS_CUH

#include "step.cuh"

namespace {
#define static static __host__ __device__
#include "src/fit/stages/loss.h"
#undef static

/* A block of threads computes the loss of SQUARE x SQUARE pixels. It also loads a margin of REACH pixels for the
   windows of SSIM. Each thread computes RUN adjacent results, so that each input is loaded once. */
const int SQUARE = 32, REACH = FXS_FIT_WINDOW / 2, PATCH = SQUARE + 2 * REACH, RUN = 4;
const int PITCH = PATCH + 3, COLUMNS_PITCH = SQUARE + 1;    /* odd row lengths of the arrays in shared memory avoid bank
                                                               conflicts */
const uint32_t LOSS_THREADS = SQUARE * SQUARE / RUN;

typedef float patch[PATCH][PITCH];
typedef float column_sums[PATCH][COLUMNS_PITCH];

struct loss_place {
    int x, y;
    int left, top;
};

__device__ inline loss_place place_of_run()
{
    return {(int)threadIdx.x % SQUARE, (int)threadIdx.x / SQUARE * RUN, (int)blockIdx.x * SQUARE,
            (int)blockIdx.y * SQUARE};
}

/* A photograph in device memory: RGB bytes, and a mask with a byte per pixel or null. */
struct loss_photograph {
    const uint8_t *pixels, *mask;
};

__device__ inline float level_of_byte(uint8_t byte)
{
    return (float)byte / 255.0f;
}

template <bool HAS_MASK>
__device__ inline bool counts(const loss_photograph &photograph, size_t at)
{
    return !HAS_MASK || photograph.mask[at];
}

/* Returns a pixel's value for the loss. If exposures are fitted, values saturate at white, as in a photograph. */
__device__ inline float recorded_of(const step_buffers &b, float a, float level)
{
    return b.factors ? recorded(a, level) : a;
}

/* Calls visit(row, column, index, is_inside) for each pixel of a thread block's square and its margin. */
template <class Visit>
__device__ inline void visit_patch(const fxs_fit_camera &c, const loss_place &p, Visit visit)
{
    for (int i = (int)threadIdx.x; i < PATCH * PATCH; i += (int)LOSS_THREADS) {
        const int row = i / PATCH, column = i % PATCH, x = p.left + column - REACH, y = p.top + row - REACH;
        const bool is_inside = x >= 0 && x < c.width && y >= 0 && y < c.height;
        visit(row, column, (size_t)y * (size_t)c.width + (size_t)x, is_inside);
    }
}

/* Computes weighted sums over RUN windows of SSIM, with consecutive starts. */
template <class Number>
__device__ inline void window_sums(Number number, float out[RUN])
{
    float numbers[RUN + 2 * REACH];
#pragma unroll
    for (int i = 0; i < RUN + 2 * REACH; i++)
        numbers[i] = number(i);
#pragma unroll
    for (int k = 0; k < RUN; k++)
        out[k] = window_sum(numbers + k + REACH, 1);
}

template <class Put>
__device__ inline void visit_runs(Put put)
{
    const int runs = SQUARE / RUN;
    for (int i = (int)threadIdx.x; i < PATCH * runs; i += (int)LOSS_THREADS)
        put(i / runs, i % runs * RUN);
}

__device__ inline void sum_rows(const patch a, const patch b, column_sums *rows)
{
    visit_runs([&](int row, int first) {
        float sums[FXS_FIT_ROWS][RUN];
        const float *p = &a[row][first], *q = &b[row][first];
        window_sums([&](int i) { return p[i]; }, sums[0]);
        window_sums([&](int i) { return q[i]; }, sums[1]);
        window_sums([&](int i) { return p[i] * p[i]; }, sums[2]);
        window_sums([&](int i) { return q[i] * q[i]; }, sums[3]);
        window_sums([&](int i) { return p[i] * q[i]; }, sums[4]);
        for (int i = 0; i < FXS_FIT_ROWS; i++)
            for (int k = 0; k < RUN; k++)
                rows[i][row][first + k] = sums[i][k];
    });
}

template <bool HAS_MASK>
__global__ void __launch_bounds__(LOSS_THREADS, 5)
find_derivatives(step_buffers b, loss_photograph photograph, fxs_fit_camera camera, bool has_report)
{
    __shared__ patch pixels[2];
    __shared__ column_sums rows[FXS_FIT_ROWS];
    if (is_stopped(b.status))
        return;
    const loss_place p = place_of_run();
    const size_t size = (size_t)camera.width * (size_t)camera.height, channel = blockIdx.z;
    visit_patch(camera, p, [&](int row, int column, size_t at, bool is_inside) {
        const bool is_seen = is_inside && counts<HAS_MASK>(photograph, at);
        const float level = is_seen ? level_of_byte(photograph.pixels[3 * at + channel]) : 0;
        pixels[0][row][column] = is_seen ? recorded_of(b, b.picture[channel * size + at], level) : 0;
        pixels[1][row][column] = level;
    });
    __syncthreads();
    sum_rows(pixels[0], pixels[1], rows);
    __syncthreads();
    float sums[FXS_FIT_ROWS][RUN];
    for (int i = 0; i < FXS_FIT_ROWS; i++)
        window_sums([&](int k) { return rows[i][p.y + k][p.x]; }, sums[i]);
    for (int k = 0; k < RUN; k++) {
        const int x = p.left + p.x, y = p.top + p.y + k;
        if (x >= camera.width || y >= camera.height)
            continue;
        const similarity found = similarity_of(sums[0][k], sums[1][k], sums[2][k], sums[3][k], sums[4][k]);
        const size_t at = (size_t)y * (size_t)camera.width + (size_t)x;
        const bool is_counted = counts<HAS_MASK>(photograph, at);
        float *out = b.derivatives + 3 * channel * size + at;
        out[0] = is_counted ? found.by_mean : 0;
        out[size] = is_counted ? found.by_square : 0;
        out[2 * size] = is_counted ? found.by_product : 0;
        if (has_report)
            b.dissimilar[channel * size + at] = is_counted ? 1.0f - found.value : 0;
    }
}

__device__ inline void sum_derivatives(const step_buffers &b, const fxs_fit_camera &camera, const loss_place &p,
                                       size_t channel, patch *derivatives, column_sums *rows,
                                       float sums[FXS_FIT_DERIVATIVES][RUN])
{
    const size_t size = (size_t)camera.width * (size_t)camera.height;
    visit_patch(camera, p, [&](int row, int column, size_t at, bool is_inside) {
        for (size_t i = 0; i < FXS_FIT_DERIVATIVES; i++)
            derivatives[i][row][column] = is_inside ? b.derivatives[(3 * channel + i) * size + at] : 0;
    });
    __syncthreads();
    visit_runs([&](int row, int first) {
        for (int i = 0; i < FXS_FIT_DERIVATIVES; i++) {
            float of_run[RUN];
            window_sums([&](int k) { return derivatives[i][row][first + k]; }, of_run);
            for (int k = 0; k < RUN; k++)
                rows[i][row][first + k] = of_run[k];
        }
    });
    __syncthreads();
    for (int i = 0; i < FXS_FIT_DERIVATIVES; i++)
        window_sums([&](int k) { return rows[i][p.y + k][p.x]; }, sums[i]);
}

template <bool HAS_MASK>
__global__ void __launch_bounds__(LOSS_THREADS, 4)
find_gradient_of_pixels(step_buffers b, loss_photograph photograph, fxs_fit_camera camera)
{
    __shared__ patch derivatives[FXS_FIT_DERIVATIVES];
    __shared__ column_sums rows[FXS_FIT_DERIVATIVES];
    if (is_stopped(b.status))
        return;
    const loss_place p = place_of_run();
    const size_t size = (size_t)camera.width * (size_t)camera.height, channel = blockIdx.z;
    float sums[FXS_FIT_DERIVATIVES][RUN];
    sum_derivatives(b, camera, p, channel, derivatives, rows, sums);
#pragma unroll
    for (int k = 0; k < RUN; k++) {
        const int x = p.left + p.x, y = p.top + p.y + k;
        if (x >= camera.width || y >= camera.height)
            continue;
        const size_t at = (size_t)y * (size_t)camera.width + (size_t)x;
        const float a = b.picture[channel * size + at], level = level_of_byte(photograph.pixels[3 * at + channel]);
        const float gradient = gradient_of(a, level, sums[0][k], sums[1][k], sums[2][k]);
        const bool is_kept = counts<HAS_MASK>(photograph, at) && !(b.factors && is_beyond_white(a, level));
        b.gradient[channel * size + at] = is_kept ? gradient : 0;
    }
}

/* Sums a row of numbers with half a warp: 16 partial sums, each of every 16th number, are added as a binary tree. */
template <class Number>
__device__ inline float row_sum(int32_t width, Number number)
{
    float sum = 0;
    for (int32_t x = (int32_t)(threadIdx.x % 16); x < (width + 15) / 16 * 16; x += 16)
        sum += x < width ? number(x) : 0.0f;
    for (int half = 8; half; half /= 2)
        sum += __shfl_down_sync(ALL_LANES, sum, (unsigned)half, 16);
    return sum;
}

template <bool HAS_MASK>
__global__ void report_rows(step_buffers b, loss_photograph photograph, fxs_fit_camera camera)
{
    if (is_stopped(b.status))
        return;
    const size_t all = 3 * (size_t)camera.height, own = (size_t)(blockIdx.x * blockDim.x + threadIdx.x) / 16;
    const size_t row = own < all ? own : all - 1, channel = row / (size_t)camera.height;
    const size_t y = row % (size_t)camera.height, width = (size_t)camera.width;
    const float *a = b.picture + row * width, *dissimilar = b.dissimilar + row * width;
    const uint8_t *bytes = photograph.pixels + 3 * y * width + channel;
    const float difference = row_sum(camera.width, [&](int32_t x) {
        const bool is_counted = counts<HAS_MASK>(photograph, y * width + (size_t)x);
        const float level = level_of_byte(bytes[3 * x]);
        return is_counted ? absolute(recorded_of(b, a[x], level) - level) : 0.0f;
    });
    const float unlike = row_sum(camera.width, [&](int32_t x) { return dissimilar[x]; });
    if (own < all && threadIdx.x % 16 == 0) {
        float *out = b.rows + 2 * channel * (size_t)camera.height + y;
        out[0] = difference;
        out[camera.height] = unlike;
    }
}

template <bool HAS_MASK>
cudaError_t launch_loss_of(const step_buffers *b, loss_photograph photograph, const fxs_fit_camera *camera,
                           int has_report, cudaStream_t stream)
{
    const uint32_t columns = (uint32_t)(camera->width + SQUARE - 1) / SQUARE;
    const uint32_t rows = (uint32_t)(camera->height + SQUARE - 1) / SQUARE;
    const dim3 squares(columns, rows, 3);
    find_derivatives<HAS_MASK><<<squares, LOSS_THREADS, 0, stream>>>(*b, photograph, *camera, has_report != 0);
    launch_early(find_gradient_of_pixels<HAS_MASK>, squares, LOSS_THREADS, 0, stream, *b, photograph, *camera);
    if (has_report)
        report_rows<HAS_MASK><<<(3 * (uint32_t)camera->height + 15) / 16, 256, 0, stream>>>(*b, photograph, *camera);
    return cudaGetLastError();
}

cudaError_t launch_loss(const step_buffers *b, loss_photograph photograph, const fxs_fit_camera *camera, int has_report,
                        cudaStream_t stream)
{
    return photograph.mask ? launch_loss_of<true>(b, photograph, camera, has_report, stream)
                           : launch_loss_of<false>(b, photograph, camera, has_report, stream);
}

__global__ void average_down(const uint8_t *full, int32_t full_width, int divisor, int32_t width, int32_t height,
                             uint8_t *out)
{
    const int32_t x = (int32_t)(blockIdx.x * blockDim.x + threadIdx.x), y = (int32_t)blockIdx.y;
    if (x >= 3 * width || y >= height)
        return;
    const uint8_t *first = full + (size_t)y * (size_t)divisor * 3 * (size_t)full_width +
                           (size_t)(x / 3 * 3 * divisor + x % 3);
    int sum = divisor * divisor / 2;
    for (int row = 0; row < divisor; row++)
        for (int column = 0; column < divisor; column++)
            sum += first[(size_t)row * 3 * (size_t)full_width + (size_t)(3 * column)];
    out[(size_t)y * 3 * (size_t)width + (size_t)x] = (uint8_t)(sum / (divisor * divisor));
}

__global__ void reduce_mask(const uint8_t *full, int32_t full_width, int divisor, int32_t width, int32_t height,
                            uint8_t *out)
{
    const int32_t x = (int32_t)(blockIdx.x * blockDim.x + threadIdx.x), y = (int32_t)blockIdx.y;
    if (x >= width || y >= height)
        return;
    const uint8_t *first = full + (size_t)y * (size_t)divisor * (size_t)full_width + (size_t)(x * divisor);
    bool is_counted = true;
    for (int row = 0; row < divisor; row++)
        for (int column = 0; column < divisor; column++)
            is_counted = is_counted && first[(size_t)row * (size_t)full_width + (size_t)column];
    out[(size_t)y * (size_t)width + (size_t)x] = is_counted;
}

cudaError_t launch_reduce(const step_buffers *b, loss_photograph *photograph, int32_t full_width, int divisor,
                          const fxs_fit_camera *camera, cudaStream_t stream)
{
    const int32_t width = camera->width, height = camera->height;
    const dim3 blocks((uint32_t)(3 * width + 255) / 256, (uint32_t)height);
    uint8_t *mask = b->photograph + 3 * (size_t)width * (size_t)height;
    average_down<<<blocks, 256, 0, stream>>>(photograph->pixels, full_width, divisor, width, height, b->photograph);
    if (photograph->mask)
        reduce_mask<<<dim3((uint32_t)(width + 255) / 256, (uint32_t)height), 256, 0, stream>>>(
            photograph->mask, full_width, divisor, width, height, mask);
    *photograph = {b->photograph, photograph->mask ? mask : nullptr};
    return cudaGetLastError();
}

}

#endif
