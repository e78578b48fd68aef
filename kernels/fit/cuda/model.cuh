/* The Gaussians in device memory: allocation, densification, relocation, and sorting along a Morton curve. Results
 * equal the CPU's bit by bit. If memory is short, a change leaves the Gaussians as before. */
#ifndef FXS_CUDA_FIT_MODEL_CUH
#define FXS_CUDA_FIT_MODEL_CUH

#include "src/fit/model.h"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "kernels/cuda/device.cuh"
#include "step.cuh"

namespace {
#define static static __host__ __device__
#include "src/fit/stages/curve.h"
#include "src/fit/stages/densify_one.h"
#include "src/fit/stages/relocate_one.h"
#undef static

const uint32_t MODEL_THREADS = 256;
const uint32_t SPARE = 8;

fxs_fit_model as_host(const device_model *m)
{
    fxs_fit_model out = {};
    out.count = m->count;
    out.stride = m->stride;
    out.parameters = m->parameters;
    out.means = m->means;
    out.squares = m->squares;
    out.by_centre = m->by_centre;
    out.views = m->views;
    return out;
}

dim3 blocks_for(uint32_t count, uint32_t planes = 1)
{
    return dim3((count + MODEL_THREADS - 1) / MODEL_THREADS, planes);
}

__device__ uint32_t gaussian_of_thread()
{
    return blockIdx.x * MODEL_THREADS + threadIdx.x;
}

uint64_t block_bytes(uint64_t stride)
{
    return FXS_FIT_PARAMETERS * stride * sizeof(float);
}

uint64_t chunks_bytes(uint64_t stride)
{
    return stride / FXS_FIT_CHUNK * sizeof(fxs_fit_chunk);
}

uint64_t model_bytes(uint64_t stride)
{
    return 3 * block_bytes(stride) + 2 * stride * sizeof(float);
}

void free_masters(device_model *m, budget *taken)
{
    if (!m->masters)
        return;
    cudaFree(m->masters);
    cudaFree(m->chunks);
    m->masters = nullptr;
    m->chunks = nullptr;
    taken->bytes -= block_bytes(m->stride) + chunks_bytes(m->stride);
}

void model_free(device_model *m, budget *taken)
{
    free_masters(m, taken);
    float *const all[] = {m->parameters, m->means, m->squares, m->by_centre, m->views};
    for (float *planes : all)
        cudaFree(planes);
    taken->bytes -= model_bytes(m->stride);
    *m = device_model{};
}

cudaError_t widen(float **planes, uint64_t count, uint64_t old, uint64_t stride, uint64_t used, cudaStream_t stream)
{
    float *made = nullptr;
    cudaError_t error = cudaMalloc(&made, count * stride * sizeof(float));
    if (!error && used)
        error = cudaMemcpy2DAsync(made, stride * sizeof(float), *planes, old * sizeof(float), used * sizeof(float),
                                  count, cudaMemcpyDeviceToDevice, stream);
    error = first_of(error, cudaStreamSynchronize(stream));
    if (error) {
        cudaFree(made);
        return error;
    }
    cudaFree(*planes);
    *planes = made;
    return cudaSuccess;
}

/* Undoes an enlargement of parameter arrays that share one allocation: moves each array back to the smaller stride
   `old`. Copies in pieces that do not overlap their destination. */
void narrow_again(float *planes, uint64_t count, uint64_t old, uint64_t stride, uint64_t used, cudaStream_t stream)
{
    for (uint64_t k = 1; k < count; k++)
        for (uint64_t at = 0; at < used; at += k * (stride - old)) {
            const uint64_t way = k * (stride - old), length = used - at < way ? used - at : way;
            cudaMemcpyAsync(planes + k * old + at, planes + k * stride + at, length * sizeof(float),
                            cudaMemcpyDeviceToDevice, stream);
        }
}

/* Enlarges the memory of one set of parameter arrays after another, so that at most one set exists twice at a time. */
cudaError_t widen_all(device_model *m, uint64_t stride, cudaStream_t stream)
{
    float **const all[] = {&m->by_centre, &m->views, &m->parameters, &m->means, &m->squares};
    for (int i = 0; i < 5; i++) {
        const cudaError_t error = widen(all[i], i < 2 ? 1 : FXS_FIT_PARAMETERS, m->stride, stride, m->count, stream);
        if (error) {
            while (m->stride && i--)
                narrow_again(*all[i], i < 2 ? 1 : FXS_FIT_PARAMETERS, m->stride, stride, m->count, stream);
            return error;
        }
    }
    return cudaSuccess;
}

uint64_t stride_for(const device_model *m, const budget *taken, uint64_t gaussians)
{
    const uint64_t least = (gaussians + FXS_FIT_CHUNK - 1) / FXS_FIT_CHUNK * FXS_FIT_CHUNK;
    const uint64_t wide = least + least / 8 / FXS_FIT_CHUNK * FXS_FIT_CHUNK;
    const uint64_t needed = taken->bytes - model_bytes(m->stride) + model_bytes(wide) + block_bytes(m->stride);
    return m->stride && wide < UINT32_MAX && (!taken->most || needed <= taken->most) ? wide : least;
}

/* Makes room for `gaussians` Gaussians in device memory, and waits for the stream. The Gaussians must not be
   quantised. */
int model_reserve(device_model *m, budget *taken, uint64_t gaussians, cudaStream_t stream, fxs_message *why)
{
    if (gaussians <= m->stride)
        return 0;
    const uint64_t stride = stride_for(m, taken, gaussians), before = model_bytes(m->stride);
    const uint64_t most = taken->bytes - before + model_bytes(stride) + block_bytes(m->stride);
    if (stride > UINT32_MAX / 2)
        return failed(why, FXS_ERR_MEMORY, "more Gaussians than a device takes", most);
    if (too_large(taken, most, why))
        return FXS_ERR_MEMORY;
    const int error = check(why, widen_all(m, stride, stream));
    if (error)
        return error == FXS_ERR_MEMORY ? failed(why, error, "the device is out of memory", most) : error;
    taken->bytes += model_bytes(stride) - before;
    m->stride = (uint32_t)stride;
    return 0;
}

struct plane_pair {
    float *host, *device;
    uint32_t count;
};

template <class Pairs>
int copy_planes(const fxs_fit_model *host, const device_model *m, const Pairs &pairs, bool is_upload,
                cudaStream_t stream, fxs_message *why)
{
    const size_t to_host = host->stride * sizeof(float), to_device = m->stride * sizeof(float);
    cudaError_t error = cudaSuccess;
    for (const plane_pair &p : pairs)
        if (p.host && !error && m->count)
            error = is_upload ? cudaMemcpy2DAsync(p.device, to_device, p.host, to_host, m->count * sizeof(float),
                                                  p.count, cudaMemcpyHostToDevice, stream)
                              : cudaMemcpy2DAsync(p.host, to_host, p.device, to_device, m->count * sizeof(float),
                                                  p.count, cudaMemcpyDeviceToHost, stream);
    return check(why, error, cudaStreamSynchronize(stream));
}

int copy_model(const fxs_fit_model *host, const device_model *m, bool is_upload, cudaStream_t stream, fxs_message *why)
{
    const plane_pair pairs[] = {{host->parameters, m->parameters, FXS_FIT_PARAMETERS},
                                {host->means, m->means, FXS_FIT_PARAMETERS},
                                {host->squares, m->squares, FXS_FIT_PARAMETERS},
                                {host->by_centre, m->by_centre, 1}, {host->views, m->views, 1},
                                {host->masters, m->masters, FXS_FIT_PARAMETERS}};
    return copy_planes(host, m, pairs, is_upload, stream, why);
}

int reserve_masters(device_model *m, budget *taken, fxs_message *why)
{
    const uint64_t bytes = block_bytes(m->stride) + chunks_bytes(m->stride), needed = taken->bytes + bytes;
    if (m->masters)
        return 0;
    if (too_large(taken, needed, why))
        return FXS_ERR_MEMORY;
    int error = check(why, cudaMalloc(&m->masters, block_bytes(m->stride)));
    if (!error && (error = check(why, cudaMalloc(&m->chunks, chunks_bytes(m->stride)))))
        cudaFree(m->masters);
    if (error) {
        m->masters = nullptr;
        return error == FXS_ERR_MEMORY ? failed(why, error, "the device is out of memory", needed) : error;
    }
    taken->bytes += bytes;
    return 0;
}

cudaError_t upload_chunks(const device_model *m, const fxs_fit_model *from, cudaStream_t stream)
{
    const size_t chunks = (from->count + FXS_FIT_CHUNK - 1) / FXS_FIT_CHUNK;
    return cudaMemcpyAsync(m->chunks, from->grid->chunks, chunks * sizeof *m->chunks, cudaMemcpyHostToDevice, stream);
}

int model_upload(device_model *m, const fxs_fit_model *from, budget *taken, cudaStream_t stream, fxs_message *why)
{
    if (!from->masters || from->count > m->stride)
        free_masters(m, taken);
    m->count = 0;                  /* With count 0, model_reserve drops the old contents. */
    int error = model_reserve(m, taken, from->count, stream, why);
    if (!error && from->masters)
        error = reserve_masters(m, taken, why);
    if (error)
        return error;
    m->count = (uint32_t)from->count;
    if (from->masters)
        error = check(why, upload_chunks(m, from, stream));
    return error ? error : copy_model(from, m, true, stream, why);
}

int model_download(const device_model *m, fxs_fit_model *to, cudaStream_t stream, fxs_message *why)
{
    if (fxs_fit_model_resize(to, m->count))
        return failed(why, FXS_ERR_MEMORY, "out of memory", model_bytes(m->count));
    return copy_model(to, m, false, stream, why);
}

int download_masters(const device_model *m, const fxs_fit_model *to, cudaStream_t stream, fxs_message *why)
{
    const plane_pair masters[] = {{to->masters, m->masters, FXS_FIT_PARAMETERS}};
    return copy_planes(to, m, masters, false, stream, why);
}

struct change_memory {
    budget *taken;
    block memory;
    explicit change_memory(budget *taken_) : taken(taken_), memory{nullptr, 0} {}
    ~change_memory() { reserve(taken, &memory, 0, nullptr); }
};

uint64_t sum_bytes(uint32_t count)
{
    size_t bytes = 0;
    cub::DeviceScan::InclusiveSum(nullptr, bytes, (uint64_t *)nullptr, (uint64_t *)nullptr, (int)count);
    return bytes;
}

uint64_t sort_bytes(uint32_t count)
{
    size_t bytes = 0;
    cub::DeviceRadixSort::SortPairs(nullptr, bytes, (const uint32_t *)nullptr, (uint32_t *)nullptr,
                                    (const uint32_t *)nullptr, (uint32_t *)nullptr, (int)count);
    return bytes;
}

cudaError_t sort(void *scratch, size_t bytes, uint32_t *const keys[2], uint32_t *const values[2], uint32_t count,
                 cudaStream_t stream)
{
    return cub::DeviceRadixSort::SortPairs(scratch, bytes, (const uint32_t *)keys[0], keys[1],
                                           (const uint32_t *)values[0], values[1], (int)count, 0, 32, stream);
}

/* Replaces `numbers` by their inclusive prefix sums, and sets *last to the total. Waits for the stream. */
int sum_up(uint64_t *numbers, uint32_t count, void *scratch, size_t bytes, uint64_t *last, cudaStream_t stream,
           fxs_message *why)
{
    cudaError_t error = cub::DeviceScan::InclusiveSum(scratch, bytes, numbers, numbers, (int)count, stream);
    if (!error)
        error = cudaMemcpyAsync(last, numbers + count - 1, sizeof *last, cudaMemcpyDeviceToHost, stream);
    return check(why, error, cudaStreamSynchronize(stream));
}

/* Gathers planes (one float per Gaussian): to[k][i] = from[k][sources[i]] for i < kept, else 0. blockIdx.y is the plane
   k. */
__global__ void gather_planes(const float *from, size_t stride, float *to, const uint32_t *sources, uint32_t count,
                              uint32_t kept)
{
    const uint32_t i = gaussian_of_thread();
    if (i < count)
        to[(size_t)blockIdx.y * count + i] = i < kept ? from[blockIdx.y * stride + sources[i]] : 0;
}

cudaError_t rebuild_planes(float *planes, size_t stride, const uint32_t *sources, uint32_t count, uint32_t kept,
                           float *spare, cudaStream_t stream)
{
    cudaError_t error = cudaSuccess;
    for (uint32_t k = 0; k < FXS_FIT_PARAMETERS && !error; k += SPARE) {
        const uint32_t some = FXS_FIT_PARAMETERS - k < SPARE ? FXS_FIT_PARAMETERS - k : SPARE;
        float *first = planes + k * stride;
        gather_planes<<<blocks_for(count, some), MODEL_THREADS, 0, stream>>>(first, stride, spare, sources, count,
                                                                             kept);
        error = cudaMemcpy2DAsync(first, stride * sizeof(float), spare, count * sizeof(float), count * sizeof(float),
                                  some, cudaMemcpyDeviceToDevice, stream);
    }
    return error;
}

/* Replaces the Gaussians by copies of the Gaussians sources[0..count). Only the first `kept` copies keep the moments of
   Adam. */
cudaError_t rebuild(device_model *m, const uint32_t *sources, uint32_t count, uint32_t kept, float *spare,
                    cudaStream_t stream)
{
    cudaError_t error = rebuild_planes(m->parameters, m->stride, sources, count, count, spare, stream);
    error = error ? error : rebuild_planes(m->means, m->stride, sources, count, kept, spare, stream);
    error = error ? error : rebuild_planes(m->squares, m->stride, sources, count, kept, spare, stream);
    m->count = count;
    if (!error)
        error = cudaMemsetAsync(m->by_centre, 0, count * sizeof(float), stream);
    return error ? error : cudaMemsetAsync(m->views, 0, count * sizeof(float), stream);
}

/* `staying` counts the Gaussians that are not removed, `grown` those to be cloned or split. */
struct fate_counts {
    uint32_t staying, grown;
};

__global__ void find_fates(fxs_fit_model m, fxs_fit_densify d, float least_logit, uint8_t *fates, fate_counts *counts)
{
    const uint32_t i = gaussian_of_thread();
    const uint8_t fate = i < m.count ? fate_of(&m, &d, least_logit, i) : (uint8_t)GOES;
    const int staying = __syncthreads_count(fate != GOES), grown = __syncthreads_count(fate >= CLONED);
    if (i < m.count)
        fates[i] = fate;
    if (threadIdx.x == 0) {
        atomicAdd(&counts->staying, (uint32_t)staying);
        atomicAdd(&counts->grown, (uint32_t)grown);
    }
}

__global__ void rank_wanted(fxs_fit_model m, const uint8_t *fates, uint32_t *keys, uint32_t *indices)
{
    const uint32_t i = gaussian_of_thread();
    if (i >= m.count)
        return;
    keys[i] = fates[i] >= CLONED ? 0x7fffffffu - (uint32_t)__float_as_int(mean_gradient(&m, i)) : UINT32_MAX;
    indices[i] = i;
}

__global__ void leave_out(fxs_fit_model m, fxs_fit_densify d, const uint32_t *indices, uint32_t from, uint32_t end,
                          uint8_t *fates)
{
    const uint32_t k = from + gaussian_of_thread();
    if (k < end)
        fates[indices[k]] = fate_without_room(&m, &d, indices[k]);
}

enum { IS_CLONE, IS_FIRST_CHILD, IS_SECOND_CHILD };

/* Sets a number for each Gaussian. Its upper 32 bits are 1 if the Gaussian stays; its lower 32 bits are the number of
   new Gaussians made from it. */
__global__ void count_next(const uint8_t *fates, uint32_t count, uint64_t *numbers)
{
    const uint32_t i = gaussian_of_thread();
    if (i < count)
        numbers[i] = (uint64_t)(fates[i] == STAYS || fates[i] == CLONED) << 32 |
                     (uint32_t)((fates[i] == SPLIT) + (fates[i] >= CLONED));
}

__global__ void set_sources(const uint8_t *fates, const uint64_t *sums, uint32_t count, uint32_t kept,
                            uint32_t *sources, uint8_t *kinds)
{
    const uint32_t i = gaussian_of_thread();
    if (i >= count || fates[i] == GOES)
        return;
    if (fates[i] != SPLIT)
        sources[(uint32_t)(sums[i] >> 32) - 1] = i;
    const uint32_t others = (fates[i] == SPLIT) + (fates[i] >= CLONED), end = kept + (uint32_t)sums[i];
    for (uint32_t k = end - others; k < end; k++) {
        sources[k] = i;
        kinds[k - kept] = fates[i] != SPLIT ? IS_CLONE : end - k == 2 ? IS_FIRST_CHILD : IS_SECOND_CHILD;
    }
}

__global__ void set_children(fxs_fit_model m, const uint8_t *kinds, uint32_t kept)
{
    const uint32_t i = kept + gaussian_of_thread();
    if (i < m.count && kinds[i - kept] != IS_CLONE)
        set_child(&m, i, kinds[i - kept] == IS_FIRST_CHILD ? 1.0f : -1.0f);
}

struct densify_memory {
    fate_counts *counts;
    uint64_t *sums;
    uint8_t *fates, *kinds;
    uint32_t *keys[2], *indices[2], *sources;
    float *spare;
    void *scratch;
    size_t scratch_bytes;
};

uint64_t cut_fates(densify_memory *d, void *memory, uint32_t count)
{
    unsigned char *at = (unsigned char *)memory;
    d->counts = cut<fate_counts>(&at, 1);
    d->sums = cut<uint64_t>(&at, count);
    d->fates = cut<uint8_t>(&at, count);
    for (int i = 0; i < 2; i++) {
        d->keys[i] = cut<uint32_t>(&at, count);
        d->indices[i] = cut<uint32_t>(&at, count);
    }
    d->scratch_bytes = sum_bytes(count) > sort_bytes(count) ? sum_bytes(count) : sort_bytes(count);
    d->scratch = cut<uint8_t>(&at, d->scratch_bytes);
    return (uint64_t)(at - (unsigned char *)memory);
}

uint64_t cut_next(densify_memory *d, void *memory, uint32_t next)
{
    unsigned char *at = (unsigned char *)memory;
    d->sources = cut<uint32_t>(&at, next);
    d->kinds = cut<uint8_t>(&at, next);
    d->spare = cut<float>(&at, (uint64_t)SPARE * next);
    return (uint64_t)(at - (unsigned char *)memory);
}

/* Lets only as many Gaussians be cloned or split as fit into memory: the `room` Gaussians with the largest gradients.
   Of equal gradients, the lower index wins. */
int limit(const fxs_fit_model *m, const fxs_fit_densify *how, densify_memory *d, uint32_t grown, uint32_t room,
          cudaStream_t stream, fxs_message *why)
{
    const uint32_t count = (uint32_t)m->count;
    rank_wanted<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(*m, d->fates, d->keys[0], d->indices[0]);
    const cudaError_t error = sort(d->scratch, d->scratch_bytes, d->keys, d->indices, count, stream);
    leave_out<<<blocks_for(grown - room), MODEL_THREADS, 0, stream>>>(*m, *how, d->indices[1], room, grown, d->fates);
    return check(why, error, cudaGetLastError());
}

int find_next(const fxs_fit_model *m, const fxs_fit_densify *how, densify_memory *d, uint64_t *last,
              cudaStream_t stream, fxs_message *why)
{
    const uint32_t count = (uint32_t)m->count;
    fate_counts counts = {0, 0};
    cudaError_t error = cudaMemsetAsync(d->counts, 0, sizeof *d->counts, stream);
    find_fates<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(*m, *how, logit_of(how->opacity), d->fates, d->counts);
    if (!error)
        error = cudaMemcpyAsync(&counts, d->counts, sizeof counts, cudaMemcpyDeviceToHost, stream);
    int failure = check(why, error, cudaStreamSynchronize(stream));
    const size_t room = how->most > counts.staying ? how->most - counts.staying : 0;
    if (!failure && counts.grown > room)
        failure = limit(m, how, d, counts.grown, (uint32_t)room, stream, why);
    if (failure)
        return failure;
    count_next<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(d->fates, count, d->sums);
    return sum_up(d->sums, count, d->scratch, d->scratch_bytes, last, stream, why);
}

int make_next(device_model *m, const densify_memory *d, uint32_t kept, uint32_t next,
              cudaStream_t stream, fxs_message *why)
{
    set_sources<<<blocks_for(m->count), MODEL_THREADS, 0, stream>>>(d->fates, d->sums, m->count, kept, d->sources,
                                                                    d->kinds);
    const cudaError_t error = rebuild(m, d->sources, next, kept, d->spare, stream);
    if (next > kept)
        set_children<<<blocks_for(next - kept), MODEL_THREADS, 0, stream>>>(as_host(m), d->kinds, kept);
    return check(why, first_of(error, cudaGetLastError()), cudaStreamSynchronize(stream));
}

int model_densify(device_model *m, const fxs_fit_densify *how, budget *taken, cudaStream_t stream, fxs_message *why)
{
    change_memory fates(taken), places(taken);
    densify_memory d;
    uint64_t last = 0;
    if (!m->count)
        return 0;
    const fxs_fit_model before = as_host(m);
    int error = reserve(taken, &fates.memory, cut_fates(&d, nullptr, m->count), why);
    if (error)
        return error;
    cut_fates(&d, fates.memory.data, m->count);
    error = find_next(&before, how, &d, &last, stream, why);
    const uint32_t kept = (uint32_t)(last >> 32);
    const uint64_t next = kept + (last & UINT32_MAX);
    if (error || !next)
        return error;
    error = model_reserve(m, taken, next, stream, why);
    if (!error)
        error = reserve(taken, &places.memory, cut_next(&d, nullptr, (uint32_t)next), why);
    if (error)
        return error;
    cut_next(&d, places.memory.data, (uint32_t)next);
    return make_next(m, &d, kept, (uint32_t)next, stream, why);
}

__global__ void limit_opacity(fxs_fit_model m, float most)
{
    const uint32_t i = gaussian_of_thread();
    if (i < m.count)
        plane(&m, FXS_FIT_OPACITY)[i] = fminf(plane(&m, FXS_FIT_OPACITY)[i], most);
}

int model_reset_opacity(device_model *m, float opacity, cudaStream_t stream, fxs_message *why)
{
    if (!m->count)
        return 0;
    const size_t first = (size_t)FXS_FIT_OPACITY * m->stride;
    limit_opacity<<<blocks_for(m->count), MODEL_THREADS, 0, stream>>>(as_host(m), logit_of(opacity));
    cudaError_t error = cudaMemsetAsync(m->means + first, 0, m->count * sizeof(float), stream);
    error = first_of(error, cudaMemsetAsync(m->squares + first, 0, m->count * sizeof(float), stream));
    return check(why, error, cudaGetLastError());
}

struct relocate_memory {
    uint64_t *sums, *dead;         /* `sums` holds prefix sums of the Gaussians' chances of being drawn; `dead` holds
                                      prefix sums that count the dead (faint) Gaussians. */
    uint32_t *times, *sources;     /* `times` holds how often each Gaussian is drawn, or DEAD; `sources` holds the
                                      Gaussian of each draw. */
    void *scratch;
    size_t scratch_bytes;
};

uint64_t cut_relocate(relocate_memory *d, void *memory, uint32_t count)
{
    unsigned char *at = (unsigned char *)memory;
    d->sums = cut<uint64_t>(&at, count);
    d->dead = cut<uint64_t>(&at, count);
    d->times = cut<uint32_t>(&at, count);
    d->sources = cut<uint32_t>(&at, count);
    d->scratch_bytes = sum_bytes(count);
    d->scratch = cut<uint8_t>(&at, d->scratch_bytes);
    return (uint64_t)(at - (unsigned char *)memory);
}

__global__ void find_chances(fxs_fit_model m, fxs_fit_relocate r, float least_opacity, uint64_t *chances,
                             uint64_t *dead)
{
    const uint32_t i = gaussian_of_thread();
    if (i >= m.count)
        return;
    chances[i] = chance_of(&m, least_opacity, i);
    if (dead)
        dead[i] = (uint64_t)is_dead(&m, &r, i);
}

__global__ void draw(fxs_fit_relocate r, uint64_t stream, const uint64_t *sums, uint32_t count, uint32_t draws,
                     uint32_t *sources, uint32_t *times)
{
    const uint32_t k = gaussian_of_thread();
    if (k >= draws)
        return;
    sources[k] = drawn(&r, stream, k, sums, count);
    atomicAdd(&times[sources[k]], 1u);
}

__global__ void mark_dead(fxs_fit_model m, fxs_fit_relocate r, uint32_t *times)
{
    const uint32_t i = gaussian_of_thread();
    if (i < m.count && is_dead(&m, &r, i))
        times[i] = DEAD;
}

__global__ void share_places(fxs_fit_model m, const uint32_t *times)
{
    const uint32_t i = gaussian_of_thread();
    if (i >= m.count || !times[i] || times[i] == DEAD)
        return;
    share(&m, i, times[i]);
    forget(&m, i);
}

/* Replaces each dead (faint) Gaussian by a copy of the Gaussian that was drawn at random for it. */
__global__ void move_planes(fxs_fit_model m, const uint64_t *dead, const uint32_t *times, const uint32_t *sources)
{
    const uint32_t i = gaussian_of_thread();
    if (i >= m.count || times[i] != DEAD)
        return;
    const size_t at = blockIdx.y * m.stride;
    m.parameters[at + i] = m.parameters[at + sources[dead[i] - 1]];
    m.means[at + i] = m.squares[at + i] = 0;
}

__global__ void add_planes(fxs_fit_model m, const uint32_t *sources, uint32_t added)
{
    const uint32_t k = gaussian_of_thread();
    if (k >= added)
        return;
    const size_t at = blockIdx.y * m.stride, to = at + m.count + k;
    m.parameters[to] = m.parameters[at + sources[k]];
    m.means[to] = m.squares[to] = 0;
}

cudaError_t start_draws(const fxs_fit_model *m, const fxs_fit_relocate *how, uint64_t number, uint32_t draws,
                        const relocate_memory *d, cudaStream_t stream)
{
    const uint32_t count = (uint32_t)m->count;
    const cudaError_t error = cudaMemsetAsync(d->times, 0, count * sizeof *d->times, stream);
    draw<<<blocks_for(draws), MODEL_THREADS, 0, stream>>>(*how, number, d->sums, count, draws, d->sources, d->times);
    if (number == 0)
        mark_dead<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(*m, *how, d->times);
    share_places<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(*m, d->times);
    return error;
}

int move_dead(const fxs_fit_model *m, const fxs_fit_relocate *how, const relocate_memory *d, cudaStream_t stream,
              fxs_message *why)
{
    const uint32_t count = (uint32_t)m->count;
    uint64_t dead = 0, all = 0;
    find_chances<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(*m, *how, how->opacity, d->sums, d->dead);
    int error = sum_up(d->dead, count, d->scratch, d->scratch_bytes, &dead, stream, why);
    error = error || !dead ? error : sum_up(d->sums, count, d->scratch, d->scratch_bytes, &all, stream, why);
    if (error || !all)
        return error;
    const cudaError_t failure = start_draws(m, how, 0, (uint32_t)dead, d, stream);
    move_planes<<<blocks_for(count, FXS_FIT_PARAMETERS), MODEL_THREADS, 0, stream>>>(*m, d->dead, d->times, d->sources);
    return check(why, failure, cudaGetLastError());
}

int add(device_model *m, const fxs_fit_relocate *how, uint32_t next, const relocate_memory *d, cudaStream_t stream,
        fxs_message *why)
{
    const fxs_fit_model before = as_host(m);
    const uint32_t count = m->count, added = next - count;
    uint64_t all = 0;
    find_chances<<<blocks_for(count), MODEL_THREADS, 0, stream>>>(before, *how, 0, d->sums, nullptr);
    const int error = sum_up(d->sums, count, d->scratch, d->scratch_bytes, &all, stream, why);
    if (error || !all)
        return error;
    cudaError_t failure = start_draws(&before, how, 1, added, d, stream);
    add_planes<<<blocks_for(added, FXS_FIT_PARAMETERS), MODEL_THREADS, 0, stream>>>(before, d->sources, added);
    m->count = next;
    failure = first_of(failure, cudaMemsetAsync(m->by_centre, 0, next * sizeof(float), stream));
    failure = first_of(failure, cudaMemsetAsync(m->views, 0, next * sizeof(float), stream));
    return check(why, first_of(failure, cudaGetLastError()), cudaStreamSynchronize(stream));
}

int model_relocate(device_model *m, const fxs_fit_relocate *how, budget *taken, cudaStream_t stream, fxs_message *why)
{
    change_memory of(taken);
    relocate_memory d;
    if (!m->count)
        return 0;
    const size_t more = (size_t)m->count + m->count / 20, next = more < how->most ? more : how->most;
    int error = next > m->count ? model_reserve(m, taken, next, stream, why) : 0;
    if (!error)
        error = reserve(taken, &of.memory, cut_relocate(&d, nullptr, m->count), why);
    if (error)
        return error;
    cut_relocate(&d, of.memory.data, m->count);
    const fxs_fit_model now = as_host(m);
    error = move_dead(&now, how, &d, stream, why);
    if (!error && next > m->count)
        error = add(m, how, (uint32_t)next, &d, stream, why);
    return error ? error : check(why, cudaStreamSynchronize(stream));
}

struct order_state {
    curve of;
    double sums[3];
};

__global__ void __launch_bounds__(CURVE_SUMS) sum_planes(fxs_fit_model m, order_state *state, int is_spread)
{
    __shared__ double sums[CURVE_SUMS];
    const float *numbers = plane(&m, FXS_FIT_POSITION + (int)blockIdx.x), middle = state->of.middle[blockIdx.x];
    double sum = 0;
    for (size_t i = threadIdx.x; i < m.count; i += CURVE_SUMS)
        sum += curve_term(numbers[i], is_spread ? &middle : nullptr);
    sums[threadIdx.x] = sum;
    __syncthreads();
    if (threadIdx.x)
        return;
    sum = curve_sum(sums);
    state->sums[blockIdx.x] = sum;
    if (!is_spread)
        state->of.middle[blockIdx.x] = curve_middle(sum, m.count);
}

__global__ void find_codes(fxs_fit_model m, const order_state *state, uint32_t *codes, uint32_t *indices)
{
    const uint32_t i = gaussian_of_thread();
    if (i >= m.count)
        return;
    curve of = state->of;
    of.spread = curve_spread(state->sums, m.count);
    codes[i] = code_of(&m, &of, i);
    indices[i] = i;
}

struct order_memory {
    order_state *state;
    uint32_t *codes[2], *indices[2];
    float *spare;
    void *scratch;
    size_t scratch_bytes;
};

uint64_t cut_order(order_memory *d, void *memory, uint32_t count)
{
    unsigned char *at = (unsigned char *)memory;
    d->state = cut<order_state>(&at, 1);
    for (int i = 0; i < 2; i++) {
        d->codes[i] = cut<uint32_t>(&at, count);
        d->indices[i] = cut<uint32_t>(&at, count);
    }
    d->spare = cut<float>(&at, (uint64_t)SPARE * count);
    d->scratch_bytes = sort_bytes(count);
    d->scratch = cut<uint8_t>(&at, d->scratch_bytes);
    return (uint64_t)(at - (unsigned char *)memory);
}

int model_order(device_model *m, budget *taken, cudaStream_t stream, fxs_message *why)
{
    change_memory of(taken);
    order_memory d;
    if (!m->count)
        return 0;
    const fxs_fit_model now = as_host(m);
    const int failure = reserve(taken, &of.memory, cut_order(&d, nullptr, m->count), why);
    if (failure)
        return failure;
    cut_order(&d, of.memory.data, m->count);
    sum_planes<<<3, CURVE_SUMS, 0, stream>>>(now, d.state, 0);
    sum_planes<<<3, CURVE_SUMS, 0, stream>>>(now, d.state, 1);
    find_codes<<<blocks_for(m->count), MODEL_THREADS, 0, stream>>>(now, d.state, d.codes[0], d.indices[0]);
    cudaError_t error = sort(d.scratch, d.scratch_bytes, d.codes, d.indices, m->count, stream);
    error = error ? error : rebuild(m, d.indices[1], m->count, m->count, d.spare, stream);
    return check(why, first_of(error, cudaGetLastError()), cudaStreamSynchronize(stream));
}

}

#endif
