/* Updates the Gaussians: sums each Gaussian's gradients over its tiles, converts them to gradients of its parameters,
 * and takes a step of Adam. */
#ifndef FXS_CUDA_FIT_UPDATE_CUH
#define FXS_CUDA_FIT_UPDATE_CUH

#include <cuda_pipeline_primitives.h>

#include "bin.cuh"

namespace {

inline uint32_t part_count(const device_model *m)
{
    return (m->count + FXS_FIT_PART - 1) / FXS_FIT_PART;
}

const uint32_t GATHERED = WARP;
const uint32_t GATHER_THREADS = GATHERED * FXS_FIT_SUMS;
const uint32_t GATHER_WARPS = GATHER_THREADS / WARP;
const uint32_t TILES_AT_ONCE = 64;

/* Sums a gradient over at most FEW_TILES tiles. Tiles that are missing add 0, which does not change the result. */
__device__ inline float sum_few(const float *sums, uint32_t tiles)
{
    float numbers[FEW_TILES], total = 0;
#pragma unroll
    for (uint32_t t = 0; t < FEW_TILES; t++)
        numbers[t] = t < tiles ? sums[(size_t)t * FXS_FIT_SUMS] : 0;
#pragma unroll
    for (uint32_t t = 0; t < FEW_TILES; t++)
        total += numbers[t];
    return total;
}

/* Sums FXS_FIT_SUMS gradients over many tiles with several threads. Each of the first FXS_FIT_SUMS threads returns the
   sum for one gradient. */
template <uint32_t Threads, uint32_t Tiles, class Sync>
__device__ inline float sum_many(const float *sums, uint32_t tiles, float staged[Tiles * FXS_FIT_SUMS], Sync sync)
{
    const uint32_t own = threadIdx.x % Threads, all = tiles * FXS_FIT_SUMS;
    float total = 0;
    for (uint32_t first = 0; first < all; first += Tiles * FXS_FIT_SUMS) {
        sync();
#pragma unroll
        for (uint32_t i = own; i < Tiles * FXS_FIT_SUMS; i += Threads)
            staged[i] = first + i < all ? sums[first + i] : 0;
        sync();
        if (own < FXS_FIT_SUMS)
#pragma unroll 16
            for (uint32_t t = 0; t < Tiles; t++)
                total += staged[t * FXS_FIT_SUMS + own];
    }
    return total;
}

__global__ void __launch_bounds__(GATHER_THREADS, 7) gather_view(step_buffers b, device_model m, float *planes)
{
    __shared__ union {
        float by_warps[GATHER_WARPS][TILES_AT_ONCE * FXS_FIT_SUMS];
        float by_block[GATHER_WARPS * TILES_AT_ONCE * FXS_FIT_SUMS];
        float totals[FXS_FIT_SUMS][GATHERED + 1];
    } shared;
    __shared__ uint32_t tiles[GATHERED];
    const uint32_t column = threadIdx.x % GATHERED, row = threadIdx.x / GATHERED;
    auto tiles_of = [&](uint32_t gaussian) { return b.bases[gaussian + 1] - b.bases[gaussian]; };
    auto sums_from = [&](uint32_t gaussian) { return b.sums + (size_t)b.bases[gaussian] * FXS_FIT_SUMS; };
    if (is_stopped(b.status))
        return;
    if (blockIdx.x < LARGE_BLOCKS)
        return visit_large(
            b,
            [&](uint32_t gaussian) {
                const float total = sum_many<GATHER_THREADS, GATHER_WARPS * TILES_AT_ONCE>(
                    sums_from(gaussian), tiles_of(gaussian), shared.by_block, [] { __syncthreads(); });
                if (threadIdx.x < FXS_FIT_SUMS)
                    planes[(size_t)threadIdx.x * m.stride + gaussian] = total;
                __syncthreads();
            },
            [&](uint32_t gaussian) {
                const float total = sum_many<WARP, TILES_AT_ONCE>(sums_from(gaussian), tiles_of(gaussian),
                                                                  shared.by_warps[row], [] { __syncwarp(); });
                if (column < FXS_FIT_SUMS)
                    planes[(size_t)column * m.stride + gaussian] = total;
            });
    const uint32_t gaussian = spread_over_blocks(column);
    if (row == 0) {
        tiles[column] = gaussian < m.count ? tiles_of(gaussian) : 0;
        if (gaussian < m.count)
            planes[(size_t)FXS_FIT_SUMS * m.stride + gaussian] = b.splats[gaussian].depth > 0;
    }
    __syncthreads();
    const uint32_t own = threadIdx.x / FXS_FIT_SUMS, k = threadIdx.x % FXS_FIT_SUMS;
    if (tiles[own] <= FEW_TILES)
        shared.totals[k][own] = tiles[own] ? sum_few(sums_from(spread_over_blocks(own)) + k, tiles[own]) : 0;
    __syncthreads();
    if (gaussian < m.count && tiles[column] <= FEW_TILES)
        planes[(size_t)row * m.stride + gaussian] = shared.totals[row][column];
}

/* Sums each Gaussian's gradients over its tiles. Writes planes of m->stride floats: FXS_FIT_SUMS gradient sums, then 1
   for visible Gaussians, else 0. */
cudaError_t launch_gather(const step_buffers *b, const device_model *m, float *planes, cudaStream_t stream)
{
    return launch_early(gather_view, LARGE_BLOCKS + (m->count + GATHERED - 1) / GATHERED, GATHER_THREADS, 0, stream, *b,
                        *m, planes);
}

/* The gradient by a Gaussian's parameters from one view. The gradient by the SH coefficients is the SH basis times g,
   the gradient by the colour. */
struct view_gradient {
    real shape[FXS_FIT_SH], g[3];
    look l;
};

__device__ inline bool is_any(const float sums[FXS_FIT_SUMS])
{
    bool found = false;
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        found = found || 0 < absolute(sums[k]);
    return found;
}

/* Computes a Gaussian's gradient from one view. A gradient that is not finite or too large counts as 0. */
template <int Degree>
__device__ inline void find_view_gradient(const fxs_fit_camera *camera, const float *at, size_t stride,
                                          const float sums[FXS_FIT_SUMS], view_gradient *out, float *by_centre)
{
    bool is_touched = is_any(sums);
    if (is_touched) {
        real centre[2], by_position[3];
        find_gradient_but_sh(camera, Degree, at, stride, sums, &out->l, out->g, out->shape, centre, by_position);
        for (int k = 0; k < FXS_FIT_SH; k++)
            is_touched = is_touched && absolute(out->shape[k]) < FXS_FIT_FARTHEST_GRADIENT;
        for (int k = 0; k < 3 * SH_COUNT(Degree); k++)
            is_touched = is_touched && absolute(out->l.basis[k / 3] * out->g[k % 3]) < FXS_FIT_FARTHEST_GRADIENT;
        if (is_touched)
            *by_centre += centre_gradient(camera, centre);
    }
    if (!is_touched)
        memset(out, 0, sizeof *out);
}

__device__ inline void add_regularisers(const fxs_fit_adam *adam, const float *at, size_t stride,
                                        real gradient[FXS_FIT_SH])
{
    gradient[FXS_FIT_OPACITY] =
        opacity_regularised(adam, gradient[FXS_FIT_OPACITY], at[FXS_FIT_OPACITY * stride]);
    const real unit = unit_at(&adam->far, at, stride);
    for (int k = FXS_FIT_SCALE; k < FXS_FIT_SCALE + 3; k++)
        gradient[k] = scale_regularised(adam, gradient[k], at[k * stride], unit);
}

__device__ inline bool has_limits(int k)
{
    return (k >= FXS_FIT_SCALE && k < FXS_FIT_ROTATION) || k == FXS_FIT_OPACITY;
}

__device__ inline real within_limits(real x)
{
    return least(most(x, -FXS_FIT_FARTHEST), FXS_FIT_FARTHEST);
}

__device__ inline float *number_at(float *planes, const device_model &m, int plane, uint32_t i)
{
    return planes + (size_t)plane * m.stride + i;
}

/* Makes a step of Adam for one parameter of a Gaussian. Streaming stores keep the moments out of the cache, as nothing
   reads them soon. */
__device__ inline void move_one(const fxs_fit_adam *adam, int k, real gradient, real number, real mean, real square,
                                const device_model &m, float *to, uint32_t i)
{
    adam_step(adam, adam->rate[k], gradient, &number, &mean, &square);
    __stcs(number_at(m.means, m, k, i), mean);
    __stcs(number_at(m.squares, m, k, i), square);
    *number_at(to, m, k, i) = has_limits(k) ? within_limits(number) : number;
}

/* Makes a step of Adam for `Count` parameters of a Gaussian. All loads precede the first store, so that many loads are
   in flight. */
template <int Count, class Gradient>
__device__ inline void move_some(const fxs_fit_adam *adam, int first, const device_model &m, float *to, uint32_t i,
                                 Gradient gradient_of)
{
    real number[Count], mean[Count], square[Count];
#pragma unroll
    for (int k = 0; k < Count; k++) {
        number[k] = *number_at(to, m, first + k, i);
        mean[k] = __ldcs(number_at(m.means, m, first + k, i));
        square[k] = __ldcs(number_at(m.squares, m, first + k, i));
    }
#pragma unroll
    for (int k = 0; k < Count; k++)
        move_one(adam, first + k, gradient_of(first + k), number[k], mean[k], square[k], m, to, i);
}

/* Arrays of one float per Gaussian that hold the colour gradient and the view direction. These overwrite gradient sums
   already read. */
enum { PLANE_G = 0, PLANE_DIRECTION = 3 };

struct batch_views {
    uint32_t count;
    float *planes[FXS_FIT_BATCH];
    const float *surfaces[FXS_FIT_BATCH];  /* 3 planes of sums by fit_surface.h; null: none in this step */
    fxs_fit_camera cameras[FXS_FIT_BATCH];
    const posed_camera *posed;
};

const uint32_t SHAPE_THREADS = 128, SHAPE_BLOCKS = 4;

/* Parameters and Adam's moments of a thread block's Gaussians. They are in shared memory, as they exceed the registers
   of a thread. */
template <int Degree>
struct shape_rows {
    float parameters[FXS_FIT_SH + 3 * SH_COUNT(Degree)][SHAPE_THREADS];
    float means[FXS_FIT_SH][SHAPE_THREADS], squares[FXS_FIT_SH][SHAPE_THREADS];
};

__device__ inline void fetch_rows(float (*rows)[SHAPE_THREADS], const float *planes, uint32_t stride, uint32_t count)
{
    for (uint32_t row = threadIdx.x / WARP; row < count; row += SHAPE_THREADS / WARP)
        __pipeline_memcpy_async(&rows[row][4 * lane_index()],
                                planes + (size_t)row * stride + blockIdx.x * SHAPE_THREADS + 4 * lane_index(), 16);
}

__device__ inline bool is_seen(const batch_views &views, const device_model &m, uint32_t i)
{
    bool found = false;
    for (uint32_t v = 0; v < views.count; v++)
        found = found || views.planes[v][(size_t)FXS_FIT_SUMS * m.stride + i] > 0;
    return found;
}

template <int Degree>
__device__ inline void fetch_shapes(shape_rows<Degree> *rows, const batch_views &views, const device_model &m,
                                    uint32_t i)
{
    fetch_rows(rows->parameters, m.parameters, m.stride, FXS_FIT_SH);
    fetch_rows(rows->means, m.means, m.stride, FXS_FIT_SH);
    fetch_rows(rows->squares, m.squares, m.stride, FXS_FIT_SH);
    if (__syncthreads_or(i < m.count && is_seen(views, m, i)))
        fetch_rows(rows->parameters + FXS_FIT_SH, m.parameters + (size_t)FXS_FIT_SH * m.stride, m.stride,
                   3 * SH_COUNT(Degree));
    __pipeline_commit();
    __pipeline_wait_prior(0);
    __syncthreads();
}

template <int Degree, bool IsPosed>
__device__ inline void add_view(const batch_views &views, uint32_t v, const device_model &m, size_t i,
                                const shape_rows<Degree> &rows, real total[FXS_FIT_SH])
{
    const float *const own_rows = rows.parameters[0] + threadIdx.x;
    float sums[FXS_FIT_SUMS], *const planes = views.planes[v] + i;
    view_gradient own;
#pragma unroll
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        sums[k] = planes[(size_t)k * m.stride];
    if (planes[(size_t)FXS_FIT_SUMS * m.stride] > 0)
        m.views[i] += 1;
    if constexpr (IsPosed) {
        const fxs_fit_camera camera = with_pose(views.cameras[v], views.posed + v);
        find_view_gradient<Degree>(&camera, own_rows, SHAPE_THREADS, sums, &own, m.by_centre + i);
    } else
        find_view_gradient<Degree>(&views.cameras[v], own_rows, SHAPE_THREADS, sums, &own, m.by_centre + i);
    for (int k = 0; k < FXS_FIT_SH; k++)
        total[k] += own.shape[k];
    for (int k = 0; k < 3 && Degree > 0; k++) {
        planes[(size_t)(PLANE_G + k) * m.stride] = own.g[k];
        planes[(size_t)(PLANE_DIRECTION + k) * m.stride] = own.l.direction[k];
    }
}

__device__ inline void add_surface_sums(const fxs_fit_adam *adam, const batch_views &views, const device_model &m,
                                        uint32_t i, const float *at, real gradient[FXS_FIT_SH])
{
    real sums[3] = {0, 0, 0};
    for (uint32_t v = 0; v < views.count; v++)
        for (int k = 0; k < 3 && views.surfaces[v]; k++)
            sums[k] += views.surfaces[v][(size_t)k * m.stride + i];
    add_surface(adam, at, SHAPE_THREADS, sums, gradient);
}

/* Updates all parameters of the Gaussians except spherical harmonics above degree 0. HasSurfaces: Gaussians are
   flattened and turned. */
template <int Degree, bool IsPosed, bool HasSurfaces>
__global__ void __launch_bounds__(SHAPE_THREADS, SHAPE_BLOCKS)
    update_shapes(step_buffers b, device_model m, const __grid_constant__ batch_views views,
                  const __grid_constant__ fxs_fit_adam adam)
{
    __shared__ __align__(16) shape_rows<Degree> rows;
    const uint32_t i = blockIdx.x * SHAPE_THREADS + threadIdx.x;
    real gradient[FXS_FIT_SH] = {0};
    if (i == 0)
        b.status->updates_sh = !is_stopped(b.status);
    if (is_stopped(b.status))
        return;
    if (i == 0)
        b.status->done++;
    fetch_shapes(&rows, views, m, i);
    if (i >= m.count)
        return;
#pragma unroll 1
    for (uint32_t v = 0; v < views.count; v++)
        add_view<Degree, IsPosed>(views, v, m, i, rows, gradient);
    if (adam.by_opacity > 0)
        add_regularisers(&adam, rows.parameters[0] + threadIdx.x, SHAPE_THREADS, gradient);
    if constexpr (HasSurfaces)
        add_surface_sums(&adam, views, m, i, rows.parameters[0] + threadIdx.x, gradient);
    real number[FXS_FIT_SH];
#pragma unroll
    for (int k = 0; k < FXS_FIT_SH; k++)
        number[k] = m.masters ? *number_at(m.masters, m, k, i) : rows.parameters[k][threadIdx.x];
#pragma unroll
    for (int k = 0; k < FXS_FIT_SH; k++)
        move_one(&adam, k, gradient[k], number[k], rows.means[k][threadIdx.x], rows.squares[k][threadIdx.x], m,
                 m.masters ? m.masters : m.parameters, i);
}

const int SH_AT_ONCE = 2;

template <int Degree, int First>
__device__ inline void update_some_sh(const fxs_fit_adam *adam, const batch_views &views, const device_model &m,
                                      uint32_t i)
{
    const int count = SH_COUNT(Degree) - First < SH_AT_ONCE ? SH_COUNT(Degree) - First : SH_AT_ONCE;
    real gradient[3 * count] = {0};
    for (uint32_t v = 0; v < views.count; v++) {
        const float *planes = views.planes[v] + i;
        real direction[3], basis[15], g[3];
        for (int k = 0; k < 3; k++) {
            g[k] = planes[(size_t)(PLANE_G + k) * m.stride];
            direction[k] = planes[(size_t)(PLANE_DIRECTION + k) * m.stride];
        }
        basis_of(direction, Degree, basis);
        for (int k = 0; k < 3 * count; k++)
            gradient[k] += basis[First + k / 3] * g[k % 3];
    }
    const int first = FXS_FIT_SH + 3 * First;
    move_some<3 * count>(adam, first, m, m.masters ? m.masters : m.parameters, i,
                         [&](int k) { return gradient[k - first]; });
}

template <int Degree, int First>
__device__ inline void update_part_of_sh(const fxs_fit_adam *adam, const batch_views &views, const device_model &m,
                                         uint32_t i, uint32_t part)
{
    if (part == First / SH_AT_ONCE)
        update_some_sh<Degree, First>(adam, views, m, i);
    else if constexpr (First + SH_AT_ONCE < SH_COUNT(Degree))
        update_part_of_sh<Degree, First + SH_AT_ONCE>(adam, views, m, i, part);
}

template <int Degree>
__global__ void __launch_bounds__(FXS_FIT_PART, 3)
    update_sh(step_buffers b, device_model m, const __grid_constant__ batch_views views,
              const __grid_constant__ fxs_fit_adam adam)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    if (i < m.count && b.status->updates_sh)
        update_part_of_sh<Degree, 0>(&adam, views, m, i, blockIdx.y);
}

