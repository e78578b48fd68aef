/* The view to begin with of a scene that was fitted. */
#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/message.h>

int fxs_fit_start_view(const fxs_fit_photo *photos, size_t photo_count, void *data, fxs_message *message)
{
    double up[3];
    if (!photo_count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no photograph to begin with");
    fxs_file_view view = photos->view;
    if (fxs_views_up(&photos->view, photo_count, sizeof *photos, up))
        fxs_view_level(&view, up);
    return fxs_view_to_start(data, &view, message);
}
