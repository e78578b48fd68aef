/* Projects Gaussians, computes the colours of the splats and finds their tiles. Each parallel job has a block of chunks
 * of 256 Gaussians, and its own places for splats. */
#include "animate.h"
#include "bands.h"
#include "chunk.h"
#include "memory.h"
#include "prepare.h"
#include "show.h"
#include "times.h"

/* Returns true if a chunk belongs to a moving scene. */
static int moves(const fxs_frame *f, uint32_t place)
{
    return f->drawn && f->drawn[place].moment.moves;
}

static unsigned char *room_of(const fxs_frame *f, uint32_t block)
{
    return f->animated + (size_t)block * f->animated_bytes;
}

/* Returns an object that has only the chunk in a block's memory. */
static fxs_object_view animated(const fxs_frame *f, const fxs_object_view *object, uint32_t block)
{
    fxs_object_view out = *object;
    out.scene = fxs_animated_scene(&object->scene, room_of(f, block));
    return out;
}

int fxs_prepare_animate(fxs_frame *f, uint32_t number, uint32_t place, uint32_t block)
{
    const fxs_object_view *object = &f->views[number];
    return !moves(f, place) ? 0
           : fxs_animate_chunk(f->context->config.kernels, &object->scene, &object->motion,
                               fxs_frame_chunk(f, place) - object->first_chunk, &f->drawn[place].moment,
                               room_of(f, block));
}

/* A chunk outside the picture is not moved: its box holds its Gaussians at all times. */
static int32_t project_animated(fxs_frame *f, uint32_t number, uint32_t place, uint32_t chunk, uint32_t share_q8,
                                uint32_t grow_q8, uint32_t slot, uint32_t block)
{
    const fxs_object_view *object = &f->views[number];
    fxs_chunk_view cv;
    const int seen = fxs_chunk_view_init(&cv, &object->view, &object->scene, chunk);
    const int error = seen <= 0 ? seen : fxs_prepare_animate(f, number, place, block);
    if (seen <= 0 || error)
        return error;
    const fxs_object_view moved = animated(f, object, block);
    const int32_t count = fxs_object_project(&moved, f->context->config.kernels, 0, share_q8, grow_q8,
                                             f->splats + slot, f->bounds + slot, f->indices + slot,
                                             f->depths + slot);
    for (int32_t i = 0; i < count; i++)
        f->indices[slot + (uint32_t)i] += chunk * FXS_CHUNK;
    return count;
}

static int shade_animated(fxs_frame *f, const fxs_object_view *object, uint32_t chunk, uint32_t slot, uint32_t count,
                          uint32_t block)
{
    const fxs_object_view moved = animated(f, object, block);
    fxs_animate_sh(&object->scene, chunk, room_of(f, block));
    return fxs_object_shade(&moved, f->context->config.kernels, 0, f->indices + slot, count, f->splats + slot);
}

int32_t fxs_prepare_project(fxs_frame *f, uint32_t number, uint32_t place, uint32_t slot, uint32_t end_slot,
                            uint32_t block)
{
    const fxs_object_view *object = &f->views[number];
    const uint32_t chunk = fxs_frame_chunk(f, place) - object->first_chunk;
    const uint32_t share_q8 = f->drawn ? f->drawn[place].share_q8 : 256;
    const uint32_t grow_q8 = f->drawn ? f->drawn[place].grow_q8 : 0;
    uint32_t *indices = f->indices + slot;
    if (end_slot - slot < FXS_CHUNK)
        return FXS_ERR_SCENE;
    if (!fxs_band_has_chunk(f, place) || !object->visible)
        return 0;
    const int32_t count = moves(f, place)
                              ? project_animated(f, number, place, chunk, share_q8, grow_q8, slot, block)
                              : fxs_object_project(object, f->context->config.kernels, chunk, share_q8, grow_q8,
                                                   f->splats + slot, f->bounds + slot, indices, f->depths + slot);
    for (int32_t i = 0; i < count && object->first_chunk; i++)
        indices[i] += object->first_chunk * FXS_CHUNK;
    return count < 0 ? count : (int32_t)fxs_band_keep(f, place, slot, (uint32_t)count);
}

int fxs_prepare_shade(fxs_frame *f, uint32_t number, uint32_t place, uint32_t slot, uint32_t count, uint32_t block)
{
    const fxs_object_view *object = &f->views[number];
    const uint32_t chunk = fxs_frame_chunk(f, place) - object->first_chunk;
    const int error = moves(f, place) ? shade_animated(f, object, chunk, slot, count, block)
                                      : fxs_object_shade(object, f->context->config.kernels, chunk,
                                                         f->indices + slot, count, f->splats + slot);
    if (f->options->show_levels && !error)
        fxs_show_level(object, chunk, f->splats + slot, count);
    return error;
}

void fxs_prepare_bin(fxs_frame *f, uint32_t slot, uint32_t count)
{
    f->context->config.kernels->bin(&f->view, f->splats + slot, f->bounds + slot, count, f->boxes + slot);
}

