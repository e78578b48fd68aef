/* update: Gaussians' sums over their tiles, the gradients of their parameters, and a step of Adam by them. */
#ifndef FXS_CUDA_FIT_UPDATE_CUH
#define FXS_CUDA_FIT_UPDATE_CUH

#include "bin.cuh"

namespace {

/* A block's Gaussians are a part of stage.h. */
const uint32_t PART_WARPS = FXS_FIT_PART / WARP;

inline uint32_t part_count(const device_model *m)
{
    return (m->count + FXS_FIT_PART - 1) / FXS_FIT_PART;
}

/* ---- gather ------------------------------------------------------------------------------------------------------ */

/* Sums of so many tiles at once, of a splat of many. */
const uint32_t STAGED_TILES = 64;

struct staged_sums {
    float numbers[PART_WARPS][STAGED_TILES * FXS_FIT_SUMS];
};

/* Those of a slot, which begin at any number of the four that are read at once. */
__device__ inline void read_slot(const float *sums, uint32_t slot, float out[FXS_FIT_SUMS])
{
    const uint64_t at = (uint64_t)slot * FXS_FIT_SUMS;
    const float4 *from = (const float4 *)sums + at / 4;
    const float4 a = from[0], b = from[1], c = from[2];
    const float read[12] = {a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w};
    float half[10];
    for (int k = 0; k < 10; k++)
        half[k] = at & 2 ? read[k + 2] : read[k];
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        out[k] = at & 1 ? half[k + 1] : half[k];
}

/* Some slots are under way at once; 0 changes no sum, as none is -0. */
__device__ inline void add_small(const float *sums, uint32_t slot, uint32_t tiles, float total[FXS_FIT_SUMS])
{
    const uint32_t at_once = 4;
    for (uint32_t t = 0; t < tiles; t += at_once) {
        float own[at_once][FXS_FIT_SUMS];
#pragma unroll
        for (uint32_t u = 0; u < at_once; u++) {
            memset(own[u], 0, sizeof own[u]);
            if (t + u < tiles)
                read_slot(sums, slot + t + u, own[u]);
        }
#pragma unroll
        for (uint32_t u = 0; u < at_once; u++)
            for (int k = 0; k < FXS_FIT_SUMS; k++)
                total[k] += own[u][k];
    }
}

/* By a warp: of one splat; each total is a thread's. */
__device__ inline float add_large(const float *sums, uint32_t slot, uint32_t tiles, float *staged)
{
    const uint32_t lane = threadIdx.x % WARP;
    const float *from = sums + (uint64_t)slot * FXS_FIT_SUMS;
    float total = 0;
    for (uint32_t first = 0; first < tiles; first += STAGED_TILES) {
        const uint32_t count = min(tiles - first, STAGED_TILES);
#pragma unroll
        for (uint32_t i = lane; i < STAGED_TILES * FXS_FIT_SUMS; i += WARP)
            if (i < count * FXS_FIT_SUMS)
                staged[i] = from[(uint64_t)first * FXS_FIT_SUMS + i];
        __syncwarp();
        for (uint32_t t = 0; t < count && lane < FXS_FIT_SUMS; t++)
            total += staged[t * FXS_FIT_SUMS + lane];
        __syncwarp();
    }
    return total;
}

/* The sums of a thread's Gaussian over its tiles, in their order; by the whole block. Returns whether it is in the
   picture. */
__device__ inline bool gather_sums(const step_buffers &b, uint32_t i, uint32_t count, staged_sums *staged,
                                   float total[FXS_FIT_SUMS])
{
    const fxs_fit_splat *splat = &b.splats[i];
    const bool is_seen = i < count && splat->depth > 0;
    const uint32_t slot = is_seen ? splat->slot : 0, tiles = is_seen ? (uint32_t)splat->tiles : 0;
    const uint32_t lane = threadIdx.x % WARP, warp = threadIdx.x / WARP;
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        total[k] = 0;
    if (tiles <= LARGE_TILES)
        add_small(b.sums, slot, tiles, total);
    for (uint32_t large = __ballot_sync(ALL_LANES, tiles > LARGE_TILES); large; large &= large - 1) {
        const uint32_t from = (uint32_t)__ffs((int)large) - 1;
        const float own = add_large(b.sums, __shfl_sync(ALL_LANES, slot, from), __shfl_sync(ALL_LANES, tiles, from),
                                    staged->numbers[warp]);
        for (int k = 0; k < FXS_FIT_SUMS; k++) {
            const float sum = __shfl_sync(ALL_LANES, own, k);
            total[k] = lane == from ? sum : total[k];
        }
    }
    return is_seen;
}

__global__ void __launch_bounds__(FXS_FIT_PART) gather_view(step_buffers b, device_model m, float *planes)
{
    __shared__ staged_sums staged;
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    float total[FXS_FIT_SUMS];
    if (is_stopped(b.status))
        return;
    const bool is_seen = gather_sums(b, i, m.count, &staged, total);
    if (i >= m.count)
        return;
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        planes[(size_t)k * m.stride + i] = total[k];
    planes[(size_t)FXS_FIT_SUMS * m.stride + i] = is_seen;
}

/* The sums of a view to FXS_FIT_SUMS planes, m->stride numbers each, and one more: 1 where a Gaussian is in the
   picture, or 0. */
cudaError_t launch_gather(const step_buffers *b, const device_model *m, float *planes, cudaStream_t stream)
{
    gather_view<<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, planes);
    return cudaGetLastError();
}

