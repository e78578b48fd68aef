/* sort: least significant digit first, three digits of 11, 11 and 10 bits of the depth. Stable, so equal depths keep the order of their
 * slots. */
#include "memory.h"
#include "stage.h"

#define DIGITS 3
#define BUCKETS 2048

static uint32_t digit(fxs_key key, int which)
{
    return (uint32_t)(key >> (32 + 11 * which)) % BUCKETS;
}

fxs_key *fxs_sort(fxs_key *keys, fxs_key *spare, uint32_t count)
{
    uint32_t next[DIGITS][BUCKETS];
    memset(next, 0, sizeof next);
    for (uint32_t i = 0; i < count; i++)
        for (int d = 0; d < DIGITS; d++)
            next[d][digit(keys[i], d)]++;
    for (int d = 0; d < DIGITS; d++) {
        if (!count || next[d][digit(keys[0], d)] == count)   /* all keys agree in this digit */
            continue;
        uint32_t start = 0;
        for (int b = 0; b < BUCKETS; b++) {
            uint32_t size = next[d][b];
            next[d][b] = start;
            start += size;
        }
        for (uint32_t i = 0; i < count; i++)
            spare[next[d][digit(keys[i], d)]++] = keys[i];
        fxs_key *sorted = spare;
        spare = keys;
        keys = sorted;
    }
    return keys;
}
