/* The host's side: device memory, and the kernels of a frame in order. */
#include <cuda_runtime.h>

#include "blend.cuh"
#include "cuda.h"
#include "dense.cuh"
#include "lists.cuh"

namespace {

const uint32_t SLOTS = 16;
const uint32_t DENSE_MAGNITUDE = 11;
const uint64_t ENTRIES_MAX = 0xffffffffu;  /* `next` counts in 32 bits */

struct block {                     /* of device memory */
    void *data;
    uint64_t bytes;
};

/* What a frame needs while it is under way. */
struct slot {
    cudaStream_t stream, side;     /* side: of blend_dense */
    cudaEvent_t done, listed, dense_done, stages[FXS_CUDA_STAGES + 1];
    block splats, larges, tiles, entries;   /* cut up by slot_buffers */
};

}

struct fxs_cuda {                  /* in pinned host memory, for the sake of `status` */
    int device, timed;
    int dense;                     /* blend_dense is used */
    uint32_t processors, groups, slot_count;   /* groups: of a block of blend_tiles */
    uint64_t max_memory, bytes;    /* allowed, and taken */
    fxs_scene scene;               /* its pointers are the device's; rows null: none */
    block scene_data, pixels;
    slot slots[SLOTS];
    cudaEvent_t ready;
    uint64_t capacity, large_capacity;      /* of a slot's entries and large splats, from its next frame on */

    fxs_options options;           /* of the frames under way */
    fxs_cuda_frame frames[FXS_CUDA_BATCH];
    frame_buffers buffers[FXS_CUDA_BATCH];
    frame_status status[FXS_CUDA_BATCH];
    uint32_t frame_count;
};

