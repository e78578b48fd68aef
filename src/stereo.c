/* Two eyes: each has the geometry and tile lists of its own camera; the colours are found once for both, and, where
 * both measure depth alike, the order. What either eye sees has the same slot in both eyes' splats. */
#include "fixed.h"
#include "frame.h"
#include "memory.h"

/* Of a slot: what the right eye has of its own. */
#define RIGHT_BYTES (sizeof(fxs_splat) + sizeof(fxs_bounds) + sizeof(fxs_box) + sizeof(uint32_t))

typedef struct eye {
    fxs_view view;
    fxs_splat *splats;
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *depths;
    unsigned char *pixels;
} eye;

typedef struct stereo {
    fxs_frame frame;               /* the eye that is drawn, at first the left; first, as jobs are given it */
    eye right;
    fxs_view middle;               /* between the eyes: where colours are seen from */
} stereo;

/* ---- The slots of a chunk -------------------------------------------------------------------------------------- */

static uint32_t union_count(const uint32_t *a, uint32_t a_count, const uint32_t *b, uint32_t b_count)
{
    uint32_t count = 0;
    for (uint32_t i = 0, j = 0; i < a_count || j < b_count; count++) {
        int in_a = j == b_count || (i < a_count && a[i] <= b[j]);
        int in_b = i == a_count || (j < b_count && b[j] <= a[i]);
        i += (uint32_t)in_a;
        j += (uint32_t)in_b;
    }
    return count;
}

/* Where the centre is of a splat that the eye does not see: left of all that project lets pass. */
#define UNSEEN_Q14 (-FXS_CENTRE_LIMIT_Q14)

/* Moves the last of *count splats to slot `to`; where the eye does not see it, makes one that is listed nowhere. */
static void spread(fxs_splat *splats, fxs_bounds *bounds, uint32_t to, int seen, uint32_t *count)
{
    if (seen) {
        splats[to] = splats[--*count];
        bounds[to] = bounds[*count];
    } else {
        splats[to] = (fxs_splat){0};
        bounds[to] = (fxs_bounds){.cx_q14 = UNSEEN_Q14};
    }
}

/* Projects a chunk for both eyes, from `slot` on. What one eye does not see has the other's depth. Returns how many
   slots are taken, at most 256, or FXS_ERR_SCENE. */
static int32_t project(stereo *s, uint32_t chunk, uint32_t slot)
{
    fxs_frame *f = &s->frame;
    uint32_t right_indices[FXS_CHUNK], *indices = f->indices + slot;
    uint32_t *depths = (uint32_t *)f->spare_keys + slot, *right_depths = s->right.depths + slot;
    const fxs_kernels *kernels = &f->context->kernels;
    const int32_t of_left = kernels->project(&f->view, f->scene, chunk, f->splats + slot, f->bounds + slot, indices,
                                             depths);
    const int32_t of_right = kernels->project(&s->right.view, f->scene, chunk, s->right.splats + slot,
                                              s->right.bounds + slot, right_indices, right_depths);
    if (of_left < 0 || of_right < 0)
        return FXS_ERR_SCENE;
    uint32_t left = (uint32_t)of_left, right = (uint32_t)of_right;
    const uint32_t count = union_count(indices, left, right_indices, right);
    for (uint32_t to = count; to-- > 0 && (left <= to || right <= to);) {
        int by_left = left && (!right || indices[left - 1] >= right_indices[right - 1]);
        int by_right = right && (!left || right_indices[right - 1] >= indices[left - 1]);
        indices[to] = by_left ? indices[left - 1] : right_indices[right - 1];
        uint32_t left_depth = by_left ? depths[left - 1] : right_depths[right - 1];
        right_depths[to] = by_right ? right_depths[right - 1] : left_depth;
        depths[to] = left_depth;
        spread(f->splats + slot, f->bounds + slot, to, by_left, &left);
        spread(s->right.splats + slot, s->right.bounds + slot, to, by_right, &right);
    }
    return (int32_t)count;
}

