/* Sorts Gaussians into chunks of 256 with a k-d tree, built from the top down. A run of Gaussians is cut across x, y,
 * z, or the distance from the scene's middle. The cut is where the sum of the costs of the two new boxes is smallest.
 * The cost of a box is the sum of squared position errors, in pixels, for a viewer near the middle. The order is the
 * same on every processor, because every float operation is rounded to a float. */
#include "order.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/packed.h>

enum {
    BINS = 32,                       /* bins of a position histogram; cuts are tried at bin borders */
    AXES = 3, DISTANCE = AXES, COORDINATES,
    /* top levels of the k-d tree use histograms over all Gaussians, not a sample, to catch outliers */
    WHOLE_LEVELS = 4,
    SAMPLED = 4096,
    FREE_LEVELS = 40,            /* runs of Gaussians below this level of the k-d tree are halved, to bound the depth */
    DEPTH = FREE_LEVELS + 24,
    SAMPLE = 16384,
    JOBS = 128,
    PIECES = 8,
    MANY = 1024 * FXS_CHUNK
};

#define AMONG_ITS_LIKE (1u << 31)     /* flag of an entry's index: the Gaussian is ordered separately */
#define LEAST_WIDTH 1e-30f
#define NARROW 0.25f         /* a run of Gaussians is not cut across axes narrower than this share of its widest axis */
#define WEIGHT_ONE 1073741824.0f

typedef struct stretch {
    uint32_t first, count;
    int level;
} stretch;

typedef struct order {
    fxs_order_entry *entries;
    float middle[3];
    float near_square;
    float coarse;
    stretch stretches[JOBS], halves[JOBS][2];
    uint32_t stretch_count, large;
} order;

/* A bounding box. Upper bounds are negated, so that one branch-free loop of minima widens all sides. */
typedef struct box {
    float sides[8];
    uint64_t weight;
    uint32_t count;
} box;

typedef struct cut {
    int coordinate;
    uint32_t first;
} cut;

static float sum_of(float x, float y)
{
    return (float)(x + y);
}

static float difference(float x, float y)
{
    return (float)(x - y);
}

static float product(float x, float y)
{
    return (float)(x * y);
}

static float length_square(float x, float y, float z)
{
    return sum_of(sum_of(product(x, x), product(y, y)), product(z, z));
}

static float distance_square(const order *o, const float position[3])
{
    return length_square(difference(position[0], o->middle[0]), difference(position[1], o->middle[1]),
                         difference(position[2], o->middle[2]));
}

/* Maps a squared distance from the scene's middle to a scale, by the bits of the float. The scale is logarithmic except
   near the middle. */
static float octaves(const order *o, float square)
{
    return (float)(int32_t)(fxs_ordered_bits(sum_of(square, o->near_square / 16)) >> 8);
}

static float coordinate_of(const order *o, const fxs_order_entry *e, int coordinate)
{
    return coordinate == DISTANCE ? distance_square(o, e->position) : e->position[coordinate];
}

static uint64_t key_of(const order *o, const fxs_order_entry *e, int coordinate)
{
    return (uint64_t)fxs_ordered_bits(coordinate_of(o, e, coordinate)) << 32 | e->index;
}

static void sort_apart(uint64_t *keys, uint32_t count, uint32_t gap)
{
    for (uint32_t i = gap; i < count; i++) {
        const uint64_t key = keys[i];
        uint32_t to = i;
        for (; to >= gap && keys[to - gap] > key; to -= gap)
            keys[to] = keys[to - gap];
        keys[to] = key;
    }
}

/* Sorts up to FXS_CHUNK keys by Shell sort with the gaps of Ciura (2001). */
static void sort_keys(uint64_t *keys, uint32_t count)
{
    static const uint8_t gaps[] = {57, 23, 10, 4, 1};
    for (size_t i = 0; i < sizeof gaps; i++)
        sort_apart(keys, count, gaps[i]);
}

/* Returns the pivot for quickselect. The pivot lies slightly beyond the k-th key, on the side with more keys, so that
   one pass removes most of that side. */
static uint64_t pivot_for(const order *o, const fxs_order_entry *e, uint32_t count, uint32_t k, int coordinate)
{
    enum { MOST = 64, LEAST = 5, MARGIN = 3 };
    const uint32_t tried = count < 1024 ? LEAST : MOST, margin = tried / (MOST / MARGIN);
    uint64_t keys[MOST];
    for (uint32_t i = 0; i < tried; i++)
        keys[i] = key_of(o, &e[(uint64_t)count * (2 * i + 1) / (2 * tried)], coordinate);
    sort_keys(keys, tried);
    uint32_t rank = (uint32_t)((uint64_t)k * tried / count);
    rank = 2 * rank < tried ? rank + margin : rank - margin;
    while (keys[rank] == keys[0])
        rank++;
    return keys[rank];
}

