/* fxs_weigh: renders a frame that writes no picture, and adds the weight of each splat in each pixel to the sum of the
 * splat's Gaussian and the pixel's label. A tile's splats are blended one at a time by the kernel `trace`: the weight
 * of a splat in a pixel is the difference that it makes to the pixel's transmittance. */
#include <fixsplat/internal/weigh.h>

#include "draw.h"
#include "memory.h"
#include "sized.h"

enum {
    CHECKED = 16,                  /* after so many splats, a tile is left if all its pixels are opaque */
    HIDDEN_Q15 = FXS_CLEAR_Q15 / 8     /* a pixel below this transmittance counts as opaque */
};

typedef struct weighing {
    fxs_frame frame;               /* the frame must be the first field, because weigh_tile casts its address to a
                                      `weighing` */
    fxs_targets targets;
    const uint8_t *labels;
    uint32_t label_count;
    uint64_t *sums;
} weighing;

/* Sets the label of each pixel of a tile. Closes the pixels that are not counted. Returns 1 if all other pixels have
   one label, and then sets it in all. */
static int read_labels(const weighing *w, int32_t x, int32_t y, fxs_tile *tile, uint8_t labels[FXS_TILE_PIXELS])
{
    const fxs_stage_view *view = &w->frame.view;
    int is_one = 1, one = -1;
    for (int32_t i = 0; i < FXS_TILE_PIXELS; i++) {
        const int32_t column = x + i % FXS_TILE, row = y + i / FXS_TILE;
        const int is_inside = column < view->width && row < view->height;
        const uint8_t label = is_inside ? w->labels[(size_t)row * (size_t)view->width + (size_t)column] : 255;
        labels[i] = is_inside && label < w->label_count ? label : 0;
        if (!is_inside || label >= w->label_count) {
            tile->transmittance_q15[i] = 0;
            continue;
        }
        is_one = is_one && (one < 0 || one == label);
        one = label;
    }
    if (is_one)
        memset(labels, one < 0 ? 0 : one, FXS_TILE_PIXELS);
    return is_one;
}

/* Closes pixels that count as opaque. */
static void close_opaque(int16_t *transmittance_q15, int32_t count)
{
    for (int32_t k = 0; k < count; k++)
        transmittance_q15[k] = transmittance_q15[k] < HIDDEN_Q15 ? 0 : transmittance_q15[k];
}

/* Returns what pixels have lost of their transmittance: at most 256 * 2^15. */
static int32_t sum_of(const int16_t *before_q15, const int16_t *after_q15, int32_t count)
{
    int32_t sum = 0;
    for (int32_t k = 0; k < count; k++)
        sum += before_q15[k] - after_q15[k];
    return sum;
}

static int is_open(const fxs_tile *tile)
{
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        if (tile->transmittance_q15[i] >= FXS_CLOSED_Q15)
            return 1;
    return 0;
}

static void weigh_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    const weighing *w = (const weighing *)(const void *)f;
    uint8_t labels[FXS_TILE_PIXELS];
    int16_t before_q15[FXS_TILE_PIXELS];
    fxs_trace nothing;
    fxs_tile pixels;
    int32_t x, y;
    (void)laps;
    nothing.which = 0;
    fxs_tile_origin(f, tile, &x, &y);
    fxs_tile_clear(&pixels);
    const int is_one = read_labels(w, x, y, &pixels, labels);
    for (uint32_t i = 0; i < list->count && (i % CHECKED || is_open(&pixels)); i++) {
        const uint32_t slot = list->entries[i] & ~FXS_ENTRY_CUT_OFF;
        const int32_t first = (f->splats[slot].first_row > y ? f->splats[slot].first_row - y : 0) * FXS_TILE;
        const int32_t end = (fxs_min(f->splats[slot].last_row - y, FXS_TILE - 1) + 1) * FXS_TILE;
        const int32_t count = end > first ? end - first : 0;
        uint64_t *sums = w->sums + (size_t)w->label_count * f->indices[slot];
        memcpy(before_q15 + first, pixels.transmittance_q15 + first, (size_t)count * sizeof *before_q15);
        f->context->config.kernels->trace(&f->view, x, y, f->splats, list->entries + i, 0, 0, 1, &pixels, &nothing);
        if (is_one)
            sums[labels[0]] += (uint64_t)sum_of(before_q15 + first, pixels.transmittance_q15 + first, count);
        for (int32_t k = is_one ? first + count : first; k < first + count; k++)
            sums[labels[k]] += (uint64_t)(before_q15[k] - pixels.transmittance_q15[k]);
        close_opaque(pixels.transmittance_q15 + first, count);
    }
}

int fxs_weigh(const fxs_context *given_context, const fxs_request *given, const uint8_t *labels, uint32_t label_count,
              uint64_t *sums, void *memory, size_t memory_bytes)
{
    weighing w = {.labels = labels, .label_count = label_count, .sums = sums};
    fxs_context context = *given_context;
    fxs_request request;
    int error = fxs_request_read(&request, given);
    if (error || !labels || !sums || !label_count)
        return error ? error : FXS_ERR_ARGUMENT;
    if (memory_bytes < fxs_request_bytes(given_context, given, 0))
        return FXS_ERR_MEMORY;
    context.config.workers = (fxs_workers){0};
    context.config.draw = 0;
    error = fxs_frame_init(&w.frame, &context, &request, memory, memory_bytes);
    if (error)
        return error;
    w.frame.targets = &w.targets;
    w.frame.draw_tile = weigh_tile;
    return fxs_frame_render(&w.frame);
}
