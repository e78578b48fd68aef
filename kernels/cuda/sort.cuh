/* Sorts keys of splats (depth in the upper 32 bits, index in the lower) in shared memory, by a group of threads. If a
 * list is too long for shared memory, the group sorts the nearest keys that fit. It sorts further keys only while a
 * pixel of the tile is not opaque. */
#ifndef FXS_CUDA_SORT_CUH
#define FXS_CUDA_SORT_CUH

#include "warp.cuh"

namespace {

const uint32_t GROUP_WARPS_MOST = 32;

template <uint32_t Room, int Bits = 11>
struct group_keys {
    static constexpr uint32_t room = Room, bins = 1u << Bits;
    static constexpr int bits = Bits;
    uint64_t keys[Room];
    uint16_t places[Room];                 /* indices into the array `keys`, in the order of the depth bins */
    uint2 bounds[GROUP_WARPS_MOST];
    uint32_t sums[GROUP_WARPS_MOST];
    uint32_t segments[WARP];
    uint32_t count, bin;
};

/* If a thread has more than two bins of the histogram, one unused bin follows them, to avoid bank conflicts in shared
   memory. */
template <class K, uint32_t T>
constexpr bool has_gaps = K::bins / T > 2;

template <class K, uint32_t T>
constexpr uint32_t bins_of = K::bins + (has_gaps<K, T> ? T : 0);

template <class K, class G>
__device__ inline uint32_t slot_of(uint32_t bin)
{
    return has_gaps<K, G::threads> ? bin + bin / (K::bins / G::threads) : bin;
}

template <uint32_t T>
struct group {
    static constexpr uint32_t threads = T;
    uint32_t number, thread;

    __device__ void sync() const
    {
        wait_at(number + 1, T);
    }

    __device__ bool any(bool x) const
    {
        return any_at(number + 1, T, x);
    }
};

template <>
struct group<WARP> {
    static constexpr uint32_t threads = WARP;
    uint32_t number, thread;

