/* Reads and writes the start view (the first camera for viewers) in the header of a packed scene. */
#include <math.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/start.h>
#include "camera_internal.h"

int fxs_view_to_start(void *data, const fxs_view *view, fxs_message *message)
{
    fxs_start start;
    fxs_camera camera;
    if (fxs_camera_from_view(&camera, view, message))
        return FXS_ERR_CAMERA;
    const double tangent = view->height / 2.0 / view->fy;
    if (view->projection == FXS_ORTHOGRAPHIC || !(tangent >= 0x1p-24 && tangent <= 12))
        return fxs_fail_as(FXS_ERR_CAMERA, message,
                           "a start view is in perspective, with a field of view of 1 to 170 degrees");
    fxs_start_of(&start, data);
    start.tangent = tangent;
    memcpy(start.position, view->position, sizeof start.position);
    fxs_quaternion_of(view->rotation, start.rotation);
    fxs_start_to(data, &start);
    return 0;
}

int fxs_view_of_start(fxs_view *view, const void *data, int width, int height)
{
    fxs_start start;
    fxs_start_of(&start, data);
    if (!(start.tangent > 0) || width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE)
        return 0;
    memset(view, 0, sizeof *view);
    strcpy(view->name, "start");
    const double *q = start.rotation, w = q[0], x = q[1], y = q[2], z = q[3], s = 2 / (w * w + x * x + y * y + z * z);
    const double rows[9] = {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
                            s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),
                            s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)};
    memcpy(view->rotation, rows, sizeof rows);
    memcpy(view->position, start.position, sizeof start.position);
    view->width = width;
    view->height = height;
    view->cx = width / 2.0;
    view->cy = height / 2.0;
    view->fx = view->fy = height / 2.0 / start.tangent;
    return 1;
}