static uint32_t part(const order *o, fxs_order_entry *e, uint32_t count, int coordinate, uint64_t pivot)
{
    uint32_t below = 0;
    for (uint32_t i = 0; i < count; i++) {
        const fxs_order_entry moved = e[i];
        e[i] = e[below];
        e[below] = moved;
        below += key_of(o, &moved, coordinate) < pivot;
    }
    return below;
}

/* Moves the k Gaussians with the lowest keys to the front by quickselect. After 16 rounds, pivots bisect the range
   of keys, to bound the number of rounds. */
static void select_first(const order *o, stretch r, int coordinate, uint32_t k)
{
    fxs_order_entry *e = o->entries + r.first;
    uint32_t from = 0, to = r.count;
    uint64_t low = 0, high = UINT64_MAX;
    for (int round = 0; from < k && k < to; round++) {
        const uint64_t pivot = round < 16 ? pivot_for(o, e + from, to - from, k - from, coordinate)
                                          : low + (high - low) / 2 + 1;
        const uint32_t border = from + part(o, e + from, to - from, coordinate, pivot);
        if (border <= k) {
            from = border;
            low = pivot;
        } else {
            to = border;
            high = pivot - 1;
        }
    }
}

static void clear(box *b)
{
    for (int i = 0; i < 8; i++)
        b->sides[i] = INFINITY;
    b->weight = 0;
    b->count = 0;
}

static void sides_of(float sides[8], const fxs_order_entry *e)
{
    memcpy(sides, e, 4 * sizeof *sides);
    for (int i = 0; i < 4; i++)
        sides[4 + i] = -sides[i];
}

static void widen(box *b, const float sides[8])
{
#if defined(__GNUC__)
#pragma GCC unroll 1                 /* without the pragma, GCC unrolls the loop instead of vectorising it */
#endif
    for (int i = 0; i < 8; i++)
        b->sides[i] = sides[i] < b->sides[i] ? sides[i] : b->sides[i];
}

static void add(box *to, const box *b)
{
    widen(to, b->sides);
    to->weight += b->weight;
    to->count += b->count;
}

static float side_of(const box *b, int axis)
{
    return difference(-b->sides[4 + axis], b->sides[axis]);
}

static float cost_of(const box *b)
{
    return product(length_square(side_of(b, 0), side_of(b, 1), side_of(b, 2)), (float)b->weight);
}

/* Returns the weight of a Gaussian: 2^30 up to the median distance from the scene's middle, farther out proportional to
   1 / distance^2. */
static uint64_t weight_of(const order *o, float distance)
{
    const float share = distance > o->near_square ? o->near_square / distance : 1;
    return 1 + (uint64_t)(int64_t)(float)(share * WEIGHT_ONE);
}

typedef struct histogram {
    uint32_t step;
    float low[COORDINATES], width[COORDINATES];  /* width of the bins per coordinate; 0: no cut across the coordinate */
    box bins[COORDINATES][BINS];
} histogram;

static void find_widths(histogram *h, const order *o, const fxs_order_entry *e, uint32_t count)
{
    float nearest = INFINITY, farthest = -INFINITY;
    box all;
    clear(&all);
    for (uint32_t n = 0; n < count; n += h->step) {
        const float square = distance_square(o, e[n].position);
        float sides[8];
        sides_of(sides, &e[n]);
        widen(&all, sides);
        nearest = square < nearest ? square : nearest;
        farthest = square > farthest ? square : farthest;
    }
    for (int i = 0; i < AXES; i++) {
        h->low[i] = all.sides[i];
        h->width[i] = side_of(&all, i);
    }
    h->low[DISTANCE] = octaves(o, nearest);
    h->width[DISTANCE] = difference(octaves(o, farthest), h->low[DISTANCE]);
    for (int i = 0; i < COORDINATES; i++)
        h->width[i] = h->width[i] > LEAST_WIDTH ? h->width[i] : 0;
}

static int widest_axis(const histogram *h)
{
    int widest = 0;
    for (int i = 1; i < AXES; i++)
        widest = h->width[i] > h->width[widest] ? i : widest;
    return widest;
}