namespace {

int failed(fxs_cuda_failure *failure, int error, const char *text, uint64_t bytes_needed = 0)
{
    if (failure)
        *failure = {text, bytes_needed};
    return error;
}

const char *words(cudaError_t error)
{
    int driver = 0;
    if (error == cudaErrorNoDevice)
        return "no NVIDIA GPU was found";
    if (error == cudaErrorInsufficientDriver && !cudaDriverGetVersion(&driver) && !driver)
        return "no NVIDIA driver or GPU was found";
    return cudaGetErrorString(error);
}

/* The first of two errors of the runtime, as one of ours. */
int check(fxs_cuda_failure *failure, cudaError_t error, cudaError_t second = cudaSuccess)
{
    error = error ? error : second;
    if (!error)
        return 0;
    cudaGetLastError();            /* forgotten, for the sake of other users */
    return failed(failure, error == cudaErrorMemoryAllocation ? FXS_ERR_MEMORY : FXS_ERR_DEVICE, words(error));
}

/* As long as it lives, the renderer's device is the thread's. */
struct on_device {
    int device, before = 0;
    explicit on_device(int device_) : device(device_)
    {
        cudaGetDevice(&before);
        if (before != device)
            cudaSetDevice(device);
    }
    ~on_device()
    {
        if (before != device && cudaSetDevice(before))
            cudaGetLastError();
    }
};

/* Makes a block of at least `bytes` bytes, contents undefined; 0 gives it back. Frames that use the old one are waited
   for, by cudaFree. */
int reserve(fxs_cuda *cuda, block *b, uint64_t bytes, fxs_cuda_failure *failure)
{
    if (bytes && bytes <= b->bytes)
        return 0;
    cudaFree(b->data);
    cuda->bytes -= b->bytes;
    *b = {0, 0};
    if (!bytes)
        return 0;
    const uint64_t needed = cuda->bytes + bytes;
    if (cuda->max_memory && needed > cuda->max_memory)
        return failed(failure, FXS_ERR_MEMORY, "the device memory allowed is too small", needed);
    const int error = check(failure, cudaMalloc(&b->data, bytes));
    if (error)
        return error == FXS_ERR_MEMORY ? failed(failure, error, "the device is out of memory", needed) : error;
    b->bytes = bytes;
    cuda->bytes += bytes;
    return 0;
}

template <class T>
T *cut(unsigned char **memory, uint64_t count)
{
    T *part = (T *)*memory;
    *memory += (count * sizeof(T) + 63) / 64 * 64;
    return part;
}

/* Cuts up a slot's memory for a scene and a picture; returns what it takes of each block. Blocks may be null. */
frame_buffers slot_buffers(const slot *s, uint32_t chunks, uint32_t tiles, uint64_t *splat_bytes, uint64_t *tile_bytes)
{
    frame_buffers f;
    unsigned char *splats = (unsigned char *)s->splats.data, *of_tiles = (unsigned char *)s->tiles.data;
    const uint64_t gaussians = (uint64_t)chunks * FXS_CHUNK;
    f.chunk_views = cut<fxs_chunk_view>(&splats, chunks);
    f.splats = cut<fxs_splat>(&splats, gaussians);
    f.split_entries = f.boxes = cut<uint64_t>(&splats, gaussians);
    f.depths = cut<uint32_t>(&splats, gaussians);
    f.split_capacity = (uint64_t)(splats - (unsigned char *)f.boxes) / sizeof *f.split_entries;
    f.status = cut<frame_status>(&of_tiles, 1);
    f.counts = cut<uint32_t>(&of_tiles, tiles);
    f.next = cut<uint32_t>(&of_tiles, tiles);
    f.classes = cut<uint32_t>(&of_tiles, 32 * (uint64_t)tiles);
    f.entries = (uint64_t *)s->entries.data;
    f.capacity = s->entries.bytes / sizeof *f.entries;
    f.larges = (large_splat *)s->larges.data;
    f.large_capacity = (uint32_t)(s->larges.bytes / sizeof *f.larges);
    *splat_bytes = (uint64_t)(splats - (unsigned char *)s->splats.data);
    *tile_bytes = (uint64_t)(of_tiles - (unsigned char *)s->tiles.data);
    return f;
}

/* What a slot takes for a scene, but for the tiles. */
uint64_t slot_bytes(const fxs_cuda *cuda, uint32_t chunks)
{
    const slot none = {};
    uint64_t splat_bytes, tile_bytes;
    slot_buffers(&none, chunks, 0, &splat_bytes, &tile_bytes);
    return splat_bytes + cuda->large_capacity * sizeof(large_splat) + cuda->capacity * sizeof(uint64_t);
}

int prepare_slot(fxs_cuda *cuda, slot *s, uint32_t tiles, frame_buffers *buffers, fxs_cuda_failure *failure)
{
    uint64_t splat_bytes, tile_bytes;
    slot_buffers(s, cuda->scene.chunk_count, tiles, &splat_bytes, &tile_bytes);
    int error = reserve(cuda, &s->splats, splat_bytes, failure);
    error = error ? error : reserve(cuda, &s->tiles, tile_bytes, failure);
    error = error ? error : reserve(cuda, &s->larges, cuda->large_capacity * sizeof(large_splat), failure);
    error = error ? error : reserve(cuda, &s->entries, cuda->capacity * sizeof(uint64_t), failure);
    if (!error)
        *buffers = slot_buffers(s, cuda->scene.chunk_count, tiles, &splat_bytes, &tile_bytes);
    return error;
}

uint64_t larger_of(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

target target_of(const fxs_cuda_frame *frame, const fxs_options *options)
{
    target t = {(unsigned char *)frame->pixels, frame->stride, {0, 0, 0}, options->format};
    for (int c = 0; c < 3 && options->format != FXS_FORMAT_RGBA8_COVERAGE; c++)
        t.background_q13[c] = (options->background[c] * 8192 + 127) / 255;
    return t;
}

void mark(const fxs_cuda *cuda, const slot *s, int stage)
{
    if (cuda->timed)
        cudaEventRecord(s->stages[stage], s->stream);
}

/* The kernels of frame i, in its slot. */
int start_frame(fxs_cuda *cuda, uint32_t i, fxs_cuda_failure *failure)
{
    slot *s = &cuda->slots[i % cuda->slot_count];
    const uint32_t chunks = cuda->scene.chunk_count;
    fxs_view view;
    frame_buffers f;
    int error = fxs_view_init(&view, &cuda->scene, &cuda->frames[i].camera, &cuda->options);
    if (error)
        return failed(failure, error, "the camera is out of range");
    const uint32_t tiles = (uint32_t)(view.tiles_x * view.tiles_y);
    error = prepare_slot(cuda, s, tiles, &f, failure);
    if (error)
        return error;
    f.dense_magnitude = cuda->dense ? DENSE_MAGNITUDE : WARP;   /* WARP: none */
    const uint64_t cleared = (uint64_t)((unsigned char *)(f.counts + tiles) - (unsigned char *)f.status);
    cudaMemsetAsync(f.status, 0, cleared, s->stream);
    mark(cuda, s, 0);
    if (chunks) {
        place_chunks<<<(chunks + 63) / 64, 64, 0, s->stream>>>(view, cuda->scene, f);
        project_chunk<<<chunks, FXS_CHUNK, 0, s->stream>>>(view, cuda->scene, f);
    }
    mark(cuda, s, 1);
    place_lists<<<(uint32_t)view.tiles_y, WARP, 0, s->stream>>>(f, (uint32_t)view.tiles_x, tiles);
    if (chunks)
        fill_lists<<<LARGE_BLOCKS + chunks, FXS_CHUNK, 0, s->stream>>>(view, cuda->scene, f);
    mark(cuda, s, 2);
    const target t = target_of(&cuda->frames[i], &cuda->options);
    if (cuda->dense) {
        cudaEventRecord(s->listed, s->stream);
        cudaStreamWaitEvent(s->side, s->listed, 0);
        blend_dense<<<cuda->processors * DENSE_BLOCKS, DENSE_THREADS, sizeof(dense_shared), s->side>>>(view, f, t);
        cudaEventRecord(s->dense_done, s->side);
    }
    blend_tiles<<<cuda->processors, cuda->groups * GROUP_THREADS, blend_bytes(cuda->groups), s->stream>>>(view, f, t);
    if (cuda->dense)
        cudaStreamWaitEvent(s->stream, s->dense_done, 0);
    mark(cuda, s, 3);
    cuda->buffers[i] = f;
    return check(failure, cudaMemcpyAsync(&cuda->status[i], f.status, sizeof *f.status, cudaMemcpyDeviceToHost,
                                          s->stream), cudaGetLastError());
}

int wait(fxs_cuda *cuda, fxs_cuda_failure *failure)
{
    for (uint32_t i = 0; i < cuda->slot_count; i++) {
        const int error = check(failure, cudaStreamSynchronize(cuda->slots[i].stream));
        if (error)
            return error;
    }
    return 0;
}

/* After `error` or the last frame: none is under way any more. Returns `error`. */
int end_frames(fxs_cuda *cuda, int error)
{
    if (error)
        wait(cuda, 0);
    cuda->frame_count = 0;
    return error;
}

int frame_valid(const fxs_cuda_frame *frame, const fxs_options *options)
{
    const uintptr_t pixel_bytes = (uintptr_t)fxs_pixel_bytes(options);
    return frame->pixels && ((uintptr_t)frame->pixels | (uintptr_t)frame->stride) % pixel_bytes == 0 &&
           fxs_stride_valid(&frame->camera, options, frame->stride);
}

int frame_fitted(const fxs_cuda *cuda, uint32_t i)
{
    const frame_status *needed = &cuda->status[i];
    const frame_buffers *had = &cuda->buffers[i];
    return needed->entries <= had->capacity && needed->larges <= had->large_capacity;
}

/* Renders frame i in as much memory as it needed, with some to spare where there is as much. */
int render_again(fxs_cuda *cuda, uint32_t i, fxs_cuda_failure *failure)
{
    const uint64_t capacity = cuda->capacity, large_capacity = cuda->large_capacity;
    const uint64_t entries = cuda->status[i].entries, larges = cuda->status[i].larges;
    if (entries > ENTRIES_MAX)
        return failed(failure, FXS_ERR_MEMORY, "a frame has more than 2^32 tile list entries",
                      entries * sizeof(uint64_t));
    int error = FXS_ERR_MEMORY;
    for (int spare = 1; spare >= 0 && error == FXS_ERR_MEMORY; spare--) {
        cuda->capacity = larger_of(capacity, entries + (spare ? entries / 8 : 0));
        cuda->capacity = cuda->capacity < ENTRIES_MAX ? cuda->capacity : ENTRIES_MAX;
        cuda->large_capacity = larger_of(large_capacity, larges + (spare ? larges / 8 : 0));
        error = start_frame(cuda, i, failure);
    }
    error = error ? error : wait(cuda, failure);
    if (!error && !frame_fitted(cuda, i))
        error = failed(failure, FXS_ERR_MEMORY, "a frame does not fit in 32-bit counts");
    if (error) {                   /* the next frame may be smaller */
        cuda->capacity = capacity;
        cuda->large_capacity = large_capacity;
    }
    return error;
}

int options_valid(const fxs_options *o)
{
    return o->sh_degree >= 0 && o->sh_degree <= 3 && (unsigned)o->cutoff <= FXS_CUTOFF_SQUARE &&
           (unsigned)o->format <= FXS_FORMAT_RGB565;
}

int slot_init(slot *s, fxs_cuda_failure *failure)
{
    cudaError_t error = cudaStreamCreateWithFlags(&s->stream, cudaStreamNonBlocking);
    error = error ? error : cudaStreamCreateWithFlags(&s->side, cudaStreamNonBlocking);
    cudaEvent_t *const events[] = {&s->done, &s->listed, &s->dense_done};
    for (int i = 0; i < 3 && !error; i++)
        error = cudaEventCreateWithFlags(events[i], cudaEventDisableTiming);
    for (int i = 0; i <= FXS_CUDA_STAGES && !error; i++)
        error = cudaEventCreate(&s->stages[i]);
    return check(failure, error);
}

void free_blocks(fxs_cuda *cuda, slot *s)
{
    reserve(cuda, &s->splats, 0, 0);
    reserve(cuda, &s->larges, 0, 0);
    reserve(cuda, &s->tiles, 0, 0);
    reserve(cuda, &s->entries, 0, 0);
}

void slot_free(fxs_cuda *cuda, slot *s)
{
    free_blocks(cuda, s);
    if (s->stream)
        cudaStreamDestroy(s->stream);
    if (s->side)
        cudaStreamDestroy(s->side);
    const cudaEvent_t events[] = {s->done, s->listed, s->dense_done};
    for (cudaEvent_t event : events)
        if (event)
            cudaEventDestroy(event);
    for (int i = 0; i <= FXS_CUDA_STAGES; i++)
        if (s->stages[i])
            cudaEventDestroy(s->stages[i]);
}

/* Fits the blocks to the shared memory that one can have: 227 KiB on an H100 or H200, 163 on an A100, 99 on others,
   where blend_tiles takes all lists. */
int fit_blocks(fxs_cuda *cuda, size_t shared_most, fxs_cuda_failure *failure)
{
    const cudaFuncAttribute size = cudaFuncAttributeMaxDynamicSharedMemorySize;
    if (shared_most < blend_bytes(1))
        return failed(failure, FXS_ERR_UNSUPPORTED, "the device has too little shared memory");
    cuda->groups = (uint32_t)((shared_most - blend_bytes(1)) / sizeof(group_shared)) + 1;
    cuda->groups = cuda->groups < GROUPS_MOST ? cuda->groups : GROUPS_MOST;
    cuda->dense = sizeof(dense_shared) <= shared_most;
    int error = check(failure, cudaFuncSetAttribute(blend_tiles, size, (int)blend_bytes(cuda->groups)));
    if (!error && cuda->dense)
        error = check(failure, cudaFuncSetAttribute(blend_dense, size, (int)sizeof(dense_shared)));
    return error;
}

int renderer_init(fxs_cuda *cuda, fxs_cuda_failure *failure)
{
    int processors = 0, shared_most = 0;
    int error = check(failure, cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, cuda->device),
                      cudaDeviceGetAttribute(&shared_most, cudaDevAttrMaxSharedMemoryPerBlockOptin, cuda->device));
    error = error ? error : fit_blocks(cuda, (size_t)shared_most, failure);
    error = error ? error : check(failure, cudaEventCreateWithFlags(&cuda->ready, cudaEventDisableTiming));
    for (uint32_t i = 0; i < cuda->slot_count && !error; i++)
        error = slot_init(&cuda->slots[i], failure);
    cuda->processors = (uint32_t)processors;
    return error;
}

fxs_cuda_memory memory_of(const fxs_cuda *cuda)
{
    fxs_cuda_memory m = {cuda->scene_data.bytes, 0, 0, 0, cuda->pixels.bytes, cuda->bytes};
    for (uint32_t i = 0; i < cuda->slot_count; i++) {
        m.splats += cuda->slots[i].splats.bytes + cuda->slots[i].larges.bytes;
        m.tiles += cuda->slots[i].tiles.bytes;
        m.entries += cuda->slots[i].entries.bytes;
    }
    return m;
}

void stats_of(const fxs_cuda *cuda, fxs_cuda_stats *stats)
{
    const frame_status *last = &cuda->status[cuda->frame_count - 1];
    const slot *s = &cuda->slots[(cuda->frame_count - 1) % cuda->slot_count];
    *stats = {last->visible, last->entries, {0}, memory_of(cuda)};
    for (int i = 0; i < FXS_CUDA_STAGES && cuda->timed; i++)
        cudaEventElapsedTime(&stats->milliseconds[i], s->stages[i], s->stages[i + 1]);
}

}

