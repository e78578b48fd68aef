/* Blends a tile with depths, ids or an occluder. The kernel `trace` blends a tile's list of splats in parts. The depths
 * of a part lie in one octave, so that 16-bit numbers suffice. After each part, the 16-bit depths are added to 64-bit
 * sums. Entry numbers, which also have 16 bits, are converted to splat indices. */
#include "draw.h"
#include "memory.h"
#include "targets.h"
#include "trace.h"

#define STRETCH 32767u             /* a list's entries are numbered in stretches of at most STRETCH, so that the numbers
                                      fit in 16 bits */
#define PART 512u
#define AHEAD 16

typedef struct tracer {
    const fxs_frame *f;
    const fxs_targets *targets;
    int bits;                      /* number of fraction bits of the depths in the caller's images */
    const uint32_t *list;
    uint32_t count;
    uint32_t first, end;
    fxs_trace trace;
    int16_t before_q15[FXS_TILE_PIXELS];
    int16_t codes_q15[PART];       /* coded depths of the splats in a part: depth / 2^octave - 1, Q15 */
    uint32_t keys[PART];
    uint32_t limits[FXS_TILE_PIXELS];      /* depth of the occluder at each pixel, as a sort key; farther splats are
                                              hidden */
    uint64_t sums[FXS_TILE_PIXELS];
    uint32_t median[FXS_TILE_PIXELS], largest[FXS_TILE_PIXELS];
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

static int trace_stretch(tracer *t, int32_t x, int32_t y, fxs_tile *tile)
{
    int open = 1;
    memset(t->trace.median, 0xff, sizeof t->trace.median);
    memset(t->trace.largest, 0xff, sizeof t->trace.largest);
    for (t->first = 0; t->first < t->count && open; t->first = t->end) {
        begin_part(t);
        reset_part(t, tile);
        t->f->context->config.kernels->trace(&t->f->view, x, y, t->f->splats, t->list, t->codes_q15, t->first, t->end,
                                             tile,
                                     &t->trace);
        open = end_part(t, tile);
    }
    if (t->trace.which & FXS_TRACE_MEDIAN)
        note_slots(t, t->trace.median, t->median);
    if (t->trace.which & FXS_TRACE_ID)
        note_slots(t, t->trace.largest, t->largest);
    return open;
}

static void read_limits(tracer *t, int32_t x, int32_t y, int32_t columns, int32_t rows)
{
    const fxs_image *occluder = &t->targets->occluder;
    memset(t->limits, 0xff, sizeof t->limits);
    for (int32_t row = 0; row < rows && occluder->pixels; row++) {
        const uint32_t *depths = (const uint32_t *)(const void *)fxs_image_at(occluder, x, y + row, 4);
        for (int32_t column = 0; column < columns; column++)
            t->limits[row * FXS_TILE + column] = fxs_depth_key(depths[column], t->bits);
    }
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

static void write_row(const tracer *t, const fxs_tile *tile, int32_t x, int32_t y, int32_t columns, int first)
{
    const fxs_targets *targets = t->targets;
    const int16_t *transmittance_q15 = tile->transmittance_q15 + first;
    if (targets->mean_depth.pixels) {
        uint32_t *means = (uint32_t *)(void *)fxs_image_at(&targets->mean_depth, x, y, 4);
        for (int32_t i = 0; i < columns; i++)
            means[i] = fxs_mean_depth(t->sums[first + i], transmittance_q15[i]);
    }
    if (targets->median_depth.pixels) {
        uint32_t *medians = (uint32_t *)(void *)fxs_image_at(&targets->median_depth, x, y, 4);
        for (int32_t i = 0; i < columns; i++)
            medians[i] = transmittance_q15[i] >= FXS_HALF_Q15
                             ? FXS_NOTHING : fxs_depth_of_key(t->f->depths[t->median[first + i]], t->bits);
    }
    if (targets->id.pixels) {
        fxs_id *ids = (fxs_id *)(void *)fxs_image_at(&targets->id, x, y, 8);
        const fxs_object_view *object = t->f->views;
        for (int32_t i = 0; i < columns; i++)
            ids[i] = id_of(t->f, t->largest[first + i], &object);
    }
}

static unsigned which_of(const fxs_targets *targets, const uint32_t *slots)
{
    return (targets->mean_depth.pixels ? FXS_TRACE_MEAN : 0u) | (targets->median_depth.pixels ? FXS_TRACE_MEDIAN : 0u) |
           (targets->id.pixels || slots ? FXS_TRACE_ID : 0u) | (targets->occluder.pixels ? FXS_TRACE_END : 0u);
}

void fxs_trace_tile(const fxs_frame *f, const fxs_list *list, int32_t x, int32_t y, fxs_tile *pixels, uint32_t *slots)
{
    tracer t;
    const fxs_stage_view *view = &f->view;
    const int32_t columns = fxs_min(FXS_TILE, view->width - x), rows = fxs_min(FXS_TILE, view->height - y);
    int open = 1;
    t.f = f;
    t.targets = f->targets;
    t.bits = fxs_depth_bits(t.targets);
    t.trace.which = which_of(t.targets, slots);
    fxs_tile_clear(pixels);
    read_limits(&t, x, y, columns, rows);
    memset(t.sums, 0, sizeof t.sums);
    memset(t.median, 0xff, sizeof t.median);
    memset(t.largest, 0xff, sizeof t.largest);
    memset(t.trace.weight_q15, 0, sizeof t.trace.weight_q15);
    for (uint32_t done = 0; done < list->count && open; done += t.count) {
        t.list = list->entries + done;
        t.count = list->count - done < STRETCH ? list->count - done : STRETCH;
        open = trace_stretch(&t, x, y, pixels);
    }
    for (int32_t row = 0; row < rows; row++)
        write_row(&t, pixels, x, y + row, columns, row * FXS_TILE);
    if (slots)
        memcpy(slots, t.largest, sizeof t.largest);
}
