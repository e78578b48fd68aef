/* fxs_count_pairs renders a frame with a version of the blend stage that counts pairs of a splat and a pixel. It writes
 * no image. */
#include "count.h"
#include "frame.h"
#include "sized.h"

typedef struct counting {
    fxs_frame frame;               /* the frame must be the first field, because count_tile casts its address to a
                                      `counting` */
    fxs_targets targets;
    uint64_t evaluated, blended;
} counting;

static void count_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    counting *c = (counting *)(void *)f;
    fxs_tile pixels;
    int32_t x, y;
    (void)laps;
    fxs_tile_origin(f, tile, &x, &y);
    fxs_blend_count(&f->view, x, y, f->splats, list->entries, list->count, &pixels, &c->evaluated,
                    &c->blended);
}

static int count(const fxs_request *request, void *memory, size_t memory_bytes, uint64_t *evaluated, uint64_t *blended)
{
    counting c = {.evaluated = 0, .blended = 0};
    fxs_context context;
    fxs_context_init(&context, 0);
    int error = fxs_frame_init(&c.frame, &context, request, memory, memory_bytes);
    if (error)
        return error;
    c.frame.targets = &c.targets;
    c.frame.draw_tile = count_tile;
    error = fxs_frame_render(&c.frame);
    *evaluated = c.evaluated;
    *blended = c.blended;
    return error;
}

int fxs_count_pairs(const fxs_request *given, void *memory, size_t memory_bytes, uint64_t *evaluated, uint64_t *blended)
{
    fxs_request request;
    const int error = fxs_request_read(&request, given);
    if (error || !evaluated || !blended)
        return error ? error : FXS_ERR_ARGUMENT;
    return count(&request, memory, memory_bytes, evaluated, blended);
}
