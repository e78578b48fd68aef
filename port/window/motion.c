#include "motion.h"

#include <math.h>

#include <fixsplat/camera.h>
#include <fixsplat/internal/view_more.h>

#define POLE 0.02   /* smallest angle in radians between the direction of view and the up or down direction */

/* Limits a turn of the camera so that the view keeps the angle POLE from straight up and down. A view that is already
   closer may move away. */
static double clear_of_poles(const fxs_view *view, const double up[3], double down)
{
    const double *forward = view->rotation + 6, pi = acos(-1);
    double along = forward[0] * up[0] + forward[1] * up[1] + forward[2] * up[2];
    double length = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
    double angle = acos(fmax(-1, fmin(1, along / length)));
    return fmin(fmax(angle + down, fmin(angle, POLE)), fmax(angle, pi - POLE)) - angle;
}

static void turn(fxs_view *view, const double pivot[3], const double up[3], double right, double down)
{
    const double axis[3] = {view->rotation[0], view->rotation[1], view->rotation[2]};
    fxs_view_orbit(view, pivot, axis, -clear_of_poles(view, up, down));
    fxs_view_orbit(view, pivot, up, -right);
}

void fxs_motion_orbit(fxs_view *view, double distance, const double up[3], double right, double down)
{
    double pivot[3];
    for (int i = 0; i < 3; i++)
        pivot[i] = view->position[i] + distance * view->rotation[6 + i];
    turn(view, pivot, up, right, down);
}

void fxs_motion_look(fxs_view *view, const double up[3], double right, double down)
{
    const double centre[3] = {view->position[0], view->position[1], view->position[2]};
    turn(view, centre, up, right, down);
}

void fxs_motion_fly(fxs_view *view, double right, double down, double forward)
{
    const double *axes = view->rotation;
    for (int i = 0; i < 3; i++)
        view->position[i] += right * axes[i] + down * axes[3 + i] + forward * axes[6 + i];
}

void fxs_motion_pan(fxs_view *view, double distance, double right, double down)
{
    const double depth = view->projection == FXS_ORTHOGRAPHIC ? 1 : distance;
    fxs_motion_fly(view, -right * depth / view->fx, -down * depth / view->fy, 0);
}

void fxs_motion_zoom(fxs_view *view, double *distance, double factor)
{
    if (view->projection == FXS_ORTHOGRAPHIC) {
        view->fx /= factor;
        view->fy /= factor;
        return;
    }
    fxs_motion_fly(view, 0, 0, *distance * (1 - factor));
    *distance *= factor;
}

void fxs_motion_fit(fxs_view *view, int width, int height)
{
    const double scale = (double)height / view->height;
    view->fx *= scale;
    view->fy *= scale;
    view->cx = width / 2.0;
    view->cy = height / 2.0;
    view->width = width;
    view->height = height;
}