static void fill_bins(histogram *h, const order *o, const fxs_order_entry *e, uint32_t count)
{
    float scale[COORDINATES];
    int filled[COORDINATES], fills = 0;
    for (int i = 0; i < COORDINATES; i++) {
        scale[i] = h->width[i] > 0 ? BINS / h->width[i] : 0;
        if (!(scale[i] > 0))
            continue;
        filled[fills++] = i;
        for (int bin = 0; bin < BINS; bin++)
            clear(&h->bins[i][bin]);
    }
    for (uint32_t n = 0; n < count; n += h->step) {
        const float *p = e[n].position, square = distance_square(o, p);
        const float x[COORDINATES] = {p[0], p[1], p[2], octaves(o, square)};
        const uint64_t weight = weight_of(o, square);
        float sides[8];
        int32_t bins[COORDINATES];
        sides_of(sides, &e[n]);
        for (int i = 0; i < COORDINATES; i++)
            bins[i] = (int32_t)product(difference(x[i], h->low[i]), scale[i]);
        for (int i = 0; i < fills; i++) {
            const int bin = bins[filled[i]];
            box *b = &h->bins[filled[i]][bin < BINS ? bin : BINS - 1];
            widen(b, sides);
            b->weight += weight;
            b->count++;
        }
    }
}

static uint32_t whole_chunks(uint32_t before, uint32_t count)
{
    const uint32_t most = (count - 1) / FXS_CHUNK, chunks = (before + FXS_CHUNK / 2) / FXS_CHUNK;
    return (chunks < 1 ? 1 : chunks > most ? most : chunks) * FXS_CHUNK;
}

static void try_cuts(const histogram *h, int coordinate, uint32_t count, cut *best, float *least)
{
    const box *bins = h->bins[coordinate];
    box left, right[BINS];
    clear(&left);
    right[BINS - 1] = bins[BINS - 1];
    for (int bin = BINS - 2; bin > 0; bin--) {
        right[bin] = right[bin + 1];
        add(&right[bin], &bins[bin]);
    }
    for (int bin = 1; bin < BINS; bin++) {
        add(&left, &bins[bin - 1]);
        const float cost = sum_of(cost_of(&left), cost_of(&right[bin]));
        if (cost < *least) {
            *least = cost;
            *best = (cut){coordinate, whole_chunks(left.count * h->step, count)};
        }
    }
}

static cut find_cut(const order *o, stretch r)
{
    const fxs_order_entry *e = o->entries + r.first;
    histogram h;
    float least = INFINITY;
    h.step = r.level < WHOLE_LEVELS ? 1 : r.count / SAMPLED + 1;
    find_widths(&h, o, e, r.count);
    const int widest = widest_axis(&h);
    cut best = {widest, whole_chunks(r.count / 2, r.count)};
    if (r.level >= FREE_LEVELS)
        return best;
    for (int i = 0; i < AXES; i++)
        h.width[i] = h.width[i] < product(h.width[widest], NARROW) ? 0 : h.width[i];
    fill_bins(&h, o, e, r.count);
    for (int i = 0; i < COORDINATES; i++)
        if (h.width[i] > 0)
            try_cuts(&h, i, r.count, &best, &least);
    return best;
}

static void cut_stretch(const order *o, stretch r, stretch to[2])
{
    const cut c = find_cut(o, r);
    select_first(o, r, c.coordinate, c.first);
    to[0] = (stretch){r.first, c.first, r.level + 1};
    to[1] = (stretch){r.first + c.first, r.count - c.first, r.level + 1};
}

static uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 8) & 0x100f;
    x = (x | x << 4) & 0x10c3;
    return (x | x << 2) & 0x1249;
}

static uint32_t morton(const box *b, float scale, const float position[3])
{
    uint32_t code = 0;
    for (int i = 0; i < 3; i++)
        code |= spread_bits((uint32_t)(int32_t)product(difference(position[i], b->sides[i]), scale)) << i;
    return code;
}

static void sort_codes(uint64_t *keys, uint32_t count)
{
    enum { SHIFT = 32 + 15 - 8 };
    uint64_t sorted[FXS_CHUNK];
    uint16_t ends[256 + 1] = {0};
    for (uint32_t i = 0; i < count; i++)
        ends[(keys[i] >> SHIFT) + 1]++;
    for (uint32_t i = 0; i < 256; i++)
        ends[i + 1] = (uint16_t)(ends[i + 1] + ends[i]);
    for (uint32_t i = 0; i < count; i++)
        sorted[ends[keys[i] >> SHIFT]++] = keys[i];
    sort_apart(sorted, count, 1);
    memcpy(keys, sorted, count * sizeof *keys);
}