/* project and shade, for a chunk. Returns what project does. */
static int32_t prepare_chunk(stereo *s, uint32_t chunk, uint32_t slot, uint64_t times[2])
{
    fxs_frame *f = &s->frame;
    fxs_splat *splats = f->splats + slot, *right = s->right.splats + slot;
    uint64_t start = fxs_now(f);
    int32_t count = project(s, chunk, slot);
    if (count < 0)
        return count;
    uint64_t projected = fxs_now(f);
    if (f->context->kernels.shade(&s->middle, f->scene, chunk, f->indices + slot, (uint32_t)count, splats))
        return FXS_ERR_SCENE;
    for (int32_t i = 0; i < count; i++)
        memcpy(right[i].colour_q13, splats[i].colour_q13, sizeof splats->colour_q13);
    times[0] += projected - start;
    times[1] += fxs_now(f) - projected;
    return count;
}

static void find_boxes(const stereo *s, const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds,
                       uint32_t count, fxs_box *boxes)
{
    s->frame.context->kernels.bin(view, splats, bounds, count, boxes);
    for (uint32_t i = 0; i < count; i++)
        if (bounds[i].cx_q14 == UNSEEN_Q14)
            boxes[i].base = FXS_NOWHERE;
}

static void prepare_block(void *argument, uint32_t block)
{
    stereo *s = argument;
    fxs_frame *f = &s->frame;
    uint32_t slot = f->block_slots[block], count = 0;
    uint64_t *times = f->block_times + 3 * (size_t)block;
    memset(times, 0, 3 * sizeof *times);
    f->block_counts[block] = FXS_BLOCK_FAILED;
    for (uint32_t chunk = fxs_block_start(f, block); chunk < fxs_block_start(f, block + 1); chunk++) {
        const int32_t more = prepare_chunk(s, chunk, slot + count, times);
        if (more < 0)
            return;
        count += (uint32_t)more;
    }
    uint64_t shaded = fxs_now(f);
    find_boxes(s, &f->view, f->splats + slot, f->bounds + slot, count, f->boxes + slot);
    find_boxes(s, &s->right.view, s->right.splats + slot, s->right.bounds + slot, count, s->right.boxes + slot);
    times[2] = fxs_now(f) - shaded;
    f->block_counts[block] = count;
}

/* ---- The pair of frames ---------------------------------------------------------------------------------------- */

size_t fxs_stereo_bytes(const fxs_context *context, const fxs_scene *scene, int32_t width, int32_t height)
{
    size_t frame = fxs_frame_bytes(context, scene, width, height, 0);
    uint64_t right = frame ? (uint64_t)scene->chunk_count * FXS_CHUNK * RIGHT_BYTES : 0;
    return right <= SIZE_MAX - frame ? frame + (size_t)right : 0;
}

static int stereo_init(stereo *s, const fxs_context *context, const fxs_scene *scene, const fxs_camera cameras[2],
                       const fxs_options *options, void *memory, size_t memory_bytes)
{
    fxs_frame *f = &s->frame;
    int error = fxs_frame_init(f, context, scene, &cameras[1], options, memory, memory_bytes);
    s->right = (eye){.view = f->view};
    if (!error)
        error = fxs_frame_init(f, context, scene, &cameras[0], options, memory, memory_bytes);
    if (error)
        return error;
    if (cameras[0].width != cameras[1].width || cameras[0].height != cameras[1].height)
        return FXS_ERR_SIZE;
    f->stats.memory.least = fxs_stereo_bytes(context, scene, f->view.width, f->view.height);
    return f->stats.memory.least && memory_bytes >= f->stats.memory.least ? 0 : FXS_ERR_MEMORY;
}

