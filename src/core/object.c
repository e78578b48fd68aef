/* Transforms the camera to an object's space, so that the stages need not know objects. Applies crop boxes, tint and
 * scale to splats. */
#include "object.h"

#include "animate.h"
#include "codes.h"
#include <fixsplat/internal/fixed.h>
#include "memory.h"

#define SCALE_LEAST_Q32 (FXS_ONE_Q32 >> 16)
#define SCALE_MOST_Q32 (FXS_ONE_Q32 << 16)
#define TRANSLATION_MOST_Q32 ((int64_t)1 << 60)
#define ONE_Q16 65536u
#define ONE_Q13 8192u
#define TINT_MOST_Q13 (4u * ONE_Q13)

static int check_crop(const fxs_crop *crop)
{
    for (int i = 0; i < 3; i++)
        if (crop->low_q32[i] > crop->high_q32[i])
            return FXS_ERR_OBJECT;
    return 0;
}

int fxs_object_check(const fxs_object *object)
{
    if (!object->scene || (object->crop_count && !object->crops))
        return FXS_ERR_ARGUMENT;
    if (!fxs_is_rotation(object->rotation_q30) || object->scale_q32 < SCALE_LEAST_Q32 ||
        object->scale_q32 > SCALE_MOST_Q32 || object->opacity_q16 > ONE_Q16 || object->crop_count > FXS_MAX_CROPS)
        return FXS_ERR_OBJECT;
    int error = 0;
    for (int i = 0; i < 3; i++)
        if (object->translation_q32[i] < -TRANSLATION_MOST_Q32 || object->translation_q32[i] > TRANSLATION_MOST_Q32 ||
            object->tint_q13[i] > TINT_MOST_Q13)
            error = FXS_ERR_OBJECT;
    for (uint32_t i = 0; i < object->crop_count && !error; i++)
        error = check_crop(&object->crops[i]);
    return error;
}

/* Converts an opacity to the offset -2 ln(opacity) = 32 ln 2 - 2 ln 2 log2(opacity_q16), saturated at FXS_FAINT_Q11 +
   1. An opacity of 0 counts as 1. */
static int32_t offset_of_q11(uint32_t opacity_q16)
{
    if (opacity_q16 == ONE_Q16 || !opacity_q16)
        return 0;
    const int64_t below_q16 = ((int64_t)16 << 16) - fxs_log2_q16(opacity_q16);
    return fxs_min((int)((below_q16 * 45426 * 2 + (1 << 20)) >> 21), FXS_FAINT_Q11 + 1);   /* the factor ln 2 is 45426
                                                                                              in Q16 */
}

int fxs_object_view_init(fxs_object_view *out, const fxs_stage_view *world, const fxs_camera *camera,
                         const fxs_object *object)
{
    memset(out, 0, sizeof *out);
    out->scene = *object->scene;
    out->id = object->id;
    out->visible = object->visible && object->opacity_q16;
    out->scale = fxs_scale_of(object->scale_q32);
    out->crops = object->crops;
    out->crop_count = object->crop_count;
    out->plain = object->scale_q32 == FXS_ONE_Q32 && !object->crop_count;
    for (uint32_t i = 0; i < object->crop_count; i++)
        out->keep_count += !object->crops[i].outside;
    for (int c = 0; c < 3; c++)
        out->tint_q13[c] = (int32_t)object->tint_q13[c];
    if (object->scene->motion) {
        fxs_motion_header motion;
        if (fxs_motion_read(&motion, object->scene))
            return FXS_ERR_SCENE;
        out->motion = fxs_motion_rows_of(object->scene, &motion);
    }
    const int error = fxs_view_of_object(&out->view, world, camera, object);
    out->view.offset_q11 = offset_of_q11(object->opacity_q16);
    return error;
}

