/* Sets the up direction and the start view of a fitted scene, from the least tilted camera of all photographs. */
#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include <math.h>
#include <string.h>

static double slope_of(const fxs_view *view, const double up[3])
{
    const double *forward = view->rotation + 6;
    return fabs(forward[0] * up[0] + forward[1] * up[1] + forward[2] * up[2]);
}

int fxs_fit_start_view(const fxs_fit_photo *photos, size_t photo_count, void *data, fxs_message *message)
{
    double up[3] = {0, 0, 0};
    size_t best = 0;
    if (!photo_count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no photograph to begin with");
    const int has_up = fxs_views_up(&photos->view, photo_count, sizeof *photos, up);
    for (size_t i = 1; i < photo_count && has_up; i++)
        best = slope_of(&photos[i].view, up) < slope_of(&photos[best].view, up) ? i : best;
    fxs_start start;
    fxs_start_of(&start, data);
    memcpy(start.up, up, sizeof up);
    fxs_start_to(data, &start);
    fxs_view view = photos[best].view;
    if (has_up)
        fxs_view_level(&view, up);
    return fxs_view_to_start(data, &view, message);
}
