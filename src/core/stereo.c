/* Renders two eyes. Each eye has the geometry and tile lists of its own camera. Colours are found once for both eyes;
 * so is the order, if both views measure depth alike. */
#include <fixsplat/fixed.h>
#include "bands.h"
#include "prepare.h"
#include "stereo.h"
#include "targets.h"

/* True if two views measure depth alike: parallel z axes, and no view ahead of the other, within 2^-14. */
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

/* Moves the left eye's viewpoint for colours to the middle between the eyes. */
static void share_eye(fxs_object_view *left, const fxs_object_view *right, uint32_t objects)
{
    for (uint32_t object = 0; object < objects; object++)
        for (int i = 0; i < 3; i++) {
            int64_t *left_q32 = left[object].view.eye_q32;
            left_q32[i] = (left_q32[i] + right[object].view.eye_q32[i]) / 2;
        }
}

/* True if the right eye's lists need their own order, also with an occluder, which cuts lists at a depth. */
static int has_own_order(const fxs_view *left, const fxs_view *right, const fxs_targets *of_right)
{
    return !same_depth(left, right) || of_right->occluder.pixels;
}

#ifndef __CUDACC__                 /* the CUDA back end renders two eyes in its own way */

static int render_shared(fxs_frame *f)
{
    int error = fxs_frame_begin(f);
    if (error)
        return error;
    share_eye(f->eyes[0].objects, f->eyes[1].objects, f->object_count);
    fxs_band_next(f);
    error = fxs_prepare_band(f);
    if (!error)
        error = fxs_frame_draw(f);
    if (error)
        return error;
    f->eye = &f->eyes[1];
    if (has_own_order(&f->eyes[0].view, &f->eyes[1].view, f->eye->targets))
        f->depths = f->eye->depths;
    return fxs_frame_draw(f);
}

/* Sets up both eyes first, so that an object too far from the second eye is an error before any output. */
static int render_exact(fxs_frame *f)
{
    int error = fxs_frame_begin(f);
    f->eye_count = 1;
    error = error ? error : fxs_frame_render(f);
    f->eye = &f->eyes[1];
    return error ? error : fxs_frame_render(f);
}

int fxs_stereo_render(fxs_frame *f, const fxs_request *request)
{
    const fxs_camera *a = &request->cameras[0], *b = &request->cameras[1];
    if (a->width != b->width || a->height != b->height || a->projection != b->projection)
        return FXS_ERR_SIZE;
    if ((uint64_t)f->chunk_count * FXS_CHUNK > FXS_MAX_SLOTS)   /* stereo has no bands */
        return FXS_ERR_OBJECT;
    if (fxs_targets_collide(&request->targets[0], &request->targets[1], a->width, a->height))
        return FXS_ERR_TARGET;
    f->stats.memory.least = fxs_request_bytes(f->context, request, 0);
    if (!f->stats.memory.least || f->memory_bytes < f->stats.memory.least)
        return FXS_ERR_MEMORY;
    const uint64_t start = fxs_now(f);
    const int error = request->exact ? render_exact(f) : render_shared(f);
    f->stats.frame_nanoseconds = fxs_now(f) - start;
    return error;
}
#endif