    __device__ void sync() const
    {
        __syncwarp();
    }
};

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

struct key_range {
    uint64_t low, high;
};

/* Returns a range of keys that covers the depths `least` to `most` of all threads in the group. */
template <class K, class G>
__device__ key_range range_of(K *shared, uint32_t least, uint32_t most, const G *g)
{
    least = __reduce_min_sync(ALL_LANES, least);
    most = __reduce_max_sync(ALL_LANES, most);
    if (lane_index() == 0)
        shared->bounds[g->thread / WARP] = make_uint2(least, most);
    g->sync();
    const uint2 of_warp = shared->bounds[lane_index() % (G::threads / WARP)];
    return {(uint64_t)__reduce_min_sync(ALL_LANES, of_warp.x) << 32,
            (uint64_t)__reduce_max_sync(ALL_LANES, of_warp.y) << 32 | UINT32_MAX};
}

__device__ inline uint32_t depth_of(uint64_t key)
{
    return (uint32_t)(key >> 32);
}

template <class K, class G, class VisitAll>
__device__ key_range range_of_list(K *shared, const G *g, VisitAll visit_all)
{
    uint32_t least = UINT32_MAX, most = 0;
    visit_all([&](uint64_t key) {
        least = min(least, depth_of(key));
        most = max(most, depth_of(key));
    });
    return range_of(shared, least, most, g);
}

/* Returns log2 of the width of a bin, such that K::bins bins cover the keys `low` to `high`. */
template <class K>
__device__ inline int bin_shift(uint64_t low, uint64_t high)
{
    const int bits = 64 - __clzll((long long)(high - low));
    return bits > K::bits ? bits - K::bits : 0;
}

/* The bins of a histogram are divided among the threads. Returns the number of keys in all bins before this thread's
   bins. *own receives the number in the thread's own bins. */
template <class K, class G>
__device__ uint32_t keys_before(K *shared, const uint32_t *bins, uint32_t *own, const G *g)
{
    const uint32_t each = K::bins / G::threads, warp = g->thread / WARP;
    *own = 0;
    for (uint32_t i = 0; i < each; i++)
        *own += bins[slot_of<K, G>(g->thread * each + i)];
    uint32_t end = warp_sum(*own);
    if (lane_index() == WARP - 1)
        shared->sums[warp] = end;
    g->sync();
    end += __reduce_add_sync(ALL_LANES, lane_index() < warp ? shared->sums[lane_index()] : 0);
    return end - *own;
}

template <class K, class G>
__device__ void place_bins(K *shared, uint32_t *bins, const G *g)
{
    const uint32_t each = K::bins / G::threads;
    uint32_t own, start = keys_before(shared, bins, &own, g);
    for (uint32_t i = g->thread * each; i < (g->thread + 1) * each; i++) {
        const uint32_t slot = slot_of<K, G>(i), size = bins[slot];
        bins[slot] = start;
        start += size;
    }
    g->sync();
}

template <class K, class G>
__device__ void clear_bins(uint32_t *bins, const G *g)
{
    for (uint32_t i = g->thread; i < bins_of<K, G::threads>; i += G::threads)
        bins[i] = 0;
}

/* Finds how many of the first bins hold at most K::room keys together. shared->bin receives the first bin after these,
   shared->count the number of their keys. */
template <class K, class G>
__device__ void find_bin(K *shared, const uint32_t *bins, const G *g)
{
    const uint32_t each = K::bins / G::threads;
    uint32_t own, start = keys_before(shared, bins, &own, g);
    const uint32_t end = start + own;
    if (start <= K::room && (end > K::room || g->thread == G::threads - 1)) {
        uint32_t bin = g->thread * each;
        for (; bin < (g->thread + 1) * each && start + bins[slot_of<K, G>(bin)] <= K::room; bin++)
            start += bins[slot_of<K, G>(bin)];
        shared->bin = bin;
        shared->count = start;
    }
    g->sync();
}

/* Moves the smallest keys of the range *r, at most K::room, to shared->keys. Advances r->low past these keys and
   returns their number. The range must hold at least one key. */
template <class K, class G, class VisitAll>
__device__ uint32_t next_round(key_range *r, K *shared, uint32_t *bins, const G *g, VisitAll visit_all)
{
    uint64_t first = r->low, last = r->high;
    uint32_t found = 0;
    while (!found) {
        const int shift = bin_shift<K>(first, last);
        clear_bins<K>(bins, g);
        g->sync();
        visit_all([&](uint64_t key) {
            if (key >= first && key <= last)
                atomicAdd(&bins[slot_of<K, G>((uint32_t)((key - first) >> shift))], 1u);
        });
        g->sync();
        find_bin(shared, bins, g);
        found = shared->count;
        const uint64_t bin = shared->bin, width = (uint64_t)1 << shift;
        if (found) {
            last = bin < K::bins ? first + bin * width - 1 : last;
        } else {                           /* the first bin holds too many keys: divides it into finer bins */
            first += bin * width;
            last = first + width - 1;
        }
        g->sync();
    }
    if (g->thread == 0)
        shared->count = 0;
    g->sync();
    visit_all([&](uint64_t key) {
        if (key >= first && key <= last)
            shared->keys[atomicAdd(&shared->count, 1u)] = key;
    });
    g->sync();
    r->low = last + 1;
    return found;
}

/* Bins of different widths, for clustered depths. The range of keys has 32 equal segments; a segment with more keys has
   more bins. */
template <class K, class G>
struct segmented {
    const uint32_t *segments;              /* for each segment of the key range: first bin << 16 | number of bins */
    uint64_t low;
    int shift;                             /* log2 of the width of a segment of keys; at least 27, as the low 32 bits of
                                              a key are an index */

    __device__ segmented(K *shared, key_range r, uint32_t count, const G *g) : segments(shared->segments), low(r.low)
    {
        shift = 64 - __clzll((long long)(r.high - r.low)) - 5;
        for (uint32_t i = g->thread; i < count; i += G::threads)
            atomicAdd(&shared->segments[(shared->keys[i] - low) >> shift], 1u);
        g->sync();
        if (g->thread < WARP) {
            const uint32_t own = shared->segments[g->thread], end = warp_sum(own);
            const uint32_t first = (end - own) * K::bins / count;
            shared->segments[g->thread] = first << 16 | (end * K::bins / count - first);
        }
        g->sync();
    }

