/* fxs_pick: renders a frame that blends only the tile of the picked pixel, and reads the result at that pixel. */
#include "sized.h"
#include "trace.h"

#define SLOPE_MOST_Q23 ((int64_t)4096 << 23)
#define POSITION_MOST_Q32 ((int64_t)1 << 60)

typedef struct pick {
    fxs_frame frame;               /* the frame must be the first field, because pick_tile casts its address to a
                                      `pick` */
    fxs_targets targets;
    int32_t x, y;
    uint32_t key, index;           /* depth (as a sort key) and number of the Gaussian that is found at the pixel */
} pick;

static void pick_tile(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    pick *p = (pick *)(void *)f;
    const int32_t x = p->x / FXS_TILE * FXS_TILE, y = p->y / FXS_TILE * FXS_TILE;
    uint32_t slots[FXS_TILE_PIXELS];
    fxs_tile pixels;
    (void)tile, (void)laps;
    fxs_trace_tile(f, list, x, y, 0, &pixels, slots);
    const uint32_t slot = slots[(p->y - y) * FXS_TILE + p->x - x];
    if (slot != FXS_NOTHING) {
        p->key = f->depths[slot];
        p->index = f->indices[slot];
    }
}

static int64_t cut(int64_t x, int64_t most)
{
    return x < -most ? -most : x > most ? most : x;
}

/* Returns mantissa 2^(exponent - 58) in Q32, saturated. The mantissa is below 2^62. */
static int64_t scaled_q32(int64_t mantissa, int exponent)
{
    const int shift = exponent - 26;
    if (shift < 0)
        return mantissa >> fxs_min(-shift, 62);
    return cut(cut(mantissa, POSITION_MOST_Q32 >> fxs_min(shift, 60)) * ((int64_t)1 << fxs_min(shift, 60)),
               POSITION_MOST_Q32);
}

/* Returns how far the ray of a pixel is from the camera's axis along x or y. For pixel column X, the distance is (X +
   1/2 - cx) / f, times the depth z in perspective. */
static int64_t across_q32(const fxs_camera *camera, int32_t pixel, int32_t c_q12, int32_t f_q12, uint32_t key)
{
    const int64_t offset_q12 = ((int64_t)pixel << 12) + 2048 - c_q12;
    if (camera->projection == FXS_ORTHOGRAPHIC)
        return cut(offset_q12 * ((int64_t)1 << 28) / f_q12, POSITION_MOST_Q32 >> 4) * 16;
    const int64_t slope_q23 = cut(offset_q12 * (1 << 23) / f_q12, SLOPE_MOST_Q23);
    return scaled_q32((slope_q23 * (1 << 26 | (key & 0x3ffffff))) >> 23, (int)(key >> 26));
}

static void fill_in(const pick *p, const fxs_camera *camera, fxs_pick_result *result)
{
    const fxs_frame *f = &p->frame;
    const uint32_t key = p->key, index = p->index;
    result->object = fxs_frame_object(f, index / FXS_CHUNK);
    result->gaussian = index - f->views[result->object].first_chunk * FXS_CHUNK;
    result->id = f->views[result->object].id;
    result->depth_q32 = scaled_q32(1 << 26 | (key & 0x3ffffff), (int)(key >> 26));
    const int64_t offset_q32[3] = {across_q32(camera, p->x, camera->cx_q12, camera->fx_q12, key),
                                   across_q32(camera, p->y, camera->cy_q12, camera->fy_q12, key), result->depth_q32};
    for (int i = 0; i < 3; i++)
        result->position_q32[i] = camera->position_q32[i] + fxs_turned_back(camera->rotation_q30, offset_q32, i);
}

int fxs_pick(const fxs_context *context, const fxs_request *given, int32_t x, int32_t y, void *memory,
             size_t memory_bytes, fxs_pick_result *result)
{
    pick p = {.x = x, .y = y, .index = FXS_NOTHING};
    fxs_request request;
    const fxs_camera *camera = request.cameras;
    int error = fxs_request_read(&request, given);
    if (error || !result || x < 0 || y < 0 || x >= camera->width || y >= camera->height)
        return error ? error : FXS_ERR_ARGUMENT;
    error = fxs_frame_init(&p.frame, context, &request, memory, memory_bytes);
    if (error)
        return error;
    p.targets.occluder = request.targets->occluder;
    p.targets.depth_bits = request.targets->depth_bits;
    p.frame.targets = &p.targets;
    p.frame.draw_tile = pick_tile;
    p.frame.only_tile = (uint32_t)(y / FXS_TILE * p.frame.view.tiles_x + x / FXS_TILE);
    error = fxs_frame_render(&p.frame);
    if (error || p.index == FXS_NOTHING)
        return error;
    fill_in(&p, camera, result);
    return 1;
}