/* Whether two views measure depth alike: their z axes are parallel, and neither is ahead, within 2^-14. */
static int same_depth(const fxs_view *a, const fxs_view *b)
{
    const int32_t *z_q30 = a->rotation_q30 + 6;
    int64_t apart[3], ahead = 0;
    uint64_t most = 0;
    for (int i = 0; i < 3; i++) {
        int64_t turned_q30 = (int64_t)b->rotation_q30[6 + i] - z_q30[i];
        if (turned_q30 < -(1 << 16) || turned_q30 > 1 << 16)
            return 0;
        apart[i] = b->position_q32[i] - a->position_q32[i];
        most |= (uint64_t)(apart[i] < 0 ? -apart[i] : apart[i]);
    }
    int bits = most ? 64 - fxs_clz64(most) : 0, shift = bits > 30 ? bits - 30 : 0;
    for (int i = 0; i < 3; i++)
        ahead += z_q30[i] * (apart[i] >> shift);
    int64_t limit_q30 = (int64_t)(most >> shift) << 16;
    return -limit_q30 <= ahead && ahead <= limit_q30;
}

/* Puts the right eye's splats behind the frame's memory, and finds the splats of both. Returns 0 or FXS_ERR_SCENE. */
static int prepare(stereo *s)
{
    fxs_frame *f = &s->frame;
    size_t slots = (size_t)f->scene->chunk_count * FXS_CHUNK;
    s->middle = f->view;
    for (int i = 0; i < 3; i++)
        s->middle.position_q32[i] = (f->view.position_q32[i] + s->right.view.position_q32[i]) / 2;
    fxs_bands_init(f);
    fxs_band_next(f);
    s->right.splats = (fxs_splat *)(f->memory + f->stats.memory.total);
    s->right.bounds = (fxs_bounds *)(s->right.splats + slots);
    s->right.boxes = (fxs_box *)(s->right.bounds + slots);
    s->right.depths = (uint32_t *)(s->right.boxes + slots);
    f->stats.memory.splats += slots * RIGHT_BYTES;
    f->stats.memory.total += slots * RIGHT_BYTES;
    return fxs_frame_prepare(f, prepare_block);
}

static void turn_right(stereo *s)
{
    s->frame.view = s->right.view;
    s->frame.splats = s->right.splats;
    s->frame.bounds = s->right.bounds;
    s->frame.boxes = s->right.boxes;
    s->frame.pixels = s->right.pixels;
}

static int render_shared(stereo *s)
{
    fxs_frame *f = &s->frame;
    int sorted = same_depth(&f->view, &s->right.view);
    int error = prepare(s);
    if (!error)
        error = fxs_frame_draw(f);
    if (error)
        return error;
    turn_right(s);
    if (!sorted) {
        memcpy(f->spare_keys, s->right.depths, (size_t)f->scene->chunk_count * FXS_CHUNK * sizeof *s->right.depths);
        fxs_frame_sort(f);
    }
    return fxs_frame_draw(f);
}

static int render_exact(stereo *s)
{
    int error = fxs_frame_render(&s->frame);
    turn_right(s);
    return error ? error : fxs_frame_render(&s->frame);
}

int fxs_render_stereo(const fxs_context *context, const fxs_scene *scene, const fxs_camera cameras[2],
                      const fxs_options *options, int exact, void *memory, size_t memory_bytes, void *const pixels[2],
                      ptrdiff_t stride, fxs_stats *stats)
{
    stereo s;
    if (!context || !cameras || !pixels || !pixels[0] || !pixels[1])
        return FXS_ERR_ARGUMENT;
    int error = stereo_init(&s, context, scene, cameras, options, memory, memory_bytes);
    if (!error && !fxs_stride_valid(&cameras[0], options, stride))
        error = FXS_ERR_ARGUMENT;
    if (!error) {
        uint64_t start = fxs_now(&s.frame);
        s.frame.pixels = pixels[0];
        s.frame.stride = stride;
        s.right.pixels = pixels[1];
        error = exact ? render_exact(&s) : render_shared(&s);
        s.frame.stats.frame_nanoseconds = fxs_now(&s.frame) - start;
    }
    if (stats)
        *stats = s.frame.stats;
    return error;
}
