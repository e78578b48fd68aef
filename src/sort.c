/* sort: least significant digit first, of the bits of the depth that differ. Stable, so equal depths keep the order of
 * their slots. A list is sorted by one job; all that is visible, for a back end without lists, by several: each has a
 * part of the keys, and a digit's places go to the jobs in order, so the result does not depend on their number. */
#include "fixed.h"
#include "memory.h"
#include "parts.h"

#define FEW 24u                    /* keys, which are sorted by insertion */
#define MANY 3000u                 /* keys, for which digits are as long as they can be */
#define SHORT_DIGIT 8
#define LONG_DIGIT 11              /* FXS_SORT_BUCKETS */

typedef struct digit {
    int shift;
    uint32_t buckets;              /* a power of two */
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

/* ---- All by several jobs ----------------------------------------------------------------------------------------- */

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

/* Sizes become starts. Returns 1 where one bucket holds every key, so that there is nothing to move. */
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
    for (; s.digit.shift < 64; s.digit.shift += LONG_DIGIT) {
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

static void insert_each(fxs_key *keys, uint32_t count)
{
    for (uint32_t i = 1; i < count; i++) {
        const fxs_key key = keys[i];
        uint32_t at = i;
        for (; at > 0 && keys[at - 1] >> 32 > key >> 32; at--)
            keys[at] = keys[at - 1];
        keys[at] = key;
    }
}

fxs_key *fxs_sort_list(fxs_key *keys, fxs_key *spare, uint32_t count)
{
    uint32_t next[FXS_SORT_BUCKETS], differ = 0;
    if (count <= FEW) {
        insert_each(keys, count);
        return keys;
    }
    for (uint32_t i = 0; i < count; i++)
        differ |= (uint32_t)((keys[i] ^ keys[0]) >> 32);
    if (!differ)
        return keys;
    const int low = fxs_ctz32(differ), bits = 32 - fxs_clz32(differ) - low;
    const int longest = count < MANY ? SHORT_DIGIT : LONG_DIGIT, digits = (bits + longest - 1) / longest;
    digit d = {32 + low, 1u << (bits + digits - 1) / digits};
    for (int i = 0; i < digits; i++, d.shift += (bits + digits - 1) / digits) {
        count_keys(keys, count, d, next);
        for (uint32_t bucket = 0, start = 0; bucket < d.buckets; bucket++) {
            const uint32_t size = next[bucket];
            next[bucket] = start;
            start += size;
        }
        move_keys(keys, count, d, next, spare);
        fxs_key *moved = spare;
        spare = keys;
        keys = moved;
    }
    return keys;
}
