/* Emulates CUDA on a processor, as far as kernels/cuda needs it. Threads of a block are coroutines, and blocks run
 * one after another. Streams are queues that advance in random order, to expose missing waits. Device memory starts
 * with garbage. */
#ifndef EMULATED_CUDA_RUNTIME_H
#define EMULATED_CUDA_RUNTIME_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <functional>
#include <type_traits>

#define __host__
#define __device__
#define __global__
#define __shared__ static          /* emulated blocks run one after another, so one copy of shared memory is enough */
#define __grid_constant__
#define __noinline__ __attribute__((noinline))
#define __launch_bounds__(...)
#define __align__(bytes) __attribute__((aligned(bytes)))
#define __builtin_assume(x)

struct dim3 {
    uint32_t x;

    dim3(uint32_t across = 1) : x(across)
    {
    }
};

extern dim3 threadIdx, blockIdx, blockDim, gridDim;

struct uint2 {
    uint32_t x, y;
};

struct alignas(16) uint4 {
    uint32_t x, y, z, w;
};

inline uint2 make_uint2(uint32_t x, uint32_t y)
{
    return {x, y};
}

inline uint4 make_uint4(uint32_t x, uint32_t y, uint32_t z, uint32_t w)
{
    return {x, y, z, w};
}

/* ---- Meetings of threads ----------------------------------------------------------------------------------------- */