/* Quantises all parameters of the Gaussians except spherical harmonics above degree 0. The array grid.chunks is in
   device memory. */
__global__ void __launch_bounds__(FXS_FIT_PART) quantise_shapes(device_model m, fxs_fit_grid grid)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    real from[FXS_FIT_SH], to[FXS_FIT_SH];
    whole codes[FXS_FIT_SH];
    if (i >= m.count)
        return;
    for (int k = 0; k < FXS_FIT_SH; k++)
        from[k] = *number_at(m.masters, m, k, i);
    quantise_shape(&grid, &grid.chunks[i / FXS_FIT_CHUNK], from, to, 1, codes);
    for (int k = 0; k < FXS_FIT_SH; k++)
        *number_at(m.parameters, m, k, i) = to[k];
}

__global__ void __launch_bounds__(FXS_FIT_PART) quantise_sh(device_model m, fxs_fit_grid grid)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    const int degree = (int)blockIdx.y + 1, first = FXS_FIT_SH + 3 * SH_COUNT(degree - 1);
    whole code;
    if (i >= m.count)
        return;
#pragma unroll 8
    for (int k = first; k < first + 6 * degree + 3; k++)
        *number_at(m.parameters, m, k, i) =
            quantise_band(&grid.chunks[i / FXS_FIT_CHUNK], degree, *number_at(m.masters, m, k, i), &code);
}