void fxs_order_chunk(fxs_order_entry *e, uint32_t count)
{
    uint64_t keys[FXS_CHUNK];
    float width = LEAST_WIDTH, sides[8];
    box b;
    clear(&b);
    for (uint32_t i = 0; i < count; i++) {
        sides_of(sides, &e[i]);
        widen(&b, sides);
    }
    for (int i = 0; i < 3; i++)
        width = side_of(&b, i) > width ? side_of(&b, i) : width;
    for (uint32_t i = 0; i < count; i++)
        keys[i] = (uint64_t)morton(&b, 31 / width, e[i].position) << 32 | e[i].index;
    sort_codes(keys, count);
    for (uint32_t i = 0; i < count; i++)
        e[i].index = (uint32_t)keys[i];
}

static box box_of(const order *o, const fxs_order_entry *e)
{
    box b;
    sides_of(b.sides, e);
    b.weight = weight_of(o, distance_square(o, e->position));
    b.count = 1;
    return b;
}

static void try_pieces(const order *o, stretch r, int coordinate, cut *best, float *least)
{
    const fxs_order_entry *e = o->entries + r.first;
    uint64_t keys[FXS_CHUNK];
    box left, right[FXS_CHUNK + 1];
    for (uint32_t i = 0; i < r.count; i++)
        keys[i] = (key_of(o, &e[i], coordinate) & ~(uint64_t)UINT32_MAX) | i;
    sort_keys(keys, r.count);
    clear(&right[r.count]);
    for (uint32_t i = r.count; i-- > 0;) {
        right[i] = box_of(o, &e[(uint32_t)keys[i]]);
        add(&right[i], &right[i + 1]);
    }
    clear(&left);
    for (uint32_t i = 1; i < r.count; i++) {
        const box one = box_of(o, &e[(uint32_t)keys[i - 1]]);
        add(&left, &one);
        const float cost = sum_of(cost_of(&left), cost_of(&right[i]));
        if (cost < *least) {
            *least = cost;
            *best = (cut){coordinate, i};
        }
    }
}

static float cost_of_leaf(const order *o, stretch r)
{
    box all;
    clear(&all);
    for (uint32_t i = r.first; i < r.first + r.count; i++) {
        const box one = box_of(o, &o->entries[i]);
        add(&all, &one);
    }
    return cost_of(&all);
}

static void cut_leaf(const order *o, stretch r, stretch *left, stretch *right)
{
    cut best = {0, 1};
    float least = INFINITY;
    for (int i = 0; i < COORDINATES; i++)
        try_pieces(o, r, i, &best, &least);
    select_first(o, r, best.coordinate, best.first);
    *left = (stretch){r.first, best.first, r.level + 1};
    *right = (stretch){r.first + best.first, r.count - best.first, r.level + 1};
}

/* Cuts a leaf of the k-d tree (256 Gaussians) into pieces. Otherwise a few distant Gaussians would widen the chunk's
   position steps to many pixels. */
static void order_leaf(const order *o, stretch r)
{
    stretch pieces[PIECES] = {r};
    float costs[PIECES] = {cost_of_leaf(o, r)};
    int count = 1, worst = 0;
    while (count < PIECES && costs[worst] > o->coarse) {
        cut_leaf(o, pieces[worst], &pieces[worst], &pieces[count]);
        costs[worst] = cost_of_leaf(o, pieces[worst]);
        costs[count] = cost_of_leaf(o, pieces[count]);
        count++;
        for (int i = 0; i < count; i++)
            worst = costs[i] > costs[worst] ? i : worst;
    }
    for (int i = 0; i < count; i++) {
        fxs_order_chunk(o->entries + pieces[i].first, pieces[i].count);
        o->entries[pieces[i].first].index |= pieces[i].first > r.first ? FXS_BEGINS_CHUNK : 0;
    }
}

static void order_stretch(const order *o, stretch r)
{
    stretch halves[2], later[DEPTH];
    int waiting = 0;
    for (;;) {
        if (r.count > FXS_CHUNK) {
            cut_stretch(o, r, halves);
            r = halves[0];
            later[waiting++] = halves[1];
            continue;
        }
        order_leaf(o, r);
        if (waiting == 0)
            return;
        r = later[--waiting];
    }
}

static void order_job(void *argument, uint32_t i)
{
    const order *o = argument;
    order_stretch(o, o->stretches[i]);
}

static void cut_job(void *argument, uint32_t i)
{
    order *o = argument;
    o->halves[i][0] = o->stretches[i];
    o->halves[i][1].count = 0;
    if (o->stretches[i].count > o->large)
        cut_stretch(o, o->stretches[i], o->halves[i]);
}