namespace emulated {

enum { SHARED_BYTES = 256 << 10 };
extern unsigned char shared[SHARED_BYTES];             /* shared memory of the running block; starts with garbage */

/* Emulates a warp operation: waits until all lanes in the mask `lanes` have called meet. Returns the argument `own` of
 * each lane. */
const uint64_t *meet(uint32_t lanes, uint64_t own);

/* Emulates a barrier: waits until `threads` threads of the block have called meet_block; 0: all running threads.
 * Returns the sum of their arguments `own`. */
uint32_t meet_block(uint32_t barrier, uint32_t threads, uint32_t own);

inline uint32_t lane()
{
    return threadIdx.x % 32;
}

template <class T>
uint64_t to_bits(T x)
{
    uint64_t bits = 0;
    memcpy(&bits, &x, sizeof x);
    return bits;
}

template <class T>
T from_bits(uint64_t bits)
{
    T x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

template <class T, class Better>
T reduce(uint32_t lanes, T own, Better better)
{
    const uint64_t *all = meet(lanes, to_bits(own));
    T found = own;
    for (uint32_t i = 0; i < 32; i++)
        if (lanes >> i & 1 && i != lane())
            found = better(found, from_bits<T>(all[i]));
    return found;
}

}

inline void __syncthreads()
{
    emulated::meet_block(0, 0, 0);
}

inline int __syncthreads_count(int x)
{
    return (int)emulated::meet_block(0, 0, x != 0);
}

inline void __syncwarp()
{
    emulated::meet(~0u, 0);
}

template <class T>
T __shfl_sync(uint32_t lanes, T x, int from, int width = 32)
{
    const uint32_t lane = emulated::lane() / (uint32_t)width * (uint32_t)width + (uint32_t)from % (uint32_t)width;
    return emulated::from_bits<T>(emulated::meet(lanes, emulated::to_bits(x))[lane]);
}

template <class T>
T __shfl_up_sync(uint32_t lanes, T x, uint32_t by)
{
    const uint64_t *all = emulated::meet(lanes, emulated::to_bits(x));
    return emulated::lane() >= by ? emulated::from_bits<T>(all[emulated::lane() - by]) : x;
}

template <class T>
T __shfl_xor_sync(uint32_t lanes, T x, int by)
{
    return emulated::from_bits<T>(emulated::meet(lanes, emulated::to_bits(x))[emulated::lane() ^ (uint32_t)by]);
}

template <class T>
uint32_t __match_any_sync(uint32_t lanes, T x)
{
    const uint64_t own = emulated::to_bits(x), *all = emulated::meet(lanes, own);
    uint32_t same = 0;
    for (uint32_t i = 0; i < 32; i++)
        same |= (uint32_t)(lanes >> i & 1 && all[i] == own) << i;
    return same;
}

inline uint32_t __ballot_sync(uint32_t lanes, int x)
{
    const uint64_t *all = emulated::meet(lanes, x != 0);
    uint32_t set = 0;
    for (uint32_t i = 0; i < 32; i++)
        set |= (uint32_t)(lanes >> i & 1 && all[i]) << i;
    return set;
}

inline int __any_sync(uint32_t lanes, int x)
{
    return __ballot_sync(lanes, x) != 0;
}

inline int __all_sync(uint32_t lanes, int x)
{
    return __ballot_sync(lanes, x) == lanes;
}

template <class T>
T __reduce_add_sync(uint32_t lanes, T x)
{
    return emulated::reduce(lanes, x, [](T a, T b) { return (T)(a + b); });
}

template <class T>
T __reduce_or_sync(uint32_t lanes, T x)
{
    return emulated::reduce(lanes, x, [](T a, T b) { return (T)(a | b); });
}

template <class T>
T __reduce_min_sync(uint32_t lanes, T x)
{
    return emulated::reduce(lanes, x, [](T a, T b) { return a < b ? a : b; });
}

template <class T>
T __reduce_max_sync(uint32_t lanes, T x)
{
    return emulated::reduce(lanes, x, [](T a, T b) { return a > b ? a : b; });
}

/* ---- Arithmetic and memory --------------------------------------------------------------------------------------- */

inline int __popc(uint32_t x)
{
    return __builtin_popcount(x);
}

inline int __popcll(uint64_t x)
{
    return __builtin_popcountll(x);
}

inline int __ffs(int x)
{
    return __builtin_ffs(x);
}

inline int __clz(int x)
{
    return x ? __builtin_clz((uint32_t)x) : 32;
}

inline int __clzll(long long x)
{
    return x ? __builtin_clzll((uint64_t)x) : 64;
}

inline uint32_t __funnelshift_l(uint32_t low, uint32_t high, uint32_t by)
{
    return (uint32_t)((((uint64_t)high << 32 | low) << by % 32) >> 32);
}

inline uint32_t __byte_perm(uint32_t low, uint32_t high, uint32_t select)
{
    const uint64_t bytes = (uint64_t)high << 32 | low;
    uint32_t picked = 0;
    for (uint32_t i = 0; i < 4; i++)
        picked |= (uint32_t)(bytes >> 8 * (select >> 4 * i & 7) & 255) << 8 * i;
    return picked;
}

inline int __float_as_int(float x)
{
    return emulated::from_bits<int>(emulated::to_bits(x));
}

inline float __int_as_float(int x)
{
    return emulated::from_bits<float>(emulated::to_bits(x));
}

float __fmaf_rd(float a, float b, float c);
float __fadd_rd(float a, float b);

inline float __fdividef(float a, float b)
{
    return a / b;
}

template <class A, class B>
typename std::common_type<A, B>::type min(A a, B b)
{
    return a < b ? a : b;
}

template <class A, class B>
typename std::common_type<A, B>::type max(A a, B b)
{
    return a > b ? a : b;
}

template <class T>
T __ldcg(const T *at)
{
    return *at;
}

inline void __threadfence()
{
}

template <class T, class Change>
T change_atomically(T *at, Change change)
{
    const T before = *at;
    *at = change(before);
    return before;
}

template <class T, class By>
T atomicAdd(T *at, By by)
{
    return change_atomically(at, [&](T x) { return (T)(x + (T)by); });
}

template <class T, class By>
T atomicOr(T *at, By by)
{
    return change_atomically(at, [&](T x) { return (T)(x | (T)by); });
}

template <class T, class By>
T atomicAnd(T *at, By by)
{
    return change_atomically(at, [&](T x) { return (T)(x & (T)by); });
}

template <class T, class By>
T atomicMin(T *at, By by)
{
    return change_atomically(at, [&](T x) { return (T)by < x ? (T)by : x; });
}

template <class T, class By>
T atomicMax(T *at, By by)
{
    return change_atomically(at, [&](T x) { return (T)by > x ? (T)by : x; });
}

template <class T, class By>
T atomicExch(T *at, By by)
{
    return change_atomically(at, [&](T) { return (T)by; });
}

template <class T, class If, class By>
T atomicCAS(T *at, If x, By by)
{
    return change_atomically(at, [&](T was) { return was == (T)x ? (T)by : was; });
}

/* ---- The CUDA runtime API ---------------------------------------------------------------------------------------- */

enum cudaError_t {
    cudaSuccess = 0,
    cudaErrorMemoryAllocation = 2,
    cudaErrorNoDevice,
    cudaErrorInvalidDevice,
    cudaErrorInsufficientDriver,
    cudaErrorNotReady
};
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost, cudaMemcpyDefault };
enum { cudaStreamNonBlocking = 1, cudaEventDisableTiming = 2, cudaHostAllocDefault = 0, cudaHostAllocMapped = 2 };
enum { cudaMemoryTypeUnregistered, cudaMemoryTypeHost, cudaMemoryTypeDevice };
enum { cudaFuncAttributeMaxDynamicSharedMemorySize };
enum { cudaDevAttrMultiProcessorCount, cudaDevAttrMaxSharedMemoryPerBlockOptin };
enum { cudaLaunchAttributeProgrammaticStreamSerialization };

