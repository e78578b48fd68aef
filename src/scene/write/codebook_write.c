/* Learns the codebooks of a .sog file. Codebooks of scalars use Lloyd's quantiser over a histogram. The SH palette uses
   k-means in two steps. */
#include "codebook_internal.h"
#include "src/base/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/exponential.h"

enum {
    BINS = 65536, GROUP = 64, GROUPS = BINS / GROUP,
    CELLS = 32,
    BOOK_ROUNDS = 30
};

typedef struct bin {
    double sum, count;
    double mean, weight;
} bin;

static int fill_bins(bin *bins, const float *values, size_t count, double power, double low, double high)
{
    const double scale = high > low ? (BINS - 1) / (high - low) : 0;
    int used = 0;
    for (size_t i = 0; i < count; i++) {
        bin *b = &bins[(int)((values[i] - low) * scale + 0.5)];
        b->count++;
        b->sum += values[i];
    }
    for (bin *b = bins; b < bins + BINS; b++) {
        if (!(b->count > 0))
            continue;
        used++;
        b->mean = b->sum / b->count;
        b->weight = fxs_exp(power * b->mean);
    }
    return used;
}

static void copy_bins(float book[FXS_BOOK], const bin *bins)
{
    int at = 0;
    for (int i = 0; i < BINS; i++)
        if (bins[i].count > 0)
            book[at++] = (float)bins[i].mean;
    for (; at < FXS_BOOK; at++)
        book[at] = book[at - 1];
}

/* Computes how densely to place codebook entries. The cube root of the weights is optimal for many entries (Panter and
   Dite 1951). */
static double find_densities(double densities[GROUPS], const bin *bins)
{
    enum { CELL = GROUPS / CELLS };
    double cells[CELLS] = {0}, total = 0, raised = 0;
    for (int g = 0; g < GROUPS; g++) {
        double weight = 0;
        for (const bin *b = bins + g * GROUP; b < bins + (g + 1) * GROUP; b++)
            weight += b->count * b->weight;
        densities[g] = weight > 0 ? fxs_exp(fxs_log(weight) / 3) : 0;
        cells[g / CELL] += densities[g];
        total += densities[g];
    }
    const double least = total / (FXS_BOOK - CELLS);
    for (int g = 0; g < GROUPS; g++) {
        const double cell = cells[g / CELL];
        densities[g] *= cell > 0 && cell < least ? least / cell : 1;
        raised += densities[g];
    }
    return raised;
}

static void begin_book(float book[FXS_BOOK], const bin *bins, double low, double high)
{
    double densities[GROUPS], passed = 0;
    const double total = find_densities(densities, bins);
    int at = 0;
    for (int g = 0; g < GROUPS; g++) {
        for (; at < FXS_BOOK && (at + 0.5) / FXS_BOOK * total <= passed + densities[g]; at++) {
            const double within = ((at + 0.5) / FXS_BOOK * total - passed) / densities[g];
            book[at] = (float)(low + (high - low) * (g + within) / GROUPS);
        }
        passed += densities[g];
    }
    for (; at < FXS_BOOK; at++)
        book[at] = (float)high;
}

/* Moves each codebook entry to the weighted mean of its nearest values. A value below its entry gets the entry's larger
   weight, because a reader sees only the entry. */
static void improve_book(float book[FXS_BOOK], const bin *bins, double power)
{
    struct { double sum, weight, own; } sums[FXS_BOOK];
    int at = 0;
    for (int k = 0; k < FXS_BOOK; k++) {
        sums[k].sum = sums[k].weight = 0;
        sums[k].own = fxs_exp(power * book[k]);
    }
    for (const bin *b = bins; b < bins + BINS; b++) {
        if (!(b->count > 0))
            continue;
        while (at < FXS_BOOK - 1 && b->mean > ((double)book[at] + book[at + 1]) / 2)
            at++;
        const double weight = b->weight > sums[at].own ? b->weight : sums[at].own;
        sums[at].sum += weight * b->sum;
        sums[at].weight += weight * b->count;
    }
    for (int k = 0; k < FXS_BOOK; k++)
        book[k] = sums[k].weight > 0 ? (float)(sums[k].sum / sums[k].weight) : book[k];
}