static void fetch_rows(const fxs_frame *f, uint32_t number, uint32_t chunk, uint32_t from, uint32_t end)
{
    const fxs_object_view *object = &f->views[number];
    const unsigned char *rows = fxs_rows(&object->scene, chunk - object->first_chunk);
    for (; from < end && from < object->scene.chunk_bytes; from += 64)
        FXS_PREFETCH(rows + from);
    (void)rows;
}

/* Runs the stages project, shade and bin on chunks first to end - 1. At most FXS_BLOCK chunks are allowed, so that
   their splats fit in the cache. Returns the number of splats stored from index `slot` on, or FXS_ERR_SCENE. */
static int32_t prepare_chunks(fxs_frame *f, uint32_t block, uint32_t first, uint32_t end, uint32_t slot,
                              uint32_t end_slot, uint64_t *times)
{
    uint32_t starts[FXS_BLOCK + 1] = {slot}, chunks[FXS_BLOCK], objects[FXS_BLOCK];
    uint64_t start = fxs_now(f);
    for (uint32_t i = 0; i < end - first; i++) {
        chunks[i] = fxs_frame_chunk(f, first + i);
        objects[i] = fxs_frame_object(f, chunks[i]);
    }
    for (uint32_t i = 0; i < end - first; i++) {
        if (first + i + 1 < end)
            fetch_rows(f, objects[i + 1], chunks[i + 1], 0, moves(f, first + i + 1) ? UINT32_MAX : FXS_ROW_SH);
        int32_t count = fxs_prepare_project(f, objects[i], first + i, starts[i], end_slot, block);
        if (count > 0 && moves(f, first + i)) {
            const int error = fxs_prepare_shade(f, objects[i], first + i, starts[i], (uint32_t)count, block);
            count = error ? error : count;
        }
        if (count < 0)
            return count;
        starts[i + 1] = starts[i] + (uint32_t)count;
    }
    uint64_t projected = fxs_now(f);
    for (uint32_t i = 0; i < end - first; i++) {
        if (first + i + 1 < end && starts[i + 2] > starts[i + 1])
            fetch_rows(f, objects[i + 1], chunks[i + 1], FXS_ROW_SH, UINT32_MAX);
        int error = moves(f, first + i) ? 0 : fxs_prepare_shade(f, objects[i], first + i, starts[i],
                                                                starts[i + 1] - starts[i], block);
        if (error)
            return error;
    }
    uint64_t shaded = fxs_now(f);
    fxs_prepare_bin(f, slot, starts[end - first] - slot);
    times[0] += projected - start;
    times[1] += shaded - projected;
    times[2] += fxs_now(f) - shaded;
    return (int32_t)(starts[end - first] - slot);
}

static int32_t plan_chunks(fxs_frame *f, uint32_t block, uint32_t first, uint32_t end, uint32_t slot)
{
    uint32_t all = 0;
    for (uint32_t place = first; place < end; place++) {
        const uint32_t object = fxs_frame_object(f, fxs_frame_chunk(f, place));
        const int32_t count = fxs_prepare_project(f, object, place, slot, slot + FXS_CHUNK, block);
        if (count < 0)
            return count;
        fxs_band_count(f, block, place, slot, (uint32_t)count);
        all += (uint32_t)count;
    }
    return (int32_t)all;
}

static void prepare_block(void *argument, uint32_t block)
{
    fxs_frame *f = argument;
    uint32_t end = fxs_block_start(f, block + 1), slot = f->block_slots[block], taken = 0;
    uint64_t *times = f->block_times + 3 * (size_t)block;
    memset(times, 0, 3 * sizeof *times);
    f->block_counts[block] = FXS_BLOCK_FAILED;
    for (uint32_t first = fxs_block_start(f, block); first < end; first += FXS_BLOCK) {
        const uint32_t last = end - first < FXS_BLOCK ? end : first + FXS_BLOCK;
        if (fxs_frame_stopped(f))
            return;
        int32_t count = f->mode == FXS_FRAME_PLAN ? plan_chunks(f, block, first, last, slot)
                                    : prepare_chunks(f, block, first, last, slot + taken, f->block_slots[block + 1],
                                                     times);
        if (count < 0)
            return;
        taken += (uint32_t)count;
    }
    f->block_counts[block] = taken;
}

int fxs_prepare_blocks(fxs_frame *f)
{
    fxs_frame_run(f, prepare_block, f->blocks);
    for (uint32_t block = 0; block < f->blocks; block++)
        if (f->block_counts[block] == FXS_BLOCK_FAILED)
            return f->stopped ? FXS_ERR_STOPPED : FXS_ERR_SCENE;
    return 0;
}

int fxs_prepare_band(fxs_frame *f)
{
    static const enum fxs_stage stages[] = {FXS_PROJECT, FXS_SHADE, FXS_BIN};
    const uint64_t start = fxs_now(f);
    const int error = fxs_prepare_blocks(f);
    if (error)
        return error;
    fxs_share_time(f, start, f->block_times, f->blocks, 3, stages);
    f->count = 0;
    for (uint32_t block = 0; block < f->blocks; block++)
        f->count += f->block_counts[block];
    f->stats.visible += f->mode == FXS_FRAME_WHOLE ? f->count : 0;
    return 0;
}
