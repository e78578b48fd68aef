/* Blends a tile with depths, ids or an occluder. The kernel `trace` blends a tile's list of splats in parts. The depths
 * of a part lie in one octave, so that 16-bit numbers suffice. After each part, the 16-bit depths are added to 64-bit
 * sums. Entry numbers, which also have 16 bits, are converted to splat indices. */
#include "draw.h"
#include "memory.h"
#include "targets.h"
#include "tile_rates.h"
#include "trace.h"

#define STRETCH 32767u             /* a list's entries are numbered in stretches of at most STRETCH, so that the numbers
                                      fit in 16 bits */
#define PART 512u
#define AHEAD 16
#define FARTHER 48u
#define SOME 64u                   /* splats that are changed to a rate above 1 at once */

typedef struct tracer {
    const fxs_frame *f;
    const fxs_targets *targets;
    int32_t x, y, shift;           /* first pixel of the tile, log2 of its rate */
    int32_t columns, first_row, end_row;   /* samples to draw */
    int bits;                      /* number of fraction bits of the depths in the caller's images */
    const uint32_t *list;
    uint32_t count, left;          /* entries of the stretch, and of it with all later stretches */
    uint32_t first, end;
    fxs_trace trace;
    int16_t before_q15[FXS_TILE_PIXELS];
    int16_t codes_q15[PART];       /* coded depths of the splats in a part: depth / 2^octave - 1, Q15 */
    uint32_t keys[PART];
    uint32_t limits[FXS_TILE_PIXELS];      /* depth of the occluder at each pixel, as a sort key; farther splats are
                                              hidden */
    uint64_t sums[FXS_TILE_PIXELS];
    uint32_t median[FXS_TILE_PIXELS], largest[FXS_TILE_PIXELS];
    fxs_splat changed[SOME];
    uint32_t numbers[SOME];
} tracer;

static uint32_t slot_of(uint32_t entry)
{
    return entry & ~FXS_ENTRY_CUT_OFF;
}

static void begin_part(tracer *t)
{
    const uint32_t *depths = t->f->depths;
    const int one_octave = t->trace.which & FXS_TRACE_MEAN;
    const int needs_keys = t->trace.which & (FXS_TRACE_MEAN | FXS_TRACE_END);
    const uint32_t rest = t->count - t->first, most = needs_keys && rest > PART ? PART : rest;
    uint32_t n = needs_keys ? 0 : most;
    for (; n < most; n++) {
        if (n + AHEAD < most)
            FXS_PREFETCH(&depths[slot_of(t->list[t->first + n + AHEAD])]);
        const uint32_t key = depths[slot_of(t->list[t->first + n])];
        if (one_octave && n && key >> 26 != t->keys[0] >> 26)
            break;
        t->keys[n] = key;
        t->codes_q15[n] = (int16_t)fxs_depth_code_q15(key);
    }
    t->end = t->first + n;
}

/* Returns the number of the first list entry with a depth key above `limit`, or INT16_MAX for none. */
static int16_t end_of(const tracer *t, uint32_t limit)
{
    uint32_t low = 0, high = t->end - t->first;
    if (t->keys[high - 1] <= limit)
        return INT16_MAX;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if (t->keys[middle] <= limit)
            low = middle + 1;
        else
            high = middle;
    }
    return (int16_t)(t->first + low);
}

static void reset_part(tracer *t, const fxs_tile *tile)
{
    if (t->trace.which & FXS_TRACE_MEAN) {
        memset(t->trace.depth_q15, 0, sizeof t->trace.depth_q15);
        memcpy(t->before_q15, tile->transmittance_q15, sizeof t->before_q15);
    }
    for (int i = 0; i < FXS_TILE_PIXELS && t->trace.which & FXS_TRACE_END; i++)
        t->trace.end[i] = end_of(t, t->limits[i]);
}

static void add_depths(tracer *t, const fxs_tile *tile)
{
    for (int i = 0; i < FXS_TILE_PIXELS; i++) {
        const int weight_q15 = t->before_q15[i] - tile->transmittance_q15[i];
        t->sums[i] += fxs_depth_sum((uint32_t)(weight_q15 + t->trace.depth_q15[i]), t->keys[0], t->bits);
    }
}

/* Converts the number of each pixel's list entry to the index of its splat. The number -1 leaves the index
   unchanged. */