int fxs_book_learn(float book[FXS_BOOK], const float *values, size_t count, double power)
{
    bin *bins = calloc(BINS, sizeof *bins);
    double low = INFINITY, high = -INFINITY;
    if (!bins)
        return -1;
    for (size_t i = 0; i < count; i++) {
        low = values[i] < low ? values[i] : low;
        high = values[i] > high ? values[i] : high;
    }
    const int used = fill_bins(bins, values, count, power, low, high);
    if (used > FXS_BOOK) {
        begin_book(book, bins, low, high);
        for (int round = 0; round < BOOK_ROUNDS; round++)
            improve_book(book, bins, power);
    } else if (used) {
        copy_bins(book, bins);
    }
    free(bins);
    return 0;
}

uint8_t fxs_book_find(const float book[FXS_BOOK], float value)
{
    int low = 0, high = FXS_BOOK - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (value > ((double)book[middle] + book[middle + 1]) / 2)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint8_t)low;
}

enum {
    WIDTH = FXS_SH_PALETTE_STRIDE,
    SAMPLE = 16384,
    COARSE_ROUNDS = 8, FINE_ROUNDS = 5
};

typedef struct cluster {
    const fxs_sh_palette_vector *vectors;
    const uint32_t *members;
    uint32_t count, entries;
    fxs_sh_palette_vector *means;
    int32_t *half_squares;
    uint32_t *nearest;
} cluster;

static int32_t dot(const int16_t *restrict a, const int16_t *restrict b)
{
    int32_t sum = 0;
    for (int d = 0; d < WIDTH; d++)
        sum += a[d] * b[d];
    return sum;
}

/* Gives each SH vector x to the nearest mean m. Half the squared distance is |x - m|^2 / 2 = |x|^2 / 2 + |m|^2 / 2 - x
   m. It is below 2^31, because components are below 2^12. */
static void share_out(const cluster *c)
{
    for (uint32_t e = 0; e < c->entries; e++)
        c->half_squares[e] = dot(c->means[e], c->means[e]) / 2;
    for (uint32_t i = 0; i < c->count; i++) {
        const int16_t *x = c->vectors[c->members[i]];
        int32_t least = INT32_MAX;
        for (uint32_t e = 0; e < c->entries; e++) {
            const int32_t cost = c->half_squares[e] - dot(x, c->means[e]);
            c->nearest[i] = cost < least ? e : c->nearest[i];
            least = cost < least ? cost : least;
        }
    }
}

static int16_t mean_of(int64_t sum, int64_t count)
{
    return (int16_t)((2 * sum + (sum < 0 ? -count : count)) / (2 * count));
}

static void find_means(const cluster *c, int64_t (*sums)[WIDTH + 1])
{
    memset(sums, 0, c->entries * sizeof *sums);
    for (uint32_t i = 0; i < c->count; i++) {
        int64_t *sum = sums[c->nearest[i]];
        for (int d = 0; d < WIDTH; d++)
            sum[d] += c->vectors[c->members[i]][d];
        sum[WIDTH]++;
    }
    for (uint32_t e = 0; e < c->entries; e++)
        for (int d = 0; d < WIDTH && sums[e][WIDTH]; d++)
            c->means[e][d] = mean_of(sums[e][d], sums[e][WIDTH]);
}

/* Learns the means of a cluster from evenly spaced members, because similar members lie together. */
static int learn(const cluster *c, int rounds)
{
    int64_t (*sums)[WIDTH + 1] = malloc(c->entries * sizeof *sums);
    if (!sums)
        return -1;
    for (uint32_t e = 0; e < c->entries; e++)
        memcpy(c->means[e], c->vectors[c->members[(uint64_t)e * c->count / c->entries]], sizeof *c->means);
    share_out(c);
    for (int round = 0; round < rounds && c->entries < c->count; round++) {
        find_means(c, sums);
        share_out(c);
    }
    free(sums);
    return 0;
}

