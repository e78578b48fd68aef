/* project for two eyes. A Gaussian that either eye sees has the same slot for both eyes, so colours and the order by
 * depth are found once. */
#include "eyes.h"

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

/* Centre of a splat that the eye does not see: left of every centre that project accepts. */
#define UNSEEN_Q14 (-FXS_CENTRE_LIMIT_Q14)

/* Moves the last of *count splats to slot `to`. If the eye does not see it, writes a splat that no list has. */
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

int32_t fxs_eyes_project(fxs_frame *f, uint32_t object, uint32_t chunk, uint32_t share_q8, uint32_t grow_q8,
                         uint32_t slot)
{
    const fxs_eye *eyes = f->eyes;
    const fxs_kernels *kernels = &f->context->kernels;
    uint32_t right_indices[FXS_CHUNK], *indices = f->indices + slot;
    uint32_t *depths = eyes[0].depths + slot, *right_depths = eyes[1].depths + slot;
    const int32_t of_left = fxs_object_project(&eyes[0].objects[object], kernels, chunk, share_q8, grow_q8,
                                               eyes[0].splats + slot, eyes[0].bounds + slot, indices, depths);
    const int32_t of_right = fxs_object_project(&eyes[1].objects[object], kernels, chunk, share_q8, grow_q8,
                                                eyes[1].splats + slot, eyes[1].bounds + slot, right_indices,
                                                right_depths);
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

void fxs_eyes_hide(const fxs_bounds *bounds, uint32_t count, fxs_box *boxes)
{
    for (uint32_t i = 0; i < count; i++)
        if (bounds[i].cx_q14 == UNSEEN_Q14)
            boxes[i] = FXS_NOWHERE;
}