int fxs_cuda_devices(void)
{
    int count = 0;
    return check(0, cudaGetDeviceCount(&count)) ? 0 : count;
}

int fxs_cuda_name(int device, char *name, size_t size, fxs_cuda_failure *failure)
{
    cudaDeviceProp properties;
    int count = 0, error = check(failure, cudaGetDeviceCount(&count));
    if (!error && (device < 0 || device >= count))
        return failed(failure, FXS_ERR_DEVICE, "no such CUDA device");
    error = error ? error : check(failure, cudaGetDeviceProperties(&properties, device));
    if (error || !size)
        return error;
    const size_t length = strlen(properties.name), kept = length < size ? length : size - 1;
    memcpy(name, properties.name, kept);
    name[kept] = 0;
    return 0;
}

int fxs_cuda_create(fxs_cuda **out, int device, uint64_t max_memory, uint32_t slots, fxs_cuda_failure *failure)
{
    char name[1];
    void *memory;
    if (!out || slots < 1 || slots > SLOTS)
        return failed(failure, FXS_ERR_ARGUMENT, "slots: expected 1 to 16");
    int error = fxs_cuda_name(device, name, sizeof name, failure);
    if (error)
        return error;
    on_device scope(device);
    error = check(failure, cudaHostAlloc(&memory, sizeof(fxs_cuda), cudaHostAllocDefault));
    if (error)
        return error;
    fxs_cuda *cuda = (fxs_cuda *)memset(memory, 0, sizeof(fxs_cuda));
    cuda->device = device;
    cuda->max_memory = max_memory;
    cuda->slot_count = slots;
    error = renderer_init(cuda, failure);
    if (error)
        fxs_cuda_destroy(cuda);
    else
        *out = cuda;
    return error;
}

