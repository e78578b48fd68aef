/* trace: blend, for targets of depth and id and with an occluder. A tile's list is blended part by part. Within a part
 * depths are in one octave, so that a code of 15 bits holds them; between parts, what was kept of the pixels is
 * added up. */
#include "frame.h"
#include "memory.h"

#define PART 512u                  /* entries, at most */

typedef struct tracer {
    const fxs_frame *f;
    const fxs_targets *targets;
    const uint32_t *list;
    uint32_t count;
    int bits;                      /* of the depths of the targets and the occluder */
    uint32_t first, end;           /* the part of the list */
    fxs_trace trace;
    int16_t before_q15[FXS_TILE_PIXELS];   /* T before the part */
    int16_t codes_q15[PART];       /* depth / 2^octave - 1 */
    uint32_t keys[PART];
    uint32_t limits[FXS_TILE_PIXELS];      /* depth keys: what is farther is hidden */
    uint64_t sums[FXS_TILE_PIXELS];        /* fxs_depth_sum */
    uint32_t median[FXS_TILE_PIXELS], largest[FXS_TILE_PIXELS];   /* slots */
} tracer;

static uint32_t slot_of(uint32_t entry)
{
    return entry & ~FXS_ENTRY_FAR;
}

/* ---- A part of the list ------------------------------------------------------------------------------------------ */

static void begin_part(tracer *t)
{
    const uint32_t *depths = t->f->eye->depths;
    const uint32_t most = t->count - t->first < PART ? t->count - t->first : PART;
    const int one_octave = t->targets->mean_depth.pixels != 0;
    uint32_t n = 0;
    for (; n < most; n++) {
        const uint32_t key = depths[slot_of(t->list[t->first + n])];
        if (one_octave && n && key >> 26 != t->keys[0] >> 26)
            break;
        t->keys[n] = key;
        t->codes_q15[n] = (int16_t)fxs_depth_code_q15(key);
    }
    t->end = t->first + n;
}

/* How many of the part's entries are no farther than a limit. */
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
    return (int16_t)low;
}

static void reset_trace(tracer *t)
{
    memset(t->trace.depth_q15, 0, sizeof t->trace.depth_q15);
    memset(t->trace.median, 0xff, sizeof t->trace.median);
    memset(t->trace.largest, 0xff, sizeof t->trace.largest);
    for (int i = 0; i < FXS_TILE_PIXELS && t->targets->occluder.pixels; i++)
        t->trace.end[i] = end_of(t, t->limits[i]);
}

static void add_depths(tracer *t, const fxs_tile *tile)
{
    for (int i = 0; i < FXS_TILE_PIXELS; i++) {
        const int weight_q15 = t->before_q15[i] - tile->transmittance_q15[i];
        t->sums[i] += fxs_depth_sum((uint32_t)(weight_q15 + t->trace.depth_q15[i]), t->keys[0], t->bits);
    }
}

/* Returns whether a pixel takes more. */
static int end_part(tracer *t, const fxs_tile *tile)
{
    const uint32_t *part = t->list + t->first, last = t->keys[t->end - t->first - 1];
    int open = 0;
    if (t->targets->mean_depth.pixels)
        add_depths(t, tile);
    for (int i = 0; i < FXS_TILE_PIXELS; i++) {
        if (t->trace.median[i] >= 0)
            t->median[i] = slot_of(part[t->trace.median[i]]);
        if (t->trace.largest[i] >= 0)
            t->largest[i] = slot_of(part[t->trace.largest[i]]);
        open |= tile->transmittance_q15[i] >= FXS_CLOSED_Q15 && t->limits[i] >= last;
    }
    return open;
}

/* ---- Targets ----------------------------------------------------------------------------------------------------- */

static void read_limits(tracer *t, int32_t x, int32_t y, int32_t columns, int32_t rows)
{
    const fxs_image *occluder = &t->targets->occluder;
    memset(t->limits, 0xff, sizeof t->limits);
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        t->trace.end[i] = INT16_MAX;
    for (int32_t row = 0; row < rows && occluder->pixels; row++) {
        const uint32_t *depths = (const uint32_t *)(const void *)fxs_image_at(occluder, x, y + row, 4);
        for (int32_t column = 0; column < columns; column++)
            t->limits[row * FXS_TILE + column] = fxs_depth_key(depths[column], t->bits);
    }
}

static fxs_id id_of(const fxs_frame *f, uint32_t slot)
{
    if (slot == FXS_NOTHING)
        return (fxs_id){FXS_NOTHING, FXS_NOTHING};
    const uint32_t index = f->indices[slot];
    const fxs_object_view *object = &f->eye->objects[fxs_frame_object(f, index / FXS_CHUNK)];
    return (fxs_id){object->id, index - object->first_chunk * FXS_CHUNK};
}

static void write_pixel(const tracer *t, const fxs_tile *tile, int32_t x, int32_t y, int i)
{
    const fxs_targets *targets = t->targets;
    const int transmittance_q15 = tile->transmittance_q15[i];
    if (targets->mean_depth.pixels)
        *(uint32_t *)(void *)fxs_image_at(&targets->mean_depth, x, y, 4) =
            fxs_mean_depth(t->sums[i], transmittance_q15);
    if (targets->median_depth.pixels)
        *(uint32_t *)(void *)fxs_image_at(&targets->median_depth, x, y, 4) =
            transmittance_q15 < FXS_HALF_Q15 ? fxs_depth_of_key(t->f->eye->depths[t->median[i]], t->bits) : FXS_NOTHING;
    if (targets->id.pixels)
        *(fxs_id *)(void *)fxs_image_at(&targets->id, x, y, 8) = id_of(t->f, t->largest[i]);
}

void fxs_trace_tile(const fxs_frame *f, uint32_t tile, int32_t x, int32_t y, fxs_tile *pixels, uint32_t *slots)
{
    tracer t;
    const fxs_view *view = &f->eye->view;
    const int32_t columns = fxs_min(FXS_TILE, view->width - x), rows = fxs_min(FXS_TILE, view->height - y);
    int open = 1;
    t.f = f;
    t.targets = f->eye->targets;
    t.bits = fxs_depth_bits(t.targets);
    t.list = fxs_list_of(f, tile);
    t.count = f->tile_counts[tile];
    fxs_tile_clear(pixels);
    read_limits(&t, x, y, columns, rows);
    memset(t.sums, 0, sizeof t.sums);
    memset(t.median, 0xff, sizeof t.median);
    memset(t.largest, 0xff, sizeof t.largest);
    memset(t.trace.weight_q15, 0, sizeof t.trace.weight_q15);
    for (t.first = 0; t.first < t.count && open; t.first = t.end) {
        begin_part(&t);
        reset_trace(&t);
        memcpy(t.before_q15, pixels->transmittance_q15, sizeof t.before_q15);
        open = f->context->kernels.trace(view, x, y, f->eye->splats, t.list + t.first, t.codes_q15, t.end - t.first,
                                         pixels, &t.trace);
        open &= end_part(&t, pixels);
    }
    for (int32_t row = 0; row < rows; row++)
        for (int32_t column = 0; column < columns; column++)
            write_pixel(&t, pixels, x + column, y + row, row * FXS_TILE + column);
    if (slots)
        memcpy(slots, t.largest, sizeof t.largest);
}
