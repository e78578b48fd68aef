/* Operations of a warp (32 threads): reductions, prefix sums, shared counters, load balance. */
#ifndef FXS_CUDA_WARP_CUH
#define FXS_CUDA_WARP_CUH

#include "ptx.cuh"

namespace {

const uint32_t WARP = 32;
const unsigned ALL_LANES = 0xffffffffu;

__device__ inline uint32_t lane_index()
{
    return threadIdx.x % WARP;
}

#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
#define REDUCE(name, reduced)                                            \
    template <typename T> __device__ inline T name(unsigned lanes, T own) \
    {                                                                    \
        for (int step = WARP / 2; step; step /= 2) {                     \
            const T other = __shfl_xor_sync(lanes, own, step);           \
            own = reduced;                                               \
        }                                                                \
        return own;                                                      \
    }
REDUCE(__reduce_add_sync, own + other)
REDUCE(__reduce_or_sync, own | other)
REDUCE(__reduce_min_sync, own < other ? own : other)
REDUCE(__reduce_max_sync, own > other ? own : other)
#undef REDUCE
#endif

/* Returns the inclusive prefix sum over the threads of a warp. */
template <class T>
__device__ inline T warp_sum(T x)
{
    for (uint32_t d = 1; d < WARP; d *= 2) {
        const T below = __shfl_up_sync(ALL_LANES, x, d);
        x += lane_index() >= d ? below : 0;
    }
    return x;
}

/* Increments counters[i] for each active thread of a warp and returns the old value. Threads with equal i share one
   atomic operation. */
__device__ inline uint32_t take_number(uint32_t *counters, uint32_t i, bool active)
{
    const unsigned lanes = __ballot_sync(ALL_LANES, active), lane = lane_index();
    uint32_t place = 0;
    if (active) {
        const unsigned same = __match_any_sync(lanes, i), leader = (unsigned)__ffs((int)same) - 1;
        if (lane == leader)
            place = atomicAdd(&counters[i], (uint32_t)__popc(same));
        place = __shfl_sync(same, place, (int)leader) + (uint32_t)__popc(same & ((1u << lane) - 1));
    }
    return place;
}

__device__ inline void add_at(uint32_t *counters, uint32_t i, uint32_t by, bool active)
{
    const unsigned lanes = __ballot_sync(ALL_LANES, active);
    if (active) {
        const unsigned same = __match_any_sync(lanes, i);
        if (lane_index() == (uint32_t)__ffs((int)same) - 1)
            atomicAdd(&counters[i], by * (uint32_t)__popc(same));
    }
}

/* Divides work evenly among the lanes of a warp. Each lane brings `own` items, and the warp visits all items, 32 per
   step. All lanes call visit(lane that brought the item, index of the item, true for a valid item). */
template <class Visit>
__device__ inline void share_out(uint32_t own, Visit visit)
{
    const uint32_t end = warp_sum(own), start = end - own, all = __shfl_sync(ALL_LANES, end, WARP - 1);
    for (uint32_t first = 0; first < all; first += WARP) {
        const uint32_t item = first + lane_index();
        uint32_t lane = 0;
        for (uint32_t step = WARP / 2; step > 0; step /= 2)
            lane += __shfl_sync(ALL_LANES, end, (int)(lane + step - 1)) <= item ? step : 0;
        visit((int)lane, item - __shfl_sync(ALL_LANES, start, (int)lane), item < all);
    }
}

/* Returns the position of the n-th set bit of mask. n counts from 0. */
__device__ inline uint32_t bit_of(uint64_t mask, uint32_t n)
{
    const uint32_t low_bits = (uint32_t)__popc((uint32_t)mask), high = n >= low_bits ? 32 : 0;
    uint32_t bits = (uint32_t)(mask >> high), place = 0;
    n -= high ? low_bits : 0;
    for (uint32_t step = 16; step > 0; step /= 2) {
        const uint32_t below = (uint32_t)__popc(bits & ((1u << step) - 1)), skip = below <= n ? step : 0;
        bits >>= skip;
        place += skip;
        n -= skip ? below : 0;
    }
    return high + place;
}

/* Lets the next kernel start early, then waits until the previous kernel has finished. Does nothing before compute
   capability 9.0. */
__device__ inline void wait_for_last_kernel()
{
#if __CUDA_ARCH__ >= 900
    cudaTriggerProgrammaticLaunchCompletion();
    cudaGridDependencySynchronize();
#endif
}

}

#endif
