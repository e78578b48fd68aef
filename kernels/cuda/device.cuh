/* Converts CUDA errors to messages, and allocates device memory and pinned host memory. */
#ifndef FXS_CUDA_DEVICE_CUH
#define FXS_CUDA_DEVICE_CUH

#include <stdint.h>
#include <string.h>

#include <cuda_runtime.h>

#include <fixsplat/fixsplat.h>

namespace {

struct block {
    void *data;
    uint64_t bytes;
};

struct host_block {
    void *data;
    uint64_t bytes;
};

/* A budget of device memory: the largest allowed number of bytes (0: no limit), and the allocated number. */
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
    if (error == cudaErrorInvalidDevice)
        return "there is no NVIDIA GPU of that number";
    if (error == cudaErrorInsufficientDriver && !cudaDriverGetVersion(&driver) && !driver)
        return "no NVIDIA driver was found";
    return cudaGetErrorString(error);
}

/* Converts a CUDA error to an FXS_ERR_* code and a message. If `error` is success, converts `second` instead. */
int check(fxs_message *why, cudaError_t error, cudaError_t second = cudaSuccess)
{
    error = error ? error : second;
    if (!error)
        return 0;
    cudaGetLastError();
    return failed(why, error == cudaErrorMemoryAllocation ? FXS_ERR_MEMORY : FXS_ERR_DEVICE, words(error));
}

cudaError_t first_of(cudaError_t a, cudaError_t b)
{
    return a ? a : b;
}

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

/* Grows a device block to at least `bytes` bytes and discards its contents. 0 bytes frees the block. */
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

/* Takes `count` elements of type T from *memory, padded to a multiple of 64 bytes. */
template <class T>
T *cut(unsigned char **memory, uint64_t count)
{
    T *part = (T *)*memory;
    *memory += (count * sizeof(T) + 63) / 64 * 64;
    return part;
}

}

#endif
