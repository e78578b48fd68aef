/* The stage `sort`: radix sort of splats by depth, then by index, least significant digit first. One job sorts the list
 * of a macro tile (2x2 tiles). Several jobs sort all splats of a band (some rows of tiles) for a back end without
 * lists: each has a part of the keys. Keys with the same digit are placed in the order of the parts, so the result does
 * not depend on the number of jobs. */
#include <fixsplat/internal/fixed.h>
#include "memory.h"
#include "sort.h"

#define FEW 24u
#define MANY 1500u
#ifdef FXS_SMALL_STACK             /* for small boards: the radix sort uses short digits and no recursion */
#define LIST_DIGIT 7
#define HUGE UINT32_MAX
#else
#define LIST_DIGIT DIGIT
#define HUGE 32768u                /* number of keys above which a list does not fit in the cache */
#endif
#define MOVES 4u                   /* largest average number of moves per key in the insertion sort */
#define DIGIT 11

typedef struct digit {
    int shift;
    uint32_t buckets;
} digit;

typedef struct sorter {
    const fxs_key *from;
    fxs_key *to;
    uint32_t count, parts;
    digit digit;
    uint32_t (*histograms)[FXS_SORT_BUCKETS];
} sorter;

static uint32_t bucket_of(digit d, fxs_key key)
{
    return (uint32_t)(key >> d.shift) & (d.buckets - 1);
}

static void count_keys(const fxs_key *keys, uint32_t count, digit d, uint32_t *sizes)
{
    memset(sizes, 0, d.buckets * sizeof *sizes);
    for (uint32_t i = 0; i < count; i++)
        sizes[bucket_of(d, keys[i])]++;
}

static void move_keys(const fxs_key *keys, uint32_t count, digit d, uint32_t *next, fxs_key *to)
{
    for (uint32_t i = 0; i < count; i++)
        to[next[bucket_of(d, keys[i])]++] = keys[i];
}

/* ---- All splats, by several jobs --------------------------------------------------------------------------------- */

static void count_part(void *argument, uint32_t part)
{
    const sorter *s = argument;
    const uint32_t first = fxs_part(s->count, s->parts, part), end = fxs_part(s->count, s->parts, part + 1);
    count_keys(s->from + first, end - first, s->digit, s->histograms[part]);
}

static void move_part(void *argument, uint32_t part)
{
    const sorter *s = argument;
    const uint32_t first = fxs_part(s->count, s->parts, part), end = fxs_part(s->count, s->parts, part + 1);
    move_keys(s->from + first, end - first, s->digit, s->histograms[part], s->to);
}

/* Turns the bucket sizes of a radix sort into start offsets. Returns 1 if one bucket holds all keys. */
static int find_starts(const sorter *s)
{
    uint32_t start = 0;
    for (uint32_t bucket = 0; bucket < s->digit.buckets; bucket++) {
        const uint32_t first = start;
        for (uint32_t part = 0; part < s->parts; part++) {
            const uint32_t size = s->histograms[part][bucket];
            s->histograms[part][bucket] = start;
            start += size;
        }
        if (start - first == s->count)
            return 1;
    }
    return 0;
}

fxs_key *fxs_sort(const fxs_config *config, fxs_key *keys, fxs_key *spare, uint32_t count,
                  uint32_t (*histograms)[FXS_SORT_BUCKETS], uint32_t parts)
{
    sorter s = {keys, spare, count, parts, {32, FXS_SORT_BUCKETS}, histograms};
    for (; s.digit.shift < 64; s.digit.shift += DIGIT) {
        fxs_run(config, count_part, &s, parts);
        if (find_starts(&s))
            continue;
        fxs_run(config, move_part, &s, parts);
        fxs_key *moved = s.to;
        s.to = (fxs_key *)s.from;
        s.from = moved;
    }
    return (fxs_key *)s.from;
}

/* ---- A list ------------------------------------------------------------------------------------------------------ */