    __device__ uint32_t bin_of(uint64_t key) const
    {
        const uint64_t above = key - low;
        const uint32_t segment = segments[above >> shift];
        const uint32_t part_q16 = (uint32_t)(above >> (shift - 16)) & 0xffff;
        return min((segment >> 16) + (part_q16 * (segment & 0xffff) >> 16), K::bins - 1);
    }
};

/* Writes values to `sorted` in the order of the bins of their keys, by counting sort. visit_all(visit) must call
   visit(key, value) for each value. Afterwards `bins` holds the end of each bin. */
template <class Moved, class K, class G, class VisitAll>
__device__ void move_to_bins(Moved *sorted, K *shared, uint32_t *bins, key_range r, const G *g, VisitAll visit_all)
{
    const int shift = bin_shift<K>(r.low, r.high);
    clear_bins<K>(bins, g);
    g->sync();
    visit_all([&](uint64_t key, Moved) {
        atomicAdd(&bins[slot_of<K, G>((uint32_t)((key - r.low) >> shift))], 1u);
    });
    g->sync();
    place_bins(shared, bins, g);
    visit_all([&](uint64_t key, Moved moved) {
        sorted[atomicAdd(&bins[slot_of<K, G>((uint32_t)((key - r.low) >> shift))], 1u)] = moved;
    });
    g->sync();
}

template <class K>
__device__ uint32_t ends_within(const uint32_t *ends, uint32_t most)
{
    const uint32_t each = K::bins / WARP;
    uint32_t blocks = (uint32_t)__popc(__ballot_sync(ALL_LANES, ends[(lane_index() + 1) * each - 1] <= most));
    uint32_t count = blocks * each;
    for (uint32_t i = lane_index(); i < each && blocks < WARP; i += WARP)
        count += (uint32_t)__popc(__ballot_sync(ALL_LANES, ends[blocks * each + i] <= most));
    return count;
}

/* Returns the last end of a bin that is at most `room` keys after index `first`. Returns `first` for no such bin. */
template <class K>
__device__ uint32_t bins_end(const uint32_t *ends, uint32_t first, uint32_t room)
{
    const uint32_t bins = ends_within<K>(ends, first + room);
    return bins ? max(ends[bins - 1], first) : first;
}

template <class K>
__device__ uint32_t bin_end(const uint32_t *ends, uint32_t first)
{
    return ends[ends_within<K>(ends, first)];
}

/* Writes to `entries` the indices in shared->keys in ascending order of depth. Within a depth bin, a key's place is the
   number of smaller keys. */
template <class K, class G>
__device__ void sort_keys(uint32_t *entries, K *shared, uint32_t *bins, uint32_t count, const G *g)
{
    uint32_t least = UINT32_MAX, most = 0;
    for (uint32_t i = g->thread; i < count; i += G::threads) {
        least = min(least, depth_of(shared->keys[i]));
        most = max(most, depth_of(shared->keys[i]));
    }
    clear_bins<K>(bins, g);
    if (g->thread < WARP)
        shared->segments[g->thread] = 0;
    const segmented<K, G> s(shared, range_of(shared, least, most, g), count, g);
    for (uint32_t i = g->thread; i < count; i += G::threads)
        atomicAdd(&bins[slot_of<K, G>(s.bin_of(shared->keys[i]))], 1u);
    g->sync();
    place_bins(shared, bins, g);
    for (uint32_t i = g->thread; i < count; i += G::threads)
        shared->places[atomicAdd(&bins[slot_of<K, G>(s.bin_of(shared->keys[i]))], 1u)] = (uint16_t)i;
    g->sync();                             /* bins[i] is now the end of bin i */
    for (uint32_t i = g->thread; i < count; i += G::threads) {
        const uint64_t key = shared->keys[shared->places[i]];
        const uint32_t bin = s.bin_of(key);
        const uint32_t start = bin ? bins[slot_of<K, G>(bin - 1)] : 0, end = bins[slot_of<K, G>(bin)];
        uint32_t place = start;
        for (uint32_t k = start; k < end && end - start > 1; k++)
            place += shared->keys[shared->places[k]] < key ? 1 : 0;
        entries[place] = (uint32_t)key;
    }
    g->sync();
}

template <uint32_t Room, int Bits, class G>
__device__ void sort_keys_by_count(uint32_t *entries, group_keys<Room, Bits> *shared, uint32_t *bins, uint32_t count,
                                   const G *g)
{
    if (count > Room / 4)
        sort_keys(entries, shared, bins, count, g);
    else if (count)
        sort_keys(entries, (group_keys<Room, Bits - 2> *)shared, bins, count, g);
}

/* Splits a list of keys into batches in ascending order of depth. Calls take(count) for each batch until take returns
   false; the batch is in shared->keys, unsorted. `ends` holds the ends of the list's depth bins; null: no bins. */
template <class K, class G, class Take>
__device__ void take_keys(K *shared, uint32_t *bins, const uint64_t *list, uint32_t count, const uint32_t *ends,
                          const G *g, Take take)
{
    bool more = true;
    for (uint32_t first = 0, end = count; first < count && more; first = end, end = count) {
        if (ends)
            end = bins_end<K>(ends, first, K::room);
        if (end == first)
            end = bin_end<K>(ends, first);
        const uint32_t own = end - first;
        auto visit_all = [&](auto visit) { visit_keys(list + first, own, g, visit); };
        key_range r = {0, 0};
        if (own > K::room)
            r = range_of_list(shared, g, visit_all);
        for (uint32_t done = 0, some; done < own && more; done += some) {
            some = own;
            if (own > K::room)
                some = next_round(&r, shared, bins, g, visit_all);
            else
                for (uint32_t i = g->thread; i < own; i += G::threads)
                    shared->keys[i] = list[first + i];
            g->sync();
            more = take(some);
        }
    }
}

}

#endif