namespace emulated {
struct stream;
struct event;
}
typedef emulated::stream *cudaStream_t;
typedef emulated::event *cudaEvent_t;

struct cudaPointerAttributes {
    int type;
};

struct cudaDeviceProp {
    char name[256];
};

struct cudaLaunchAttribute {
    int id;
    struct {
        int programmaticStreamSerializationAllowed;
    } val;
};

struct cudaLaunchConfig_t {
    dim3 gridDim, blockDim;
    size_t dynamicSmemBytes;
    cudaStream_t stream;
    cudaLaunchAttribute *attrs;
    unsigned numAttrs;
};

cudaError_t cudaGetDevice(int *device);
cudaError_t cudaSetDevice(int device);
cudaError_t cudaGetDeviceCount(int *count);
cudaError_t cudaGetDeviceProperties(cudaDeviceProp *properties, int device);
cudaError_t cudaDeviceGetAttribute(int *value, int attribute, int device);
cudaError_t cudaDriverGetVersion(int *version);
cudaError_t cudaGetLastError();
const char *cudaGetErrorString(cudaError_t error);

cudaError_t cudaMalloc(void **memory, size_t bytes);
cudaError_t cudaFree(void *memory);
cudaError_t cudaHostAlloc(void **memory, size_t bytes, unsigned flags);
cudaError_t cudaFreeHost(void *memory);
cudaError_t cudaHostGetDevicePointer(void **there, void *here, unsigned flags);
cudaError_t cudaMemGetInfo(size_t *unused, size_t *all);
cudaError_t cudaPointerGetAttributes(cudaPointerAttributes *attributes, const void *memory);
cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, cudaMemcpyKind kind);
cudaError_t cudaMemcpyAsync(void *to, const void *from, size_t bytes, cudaMemcpyKind kind, cudaStream_t stream);
cudaError_t cudaMemcpy2D(void *to, size_t to_pitch, const void *from, size_t from_pitch, size_t width, size_t height,
                         cudaMemcpyKind kind);
cudaError_t cudaMemcpy2DAsync(void *to, size_t to_pitch, const void *from, size_t from_pitch, size_t width,
                              size_t height, cudaMemcpyKind kind, cudaStream_t stream);
cudaError_t cudaMemset(void *to, int byte, size_t bytes);
cudaError_t cudaMemsetAsync(void *to, int byte, size_t bytes, cudaStream_t stream);

cudaError_t cudaStreamCreateWithFlags(cudaStream_t *stream, unsigned flags);
cudaError_t cudaStreamCreateWithPriority(cudaStream_t *stream, unsigned flags, int priority);
cudaError_t cudaDeviceGetStreamPriorityRange(int *least, int *most);
cudaError_t cudaStreamDestroy(cudaStream_t stream);
cudaError_t cudaStreamSynchronize(cudaStream_t stream);
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned flags);
cudaError_t cudaEventCreate(cudaEvent_t *event);
cudaError_t cudaEventCreateWithFlags(cudaEvent_t *event, unsigned flags);
cudaError_t cudaEventDestroy(cudaEvent_t event);
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream);
cudaError_t cudaEventSynchronize(cudaEvent_t event);
cudaError_t cudaEventQuery(cudaEvent_t event);
cudaError_t cudaEventElapsedTime(float *milliseconds, cudaEvent_t from, cudaEvent_t to);

template <class T>
cudaError_t cudaMalloc(T **memory, size_t bytes)
{
    return cudaMalloc((void **)memory, bytes);
}

template <class T>
cudaError_t cudaHostAlloc(T **memory, size_t bytes, unsigned flags)
{
    return cudaHostAlloc((void **)memory, bytes, flags);
}

template <class Kernel>
cudaError_t cudaFuncSetAttribute(Kernel *, int, int)
{
    return cudaSuccess;
}

namespace emulated {

void enqueue(cudaStream_t stream, std::function<void()> work);
void run_grid(uint32_t blocks, uint32_t threads, const std::function<void()> &thread);

template <class T>
struct given {
    typedef T type;
};

}

template <class... Parameters>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t *how, void (*kernel)(Parameters...),
                               typename emulated::given<Parameters>::type... parameters)
{
    const uint32_t blocks = how->gridDim.x, threads = how->blockDim.x;
    emulated::enqueue(how->stream, [=] { emulated::run_grid(blocks, threads, [=] { kernel(parameters...); }); });
    return cudaSuccess;
}

#endif
