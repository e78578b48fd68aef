/* Wraps PTX instructions, dynamic shared memory and kernel launches. tests/gpu/emulated/ptx.h replaces this file to
 * run the kernels on a CPU. */
#ifndef FXS_CUDA_PTX_CUH
#define FXS_CUDA_PTX_CUH

#include <stdint.h>

#include <cuda_runtime.h>

namespace {

template <class... Parameters>
void start(void (*kernel)(Parameters...), uint32_t blocks, uint32_t threads, size_t shared, cudaStream_t stream,
           const Parameters &...parameters)
{
    kernel<<<blocks, threads, shared, stream>>>(parameters...);
}

__device__ inline unsigned char *shared_memory()
{
    extern __shared__ __align__(16) unsigned char memory[];
    return memory;
}

/* Returns a * b + c by one mad instruction, which nvcc would not emit. */
__device__ inline uint32_t multiply_add(uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t sum;
    asm("mad.lo.u32 %0, %1, %2, %3;" : "=r"(sum) : "r"(a), "r"(b), "r"(c));
    return sum;
}

/* Returns sqrt(x) for x >= 1, with a relative error of at most 2^-22. */
__device__ inline float approximate_root(float x)
{
    float root;
    asm("sqrt.approx.f32 %0, %1;" : "=f"(root) : "f"(x));
    return root;
}

/* Returns alpha * T + 1/2 in Q30 for a splat at a pixel with transmittance T. Returns 0 if level > limit (the splat is
   too faint) or T < Closed (the pixel is opaque). alpha is the 16-bit element of alpha_q15 at byte offset level &
   0xfffe. */
template <int Closed>
__device__ inline int weight_product(const uint16_t *alpha_q15, int level, int limit, int transmittance)
{
    int product;
    asm("{ .reg .pred touched, open; .reg .u32 alpha;\n"
        "setp.le.s32 touched, %1, %2; and.b32 alpha, %1, 0xfffe; add.u32 alpha, alpha, %4;\n"
        "@touched ld.shared.u16 alpha, [alpha];\n"
        "setp.ge.and.s32 open, %3, %5, touched; mov.u32 %0, 0;\n"
        "@open mad.lo.s32 %0, alpha, %3, 16384; }"
        : "=&r"(product)
        : "r"(level), "r"(limit), "r"(transmittance), "r"((uint32_t)__cvta_generic_to_shared(alpha_q15)), "n"(Closed));
    return product;
}

/* Returns x, kept in a register. Otherwise nvcc would compute x again in every loop iteration. */
__device__ inline uint32_t kept(uint32_t x)
{
    asm volatile("" : "+r"(x));
    return x;
}

template <class T>
__device__ inline T *kept_shared(T *x)
{
    x = (T *)__cvta_shared_to_generic(kept((uint32_t)__cvta_generic_to_shared(x)));
    __builtin_assume(__isShared(x));
    return x;
}

__device__ inline void wait_at(uint32_t barrier, uint32_t threads)
{
    asm volatile("barrier.sync %0, %1;" ::"r"(barrier), "r"(threads) : "memory");
}

__device__ inline bool any_at(uint32_t barrier, uint32_t threads, bool x)
{
    uint32_t result;
    asm volatile("{ .reg .pred p, q; setp.ne.u32 p, %1, 0; barrier.red.or.pred q, %2, %3, p; selp.u32 %0, 1, 0, q; }"
                 : "=r"(result) : "r"((uint32_t)x), "r"(barrier), "r"(threads) : "memory");
    return result != 0;
}

}

#endif
