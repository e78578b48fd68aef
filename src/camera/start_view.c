/* The start view that a packed scene keeps in its header. */
#include <math.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/message.h>
#include <fixsplat/packed.h>
#include "camera_internal.h"

/* The tangent of half the field of view of 170 degrees is 11.5, of 1 degree 0.0087. */
#define TANGENT_ONE 16777216.0
#define TANGENT_MOST (12 << 24)

int fxs_view_to_start(void *data, const fxs_file_view *view, fxs_message *message)
{
    fxs_packed_header h;
    fxs_camera camera;
    double q[4];
    if (fxs_camera_from_view(&camera, view, message))
        return FXS_ERR_CAMERA;
    const double tangent = floor(view->height / 2.0 / view->fy * TANGENT_ONE + 0.5);
    if (view->projection == FXS_ORTHOGRAPHIC || !(tangent >= 1 && tangent <= TANGENT_MOST))
        return fxs_fail_as(FXS_ERR_CAMERA, message,
                           "a start view is in perspective, with a field of view of 1 to 170 degrees");
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    fxs_quaternion_of(view->rotation, q);
    h.start_tangent_q24 = (uint32_t)tangent;
    memcpy(h.start_q32, camera.position_q32, sizeof h.start_q32);
    for (int i = 0; i < 4; i++)
        h.start_rotation_q30[i] = (int32_t)floor(ldexp(q[i], 30) + 0.5);
    fxs_packed_header_turn(&h);
    memcpy(data, &h, sizeof h);
    return 0;
}

int fxs_view_of_start(fxs_file_view *view, const void *data, int width, int height)
{
    fxs_packed_header h;
    double q[4], square = 0;
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    for (int i = 0; i < 4; i++) {
        q[i] = ldexp(h.start_rotation_q30[i], -30);
        square += q[i] * q[i];
    }
    int valid = h.start_tangent_q24 >= 1 && h.start_tangent_q24 <= TANGENT_MOST && fabs(square - 1) < 1e-3;
    for (int i = 0; i < 3; i++)
        valid = valid && fxs_within(h.start_q32[i], (int64_t)1 << 60);
    if (!valid || width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE)
        return 0;
    memset(view, 0, sizeof *view);
    strcpy(view->name, "start");
    const double w = q[0], x = q[1], y = q[2], z = q[3], s = 2 / square;
    const double rows[9] = {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
                            s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),
                            s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)};
    memcpy(view->rotation, rows, sizeof rows);
    for (int i = 0; i < 3; i++)
        view->position[i] = ldexp((double)h.start_q32[i], -32);
    view->width = width;
    view->height = height;
    view->cx = width / 2.0;
    view->cy = height / 2.0;
    view->fx = view->fy = height / 2.0 / (h.start_tangent_q24 / TANGENT_ONE);
    return 1;
}