/* ---- Gradients --------------------------------------------------------------------------------------------------- */

/* Of a Gaussian, by one view. That of SH is not kept, but found where it is needed. */
template <int Degree>
struct view_gradient {
    real shape[FXS_FIT_SH], g[3];
    look l;

    __device__ real sh(int k) const
    {
        return l.basis[k / 3] * g[k % 3];
    }
};

/* By several, whose SH's are found anew; of views without a gradient `g` is 0. */
template <int Degree>
struct batch_gradient {
    real shape[FXS_FIT_SH], g[FXS_FIT_BATCH][3], direction[FXS_FIT_BATCH][3];
    uint32_t views;

    __device__ real sh(int k) const
    {
        real total = 0;
        for (uint32_t v = 0; v < views; v++) {
            real basis[15];
            basis_of(direction[v], Degree, basis);
            total += basis[k / 3] * g[v][k % 3];
        }
        return total;
    }
};

__device__ inline bool is_any(const float sums[FXS_FIT_SUMS])
{
    bool found = false;
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        found = found || 0 < absolute(sums[k]);
    return found;
}

/* Returns whether there is one that is finite and not too large; else it is 0. `at`: the Gaussian's first parameter. */
template <int Degree>
__device__ inline bool find_view_gradient(const fxs_fit_camera *camera, const float *at, size_t stride,
                                          const float sums[FXS_FIT_SUMS], view_gradient<Degree> *out, float *by_centre)
{
    bool is_touched = is_any(sums);
    if (is_touched) {
        real centre[2];
        find_gradient_but_sh(camera, Degree, at, stride, sums, &out->l, out->g, out->shape, centre);
        for (int k = 0; k < FXS_FIT_SH; k++)
            is_touched = is_touched && absolute(out->shape[k]) < FXS_FIT_FARTHEST_GRADIENT;
        for (int k = 0; k < 3 * SH_COUNT(Degree); k++)
            is_touched = is_touched && absolute(out->sh(k)) < FXS_FIT_FARTHEST_GRADIENT;
        if (is_touched)
            *by_centre += centre_gradient(camera, centre);
    }
    if (!is_touched)
        memset(out, 0, sizeof *out);
    return is_touched;
}

/* ---- Adam -------------------------------------------------------------------------------------------------------- */

/* Of mean opacity and mean scale. */
__device__ inline void add_regularisers(const fxs_fit_adam *adam, const float *at, size_t stride,
                                        real gradient[FXS_FIT_SH])
{
    gradient[FXS_FIT_OPACITY] =
        opacity_regularised(adam, gradient[FXS_FIT_OPACITY], at[FXS_FIT_OPACITY * stride]);
    for (int k = FXS_FIT_SCALE; k < FXS_FIT_SCALE + 3; k++)
        gradient[k] = scale_regularised(adam, gradient[k], at[k * stride]);
}

const int AT_ONCE = 6;             /* parameters */

__device__ inline bool has_limits(int k)
{
    return (k >= FXS_FIT_SCALE && k < FXS_FIT_ROTATION) || k == FXS_FIT_OPACITY;
}

__device__ inline real within_limits(real x)
{
    return least(most(x, -FXS_FIT_FARTHEST), FXS_FIT_FARTHEST);
}

/* Of a plane, a Gaussian's number. */
__device__ inline float *number_of(float *planes, const device_model &m, int plane, uint32_t i)
{
    return planes + (size_t)plane * m.stride + i;
}