FXS_STAGE uint32_t fxs_object_of(const fxs_object_view *objects, uint32_t count, uint32_t chunk)
{
    uint32_t low = 0, high = count;
    while (high - low > 1) {
        const uint32_t middle = (low + high) / 2;
        if (objects[middle].first_chunk <= chunk)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* ---- Changes by an object ---------------------------------------------------------------------------------------- */

static uint32_t scale_depth(uint32_t key, fxs_scale scale)
{
    const uint32_t product = fxs_mulhi((1u << 26 | (key & 0x3ffffff)) << 5, scale.mantissa);
    const int zeros = fxs_clz32(product), exponent = (int)(key >> 26) + scale.exponent + 1 - zeros;
    return exponent < 0 ? 0 : exponent > 63 ? UINT32_MAX
           : (uint32_t)exponent << 26 | ((product << zeros) >> 5 & 0x3ffffff);
}

static int lies_in(const int64_t low_q32[3], const int64_t high_q32[3], const fxs_crop *crop, int any)
{
    for (int i = 0; i < 3; i++) {
        const int64_t *first = any ? high_q32 : low_q32, *last = any ? low_q32 : high_q32;
        if (first[i] < crop->low_q32[i] || last[i] > crop->high_q32[i])
            return 0;
    }
    return 1;
}

/* Returns true if a part of the box low..high may pass the object's crop boxes. For a point, the answer is exact. */
static int within_crops(const fxs_object_view *object, const int64_t low_q32[3], const int64_t high_q32[3])
{
    int kept = !object->keep_count;
    for (uint32_t i = 0; i < object->crop_count; i++) {
        const fxs_crop *crop = &object->crops[i];
        if (crop->outside && lies_in(low_q32, high_q32, crop, 0))
            return 0;
        kept |= !crop->outside && lies_in(low_q32, high_q32, crop, 1);
    }
    return kept;
}

FXS_STAGE int fxs_object_has_chunk(const fxs_object_view *object, const fxs_chunk *header)
{
    int64_t high_q32[3];
    for (int i = 0; i < 3; i++)
        high_q32[i] = header->origin_q32[i] + ((int64_t)header->step_q32[i] * 65535 << header->step_shift);
    return !object->crop_count || within_crops(object, header->origin_q32, high_q32);
}

FXS_STAGE int fxs_object_change(const fxs_object_view *object, const fxs_chunk *header, const uint16_t position[3],
                                uint32_t *depth)
{
    int64_t centre_q32[3];
    for (int i = 0; i < 3; i++)
        centre_q32[i] = header->origin_q32[i] + ((int64_t)header->step_q32[i] * position[i] << header->step_shift);
    if (object->crop_count && !within_crops(object, centre_q32, centre_q32))
        return 0;
    *depth = scale_depth(*depth, object->scale);
    return 1;
}

FXS_STAGE void fxs_object_tint(const fxs_object_view *object, fxs_splat *splat)
{
    for (int c = 0; c < 3; c++)
        splat->colour_q13[c] = (int16_t)fxs_min((splat->colour_q13[c] * object->tint_q13[c] + 4096) >> 13, 32767);
}

#ifndef __CUDACC__
int32_t fxs_object_project(const fxs_object_view *object, const fxs_kernels *kernels, uint32_t chunk,
                           uint32_t share_q8, uint32_t grow_q8, fxs_splat *splats, fxs_bounds *bounds,
                           uint32_t *indices, uint32_t *depths)
{
    const fxs_stage_view *view = &object->view;
    fxs_stage_view changed;
    fxs_chunk header;
    int32_t kept = 0;
    if (!object->visible)
        return 0;
    if (object->plain && share_q8 == 256 && !grow_q8)
        return kernels->project(view, &object->scene, chunk, splats, bounds, indices, depths);
    if (share_q8 != 256 || grow_q8) {
        changed = *view;
        changed.share_q8 = share_q8;
        changed.grow_q16 = (int32_t)grow_q8 << 8;
        view = &changed;
    }
    if (object->plain)
        return kernels->project(view, &object->scene, chunk, splats, bounds, indices, depths);
    const int error = fxs_chunk_read(&header, &object->scene, chunk);
    if (error)
        return error;
    if (!fxs_object_has_chunk(object, &header))
        return 0;
    const int32_t count = kernels->project(view, &object->scene, chunk, splats, bounds, indices, depths);
    const unsigned char *rows = fxs_rows(&object->scene, chunk);
    for (int32_t i = 0; i < count; i++) {
        const fxs_codes codes = fxs_codes_of(&object->scene, rows, indices[i] % FXS_CHUNK);
        splats[kept] = splats[i];
        bounds[kept] = bounds[i];
        indices[kept] = indices[i];
        depths[kept] = depths[i];
        kept += fxs_object_change(object, &header, codes.position, &depths[kept]);
    }
    return count < 0 ? count : kept;
}

int fxs_object_shade(const fxs_object_view *object, const fxs_kernels *kernels, uint32_t chunk,
                     const uint32_t *indices, uint32_t count, fxs_splat *splats)
{
    const int error = count ? kernels->shade(&object->view, &object->scene, chunk, indices, count, splats) : 0;
    const int tinted = object->tint_q13[0] != (int)ONE_Q13 || object->tint_q13[1] != (int)ONE_Q13 ||
                       object->tint_q13[2] != (int)ONE_Q13;
    for (uint32_t i = 0; i < count && tinted && !error; i++)
        fxs_object_tint(object, &splats[i]);
    return error;
}
#endif