/* Insertion sort for nearly sorted keys. Gives up and returns 0 after more than `left` moves. */
static int insert_each(fxs_key *keys, uint32_t count, uint64_t left)
{
    for (uint32_t i = 1; i < count; i++) {
        const fxs_key key = keys[i];
        uint32_t at = i;
        for (; at > 0 && keys[at - 1] > key; at--)
            keys[at] = keys[at - 1];
        keys[at] = key;
        if (i - at > left)
            return 0;
        left -= i - at;
    }
    return 1;
}

/* Radix sort of keys by two digits of the depth. The digits start at bit `shift` of (depth - least). */
static void sort_by_two(fxs_key *keys, fxs_key *spare, uint32_t count, uint32_t least, int shift, int bits)
{
    uint32_t next[2][1 << LIST_DIGIT];
    const uint32_t buckets = 1u << bits;
    memset(next[0], 0, buckets * sizeof **next);
    memset(next[1], 0, buckets * sizeof **next);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t depth = ((uint32_t)(keys[i] >> 32) - least) >> shift;
        next[0][depth & (buckets - 1)]++;
        next[1][depth >> bits & (buckets - 1)]++;
    }
    for (int d = 0; d < 2; d++) {
        for (uint32_t bucket = 0, start = 0, size; bucket < buckets; bucket++, start += size) {
            size = next[d][bucket];
            next[d][bucket] = start;
        }
        for (uint32_t i = 0; i < count; i++)
            spare[next[d][((uint32_t)(keys[i] >> 32) - least) >> shift >> d * bits & (buckets - 1)]++] = keys[i];
        fxs_key *moved = spare;
        spare = keys;
        keys = moved;
    }
}

/* Sorts a long list by the top digit of the depth, then each bucket separately, because a bucket fits in a cache. */
static void sort_by_top(fxs_key *keys, fxs_key *spare, uint32_t count, uint32_t least, int range)
{
    uint32_t next[257] = {0};
    const int shift = range > 8 ? range - 8 : 0;
    for (uint32_t i = 0; i < count; i++)
        next[(((uint32_t)(keys[i] >> 32) - least) >> shift) + 1]++;
    for (int bucket = 0; bucket < 256; bucket++)
        next[bucket + 1] += next[bucket];
    for (uint32_t i = 0; i < count; i++)
        spare[next[((uint32_t)(keys[i] >> 32) - least) >> shift]++] = keys[i];
    for (uint32_t bucket = 0, start = 0; bucket < 256; start = next[bucket++]) {
        const uint32_t size = next[bucket] - start;
        fxs_sort_c(spare + start, keys + start, size);
        memcpy(keys + start, spare + start, size * sizeof *keys);
    }
}

/* Sorts keys by the two top digits of the range of depths, then by insertion. If many depths are too close, sorts by
   all digits. */
void fxs_sort_c(fxs_key *keys, fxs_key *spare, uint32_t count)
{
    uint32_t least = UINT32_MAX, most = 0;
    if (count <= FEW && insert_each(keys, count, UINT64_MAX))
        return;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t depth = (uint32_t)(keys[i] >> 32);
        least = depth < least ? depth : least;
        most = depth > most ? depth : most;
    }
    const int range = 32 - fxs_clz32((most - least) | 1), bits = fxs_min(count < MANY ? 8 : 11, LIST_DIGIT);
    if (count > HUGE && most > least) {
        sort_by_top(keys, spare, count, least, range);
        return;
    }
    sort_by_two(keys, spare, count, least, range > 2 * bits ? range - 2 * bits : 0, bits);
    if (insert_each(keys, count, MOVES * (uint64_t)count))
        return;
    for (int shift = 0; shift < range; shift += 2 * fxs_min(8, LIST_DIGIT))
        sort_by_two(keys, spare, count, least, shift, fxs_min(8, LIST_DIGIT));
    insert_each(keys, count, UINT64_MAX);
}
