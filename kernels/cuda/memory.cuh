/* The host's side: errors, memory, and the scenes that are on the device. */
#ifndef FXS_CUDA_MEMORY_CUH
#define FXS_CUDA_MEMORY_CUH

#include <cuda_runtime.h>

#include "stages.cuh"

namespace {

struct block {                     /* of device memory */
    void *data;
    uint64_t bytes;
};

struct host_block {                /* of pinned host memory */
    void *data;
    uint64_t bytes;
};

/* Device memory, allowed (0: any) and taken. */
struct budget {
    uint64_t most, bytes;
};

void copy_text(char *out, size_t size, const char *text)
{
    const size_t length = strlen(text), kept = length < size ? length : size - 1;
    memcpy(out, text, kept);
    out[kept] = 0;
}

int failed(fxs_message *why, int error, const char *text, uint64_t bytes_needed = 0)
{
    if (why) {
        copy_text(why->text, sizeof why->text, text);
        why->bytes_needed = bytes_needed;
    }
    return error;
}

const char *words(cudaError_t error)
{
    int driver = 0;
    if (error == cudaErrorNoDevice)
        return "no NVIDIA GPU was found";
    if (error == cudaErrorInsufficientDriver && !cudaDriverGetVersion(&driver) && !driver)
        return "no NVIDIA driver was found";
    return cudaGetErrorString(error);
}

/* The first of two errors of the runtime, as one of ours. */
int check(fxs_message *why, cudaError_t error, cudaError_t second = cudaSuccess)
{
    error = error ? error : second;
    if (!error)
        return 0;
    cudaGetLastError();            /* forgotten, for the sake of other users */
    return failed(why, error == cudaErrorMemoryAllocation ? FXS_ERR_MEMORY : FXS_ERR_DEVICE, words(error));
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

int too_large(const budget *allowed, uint64_t needed, fxs_message *why)
{
    return allowed->most && needed > allowed->most
               ? failed(why, FXS_ERR_MEMORY, "the device memory allowed is too small", needed) : 0;
}

/* Makes a block of at least `bytes` bytes, contents undefined; 0 gives it back. Frames that use the old one are waited
   for, by cudaFree. */
int reserve(budget *taken, block *b, uint64_t bytes, fxs_message *why)
{
    if (bytes && bytes <= b->bytes)
        return 0;
    cudaFree(b->data);
    taken->bytes -= b->bytes;
    *b = {0, 0};
    if (!bytes)
        return 0;
    const uint64_t needed = taken->bytes + bytes;
    if (too_large(taken, needed, why))
        return FXS_ERR_MEMORY;
    const int error = check(why, cudaMalloc(&b->data, bytes));
    if (error)
        return error == FXS_ERR_MEMORY ? failed(why, error, "the device is out of memory", needed) : error;
    b->bytes = bytes;
    taken->bytes += bytes;
    return 0;
}

/* The same, and keeps what is there. */
int reserve_host(host_block *b, uint64_t bytes, fxs_message *why)
{
    void *data;
    if (bytes <= b->bytes)
        return 0;
    const int error = check(why, cudaHostAlloc(&data, bytes, cudaHostAllocDefault));
    if (error)
        return error;
    if (b->data) {
        memcpy(data, b->data, b->bytes);
        cudaFreeHost(b->data);
    }
    *b = {data, bytes};
    return 0;
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

struct scene_copy {
    const fxs_scene *key;
    fxs_scene here, there;         /* as it was given; with the device's pointers */
    block data;                    /* none: it is wanted */
};

/* In the order of their keys. */
struct scene_table {
    host_block memory;
    uint32_t count;
    uint64_t bytes_wanted;
};

scene_copy *copies_of(const scene_table *t)
{
    return (scene_copy *)t->memory.data;
}

/* The place of a scene, or where it would be. */
uint32_t place_of(const scene_table *t, const fxs_scene *scene)
{
    uint32_t low = 0, high = t->count;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if ((uintptr_t)copies_of(t)[middle].key < (uintptr_t)scene)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Null where it is not there. */
scene_copy *find_scene(const scene_table *t, const fxs_scene *scene)
{
    const uint32_t place = place_of(t, scene);
    return place < t->count && copies_of(t)[place].key == scene ? &copies_of(t)[place] : nullptr;
}

/* Of what is copied: at least 1. */
uint64_t bytes_of(const fxs_scene *scene)
{
    const uint64_t bytes = (uint64_t)(scene->rows - scene->chunks) + (uint64_t)scene->chunk_count * scene->chunk_bytes;
    return bytes + !bytes;
}

void drop_scene(scene_table *t, budget *taken, const fxs_scene *scene)
{
    scene_copy *copy = find_scene(t, scene);
    if (!copy)
        return;
    reserve(taken, &copy->data, 0, nullptr);
    memmove(copy, copy + 1, (size_t)(copies_of(t) + t->count - copy - 1) * sizeof *copy);
    t->count--;
}

/* Makes a place for a scene that is not there. One that has changed is dropped first. */
int want_scene(scene_table *t, budget *taken, const fxs_scene *scene, fxs_message *why)
{
    const scene_copy *found = find_scene(t, scene);
    if (found && !memcmp(&found->here, scene, sizeof *scene))
        return 0;
    drop_scene(t, taken, scene);
    const uint64_t bytes = (t->count + 1) * sizeof(scene_copy);
    const int error = bytes > t->memory.bytes ? reserve_host(&t->memory, 2 * bytes, why) : 0;
    if (error)
        return error;
    scene_copy *copy = copies_of(t) + place_of(t, scene);
    memmove(copy + 1, copy, (size_t)(copies_of(t) + t->count - copy) * sizeof *copy);
    *copy = {scene, *scene, *scene, {nullptr, 0}};
    t->count++;
    t->bytes_wanted += bytes_of(scene);
    return 0;
}

int copy_scene(scene_copy *copy, budget *taken, cudaStream_t stream, fxs_message *why)
{
    const fxs_scene *from = &copy->here;
    int error = reserve(taken, &copy->data, bytes_of(from), why);
    if (!error && from->chunk_count)
        error = check(why, cudaMemcpyAsync(copy->data.data, from->chunks, bytes_of(from), cudaMemcpyHostToDevice,
                                           stream));
    error = error ? error : check(why, cudaStreamSynchronize(stream));
    if (error) {
        reserve(taken, &copy->data, 0, nullptr);
        return error;
    }
    const unsigned char *start = from->chunks;
    unsigned char *data = (unsigned char *)copy->data.data;
    copy->there.chunks = data;
    copy->there.rows = data + (from->rows - start);
    copy->there.palette = from->palette ? (const int8_t *)data + (from->palette - (const int8_t *)start) : nullptr;
    return 0;
}

/* Copies the scenes that are wanted; after an error, they are wanted no more. */
int fetch_scenes(scene_table *t, budget *taken, int error, cudaStream_t stream, fxs_message *why)
{
    for (uint32_t i = 0; i < t->count && t->bytes_wanted; i++) {
        scene_copy *copy = &copies_of(t)[i];
        if (!copy->data.data && !error)
            error = copy_scene(copy, taken, stream, why);
    }
    for (uint32_t i = t->count; i-- > 0 && error && t->bytes_wanted;)
        if (!copies_of(t)[i].data.data)
            drop_scene(t, taken, copies_of(t)[i].key);
    t->bytes_wanted = 0;
    return error;
}

}

#endif