static void note_slots(const tracer *t, const int16_t numbers[FXS_TILE_PIXELS], uint32_t slots[FXS_TILE_PIXELS])
{
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        slots[i] = numbers[i] < 0 ? slots[i] : slot_of(t->list[numbers[i]]);
}

static int end_part(tracer *t, const fxs_tile *tile)
{
    int open = 0;
    if (t->trace.which & FXS_TRACE_MEAN)
        add_depths(t, tile);
    const uint32_t last = t->trace.which & FXS_TRACE_END ? t->keys[t->end - t->first - 1] : 0;
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        open |= (tile->transmittance_q15[i] >= FXS_CLOSED_Q15) & (t->limits[i] >= last);
    return open;
}

/* Changes the splats of a list with a rate r above 1. The sample (i, j), which the kernel takes for pixel (i, j) of a
   tile at (0, 0), is at pixel (x + r i + r / 2, y + r j + r / 2). So u = u0 + X ux + Y uy, modulo 2^32, stays exact. */
static void change_splats(tracer *t)
{
    const uint32_t x = (uint32_t)(t->x + fxs_rate_pixel(t->shift)), y = (uint32_t)(t->y + fxs_rate_pixel(t->shift));
    const int32_t rate = 1 << t->shift;
    for (uint32_t n = 0; n < t->count; n++) {
        if (n + FARTHER < t->left)
            FXS_PREFETCH(&t->f->splats[slot_of(t->list[n + FARTHER])]);
        fxs_splat s = t->f->splats[slot_of(t->list[n])];
        s.u0_q24 += x * (uint32_t)s.ux_q24 + y * (uint32_t)s.uy_q24;
        s.v0_q24 += y * (uint32_t)s.vy_q24;
        s.ux_q24 *= rate;          /* below 2^27, as |ux|, |uy| and vy are at most 1.83 */
        s.uy_q24 *= rate;
        s.vy_q24 *= rate;
        s.first_row = (uint16_t)(s.first_row > t->y ? (s.first_row - t->y) >> t->shift : 0);
        s.last_row = (uint16_t)(s.last_row > t->y ? (s.last_row - t->y) >> t->shift : 0);
        t->changed[n] = s;
        t->numbers[n] = n;
    }
}

static int trace_stretch(tracer *t, fxs_tile *tile)
{
    const int changed = t->shift > 0;
    int open = 1;
    if (changed)
        change_splats(t);
    memset(t->trace.median, 0xff, sizeof t->trace.median);
    memset(t->trace.largest, 0xff, sizeof t->trace.largest);
    for (t->first = 0; t->first < t->count && open; t->first = t->end) {
        begin_part(t);
        reset_part(t, tile);
        t->f->context->config.kernels->trace(&t->f->view, changed ? 0 : t->x, changed ? 0 : t->y,
                                             changed ? t->changed : t->f->splats, changed ? t->numbers : t->list,
                                             t->codes_q15, t->first, t->end, tile, &t->trace);
        open = end_part(t, tile);
    }
    if (t->trace.which & FXS_TRACE_MEDIAN)
        note_slots(t, t->trace.median, t->median);
    if (t->trace.which & FXS_TRACE_ID)
        note_slots(t, t->trace.largest, t->largest);
    return open;
}

static void read_limits(tracer *t)
{
    const fxs_image *occluder = &t->targets->occluder;
    const int32_t x = t->x + fxs_rate_pixel(t->shift), y = t->y + fxs_rate_pixel(t->shift);
    memset(t->limits, 0xff, sizeof t->limits);
    for (int32_t row = t->first_row; row < t->end_row && occluder->pixels; row++) {
        const uint32_t *depths = (const uint32_t *)(const void *)fxs_image_at(occluder, x, y + (row << t->shift), 4);
        for (int32_t column = 0; column < t->columns; column++)
            t->limits[row * FXS_TILE + column] = fxs_depth_key(depths[column << t->shift], t->bits);
    }
}

/* Sets the samples to draw. Of a macro tile, closes the others: they may be outside the band or the picture, or are not
   needed. */