void fxs_cuda_destroy(fxs_cuda *cuda)
{
    if (!cuda)
        return;
    on_device scope(cuda->device);
    wait(cuda, 0);
    for (uint32_t i = 0; i < cuda->slot_count; i++)
        slot_free(cuda, &cuda->slots[i]);
    reserve(cuda, &cuda->scene_data, 0, 0);
    reserve(cuda, &cuda->pixels, 0, 0);
    if (cuda->ready)
        cudaEventDestroy(cuda->ready);
    cudaFreeHost(cuda);
}

int fxs_cuda_upload(fxs_cuda *cuda, const fxs_scene *scene, fxs_cuda_failure *failure)
{
    if (!cuda || !scene)
        return failed(failure, FXS_ERR_ARGUMENT, "an argument is null");
    on_device scope(cuda->device);
    const unsigned char *start = scene->chunks;
    const uint64_t bytes = (uint64_t)(scene->rows - start) + (uint64_t)scene->chunk_count * scene->chunk_bytes;
    cuda->scene = {};
    reserve(cuda, &cuda->scene_data, 0, 0);
    for (uint32_t i = 0; i < cuda->slot_count; i++)
        free_blocks(cuda, &cuda->slots[i]);
    cuda->capacity = 2 * (uint64_t)scene->count + 65536;
    cuda->large_capacity = scene->count / 16 + 4096;
    const uint64_t needed = cuda->bytes + bytes + cuda->slot_count * slot_bytes(cuda, scene->chunk_count);
    if (cuda->max_memory && needed > cuda->max_memory)
        return failed(failure, FXS_ERR_MEMORY, "the device memory allowed is too small", needed);
    const cudaStream_t stream = cuda->slots[0].stream;
    int error = reserve(cuda, &cuda->scene_data, bytes + !bytes, failure);
    error = error ? error : check(failure, cudaMemcpyAsync(cuda->scene_data.data, start, bytes, cudaMemcpyHostToDevice,
                                                           stream));
    error = error ? error : check(failure, cudaStreamSynchronize(stream));
    if (error)
        return error;
    unsigned char *copy = (unsigned char *)cuda->scene_data.data;
    cuda->scene = *scene;
    cuda->scene.chunks = copy;
    cuda->scene.rows = copy + (scene->rows - start);
    cuda->scene.palette = scene->palette ? (const int8_t *)copy + (scene->palette - (const int8_t *)start) : 0;
    return 0;
}