fxs_fit_grid grid_on_device(const device_model *m, const fxs_fit_grid *grid)
{
    fxs_fit_grid there = *grid;
    there.chunks = m->chunks;
    return there;
}

cudaError_t launch_quantise_shapes(const device_model *m, const fxs_fit_grid *grid, cudaStream_t stream)
{
    quantise_shapes<<<part_count(m), FXS_FIT_PART, 0, stream>>>(*m, grid_on_device(m, grid));
    return cudaGetLastError();
}

cudaError_t launch_quantise_sh(const device_model *m, const fxs_fit_grid *grid, cudaStream_t stream)
{
    const dim3 blocks(part_count(m), (uint32_t)grid->sh_degree);
    if (grid->sh_degree > 0)
        quantise_sh<<<blocks, FXS_FIT_PART, 0, stream>>>(*m, grid_on_device(m, grid));
    return cudaGetLastError();
}

/* Updates the Gaussians from the gradient sums of `count` views, in the order of the views. `posed` and `grid` may be
   null. A second stream updates SH above degree 0. */
cudaError_t launch_update(const step_buffers *b, const device_model *m, float *const *planes,
                          const float *const *surfaces, const fxs_fit_camera *cameras,
                          const posed_camera *posed, uint32_t count, int degree,
                          const fxs_fit_adam *adam, const fxs_fit_grid *grid, cudaStream_t stream,
                          const side_stream *beside)
{
    batch_views views;
    memset(&views, 0, sizeof views);
    views.count = count;
    views.posed = posed;
    for (uint32_t v = 0; v < count; v++) {
        views.planes[v] = planes[v];
        views.surfaces[v] = surfaces[v];
        views.cameras[v] = cameras[v];
    }
    by_degree(degree, [&](auto d) {
        constexpr int Degree = d.value;
        const auto plain = posed ? update_shapes<Degree, true, false> : update_shapes<Degree, false, false>;
        const auto flat = posed ? update_shapes<Degree, true, true> : update_shapes<Degree, false, true>;
        const auto shapes = adam->by_flat > 0 ? flat : plain;
        launch_early(shapes, (m->count + SHAPE_THREADS - 1) / SHAPE_THREADS, SHAPE_THREADS, 0, stream, *b, *m, views,
                     *adam);
        beside->start(stream);
        if constexpr (Degree > 0)
            update_sh<Degree><<<dim3(part_count(m), (SH_COUNT(Degree) + SH_AT_ONCE - 1) / SH_AT_ONCE), FXS_FIT_PART, 0,
                                beside->stream>>>(*b, *m, views, *adam);
    });
    if (grid)
        launch_quantise_sh(m, grid, beside->stream);
    return first_of(cudaGetLastError(), cudaEventRecord(beside->end, beside->stream));
}

__global__ void __launch_bounds__(FXS_FIT_PART) move_by_noise(step_buffers b, device_model m, fxs_fit_noise noise)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    if (i < m.count && !is_stopped(b.status))
        add_noise(&noise, (m.masters ? m.masters : m.parameters) + i, m.stride, i);
}

cudaError_t launch_noise(const step_buffers *b, const device_model *m, const fxs_fit_noise *noise, cudaStream_t stream)
{
    move_by_noise<<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, *noise);
    return cudaGetLastError();
}

/* Raises scales of Gaussians to their lower limit. The array cameras.of is in device memory. */
__global__ void __launch_bounds__(FXS_FIT_PART)
    smooth_model(step_buffers b, device_model m, fxs_fit_cameras cameras, int divisor)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    if (i < m.count && !is_stopped(b.status))
        smooth_scales(&cameras, divisor, (m.masters ? m.masters : m.parameters) + i, m.stride);
}

cudaError_t launch_smooth(const step_buffers *b, const device_model *m, const fxs_fit_cameras *cameras, int divisor,
                          cudaStream_t stream)
{
    smooth_model<<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, *cameras, divisor);
    return cudaGetLastError();
}

}

#endif
