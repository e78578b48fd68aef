/* sort, for a group of threads: the next keys of a list, near to far, as far as they are needed. */
#ifndef FXS_CUDA_SORT_CUH
#define FXS_CUDA_SORT_CUH

#include "stages.cuh"

namespace {

const uint32_t GROUP_WARPS_MOST = 8;
const uint32_t ROUND_KEYS = 1024;          /* sorted at a time */
const uint32_t BIN_BITS = 11, BINS = 1u << BIN_BITS;

/* Where a group sorts. */
struct group_keys {
    uint64_t keys[ROUND_KEYS];
    uint64_t bounds[GROUP_WARPS_MOST][2];
    uint32_t sums[GROUP_WARPS_MOST];
    uint32_t count, bin;
};

/* A group of T threads. */
template <uint32_t T>
struct group {
    static constexpr uint32_t threads = T;
    uint32_t number, thread;               /* the group in its block, the thread in its group */

    __device__ void sync() const
    {
        asm volatile("barrier.sync %0, %1;" ::"r"(number + 1), "r"(T) : "memory");
    }

    /* Whether `x` holds in any thread; synchronises too. */
    __device__ bool any(bool x) const
    {
        uint32_t result;
        asm volatile("{ .reg .pred p, q; setp.ne.u32 p, %1, 0; barrier.red.or.pred q, %2, %3, p; "
                     "selp.u32 %0, 1, 0, q; }"
                     : "=r"(result) : "r"((uint32_t)x), "r"(number + 1), "r"(T) : "memory");
        return result != 0;
    }
};

/* Bitonic sort (Batcher 1968): thread t holds keys N t to N t + N - 1. Comparisons are with the mirror image first, so
   all point up. */

template <int N>
__device__ inline void order_local(uint64_t k[N], int mask)
{
#pragma unroll
    for (int i = 0; i < N; i++) {
        const int j = i ^ mask;
        if (j > i && k[j] < k[i]) {
            const uint64_t least = k[j];
            k[j] = k[i];
            k[i] = least;
        }
    }
}

/* Orders with thread ^ mask; mirrored: its keys from the last to the first. */
template <int N, class G>
__device__ inline void order_threads(uint64_t k[N], uint32_t mask, bool mirrored, group_keys *shared, const G *g)
{
    const bool upper = (g->thread & (mirrored ? (mask + 1) / 2 : mask)) != 0;
    uint64_t other[N];
    if (mask < WARP) {
#pragma unroll
        for (int i = 0; i < N; i++)
            other[i] = __shfl_xor_sync(ALL_LANES, k[i], (int)mask);
    } else {
        g->sync();
#pragma unroll
        for (int i = 0; i < N; i++)
            shared->keys[i * G::threads + g->thread] = k[i];
        g->sync();
#pragma unroll
        for (int i = 0; i < N; i++)
            other[i] = shared->keys[i * G::threads + (g->thread ^ mask)];
    }
#pragma unroll
    for (int i = 0; i < N; i++) {
        const uint64_t theirs = mirrored ? other[N - 1 - i] : other[i];
        k[i] = (theirs < k[i]) != upper ? theirs : k[i];
    }
}

/* Sorts shared->keys, `count` of them, at most N G::threads. */
template <int N, class G>
__device__ void sort_group(group_keys *shared, uint32_t count, const G *g)
{
    uint64_t k[N];
#pragma unroll
    for (int i = 0; i < N; i++) {
        const uint32_t at = g->thread * N + (uint32_t)i;
        k[i] = at < count ? shared->keys[at] : ~(uint64_t)0;
    }
#pragma unroll
    for (int size = 1; size < N; size *= 2) {
        order_local<N>(k, 2 * size - 1);
#pragma unroll
        for (int half = size / 2; half > 0; half /= 2)
            order_local<N>(k, half);
    }
    for (uint32_t size = 1; size < G::threads && size * N < count; size *= 2) {
        order_threads<N>(k, 2 * size - 1, true, shared, g);
        for (uint32_t half = size / 2; half > 0; half /= 2)
            order_threads<N>(k, half, false, shared, g);
#pragma unroll
        for (int half = N / 2; half > 0; half /= 2)
            order_local<N>(k, half);
    }
    g->sync();
#pragma unroll
    for (int i = 0; i < N; i++)
        shared->keys[g->thread * N + (uint32_t)i] = k[i];
    g->sync();
}

/* Calls visit(key) for every key of a list; several are fetched at once. */
template <class G, class Visit>
__device__ void visit_keys(const uint64_t *list, uint32_t count, const G *g, Visit visit)
{
    enum { FETCHES = 8 };
    for (uint32_t first = g->thread; first < count; first += FETCHES * G::threads) {
        uint64_t k[FETCHES];
#pragma unroll
        for (uint32_t i = 0; i < FETCHES; i++)
            k[i] = first + i * G::threads < count ? __ldcg(&list[first + i * G::threads]) : 0;
#pragma unroll
        for (uint32_t i = 0; i < FETCHES; i++)
            if (first + i * G::threads < count)
                visit(k[i]);
    }
}

/* A list being taken in rounds. */
struct rounds {
    uint64_t low, high;                    /* keys below low are done; all are at most high */
};

template <class G>
__device__ rounds begin_rounds(group_keys *shared, const uint64_t *list, uint32_t count, const G *g)
{
    rounds r = {~(uint64_t)0, 0};
    visit_keys(list, count, g, [&](uint64_t key) {
        r.low = key < r.low ? key : r.low;
        r.high = key > r.high ? key : r.high;
    });
    for (int d = WARP / 2; d > 0; d /= 2) {
        const uint64_t low = __shfl_xor_sync(ALL_LANES, r.low, d), high = __shfl_xor_sync(ALL_LANES, r.high, d);
        r.low = low < r.low ? low : r.low;
        r.high = high > r.high ? high : r.high;
    }
    if (g->thread % WARP == 0) {
        shared->bounds[g->thread / WARP][0] = r.low;
        shared->bounds[g->thread / WARP][1] = r.high;
    }
    g->sync();
    for (uint32_t i = 0; i < G::threads / WARP; i++) {
        r.low = shared->bounds[i][0] < r.low ? shared->bounds[i][0] : r.low;
        r.high = shared->bounds[i][1] > r.high ? shared->bounds[i][1] : r.high;
    }
    return r;
}

/* A bin holds 2^that keys, so that BINS reach from `low` to `high`. */
__device__ inline int bin_shift(uint64_t low, uint64_t high)
{
    const int bits = 64 - __clzll((long long)(high - low));
    return bits > (int)BIN_BITS ? bits - (int)BIN_BITS : 0;
}

/* How many keys are in the bins before this thread's, and in its own. */
template <class G>
__device__ uint32_t keys_before(group_keys *shared, const uint32_t *bins, uint32_t *own, const G *g)
{
    const uint32_t each = BINS / G::threads, warp = g->thread / WARP;
    *own = 0;
    for (uint32_t i = 0; i < each; i++)
        *own += bins[g->thread * each + i];
    uint32_t end = warp_sum(*own);
    if (lane_index() == WARP - 1)
        shared->sums[warp] = end;
    g->sync();
    for (uint32_t i = 0; i < warp; i++)
        end += shared->sums[i];
    return end - *own;
}

/* Finds the first bin with which the keys are more than ROUND_KEYS: shared->bin (BINS: none), and how many are below
   it: shared->count. */
template <class G>
__device__ void find_bin(group_keys *shared, const uint32_t *bins, const G *g)
{
    const uint32_t each = BINS / G::threads;
    uint32_t own, start = keys_before(shared, bins, &own, g);
    const uint32_t end = start + own;
    if (start <= ROUND_KEYS && (end > ROUND_KEYS || g->thread == G::threads - 1)) {
        uint32_t bin = g->thread * each;
        for (; bin < (g->thread + 1) * each && start + bins[bin] <= ROUND_KEYS; bin++)
            start += bins[bin];
        shared->bin = bin;
        shared->count = start;
    }
    g->sync();
}

/* Puts the least keys from r->low on into shared->keys, at most ROUND_KEYS, and moves r->low. Returns how many. There
   must be some left. `bins`: BINS of shared memory. */
template <class G>
__device__ uint32_t next_round(rounds *r, group_keys *shared, uint32_t *bins, const uint64_t *list, uint32_t count,
                               const G *g)
{
    uint64_t first = r->low, last = r->high;
    uint32_t found = 0;
    while (!found) {
        const int shift = bin_shift(first, last);
        for (uint32_t i = g->thread; i < BINS; i += G::threads)
            bins[i] = 0;
        g->sync();
        visit_keys(list, count, g, [&](uint64_t key) {
            if (key >= first && key <= last)
                atomicAdd(&bins[(key - first) >> shift], 1u);
        });
        g->sync();
        find_bin(shared, bins, g);
        found = shared->count;
        const uint64_t bin = shared->bin, width = (uint64_t)1 << shift;
        if (found) {
            last = bin < BINS ? first + bin * width - 1 : last;
        } else {                           /* too many in one bin */
            first += bin * width;
            last = first + width - 1;
        }
        g->sync();
    }
    if (g->thread == 0)
        shared->count = 0;
    g->sync();
    visit_keys(list, count, g, [&](uint64_t key) {
        if (key >= first && key <= last)
            shared->keys[atomicAdd(&shared->count, 1u)] = key;
    });
    g->sync();
    r->low = last + 1;
    return found;
}

template <class G>
__device__ void sort_keys(group_keys *shared, uint32_t count, const G *g)
{
    if (count <= G::threads)
        sort_group<1>(shared, count, g);
    else if (count <= 2 * G::threads)
        sort_group<2>(shared, count, g);
    else if (count <= 4 * G::threads)
        sort_group<4>(shared, count, g);
    else
        sort_group<ROUND_KEYS / G::threads>(shared, count, g);
}

}

#endif
