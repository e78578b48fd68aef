/* Replaces the inline PTX of kernels/cuda/ptx.cuh with C++. */
#ifndef FXS_CUDA_PTX_CUH
#define FXS_CUDA_PTX_CUH

#include <cuda_runtime.h>

namespace {

template <class... Parameters>
void start(void (*kernel)(Parameters...), uint32_t blocks, uint32_t threads, size_t, cudaStream_t stream,
           const typename emulated::given<Parameters>::type &...parameters)
{
    cudaLaunchConfig_t how = {};
    how.gridDim.x = blocks;
    how.blockDim.x = threads;
    how.stream = stream;
    cudaLaunchKernelEx(&how, kernel, parameters...);
}

inline unsigned char *shared_memory()
{
    return emulated::shared;
}

inline uint32_t multiply_add(uint32_t a, uint32_t b, uint32_t c)
{
    return a * b + c;
}

inline float approximate_root(float x)
{
    return sqrtf(x);
}

template <int Closed>
inline int weight_product(const uint16_t *alpha_q15, int level, int limit, int transmittance)
{
    const bool takes = level <= limit && transmittance >= Closed;
    return takes ? alpha_q15[(level & 0xffff) / 2] * transmittance + 16384 : 0;
}

inline uint32_t kept(uint32_t x)
{
    return x;
}

template <class T>
inline T *kept_shared(T *x)
{
    return x;
}

inline void wait_at(uint32_t barrier, uint32_t threads)
{
    emulated::meet_block(barrier, threads, 0);
}

inline bool any_at(uint32_t barrier, uint32_t threads, bool x)
{
    return emulated::meet_block(barrier, threads, x) != 0;
}

}

#endif