void fxs_cuda_time(fxs_cuda *cuda, int on)
{
    cuda->timed = on;
}

int fxs_cuda_render(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                    void *stream, fxs_cuda_failure *failure)
{
    if (!cuda || !frames || !options || !cuda->scene.rows || count < 1 || count > FXS_CUDA_BATCH ||
        !options_valid(options))
        return failed(failure, FXS_ERR_ARGUMENT, "an argument is null or out of range");
    for (uint32_t i = 0; i < count; i++)
        if (!frame_valid(&frames[i], options))
            return failed(failure, FXS_ERR_ARGUMENT, "pixels are null or not aligned to a pixel, or rows overlap");
    on_device scope(cuda->device);
    cudaGetLastError();            /* not ours */
    cuda->options = *options;
    cuda->frame_count = count;
    memcpy(cuda->frames, frames, count * sizeof *frames);
    int error = check(failure, cudaEventRecord(cuda->ready, (cudaStream_t)stream));
    const uint32_t used = count < cuda->slot_count ? count : cuda->slot_count;
    for (uint32_t i = 0; i < used && !error; i++)
        error = check(failure, cudaStreamWaitEvent(cuda->slots[i].stream, cuda->ready, 0));
    for (uint32_t i = 0; i < count && !error; i++)
        error = start_frame(cuda, i, failure);
    for (uint32_t i = 0; i < used && !error; i++)
        if (!(error = check(failure, cudaEventRecord(cuda->slots[i].done, cuda->slots[i].stream))))
            error = check(failure, cudaStreamWaitEvent((cudaStream_t)stream, cuda->slots[i].done, 0));
    return error ? end_frames(cuda, error) : 0;
}

