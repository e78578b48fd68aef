#include "order.h"

#include <math.h>
#include <stdlib.h>

/* Radix sort, least significant digit first: 6 digits of 11 bits hold the code's 63 and the bit of those left out. */
enum { DIGIT_BITS = 11, DIGITS = 6, BUCKETS = 1 << DIGIT_BITS };

typedef struct sorter {
    fxs_order_entry *from, *to;
    uint32_t count, parts;
    int shift;                                  /* of the digit, bits */
    uint32_t (*starts)[BUCKETS];                /* of each part; first the sizes */
    const fxs_pack_report *report;
} sorter;

/* ---- Keys ------------------------------------------------------------------------------------------------------ */

static uint64_t spread_bits(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

/* 21 bits an axis. Coordinates go through t / (1 + |t|), t = 0 in the middle of the scene, so that far outliers do
   not coarsen it. */
static uint64_t morton(const fxs_pack_report *report, const float position[3])
{
    uint64_t code = 0;
    for (int i = 0; i < 3; i++) {
        double middle = (report->inner_low[i] + report->inner_high[i]) / 2;
        double half = (report->inner_high[i] - report->inner_low[i]) / 2;
        double t = (position[i] - middle) / (half > 1e-9 ? half : 1e-9);
        code |= spread_bits((uint64_t)((t / (1 + fabs(t)) + 1) * 1048575.5)) << i;
    }
    return code;
}

static uint32_t first_of(const sorter *s, uint32_t part)
{
    return (uint32_t)((uint64_t)s->count * part / s->parts);
}

static void make_keys(void *argument, uint32_t part)
{
    const sorter *s = argument;
    for (uint32_t i = first_of(s, part); i < first_of(s, part + 1); i++) {
        fxs_order_entry *e = &s->from[i];
        uint64_t code = isnan(e->position[0]) ? UINT64_MAX : morton(s->report, e->position);
        e->key.low = (uint32_t)code;
        e->key.high = (uint32_t)(code >> 32);
        e->key.index = i;
    }
}

/* ---- Sort ------------------------------------------------------------------------------------------------------ */

static uint32_t digit(const sorter *s, const fxs_order_entry *e)
{
    return (uint32_t)(((uint64_t)e->key.high << 32 | e->key.low) >> s->shift) % BUCKETS;
}

static void count_part(void *argument, uint32_t part)
{
    const sorter *s = argument;
    uint32_t *sizes = s->starts[part], end = first_of(s, part + 1);
    for (uint32_t bucket = 0; bucket < BUCKETS; bucket++)
        sizes[bucket] = 0;
    for (uint32_t i = first_of(s, part); i < end; i++)
        sizes[digit(s, &s->from[i])]++;
}

static void move_part(void *argument, uint32_t part)
{
    const sorter *s = argument;
    uint32_t *next = s->starts[part], end = first_of(s, part + 1);
    for (uint32_t i = first_of(s, part); i < end; i++)
        s->to[next[digit(s, &s->from[i])]++] = s->from[i];
}

static void find_starts(const sorter *s)
{
    uint32_t start = 0;
    for (uint32_t bucket = 0; bucket < BUCKETS; bucket++)
        for (uint32_t part = 0; part < s->parts; part++) {
            uint32_t size = s->starts[part][bucket];
            s->starts[part][bucket] = start;
            start += size;
        }
}

int fxs_order(fxs_order_entry *entries, uint32_t count, const fxs_pack_report *report,
              const fxs_pack_options *options)
{
    sorter s = {entries, fxs_allocate(options->allocator, count, sizeof *entries), count, options->threads, 0, 0, report};
    fxs_order_entry *spare = s.to;
    s.starts = fxs_allocate(options->allocator, s.parts, sizeof *s.starts);
    int status = spare && s.starts ? 0 : -1;
    if (status == 0)
        options->run(options->pool, make_keys, &s, s.parts);
    for (int i = 0; i < DIGITS && status == 0; i++) {   /* even in number: the last move ends in entries */
        s.shift = i * DIGIT_BITS;
        options->run(options->pool, count_part, &s, s.parts);
        find_starts(&s);
        options->run(options->pool, move_part, &s, s.parts);
        fxs_order_entry *moved = s.to;
        s.to = s.from;
        s.from = moved;
    }
    fxs_release(options->allocator, s.starts);
    fxs_release(options->allocator, spare);
    return status;
}
