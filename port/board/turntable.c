/* Turns a scene in front of a camera that shows the whole scene. */
#include "turntable.h"

#include <fixsplat/internal/packed.h>

#define COS_18_Q30 1021189159
#define SIN_18_Q30 331804471
#define QUARTER (FXS_TURNTABLE_STEPS / 4)

/* Returns sin(2 pi i / 64) in Q30. */
static int32_t sine_q30(uint32_t i)
{
    static const int32_t quarter_q30[QUARTER + 1] = {
        0, 105245103, 209476638, 311690799, 410903207, 506158392, 596538995, 681174602, 759250125, 830013654, 892783698,
        946955747, 992008094, 1027506862, 1053110176, 1068571464, 1073741824};
    const uint32_t at = i % (2 * QUARTER);
    const int32_t sine = quarter_q30[at <= QUARTER ? at : 2 * QUARTER - at];
    return i % FXS_TURNTABLE_STEPS < 2 * QUARTER ? sine : -sine;
}

/* Returns the product x r for r from -1 to 1, rounded down. x has up to 61 bits, so the product takes two steps. */
static int64_t times_q30(int64_t x, int32_t r_q30)
{
    return (x >> 30) * r_q30 + ((x & 0x3fffffff) * r_q30 >> 30);
}

/* Places the camera 18 degrees above the scene, with a vertical field of view of 50 degrees. */
static void frame_box(fxs_turntable *t, const int64_t half_q32[3], int32_t width, int32_t height)
{
    fxs_camera *c = &t->camera;
    fxs_camera_init(c, width, height);
    /* focal length in pixels, as a multiple of the height: 1 / (2 tan 25 degrees) = 1.0723 */
    c->fx_q12 = c->fy_q12 = height * 4392;
    /* radius of the turning box, half the diagonal of its floor: sqrt(x^2 + z^2) <= greater + 7/16 lesser */
    const int64_t x = half_q32[0], z = half_q32[2], radius = x > z ? x + z / 16 * 7 : z + x / 16 * 7;
    const int64_t tall = times_q30(half_q32[1], COS_18_Q30) + times_q30(radius, SIN_18_Q30);
    const int32_t high = height / 32 < width ? height : 32 * width;
    /* camera distance at which the box fills 95 % of the picture: half the box's size times 2.25 = 1 / (0.95 tan 25
       degrees) */
    const int64_t far_y = tall / 8 * 18 + 1, far_x = radius / 8 * 18 / width * high + 1;
    const int64_t distance = radius / 4 + (far_x > far_y ? far_x : far_y);
    const int32_t rotation_q30[9] = {1 << 30, 0, 0, 0, COS_18_Q30, -SIN_18_Q30, 0, SIN_18_Q30, COS_18_Q30};
    for (int i = 0; i < 9; i++)
        c->rotation_q30[i] = rotation_q30[i];
    for (int i = 0; i < 3; i++)
        c->position_q32[i] = t->middle_q32[i] - times_q30(distance, rotation_q30[6 + i]);
    c->near_q32 = distance / 64 > 4096 ? distance / 64 : 4096;
}

int fxs_turntable_open(fxs_turntable *t, const void *data, size_t bytes, int32_t width, int32_t height)
{
    const fxs_packed_header *header = data;
    int64_t half_q32[3];
    const int error = fxs_scene_open(&t->scene, data, bytes);
    if (error)
        return error;
    if (width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE)
        return FXS_ERR_SIZE;
    for (int i = 0; i < 3; i++) {
        const int64_t low = (int64_t)fxs_little_64((uint64_t)header->inner_low_q32[i]);
        const int64_t high = (int64_t)fxs_little_64((uint64_t)header->inner_high_q32[i]);
        /* the scene must lie within 2^24 units, which leaves room for the camera's distance */
        const int64_t most = (int64_t)1 << 56;
        if (low > high || low < -most || high > most)
            return FXS_ERR_SCENE;
        half_q32[i] = (high - low) / 2;
        t->middle_q32[i] = low + half_q32[i];
    }
    frame_box(t, half_q32, width, height);
    fxs_object_init(&t->object, &t->scene);
    t->duration_q32 = fxs_scene_motion(&t->scene).duration_q32;
    return 0;
}

/* Rotates the scene about its middle by R, a rotation about the y axis: world = middle + R (position - middle). */
void fxs_turntable_turn(fxs_turntable *t, uint32_t step)
{
    const int32_t sine = sine_q30(step), cosine = sine_q30(step + QUARTER);
    const int32_t rotation_q30[9] = {cosine, 0, sine, 0, 1 << 30, 0, -sine, 0, cosine};
    const int64_t *m = t->middle_q32;
    t->object.time_q32 = t->duration_q32 / FXS_TURNTABLE_STEPS * step;
    for (int i = 0; i < 9; i++)
        t->object.rotation_q30[i] = rotation_q30[i];
    t->object.translation_q32[0] = m[0] - times_q30(m[0], cosine) - times_q30(m[2], sine);
    t->object.translation_q32[1] = 0;
    t->object.translation_q32[2] = m[2] + times_q30(m[0], sine) - times_q30(m[2], cosine);
}