int fxs_cuda_finish(fxs_cuda *cuda, fxs_cuda_stats *stats, fxs_cuda_failure *failure)
{
    if (!cuda || !cuda->frame_count)
        return failed(failure, FXS_ERR_ARGUMENT, "no frame is under way");
    on_device scope(cuda->device);
    cudaGetLastError();            /* not ours */
    int error = wait(cuda, failure);
    for (uint32_t i = 0; i < cuda->frame_count && !error; i++)
        if (cuda->status[i].damaged)
            error = failed(failure, FXS_ERR_SCENE, fxs_strerror(FXS_ERR_SCENE));
        else if (!frame_fitted(cuda, i))
            error = render_again(cuda, i, failure);
    if (!error && stats)
        stats_of(cuda, stats);
    return end_frames(cuda, error);
}

int fxs_cuda_render_host(fxs_cuda *cuda, const fxs_camera *camera, const fxs_options *options, void *pixels,
                         ptrdiff_t stride, fxs_cuda_stats *stats, fxs_cuda_failure *failure)
{
    if (!cuda || !camera || !options || !pixels || !fxs_stride_valid(camera, options, stride))
        return failed(failure, FXS_ERR_ARGUMENT, "an argument is null, or rows overlap");
    if (camera->width < 1 || camera->height < 1 || camera->width > FXS_MAX_SIZE || camera->height > FXS_MAX_SIZE)
        return failed(failure, FXS_ERR_SIZE, "the width or height is outside 1 to 16384");
    on_device scope(cuda->device);
    const size_t row = (size_t)camera->width * (size_t)fxs_pixel_bytes(options);
    const size_t height = (size_t)camera->height;
    int error = reserve(cuda, &cuda->pixels, row * height, failure);
    const fxs_cuda_frame frame = {*camera, cuda->pixels.data, (ptrdiff_t)row};
    error = error ? error : fxs_cuda_render(cuda, &frame, 1, options, 0, failure);
    error = error ? error : fxs_cuda_finish(cuda, stats, failure);
    if (error)
        return error;
    if (stride >= 0)
        return check(failure, cudaMemcpy2D(pixels, (size_t)stride, frame.pixels, row, row, height,
                                           cudaMemcpyDeviceToHost));
    for (size_t y = 0; y < height && !error; y++)
        error = check(failure, cudaMemcpy((unsigned char *)pixels + (ptrdiff_t)y * stride,
                                          (unsigned char *)frame.pixels + y * row, row, cudaMemcpyDeviceToHost));
    return error;
}
