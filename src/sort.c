/* sort: least significant digit first, three digits of 11, 11 and 10 bits of the depth. Stable, so equal depths keep
 * the order of their slots. Each job has a part of the keys; a digit's slots go to the jobs in order, so the result
 * does not depend on their number. */
#include "memory.h"
#include "parts.h"

typedef struct sorter {
    const fxs_key *from;
    fxs_key *to;
    uint32_t count, parts;
    int shift;
    uint32_t (*histograms)[FXS_SORT_BUCKETS];
} sorter;

static uint32_t digit(const sorter *s, fxs_key key)
{
    return (uint32_t)(key >> s->shift) % FXS_SORT_BUCKETS;
}

static void count_part(void *argument, uint32_t part)
{
    const sorter *s = argument;
    uint32_t *sizes = s->histograms[part], end = fxs_part(s->count, s->parts, part + 1);
    memset(sizes, 0, sizeof *s->histograms);
    for (uint32_t i = fxs_part(s->count, s->parts, part); i < end; i++)
        sizes[digit(s, s->from[i])]++;
}

static void move_part(void *argument, uint32_t part)
{
    const sorter *s = argument;
    uint32_t *next = s->histograms[part], end = fxs_part(s->count, s->parts, part + 1);
    for (uint32_t i = fxs_part(s->count, s->parts, part); i < end; i++)
        s->to[next[digit(s, s->from[i])]++] = s->from[i];
}

/* Sizes become starts. Returns 1 where one bucket holds every key, so that there is nothing to move. */
static int find_starts(const sorter *s)
{
    uint32_t start = 0;
    for (uint32_t bucket = 0; bucket < FXS_SORT_BUCKETS; bucket++) {
        uint32_t first = start;
        for (uint32_t part = 0; part < s->parts; part++) {
            uint32_t size = s->histograms[part][bucket];
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
    sorter s = {keys, spare, count, parts, 32, histograms};
    for (; s.shift < 64; s.shift += 11) {
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