uint32_t fxs_sh_palette_entries(uint32_t count)
{
    uint32_t entries = 1;
    while (entries < FXS_SH_PALETTE_MOST && 2 * entries <= count)
        entries *= 2;
    return entries;
}

typedef struct work {
    fxs_sh_palette_vector coarse[256];
    uint32_t starts[257];
    int32_t half_squares[FXS_SH_PALETTE_MOST];
    uint32_t *members, *nearest;
    const fxs_progress *progress;
} work;

static uint32_t find_coarse(work *w, const fxs_sh_palette_vector *vectors, uint32_t count, uint32_t entries)
{
    const uint32_t step = count / SAMPLE + 1;
    cluster c = {vectors, w->members, 0, 1, w->coarse, w->half_squares, w->nearest};
    while (c.entries * c.entries * 4 <= entries)
        c.entries *= 2;
    for (uint32_t i = 0; i < count; i += step)
        w->members[c.count++] = i;
    if (learn(&c, COARSE_ROUNDS))
        return 0;
    for (uint32_t i = 0; i < count; i++)
        w->members[i] = i;
    c.count = count;
    share_out(&c);
    return c.entries;
}

static void sort_members(work *w, uint32_t coarse, uint32_t count)
{
    uint32_t next[256];
    memset(w->starts, 0, sizeof w->starts);
    for (uint32_t i = 0; i < count; i++)
        w->starts[w->nearest[i] + 1]++;
    for (uint32_t k = 0; k < coarse; k++) {
        w->starts[k + 1] += w->starts[k];
        next[k] = w->starts[k];
    }
    for (uint32_t i = 0; i < count; i++)
        w->members[next[w->nearest[i]]++] = i;
}

/* Gives each coarse cluster one palette entry, and shares out the other entries in proportion to the cluster's
   members. */
static int find_fine(work *w, uint32_t coarse, fxs_sh_palette_vector *palette, uint32_t entries, uint32_t *labels,
                     const fxs_sh_palette_vector *vectors, uint32_t count)
{
    uint32_t first = 0;
    for (uint32_t k = 0; k < coarse; k++) {
        const uint32_t start = w->starts[k], own = w->starts[k + 1] - start;
        const uint32_t share = 1 + (uint32_t)((uint64_t)(entries - coarse) * own / count);
        const cluster c = {vectors, w->members + start, own, share < own ? share : own, palette + first,
                           w->half_squares, w->nearest};
        if (!own)
            continue;
        if (learn(&c, FINE_ROUNDS) || (fxs_report(w->progress, (double)(start + own) / count)))
            return -1;
        for (uint32_t i = 0; i < own; i++)
            labels[c.members[i]] = first + c.nearest[i];
        first += c.entries;
    }
    return 0;
}

int fxs_sh_palette_learn(fxs_sh_palette_vector *palette, uint32_t entries, uint32_t *labels,
                         const fxs_sh_palette_vector *vectors, uint32_t count, const fxs_progress *progress)
{
    work *w = malloc(sizeof *w);
    uint32_t *members = malloc(((size_t)count + 1) * sizeof *members);
    uint32_t *nearest = malloc(((size_t)count + 1) * sizeof *nearest);
    int result = -1;
    if (w && members && nearest) {
        w->members = members;
        w->nearest = nearest;
        w->progress = progress;
        memset(palette, 0, entries * sizeof *palette);
        const uint32_t coarse = find_coarse(w, vectors, count, entries);
        if (coarse) {
            sort_members(w, coarse, count);
            result = find_fine(w, coarse, palette, entries, labels, vectors, count);
        }
    }
    free(members);
    free(nearest);
    free(w);
    return result;
}
