/* Gives tests access to internal buffers of the CUDA back end, by including its source file. */
#include <stdlib.h>

#include "kernels/cuda/cuda.cu"
#include "peek.h"

namespace {

template <class T, class U>
int download(U **out, const T *from, uint64_t count)
{
    *out = (U *)malloc(count * sizeof(T) + 1);
    return !*out || cudaMemcpy(*out, from, count * sizeof(T), cudaMemcpyDefault) != cudaSuccess;
}

}

int peek(fxs_cuda *cuda, peeked *out)
{
    const frame_buffers *f = &cuda->buffers[0];
    const frame *of = &cuda->frames[0];
    const frame_needs *n = &last_call(cuda)->needs[0];
    tile_list *lists = nullptr;
    int error = download(&out->splats, f->splats, (uint64_t)of->chunks * FXS_CHUNK) ||
                download(&lists, f->lists, (uint64_t)f->list_step * of->tiles) ||
                (n->entries <= f->capacity && n->larges <= f->large_capacity &&
                 download(&out->entries, f->entries, n->entries));
    out->counts = (uint32_t *)malloc(of->tiles * sizeof *out->counts);
    out->ends = (uint32_t *)malloc(of->tiles * sizeof *out->ends);
    error = error || !out->counts || !out->ends;
    for (uint32_t tile = 0; tile < of->tiles && !error; tile++) {
        out->counts[tile] = lists[f->list_step * tile].count;
        out->ends[tile] = lists[f->list_step * tile].next;
    }
    free(lists);
    return error;
}

int peek_cut(fxs_cuda *cuda, void **drawn, uint32_t *count, int *by_device)
{
    const frame_buffers *f = &cuda->buffers[0];
    uint32_t *found = nullptr;
    *by_device = f->drawn_count != nullptr;
    int error = *by_device && download(&found, f->drawn_count, 1);
    *count = error ? 0 : found ? *found : cuda->frames[0].chunks;
    free(found);
    return error || download(drawn, f->drawn, *count);
}

const uint32_t *peek_places(const fxs_cuda *cuda, const fxs_scene *scene)
{
    const scene_copy *copy = find_scene(&cuda->scenes, scene);
    return copy ? copy->mirror->scene.places : nullptr;
}

int peek_is_sorted(uint32_t count)
{
    return !(count >> LONG_MAGNITUDE);
}

void peek_free(peeked *p)
{
    free(p->splats);
    free(p->counts);
    free(p->ends);
    free(p->entries);
}

namespace {

const uint32_t STEPS_OF_COORDINATES = 80001;

__global__ void compare_levels(unsigned long long *wrong)
{
    /* Coordinate u in Q13: every value up to +-4, then every 144th value up to +-128, where coordinates wrap. */
    const int step = (int)(blockIdx.x % STEPS_OF_COORDINATES) - 40000, beyond = max(abs(step) - 33000, 0);
    const int u = step + (step < 0 ? -beyond : beyond) * 144;
    const int offset = (int)(threadIdx.x + blockIdx.x / STEPS_OF_COORDINATES * blockDim.x);
    if (offset > FXS_FAINT_Q11)
        return;
    const uint32_t u_q24 = (uint32_t)u << 11 | (uint32_t)(offset * 37 & 2047);
    for (int swap = 0; swap < 2; swap++) {
        const float row = row_level(swap ? u_q24 : 0, offset), coordinate = coordinate_q6(swap ? 0 : u_q24);
        const int level = __float_as_int(__fmaf_rd(coordinate, coordinate, row));
        const int limit = LEVEL_ONE + 2 * fxs_limit_q11(offset, FXS_CUT_Q11) + 1;
        const int row_wanted = fxs_row_level_q11(swap ? fxs_coordinate_q13((int)u_q24) : 0, offset);
        const int wanted = fxs_level_q11(swap ? 0 : fxs_coordinate_q13((int)u_q24), row_wanted);
        const bool passes = level <= limit;
        if (passes != (wanted <= fxs_limit_q11(offset, FXS_CUT_Q11)) || (passes && (level & 0xffff) >> 1 != wanted))
            atomicAdd(wrong, 1ull);
    }
}

}

long peek_levels(void)
{
    unsigned long long *wrong, count = 1;
    if (cudaMalloc(&wrong, sizeof *wrong) || cudaMemset(wrong, 0, sizeof *wrong))
        return -1;
    start(compare_levels, STEPS_OF_COORDINATES * ((FXS_FAINT_Q11 + 256) / 256), 256, 0, nullptr, wrong);
    const cudaError_t error = cudaMemcpy(&count, wrong, sizeof count, cudaMemcpyDeviceToHost);
    cudaFree(wrong);
    return error ? -1 : (long)count;
}

int peek_fit_blocks(fxs_cuda *cuda, size_t shared_most, fxs_message *why)
{
    return fit_blocks(cuda, shared_most, why);
}

void peek_limit_room(fxs_cuda *cuda, uint64_t entries, uint64_t split, uint32_t larges)
{
    cuda->larges_most = larges;
    cuda->entries_most = entries;
    cuda->split_most = split;
}

void *peek_device_memory(size_t bytes)
{
    void *memory;
    return cudaMalloc(&memory, bytes) ? 0 : memory;
}

void peek_device_free(void *memory)
{
    cudaFree(memory);
}

void *peek_pinned_memory(size_t bytes)
{
    void *memory;
    return cudaHostAlloc(&memory, bytes, cudaHostAllocDefault) ? 0 : memory;
}

void peek_pinned_free(void *memory)
{
    cudaFreeHost(memory);
}

void *peek_stream(void)
{
    cudaStream_t stream;
    return cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking) ? 0 : (void *)stream;
}

void peek_stream_free(void *stream)
{
    cudaStreamDestroy((cudaStream_t)stream);
}

int peek_copy(void *to, const void *from, size_t bytes)
{
    return cudaMemcpy(to, from, bytes, cudaMemcpyDefault) != cudaSuccess;
}

int peek_copy_after(void *to, const void *from, size_t bytes)
{
    return cudaMemcpyAsync(to, from, bytes, cudaMemcpyDefault, nullptr) != cudaSuccess;
}

float peek_time(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                fxs_message *why)
{
    cudaEvent_t start, end;
    float milliseconds = -1;
    cudaEventCreate(&start);
    cudaEventCreate(&end);
    cudaEventRecord(start, 0);
    int error = fxs_cuda_render(cuda, frames, count, options, 0, why);
    cudaEventRecord(end, 0);
    error = error ? error : fxs_cuda_finish(cuda, 0, why);
    if (!error && !cudaEventSynchronize(end))
        cudaEventElapsedTime(&milliseconds, start, end);
    cudaEventDestroy(start);
    cudaEventDestroy(end);
    return milliseconds;
}