static void set_samples(tracer *t, fxs_tile *samples)
{
    const fxs_frame *f = t->f;
    const int32_t side = t->shift ? FXS_RATE_PIXELS : FXS_TILE, first = f->first_row * FXS_TILE - t->y;
    const int32_t end = fxs_min(f->view.height, f->end_row * FXS_TILE) - t->y;
    t->columns = fxs_min(side, f->view.width - t->x) >> t->shift;
    t->first_row = (first > 0 ? first : 0) >> t->shift;
    t->end_row = fxs_min(side, end) >> t->shift;
    fxs_tile_clear(samples);
    for (int32_t i = 0; i < FXS_TILE_PIXELS && t->shift; i++)
        if (i % FXS_TILE >= t->columns || i / FXS_TILE < t->first_row || i / FXS_TILE >= t->end_row)
            samples->transmittance_q15[i] = 0;
}

fxs_id fxs_id_of(const fxs_object_view *objects, uint32_t count, uint32_t index, const fxs_object_view **object)
{
    if (index / FXS_CHUNK < (*object)->first_chunk || index / FXS_CHUNK >= (*object)->end_chunk)
        *object = &objects[fxs_object_of(objects, count, index / FXS_CHUNK)];
    return (fxs_id){(*object)->id, index - (*object)->first_chunk * FXS_CHUNK};
}

static fxs_id id_of(const fxs_frame *f, uint32_t slot, const fxs_object_view **object)
{
    return slot == FXS_NOTHING ? (fxs_id){FXS_NOTHING, FXS_NOTHING}
                               : fxs_id_of(f->views, f->object_count, f->indices[slot], object);
}

static void write_row(const tracer *t, const fxs_tile *tile, int32_t row)
{
    const fxs_targets *targets = t->targets;
    const int32_t x = t->x, y = t->y + row, columns = t->columns << t->shift, shift = t->shift;
    const int first = (row >> shift) * FXS_TILE;
    const int16_t *transmittance_q15 = tile->transmittance_q15 + first;
    if (targets->mean_depth.pixels) {
        uint32_t *means = (uint32_t *)(void *)fxs_image_at(&targets->mean_depth, x, y, 4);
        for (int32_t i = 0; i < columns; i++)
            means[i] = fxs_mean_depth(t->sums[first + (i >> shift)], transmittance_q15[i >> shift]);
    }
    if (targets->median_depth.pixels) {
        uint32_t *medians = (uint32_t *)(void *)fxs_image_at(&targets->median_depth, x, y, 4);
        for (int32_t i = 0; i < columns; i++)
            medians[i] = transmittance_q15[i >> shift] >= FXS_HALF_Q15
                             ? FXS_NOTHING : fxs_depth_of_key(t->f->depths[t->median[first + (i >> shift)]], t->bits);
    }
    if (targets->id.pixels) {
        fxs_id *ids = (fxs_id *)(void *)fxs_image_at(&targets->id, x, y, 8);
        const fxs_object_view *object = t->f->views;
        for (int32_t i = 0; i < columns; i++)
            ids[i] = id_of(t->f, t->largest[first + (i >> shift)], &object);
    }
}

static unsigned which_of(const fxs_targets *targets, const uint32_t *slots)
{
    return (targets->mean_depth.pixels ? FXS_TRACE_MEAN : 0u) | (targets->median_depth.pixels ? FXS_TRACE_MEDIAN : 0u) |
           (targets->id.pixels || slots ? FXS_TRACE_ID : 0u) | (targets->occluder.pixels ? FXS_TRACE_END : 0u);
}

void fxs_trace_tile(const fxs_frame *f, const fxs_list *list, int32_t x, int32_t y, int shift, fxs_tile *samples,
                    uint32_t *slots)
{
    tracer t;
    const uint32_t most = shift ? SOME : STRETCH;
    int open = 1;
    t.f = f;
    t.x = x;
    t.y = y;
    t.shift = shift;
    t.targets = f->targets;
    t.bits = fxs_depth_bits(t.targets);
    t.trace.which = which_of(t.targets, slots);
    set_samples(&t, samples);
    read_limits(&t);
    memset(t.sums, 0, sizeof t.sums);
    memset(t.median, 0xff, sizeof t.median);
    memset(t.largest, 0xff, sizeof t.largest);
    memset(t.trace.weight_q15, 0, sizeof t.trace.weight_q15);
    for (uint32_t done = 0; done < list->count && open; done += t.count) {
        t.list = list->entries + done;
        t.left = list->count - done;
        t.count = t.left < most ? t.left : most;
        open = trace_stretch(&t, samples);
    }
    for (int32_t row = t.first_row << shift; row < t.end_row << shift; row++)
        write_row(&t, samples, row);
    if (slots)
        memcpy(slots, t.largest, sizeof t.largest);
}
