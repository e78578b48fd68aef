/* Reads and writes the start view (the first camera for viewers) in the header of a packed scene. A picture
 * higher than wide has a wider view, which shows the scene's visible part to both sides. */
#include <math.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "camera_internal.h"

int fxs_view_to_start(void *data, const fxs_view *view, fxs_message *message)
{
    fxs_start start;
    fxs_camera camera;
    if (fxs_camera_from_view(&camera, view, message))
        return FXS_ERR_CAMERA;
    const double tangent = view->height / 2.0 / view->fy;
    if (view->projection == FXS_ORTHOGRAPHIC || !(tangent >= 0x1p-24 && tangent <= FXS_START_TANGENT_MOST))
        return fxs_fail_as(FXS_ERR_CAMERA, message,
                           "a start view is in perspective, with a field of view of 1 to 170 degrees");
    fxs_start_of(&start, data);
    start.tangent = tangent;
    memcpy(start.position, view->position, sizeof start.position);
    fxs_quaternion_of(view->rotation, start.rotation);
    fxs_start_to(data, &start);
    return 0;
}

/* A picture higher than wide shows no more to both sides than a picture of 16:9. */
#define WIDEST (16.0 / 9)
#define ROOM 1.2

/* The box counts as an ellipsoid, ROOM times as large. c is its centre in camera space, a[i] its half axis i. A plane
   x = m z through the camera touches it if (c.x - m c.z)^2 = |u - m w|^2, with u[i] = a[i].x and w[i] = a[i].z. The
   reach is the larger |m| of the two. */
double fxs_view_reach(const fxs_view *view, const double low[3], const double high[3], int axis)
{
    const double *across = view->rotation + 3 * axis, *forward = view->rotation + 6;
    double x = 0, z = 0, uu = 0, uw = 0, ww = 0;
    for (int i = 0; i < 3; i++) {
        const double centre = (low[i] + high[i]) / 2 - view->position[i], half = ROOM * (high[i] - low[i]) / 2;
        x += across[i] * centre;
        z += forward[i] * centre;
        uu += half * half * across[i] * across[i];
        uw += half * half * across[i] * forward[i];
        ww += half * half * forward[i] * forward[i];
    }
    if (!(z > 0 && z * z > ww))
        return 0;
    const double square = z * z - ww, middle = x * z - uw;
    return (fabs(middle) + sqrt(fmax(middle * middle - square * (x * x - uu), 0))) / square;
}

double fxs_start_reach(const fxs_view *start, const void *data)
{
    double low[3], high[3];
    fxs_inner_box(data, low, high);
    return fmin(fxs_view_reach(start, low, high, 0), WIDEST * start->height / 2.0 / start->fy);
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
    const double tall = (double)height / width, reach = fmin(fxs_start_reach(view, data), start.tangent * tall);
    if (tall > 1 && reach * tall > start.tangent)
        view->fx = view->fy = height / 2.0 / fmin(reach * tall, FXS_START_TANGENT_MOST);
    return 1;
}