/* Of `Count` parameters from `first` on, whose gradients gradient_of(k) says. All is read before the first is written,
   so that much of it is under way at once; moments, which are not read again soon, make no room for themselves. */
template <int Count, class Gradient>
__device__ inline void move_some(const fxs_fit_adam *adam, int first, const device_model &m, float *to, uint32_t i,
                                 Gradient gradient_of)
{
    real number[Count], mean[Count], square[Count];
#pragma unroll
    for (int k = 0; k < Count; k++) {
        number[k] = *number_of(to, m, first + k, i);
        mean[k] = __ldcs(number_of(m.means, m, first + k, i));
        square[k] = __ldcs(number_of(m.squares, m, first + k, i));
    }
#pragma unroll
    for (int k = 0; k < Count; k++) {
        adam_step(adam, adam->rate[first + k], gradient_of(first + k), 1, &number[k], &mean[k], &square[k]);
        __stcs(number_of(m.means, m, first + k, i), mean[k]);
        __stcs(number_of(m.squares, m, first + k, i), square[k]);
        *number_of(to, m, first + k, i) = has_limits(first + k) ? within_limits(number[k]) : number[k];
    }
}

template <int Count, class Gradient>
__device__ inline void move_parameters(const fxs_fit_adam *adam, int first, const device_model &m, float *to,
                                       uint32_t i, Gradient gradient_of)
{
    const int own = Count < AT_ONCE ? Count : AT_ONCE;
    move_some<own>(adam, first, m, to, i, gradient_of);
    if constexpr (Count > own)
        move_parameters<Count - own>(adam, first + own, m, to, i, gradient_of);
}

/* Those of a part that do not move are brought within the limits too. */
__device__ inline void limit_parameters(const device_model &m, float *to, size_t i)
{
    for (int k = 0; k < FXS_FIT_SH; k++)
        if (has_limits(k))
            to[(size_t)k * m.stride + i] = within_limits(to[(size_t)k * m.stride + i]);
}

/* By the whole block. */
template <int Degree, class Gradient>
__device__ inline void update_part(const fxs_fit_adam *adam, const device_model &m, uint32_t i, bool is_touched,
                                   Gradient *gradient)
{
    float *const to = m.masters ? m.masters : m.parameters;
    if (adam->only_touched && !__syncthreads_or(is_touched))
        return;
    if (i >= m.count)
        return;
    if (adam->only_touched && !is_touched) {
        limit_parameters(m, to, i);
        return;
    }
    if (adam->by_opacity > 0)
        add_regularisers(adam, m.parameters + i, m.stride, gradient->shape);
    move_parameters<FXS_FIT_SH>(adam, 0, m, to, i, [&](int k) { return gradient->shape[k]; });
    if constexpr (Degree > 0)
        if (!adam->without_sh)
            move_parameters<3 * SH_COUNT(Degree)>(adam, FXS_FIT_SH, m, to, i,
                                                  [&](int k) { return gradient->sh(k - FXS_FIT_SH); });
}

template <int Degree>
__global__ void __launch_bounds__(FXS_FIT_PART, 2)
    update_by_view(step_buffers b, device_model m, const __grid_constant__ fxs_fit_camera camera,
                   const __grid_constant__ fxs_fit_adam adam)
{
    __shared__ staged_sums staged;
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    float sums[FXS_FIT_SUMS];
    view_gradient<Degree> gradient;
    if (is_stopped(b.status))
        return;
    if (gather_sums(b, i, m.count, &staged, sums))
        m.views[i] += 1;
    const bool is_touched =
        find_view_gradient(&camera, m.parameters + i, m.stride, sums, &gradient, m.by_centre + i);
    update_part<Degree>(&adam, m, i, is_touched, &gradient);
}

cudaError_t launch_update(const step_buffers *b, const device_model *m, const fxs_fit_camera *camera, int degree,
                          const fxs_fit_adam *adam, cudaStream_t stream)
{
    by_degree(degree, [&](auto d) {
        constexpr int Degree = d.value;
        update_by_view<Degree><<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, *camera, *adam);
    });
    return cudaGetLastError();
}

/* ---- Batches ----------------------------------------------------------------------------------------------------- */

/* Of each view: its planes (see launch_gather). */
struct batch_views {
    uint32_t count;
    const float *planes[FXS_FIT_BATCH];
    fxs_fit_camera cameras[FXS_FIT_BATCH];
};