static int cut_stretches(order *o, const fxs_pack_options *options)
{
    const uint32_t before = o->stretch_count;
    options->workers.run(options->workers.pool, cut_job, o, before);
    o->stretch_count = 0;
    for (uint32_t i = 0; i < before; i++)
        for (int side = 0; side < 2; side++)
            if (o->halves[i][side].count > 0)
                o->stretches[o->stretch_count++] = o->halves[i][side];
    return o->stretch_count > before;
}

float fxs_value_of_rank(const float *values, size_t count, size_t rank)
{
    uint32_t bits = 0;
    for (int shift = 24; shift >= 0; shift -= 8) {
        size_t counts[256] = {0};
        uint32_t digit = 0;
        for (size_t i = 0; i < count; i++) {
            const uint32_t own = fxs_ordered_bits(values[i]) >> shift;
            counts[own & 255] += own >> 8 == bits;
        }
        while (rank >= counts[digit])
            rank -= counts[digit++];
        bits = bits << 8 | digit;
    }
    return fxs_ordered_float(bits);
}

static float median_coordinate(const order *o, uint32_t count, float *sample, int coordinate)
{
    const uint32_t step = (count - 1) / SAMPLE + 1;
    size_t n = 0;
    for (uint32_t i = 0; i < count; i += step)
        sample[n++] = coordinate_of(o, &o->entries[i], coordinate);
    return fxs_value_of_rank(sample, n, n / 2);
}

static void find_middle(order *o, uint32_t count, float *sample)
{
    for (int i = 0; i < 3; i++)
        o->middle[i] = median_coordinate(o, count, sample, i);
    o->near_square = median_coordinate(o, count, sample, DISTANCE);
    o->near_square = o->near_square > LEAST_WIDTH ? o->near_square : LEAST_WIDTH;
}

static uint32_t number_entries(fxs_order_entry *entries, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const fxs_order_entry e = {{entries[i].position[0], entries[i].position[1], entries[i].position[2]},
                                   i | entries[i].index * AMONG_ITS_LIKE};
        if (!isnan(e.position[0])) {
            entries[i] = entries[kept];
            entries[kept++] = e;
        } else {
            entries[i] = e;
        }
    }
    return kept;
}

static uint32_t part_by_likeness(fxs_order_entry *entries, uint32_t count)
{
    uint32_t others = 0;
    for (uint32_t i = 0; i < count; i++)
        if (!(entries[i].index & AMONG_ITS_LIKE)) {
            const fxs_order_entry e = entries[i];
            entries[i] = entries[others];
            entries[others++] = e;
        }
    for (uint32_t i = 0; i < count; i++)
        entries[i].index &= AMONG_ITS_LIKE - 1;
    return fxs_chunks_of(others);
}

/* Returns the largest cost of a leaf that is not cut further: 256 Gaussians in a box with a diagonal of `reach` times
   their distance from the scene's middle. */
static float coarse_cost(const order *o, uint32_t count, float reach)
{
    const float few = count < MANY ? (float)MANY / (float)count : 1;
    return reach > 0 ? product(product(product(product(reach, reach), few), o->near_square), FXS_CHUNK * WEIGHT_ONE)
                     : INFINITY;
}

int fxs_order(fxs_order_entry *entries, uint32_t count, float reach, const fxs_pack_options *options)
{
    float *sample = fxs_allocate(options->allocator, SAMPLE, sizeof *sample);
    order *o = fxs_allocate(options->allocator, 1, sizeof *o);
    const int status = sample && o ? 0 : FXS_ERR_MEMORY;
    const uint32_t kept = number_entries(entries, count);
    if (status == 0 && kept > 0) {
        o->entries = entries;
        find_middle(o, kept, sample);
        o->coarse = coarse_cost(o, kept, reach);
        const uint64_t others = (uint64_t)part_by_likeness(entries, kept) * FXS_CHUNK;
        const uint32_t first = others < kept ? (uint32_t)others : kept;
        o->stretches[0] = (stretch){0, first, 0};
        o->stretches[1] = (stretch){first, kept - first, 0};
        o->stretch_count = first == 0 || first == kept ? 1 : 2;
        if (first == 0)
            o->stretches[0] = o->stretches[1];
        o->large = kept / 64 > 16 * FXS_CHUNK ? kept / 64 : 16 * FXS_CHUNK;
        while (o->stretch_count <= JOBS / 2 && cut_stretches(o, options))
            ;
        options->workers.run(options->workers.pool, order_job, o, o->stretch_count);
    }
    fxs_release(options->allocator, o);
    fxs_release(options->allocator, sample);
    return status;
}
