/* Blends the splats of a tile's list over its 256 pixels, from front to back, with the arithmetic of pixel.h. */
#include "draw.h"
#include "memory.h"

/* A splat relative to a tile: its coordinates u and v at the tile's first pixel, and the pixel rows to blend. */
typedef struct at_tile {
    int32_t u_q24, v_q24, first_row, last_row, limit_q11;
} at_tile;

static at_tile at_tile_of(const fxs_stage_view *view, const fxs_splat *splat, uint32_t entry, int32_t x, int32_t y)
{
    uint32_t u = splat->u0_q24 + (uint32_t)x * (uint32_t)splat->ux_q24 + (uint32_t)y * (uint32_t)splat->uy_q24;
    uint32_t v = splat->v0_q24 + (uint32_t)y * (uint32_t)splat->vy_q24;
    at_tile p;
    p.u_q24 = entry & FXS_ENTRY_CUT_OFF ? FXS_CUT_OFF_Q24 : (int32_t)u;
    p.v_q24 = entry & FXS_ENTRY_CUT_OFF ? FXS_CUT_OFF_Q24 : (int32_t)v;
    p.first_row = splat->first_row > y ? splat->first_row - y : 0;
    p.last_row = fxs_min(splat->last_row - y, FXS_TILE - 1);
    p.limit_q11 = fxs_limit_q11(splat->offset_q11, view->cut_q11);
    return p;
}

void fxs_tile_clear(fxs_tile *tile)
{
    memset(tile->sum_q13, 0, sizeof tile->sum_q13);
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        tile->transmittance_q15[i] = FXS_CLEAR_Q15;
}

typedef struct blending {
    fxs_tile *tile;
    fxs_trace *trace;              /* receives depths and ids; null: no depths or ids are needed */
    int number;
    int depth_q15;
    uint64_t evaluated, blended;
} blending;

static void trace_pixel(const blending *b, int i, int transmittance_q15, int weight_q15)
{
    fxs_trace *trace = b->trace;
    if (trace->which & FXS_TRACE_MEAN)
        trace->depth_q15[i] = (int16_t)(trace->depth_q15[i] + fxs_mul_q15(weight_q15, b->depth_q15));
    if (trace->which & FXS_TRACE_MEDIAN && weight_q15 && transmittance_q15 >= FXS_HALF_Q15)
        trace->median[i] = (int16_t)b->number;
    if (trace->which & FXS_TRACE_ID && weight_q15 > trace->weight_q15[i]) {
        trace->weight_q15[i] = (int16_t)weight_q15;
        trace->largest[i] = (int16_t)b->number;
    }
}

static int is_hidden(const blending *b, int i)
{
    return b->trace && b->trace->which & FXS_TRACE_END && b->number >= b->trace->end[i];
}

/* Blends a splat over one pixel row of a tile. Returns the number of pixels that became opaque. */
static int blend_row(blending *b, int row, const fxs_splat *splat, const at_tile *p)
{
    fxs_tile *tile = b->tile;
    int closed = 0, first = row * FXS_TILE;
    uint32_t v_q24 = (uint32_t)p->v_q24 + (uint32_t)row * (uint32_t)splat->vy_q24;
    uint32_t u_q24 = (uint32_t)p->u_q24 + (uint32_t)row * (uint32_t)splat->uy_q24;
    int level_of_row = fxs_row_level_q11(fxs_coordinate_q13((int32_t)v_q24), splat->offset_q11);
    for (int i = first; i < first + FXS_TILE; i++, u_q24 += (uint32_t)splat->ux_q24) {
        int transmittance = tile->transmittance_q15[i];
        if (transmittance < FXS_CLOSED_Q15)
            continue;
        b->evaluated++;
        int level = fxs_level_q11(fxs_coordinate_q13((int32_t)u_q24), level_of_row);
        if (level > p->limit_q11 || is_hidden(b, i))
            continue;
        b->blended++;
        int weight = fxs_weight_q15(fxs_alpha_q15(level), transmittance);
        tile->transmittance_q15[i] = (int16_t)(transmittance - weight);
        closed += transmittance - weight < FXS_CLOSED_Q15;
        for (int c = 0; c < 3; c++)
            tile->sum_q13[c][i] = (int16_t)fxs_accumulate_q13(tile->sum_q13[c][i], weight, splat->colour_q13[c]);
        if (b->trace)
            trace_pixel(b, i, transmittance, weight);
    }
    return closed;
}

static void blend_list(blending *b, const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                       const uint32_t *entries, const int16_t *depths_q15, uint32_t first, uint32_t end)
{
    int open = 0;
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        open += b->tile->transmittance_q15[i] >= FXS_CLOSED_Q15;
    for (uint32_t i = first; i < end && open > 0; i++) {
        const fxs_splat *splat = &splats[entries[i] & ~FXS_ENTRY_CUT_OFF];
        at_tile p = at_tile_of(view, splat, entries[i], x, y);
        b->number = (int)i;
        b->depth_q15 = b->trace && b->trace->which & FXS_TRACE_MEAN ? depths_q15[i - first] : 0;
        for (int row = p.first_row; row <= p.last_row; row++)
            open -= blend_row(b, row, splat, &p);
    }
}

void fxs_blend_count(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                     uint32_t count, fxs_tile *tile, uint64_t *evaluated, uint64_t *blended)
{
    blending b = {.tile = tile};
    fxs_tile_clear(tile);
    blend_list(&b, view, x, y, splats, entries, 0, 0, count);
    *evaluated += b.evaluated;
    *blended += b.blended;
}

void fxs_blend_c(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                 uint32_t count, fxs_tile *tile)
{
    uint64_t evaluated = 0, blended = 0;
    fxs_blend_count(view, x, y, splats, entries, count, tile, &evaluated, &blended);
}

void fxs_trace_c(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                 const int16_t *depths_q15, uint32_t first, uint32_t end, fxs_tile *tile, fxs_trace *trace)
{
    blending b = {.tile = tile, .trace = trace};
    blend_list(&b, view, x, y, splats, entries, depths_q15, first, end);
}