/* Adds the gradient by a view; returns whether there is one. */
template <int Degree>
__device__ inline bool add_view(const batch_views &views, uint32_t v, const device_model &m, size_t i,
                                batch_gradient<Degree> *total)
{
    float sums[FXS_FIT_SUMS];
    view_gradient<Degree> own;
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        sums[k] = views.planes[v][(size_t)k * m.stride + i];
    if (views.planes[v][(size_t)FXS_FIT_SUMS * m.stride + i] > 0)
        m.views[i] += 1;
    const bool is_touched =
        find_view_gradient(&views.cameras[v], m.parameters + i, m.stride, sums, &own, m.by_centre + i);
    for (int k = 0; k < FXS_FIT_SH; k++)
        total->shape[k] += own.shape[k];
    for (int k = 0; k < 3; k++) {
        total->g[v][k] = own.g[k];
        total->direction[v][k] = own.l.direction[k];
    }
    return is_touched;
}

template <int Degree>
__global__ void __launch_bounds__(FXS_FIT_PART, 2)
    update_by_batch(step_buffers b, device_model m, const __grid_constant__ batch_views views,
                    const __grid_constant__ fxs_fit_adam adam)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    batch_gradient<Degree> total;
    bool is_touched = false;
    if (is_stopped(b.status))
        return;
    memset(total.shape, 0, sizeof total.shape);
    total.views = views.count;
    for (uint32_t v = 0; v < views.count && i < m.count; v++)
        is_touched = add_view<Degree>(views, v, m, i, &total) || is_touched;
    update_part<Degree>(&adam, m, i, is_touched, &total);
}

/* By the planes of `count` views, in their order. */
cudaError_t launch_update_batch(const step_buffers *b, const device_model *m, float *const *planes,
                                const fxs_fit_camera *cameras, uint32_t count, int degree, const fxs_fit_adam *adam,
                                cudaStream_t stream)
{
    batch_views views;
    memset(&views, 0, sizeof views);
    views.count = count;
    for (uint32_t v = 0; v < count; v++) {
        views.planes[v] = planes[v];
        views.cameras[v] = cameras[v];
    }
    by_degree(degree, [&](auto d) {
        constexpr int Degree = d.value;
        update_by_batch<Degree><<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, views, *adam);
    });
    return cudaGetLastError();
}

/* ---- After the update -------------------------------------------------------------------------------------------- */

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

/* Those of a degree; all is read before the first is written. */
template <int Degree>
__device__ inline void quantise_sh(const fxs_fit_chunk *chunk, const device_model &m, uint32_t i)
{
    const int first = FXS_FIT_SH + 3 * SH_COUNT(Degree - 1), count = 6 * Degree + 3;
    real numbers[count];
    whole code;
#pragma unroll
    for (int k = 0; k < count; k++)
        numbers[k] = *number_of(m.masters, m, first + k, i);
#pragma unroll
    for (int k = 0; k < count; k++)
        *number_of(m.parameters, m, first + k, i) = quantise_band(chunk, Degree, numbers[k], &code);
}

/* grid.chunks: the device's. */
__global__ void __launch_bounds__(FXS_FIT_PART) quantise_model(step_buffers b, device_model m, fxs_fit_grid grid)
{
    const uint32_t i = blockIdx.x * FXS_FIT_PART + threadIdx.x;
    const fxs_fit_chunk *chunk = &grid.chunks[i / FXS_FIT_CHUNK];
    real from[FXS_FIT_SH], to[FXS_FIT_SH];
    whole codes[FXS_FIT_SH];
    if (i >= m.count || is_stopped(b.status))
        return;
    for (int k = 0; k < FXS_FIT_SH; k++)
        from[k] = *number_of(m.masters, m, k, i);
    quantise_shape(&grid, chunk, from, to, 1, codes);
    for (int k = 0; k < FXS_FIT_SH; k++)
        *number_of(m.parameters, m, k, i) = to[k];
    if (grid.sh_degree >= 1)
        quantise_sh<1>(chunk, m, i);
    if (grid.sh_degree >= 2)
        quantise_sh<2>(chunk, m, i);
    if (grid.sh_degree >= 3)
        quantise_sh<3>(chunk, m, i);
}

/* The parameters become what the grid makes of the masters. */
cudaError_t launch_quantise(const step_buffers *b, const device_model *m, const fxs_fit_grid *grid, cudaStream_t stream)
{
    fxs_fit_grid there = *grid;
    there.chunks = m->chunks;
    quantise_model<<<part_count(m), FXS_FIT_PART, 0, stream>>>(*b, *m, there);
    return cudaGetLastError();
}

}

#endif
