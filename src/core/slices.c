/* What a tile row has that does not fit in the memory, taken in slices: of some of its columns the nearest splats that
 * fit, then the next ones. So any view is drawn in the least memory, the slower the less. */
#include "memory.h"
#include "parts.h"

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
static void keep(const fxs_frame *f, fxs_slice *s, uint32_t count)
{
    for (uint32_t slot = s->count, end = s->count + count; slot < end; slot++) {
        const fxs_key key = key_of(f, slot);
        const fxs_span columns = fxs_bin_columns(&f->eye->view, &f->eye->bounds[slot]);
        if (key >= s->first && key <= s->last && columns.last >= f->first_column && columns.first < f->end_column)
            move(f, s->count++, slot);
    }
}

/* Leaves the nearest three quarters of the room, in the order of the scene. */
static void drop_farthest(const fxs_frame *f, fxs_slice *s)
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

/* Whether a chunk may have splats of the slice. */
static int may_have(const fxs_frame *f, const fxs_slice *s, uint32_t chunk)
{
    const fxs_extent *e = &f->extents[chunk];
    return fxs_band_has_chunk(f, chunk) && e->columns.last >= f->first_column && e->columns.first < f->end_column &&
           e->farthest >= s->first >> 32 && e->nearest <= s->last >> 32;
}

/* Projects what the slice needs. Returns 0, FXS_ERR_SCENE or FXS_ERR_STOPPED. */
static int take(fxs_frame *f, fxs_slice *s)
{
    s->last = UINT64_MAX;
    s->count = 0;
    s->more = 0;
    for (uint32_t chunk = 0; chunk < f->chunk_count; chunk++) {
        if (!may_have(f, s, chunk))
            continue;
        if (fxs_frame_stopped(f))
            return FXS_ERR_STOPPED;
        const int32_t count = fxs_prepare_project(f, fxs_frame_object(f, chunk), chunk, s->count, s->room + FXS_CHUNK);
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
        const int error = fxs_prepare_shade(f, fxs_frame_object(f, chunk), chunk, slot, end - slot);
        if (error)
            return error;
    }
    fxs_prepare_bin(f, 0, count);
    memset(f->block_counts, 0, f->blocks * sizeof *f->block_counts);
    f->block_slots[0] = 0;
    f->block_counts[0] = f->count = count;
    return 0;
}

int fxs_slice_next(fxs_frame *f, fxs_slice *s)
{
    int error = take(f, s);
    error = error ? error : finish(f, s->count);
    s->first = s->last + 1;
    s->taken += s->count;
    return error ? error : s->taken > (uint64_t)f->chunk_count * FXS_CHUNK ? FXS_ERR_SCENE : 0;
}
