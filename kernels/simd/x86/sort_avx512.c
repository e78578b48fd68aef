/* Sorts 64-bit keys. The keys are distributed to buckets by the top digit of their range. As many buckets as fit in 8
 * vectors are sorted together. For this, each lane is sorted across the vectors, lanes are transposed to vectors, and
 * the vectors are merged pairwise. */
#include "lanes_avx512.h"
#include "kernels/simd/lanes/stages.h"
#include "src/core/memory.h"

#define KEYS 8u
#define FEW (8 * KEYS)
#define MOST_BITS 11               /* largest number of bits in a digit of the keys */

static inline void put_in_order(__m512i *low, __m512i *high)
{
    const __m512i first = _mm512_min_epu64(*low, *high);
    *high = _mm512_max_epu64(*low, *high);
    *low = first;
}

/* Sorts each lane of 8 vectors with Batcher's sorting network. */
static inline void sort_lanes(__m512i x[8])
{
    static const unsigned char steps[19][2] = {
        {0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {1, 2}, {5, 6},
        {0, 4}, {1, 5}, {2, 6}, {3, 7}, {2, 4}, {3, 5}, {1, 2}, {3, 4}, {5, 6},
    };
#pragma GCC unroll 19
    for (int i = 0; i < 19; i++)
        put_in_order(&x[steps[i][0]], &x[steps[i][1]]);
}

static inline void transpose_keys(__m512i x[8])
{
    __m512i y[8];
    for (int i = 0; i < 8; i += 2) {
        y[i] = _mm512_unpacklo_epi64(x[i], x[i + 1]);
        y[i + 1] = _mm512_unpackhi_epi64(x[i], x[i + 1]);
    }
    for (int i = 0; i < 8; i++)
        x[i] = i & 2 ? _mm512_shuffle_i64x2(y[i - 2], y[i], 0xdd) : _mm512_shuffle_i64x2(y[i], y[i + 2], 0x88);
    for (int i = 0; i < 8; i++)
        y[i] = i & 4 ? _mm512_shuffle_i64x2(x[i - 4], x[i], 0xdd) : _mm512_shuffle_i64x2(x[i], x[i + 4], 0x88);
    for (int i = 0; i < 8; i++)
        x[i] = y[i];
}

/* Sorts a bitonic vector, which rises in one part and falls in the other. */
static inline __m512i merge_within(__m512i x)
{
    __m512i other = _mm512_shuffle_i64x2(x, x, 0x4e);
    x = _mm512_mask_max_epu64(_mm512_min_epu64(x, other), 0xf0, x, other);
    other = _mm512_permutex_epi64(x, 0x4e);
    x = _mm512_mask_max_epu64(_mm512_min_epu64(x, other), 0xcc, x, other);
    other = _mm512_shuffle_epi32(x, _MM_PERM_BADC);
    return _mm512_mask_max_epu64(_mm512_min_epu64(x, other), 0xaa, x, other);
}

static inline __attribute__((always_inline)) void merge_runs(__m512i *x, int half)
{
    const __m512i backwards = _mm512_setr_epi64(7, 6, 5, 4, 3, 2, 1, 0);
    for (int i = 0; i < half; i++) {
        __m512i *other = &x[2 * half - 1 - i];
        *other = _mm512_permutexvar_epi64(backwards, *other);
        put_in_order(&x[i], other);
    }
    for (int apart = half / 2; apart; apart /= 2)
        for (int i = 0; i < 2 * half; i++)
            if (!(i & apart))
                put_in_order(&x[i], &x[i + apart]);
    for (int i = 0; i < 2 * half; i++)
        x[i] = merge_within(x[i]);
}

static void sort_few(const fxs_key *keys, fxs_key *to, uint32_t count)
{
    const __m512i none = _mm512_set1_epi64(-1);
    const uint64_t there = ~(uint64_t)0 >> (FEW - count);
    __m512i x[8];
    for (uint32_t i = 0; i < 8; i++)
        x[i] = _mm512_mask_loadu_epi64(none, (__mmask8)(there >> i * KEYS), keys + i * KEYS);
    sort_lanes(x);
    transpose_keys(x);
    for (int i = 0; i < 8; i += 2)
        merge_runs(x + i, 1);
    merge_runs(x, 2);
    merge_runs(x + 4, 2);
    merge_runs(x, 4);
    for (uint32_t i = 0; i < 8; i++)
        _mm512_mask_storeu_epi64(to + i * KEYS, (__mmask8)(there >> i * KEYS), x[i]);
}

/* Finds the smallest and the largest key, and prefetches `spare`, the array that is written next. */
static inline void range_of(const fxs_key *keys, const fxs_key *spare, uint32_t count, fxs_key *least, fxs_key *most)
{
    __m512i low = _mm512_loadu_si512(keys + count - KEYS), high = low;
    for (uint32_t i = 0; i + KEYS <= count; i += KEYS) {
        const __m512i x = _mm512_loadu_si512(keys + i);
        __builtin_prefetch(spare + i, 1);
        low = _mm512_min_epu64(low, x);
        high = _mm512_max_epu64(high, x);
    }
    *least = _mm512_reduce_min_epu64(low);
    *most = _mm512_reduce_max_epu64(high);
}

static inline void move_to_buckets(const fxs_key *keys, fxs_key *spare, uint32_t count, fxs_key least, int shift,
                                   uint32_t buckets, uint32_t *ends)
{
    memset(ends, 0, buckets * sizeof *ends);
    for (uint32_t i = 0; i < count; i++)
        ends[(keys[i] - least) >> shift]++;
    for (uint32_t bucket = 0, start = 0; bucket < buckets; bucket++) {
        const uint32_t size = ends[bucket];
        ends[bucket] = start;
        start += size;
    }
    for (uint32_t i = 0; i < count; i++)
        spare[ends[(keys[i] - least) >> shift]++] = keys[i];
}

FXS_SORT(avx512)
{
    uint32_t ends[1 << MOST_BITS], start = 0, end;
    fxs_key least, most;
    if (count <= FEW) {
        if (count > 1)
            sort_few(keys, keys, count);
        return;
    }
    range_of(keys, spare, count, &least, &most);
    const int range = 64 - fxs_clz64((most - least) | 1), bits = fxs_min(31 - fxs_clz32(count), MOST_BITS);
    const int shift = range > bits ? range - bits : 0;
    move_to_buckets(keys, spare, count, least, shift, 1u << bits, ends);
    for (; start < count; start = end) {
        const uint32_t last = count - start < FEW ? count - 1 : start + FEW - 1;
        const uint32_t bucket = (uint32_t)((spare[last] - least) >> shift);
        end = ends[bucket] <= last + 1 ? ends[bucket] : bucket ? ends[bucket - 1] : 0;
        if (end > start) {
            sort_few(spare + start, keys + start, end - start);
            continue;
        }
        end = ends[bucket];
        memcpy(keys + start, spare + start, (end - start) * sizeof *keys);
        if (shift)
            fxs_sort_avx512(keys + start, spare + start, end - start);
    }
}
