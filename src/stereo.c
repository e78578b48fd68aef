/* Two eyes: each has the geometry and tile lists of its own camera; the colours are found once for both, and, where
 * both measure depth alike, the order. What either eye sees has the same slot in both eyes' splats. */
#include "fixed.h"
#include "frame.h"
#include "memory.h"

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

int32_t fxs_stereo_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t slot)
{
    const fxs_eye *eyes = f->eyes;
    const fxs_kernels *kernels = &f->context->kernels;
    uint32_t right_indices[FXS_CHUNK], *indices = f->indices + slot;
    uint32_t *depths = eyes[0].depths + slot, *right_depths = eyes[1].depths + slot;
    const int32_t of_left = fxs_object_project(&eyes[0].objects[object], kernels, chunk, eyes[0].splats + slot,
                                               eyes[0].bounds + slot, indices, depths);
    const int32_t of_right = fxs_object_project(&eyes[1].objects[object], kernels, chunk, eyes[1].splats + slot,
                                                eyes[1].bounds + slot, right_indices, right_depths);
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
        spread(eyes[0].splats + slot, eyes[0].bounds + slot, to, by_left, &left);
        spread(eyes[1].splats + slot, eyes[1].bounds + slot, to, by_right, &right);
    }
    return (int32_t)count;
}

void fxs_stereo_hide(const fxs_bounds *bounds, uint32_t count, fxs_box *boxes)
{
    for (uint32_t i = 0; i < count; i++)
        if (bounds[i].cx_q14 == UNSEEN_Q14)
            boxes[i].base = FXS_NOWHERE;
}

/* ---- The pair of frames ---------------------------------------------------------------------------------------- */

size_t fxs_stereo_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                        int32_t height)
{
    return fxs_measure(context, objects, count, width, height, 2, 0);
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

/* Colours are seen from between the eyes. */
static void share_eye(fxs_frame *f)
{
    for (uint32_t object = 0; object < f->object_count; object++)
        for (int i = 0; i < 3; i++) {
            int64_t *left_q32 = f->eyes[0].objects[object].view.eye_q32;
            left_q32[i] = (left_q32[i] + f->eyes[1].objects[object].view.eye_q32[i]) / 2;
        }
}

static int render_shared(fxs_frame *f)
{
    int error = fxs_bands_init(f);
    if (error)
        return error;
    share_eye(f);
    fxs_band_next(f);
    error = fxs_frame_prepare(f);
    if (!error)
        error = fxs_frame_draw(f);
    if (error)
        return error;
    f->eye = &f->eyes[1];
    if (!same_depth(&f->eyes[0].view, &f->eyes[1].view))
        fxs_frame_sort(f);
    return fxs_frame_draw(f);
}

static int render_exact(fxs_frame *f)
{
    f->eye_count = 1;
    int error = fxs_frame_render(f);
    f->eye = &f->eyes[1];
    return error ? error : fxs_frame_render(f);
}

int fxs_render_stereo(const fxs_context *context, const fxs_object *objects, uint32_t count,
                      const fxs_camera cameras[2], const fxs_options *options, const fxs_targets targets[2], int exact,
                      void *memory, size_t memory_bytes, fxs_stats *stats)
{
    fxs_frame f;
    if (!cameras || !targets)
        return FXS_ERR_ARGUMENT;
    int error = fxs_frame_init(&f, context, objects, count, &cameras[0], options, &targets[0], memory, memory_bytes);
    if (!error)
        error = fxs_frame_add_eye(&f, &cameras[1], &targets[1]);
    if (error)
        return error;
    if (cameras[0].width != cameras[1].width || cameras[0].height != cameras[1].height ||
        cameras[0].projection != cameras[1].projection)
        return FXS_ERR_SIZE;
    if (f.tile_job && (!fxs_targets_any(&targets[0]) || !fxs_targets_any(&targets[1])))
        return FXS_ERR_TARGET;
    f.stats.memory.least = fxs_stereo_bytes(context, objects, count, cameras[0].width, cameras[0].height);
    error = f.stats.memory.least && memory_bytes >= f.stats.memory.least ? 0 : FXS_ERR_MEMORY;
    if (!error) {
        uint64_t start = fxs_now(&f);
        error = exact ? render_exact(&f) : render_shared(&f);
        f.stats.frame_nanoseconds = fxs_now(&f) - start;
    }
    if (stats)
        *stats = f.stats;
    return error;
}
