/* A tile row whose splats do not fit in the memory: some of its columns at a time, and of those some splats at a time,
 * near to far, while the tiles' pixels are kept. So any view is drawn in the least memory, the slower the less. */
#include "frame.h"
#include "memory.h"

/* What is taken at a time: the nearest splats from a key on. Keys are depth and place in the scene, no two alike. */
typedef struct slice {
    fxs_key first, last;
    uint32_t count, room;          /* splats, and those that are kept before a chunk is projected behind them */
    int more;                      /* there are some beyond `last` */
} slice;

static fxs_key key_of(const fxs_frame *f, uint32_t slot)
{
    return FXS_KEY(f->eye->depths[slot], f->indices[slot]);
}

static void move(const fxs_frame *f, uint32_t to, uint32_t slot)
{
    const fxs_eye *eye = f->eye;
    eye->splats[to] = eye->splats[slot];
    eye->bounds[to] = eye->bounds[slot];
    eye->depths[to] = eye->depths[slot];
    f->indices[to] = f->indices[slot];
}

/* Keeps those of `count` splats behind the slice's that are in it and touch its columns. */
static void keep(const fxs_frame *f, slice *s, uint32_t count)
{
    for (uint32_t slot = s->count, end = s->count + count; slot < end; slot++) {
        const fxs_key key = key_of(f, slot);
        const fxs_span columns = fxs_bin_columns(&f->eye->view, &f->eye->bounds[slot]);
        if (key < s->first || columns.last < f->first_column || columns.first >= f->end_column)
            continue;
        s->more |= key > s->last;
        if (key <= s->last)
            move(f, s->count++, slot);
    }
}

/* Leaves the nearest three quarters of the room, in the order of the scene. */
static void drop_farthest(const fxs_frame *f, slice *s)
{
    const uint32_t left = s->room / 4 * 3, count = s->count;
    for (uint32_t slot = 0; slot < count; slot++)
        f->keys[slot] = FXS_KEY(f->eye->depths[slot], slot << 4);
    f->context->kernels.sort(f->keys, f->spare, count);
    s->last = key_of(f, FXS_LISTED_SLOT(f->keys[left - 1]));
    s->more = 1;
    s->count = 0;
    for (uint32_t slot = 0; slot < count; slot++)
        if (key_of(f, slot) <= s->last)
            move(f, s->count++, slot);
}

/* Whether a chunk may have splats of the slice; where it has but farther ones, there are more. */
static int may_have(const fxs_frame *f, slice *s, uint32_t chunk)
{
    const fxs_extent *e = &f->extents[chunk];
    if (!fxs_band_has_chunk(f, chunk) || e->columns.last < f->first_column || e->columns.first >= f->end_column ||
        e->farthest < s->first >> 32)
        return 0;
    s->more |= e->nearest > s->last >> 32;
    return e->nearest <= s->last >> 32;
}

/* Projects what the slice needs. Returns 0 or FXS_ERR_SCENE. */
static int take(fxs_frame *f, slice *s)
{
    s->last = UINT64_MAX;
    s->count = 0;
    s->more = 0;
    for (uint32_t chunk = 0; chunk < f->chunk_count; chunk++) {
        if (!may_have(f, s, chunk))
            continue;
        const int32_t count = fxs_frame_project(f, fxs_frame_object(f, chunk), chunk, s->count, s->room + FXS_CHUNK);
        if (count < 0)
            return count;
        keep(f, s, (uint32_t)count);
        if (s->count > s->room)
            drop_farthest(f, s);
    }
    return 0;
}

/* Colours, and boxes; slots are in the order of the chunks. Returns 0 or FXS_ERR_SCENE. */
static int finish(fxs_frame *f, uint32_t count)
{
    for (uint32_t slot = 0, end; slot < count; slot = end) {
        const uint32_t chunk = f->indices[slot] / FXS_CHUNK;
        for (end = slot + 1; end < count && f->indices[end] / FXS_CHUNK == chunk;)
            end++;
        const int error = fxs_frame_shade(f, fxs_frame_object(f, chunk), chunk, slot, end - slot);
        if (error)
            return error;
    }
    fxs_frame_bin(f, 0, count);
    memset(f->block_counts, 0, f->blocks * sizeof *f->block_counts);
    f->block_slots[0] = 0;
    f->block_counts[0] = f->count = count;
    return 0;
}

/* Goes on with a tile: `trace` of nothing goes on where `blend` begins. */
static void blend_on(fxs_frame *f, uint32_t tile, const fxs_list *list, fxs_laps *laps)
{
    fxs_tile *pixels = &f->pixels[(int32_t)tile % f->eye->view.tiles_x - f->first_column];
    int32_t x, y;
    (void)laps;
    fxs_tile_origin(f, tile, &x, &y);
    for (uint32_t first = 0; first < list->count; first += INT16_MAX) {
        const uint32_t left = list->count - first, count = left < INT16_MAX ? left : INT16_MAX;
        f->context->kernels.trace(&f->eye->view, x, y, f->eye->splats, list->entries + first, 0, 0, count, pixels,
                                  f->nothing);
    }
}

/* The tiles of the columns, once they are blended. Returns 0 or a back end's error. */
static int hand_over(fxs_frame *f)
{
    const uint32_t above = fxs_tiles_above(f, f->first_row);
    f->first_tile = above + (uint32_t)f->first_column;
    f->last_tile = above + (uint32_t)f->end_column - 1;
    if (f->context->config.draw)
        return fxs_draw_blended(f);
    for (uint32_t tile = f->first_tile; tile <= f->last_tile; tile++) {
        int32_t x, y;
        fxs_tile_origin(f, tile, &x, &y);
        fxs_resolve_targets(f, &f->pixels[tile - f->first_tile], x, y);
    }
    return 0;
}

/* Every slice of the columns. A scene that changes meanwhile cannot have more than it had. */
static int draw_columns(fxs_frame *f)
{
    slice s = {.room = f->slice_room, .more = 1};
    uint64_t drawn = 0;
    for (int32_t i = 0; i < f->end_column - f->first_column; i++)
        fxs_tile_clear(&f->pixels[i]);
    for (; s.more; s.first = s.last + 1) {
        const uint64_t start = fxs_now(f);
        int error = take(f, &s);
        error = error ? error : finish(f, s.count);
        f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
        error = error ? error : fxs_frame_draw(f);
        drawn += s.count;
        if (error || drawn > (uint64_t)f->chunk_count * FXS_CHUNK)
            return error ? error : FXS_ERR_SCENE;
        f->stats.slices++;
    }
    return hand_over(f);
}

int fxs_slices_draw(fxs_frame *f)
{
    const int32_t step = f->end_column, tiles_x = f->eye->view.tiles_x;
    void (*const draw_tile)(fxs_frame *, uint32_t, const fxs_list *, fxs_laps *) = f->draw_tile;
    int error = 0;
    f->depths = f->eye->depths;
    f->nothing->which = 0;
    f->draw_tile = blend_on;
    for (f->first_column = 0; f->first_column < tiles_x && !error; f->first_column = f->end_column) {
        f->end_column = fxs_min(f->first_column + step, tiles_x);
        error = draw_columns(f);
    }
    f->draw_tile = draw_tile;
    return error;
}
