/* Draws a tile row with more splats than the memory holds, in slices: blends the nearest splats that fit, then the next
 * ones over the same pixels. The method is slow, because every slice projects the row's Gaussians again. */
#include "bands.h"
#include "draw.h"
#include "lister.h"
#include "memory.h"
#include "prepare.h"
#include "runs.h"
#include "slices.h"
#include "targets.h"
#include "tile_rates.h"
#include "times.h"

/* A slice has the splats with keys from `first` to `last`. A key is a depth and a Gaussian's number, hence unique. */
typedef struct slice {
    fxs_key first, last;
    uint32_t count, room;
    uint64_t taken;
    int more;
} slice;

static fxs_key key_of(const fxs_frame *f, uint32_t slot)
{
    return FXS_KEY(f->depths[slot], f->indices[slot]);
}

/* Of the last `count` splats, keeps only the splats in the slice's range of keys and tile columns. */
static void keep(const fxs_frame *f, slice *s, uint32_t count)
{
    for (uint32_t slot = s->count, end = s->count + count; slot < end; slot++) {
        const fxs_key key = key_of(f, slot);
        const fxs_span columns = fxs_bin_columns(&f->view, &f->bounds[slot]);
        if (key >= s->first && key <= s->last && columns.last >= f->first_column && columns.first < f->end_column)
            fxs_frame_move(f, s->count++, slot);
    }
}

/* Keeps only the nearest splats of a slice, 3/4 of its capacity. Sets `last` to the key of the farthest splat kept. */
static void drop_farthest(const fxs_frame *f, slice *s)
{
    const uint32_t left = s->room / 4 * 3, count = s->count;
    for (uint32_t slot = 0; slot < count; slot++)
        f->keys[slot] = FXS_KEY(f->depths[slot], slot << 4);
    f->context->config.kernels->sort(f->keys, f->spare, count);
    s->last = key_of(f, FXS_LISTED_SLOT(f->keys[left - 1]));
    s->more = 1;
    s->count = 0;
    for (uint32_t slot = 0; slot < count; slot++)
        if (key_of(f, slot) <= s->last)
            fxs_frame_move(f, s->count++, slot);
}

static int may_have(const fxs_frame *f, const slice *s, uint32_t chunk)
{
    const fxs_extent *e = &f->extents[chunk];
    return fxs_band_has_chunk(f, chunk) && e->columns.last >= f->first_column && e->columns.first < f->end_column &&
           e->farthest >= s->first >> 32 && e->nearest <= s->last >> 32;
}

static int take(fxs_frame *f, slice *s)
{
    s->last = UINT64_MAX;
    s->count = 0;
    s->more = 0;
    for (uint32_t place = 0; place < f->chunk_count; place++) {
        if (!may_have(f, s, place))
            continue;
        if (fxs_frame_stopped(f))
            return FXS_ERR_STOPPED;
        const uint32_t object = fxs_frame_object(f, fxs_frame_chunk(f, place));
        const int32_t count = fxs_prepare_project(f, object, place, s->count, s->room + FXS_CHUNK, 0);
        if (count < 0)
            return count;
        keep(f, s, (uint32_t)count);
        if (s->count > s->room)
            drop_farthest(f, s);
    }
    return 0;
}

static int finish(fxs_frame *f, uint32_t count)
{
    for (uint32_t slot = 0, end; slot < count; slot = end) {
        const uint32_t chunk = f->indices[slot] / FXS_CHUNK;
        for (end = slot + 1; end < count && f->indices[end] / FXS_CHUNK == chunk;)
            end++;
        const uint32_t object = fxs_frame_object(f, chunk), place = fxs_frame_place(f, chunk);
        int error = fxs_prepare_animate(f, object, place, 0);
        error = error ? error : fxs_prepare_shade(f, object, place, slot, end - slot, 0);
        if (error)
            return error;
    }
    fxs_prepare_bin(f, 0, count);
    memset(f->block_counts, 0, f->blocks * sizeof *f->block_counts);
    f->block_slots[0] = 0;
    f->block_counts[0] = f->count = count;
    return 0;
}

/* Prepares the next slice, the nearest splats of a tile row that are not drawn yet. Returns FXS_ERR_SCENE also if the
   scene changes meanwhile and yields endless splats. */
static int next_slice(fxs_frame *f, slice *s)
{
    int error = take(f, s);
    error = error ? error : finish(f, s->count);
    s->first = s->last + 1;
    s->taken += s->count;
    return error ? error : s->taken > (uint64_t)f->chunk_count * FXS_CHUNK ? FXS_ERR_SCENE : 0;
}

/* Blends a slice's list of splats over a tile that earlier slices have drawn. Uses the kernel `trace`, because the
   kernel `blend` would start with an empty tile. */
static void blend_on(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    const int32_t column = (int32_t)tile % f->view.tiles_x - f->first_column;
    fxs_trace *nothing = &f->nothing[column / FXS_MACRO];      /* no depths or ids are wanted, but kernels may still
                                                                  write to the arrays of `nothing` */
    int32_t x, y;
    nothing->which = 0;
    fxs_tile_origin(f, tile, &x, &y);
    for (uint32_t first = 0; first < list->count; first += INT16_MAX) {
        const uint32_t left = list->count - first, count = left < INT16_MAX ? left : INT16_MAX;
        f->context->config.kernels->trace(&f->view, x, y, f->splats, list->entries + first, 0, 0, count,
                                  &f->pixels[column], nothing);
    }
    fxs_lap(f, laps, FXS_BLENDED);
}

static int hand_over(fxs_frame *f)
{
    const uint32_t above = fxs_tiles_above(f, f->first_row);
    f->first_tile = above + (uint32_t)f->first_column;
    f->last_tile = above + (uint32_t)f->end_column - 1;
    if (f->context->config.draw)
        return fxs_runs_draw_blended(f);
    for (uint32_t tile = f->first_tile; tile <= f->last_tile; tile++) {
        const fxs_tile *pixels = &f->pixels[tile - f->first_tile];
        int32_t x, y;
        fxs_tile_origin(f, tile, &x, &y);
        const int shift = fxs_rate_shift(&f->targets->rates, f->view.width, f->view.height, x, y);
        if (shift)
            fxs_rate_resolve(f, pixels, shift, fxs_rate_pixel(shift) * (FXS_TILE + 1), 1 << shift, x, y);
        else
            fxs_resolve_targets(f, pixels, x, y);
    }
    return 0;
}

static int draw_columns(fxs_frame *f)
{
    slice s = {.room = f->slice_room, .more = 1};
    for (int32_t i = 0; i < f->end_column - f->first_column; i++)
        fxs_tile_clear(&f->pixels[i]);
    while (s.more) {
        const uint64_t start = fxs_now(f);
        int error = next_slice(f, &s);
        f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
        if (!error)
            error = fxs_frame_draw(f);
        if (error)
            return error;
        f->stats.slices++;
    }
    return hand_over(f);
}

int fxs_slices_draw(fxs_frame *f)
{
    const int32_t step = (int32_t)f->slice_macros * FXS_MACRO, tiles_x = f->view.tiles_x;
    fxs_tile_fn *const draw_tile = f->draw_tile;
    int error = 0;
    f->draw_tile = blend_on;
    for (f->first_column = 0; f->first_column < tiles_x && !error; f->first_column = f->end_column) {
        f->end_column = fxs_min(f->first_column + step, tiles_x);
        error = draw_columns(f);
    }
    f->draw_tile = draw_tile;
    return error;
}
