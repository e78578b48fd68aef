/* Chooses the first view of an opened scene that has no cameras. */
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/internal/view_more.h>
#include "port/backend/processor_internal.h"
#include "opened_camera.h"
#include "src/base/try_internal.h"
#include "src/camera/first_view.h"

/* Chooses the first view of a scene, with threads on all processors. */
static int choose(const fxs_object *objects, uint32_t count, double box[2][3], const double up[3],
                  fxs_first_choice *first, fxs_message *message)
{
    static const fxs_backend_options usual = {.size = sizeof usual};
    static const fxs_config plain = {.size = sizeof plain};
    fxs_processor processor;
    int error = fxs_processor_open(&processor, &usual, &plain, message);
    if (error)
        return error;
    error = fxs_first_view_choose(first, &processor.context, objects, count, box[0], box[1], up, message);
    fxs_processor_close(&processor);
    return error;
}

int fxs_first_view(const fxs_object *objects, uint32_t count, double box[2][3], double up[3],
                   const fxs_picture *picture, fxs_view *view, fxs_message *message)
{
    fxs_first_choice chosen;
    if ((count && !objects) || !box || !picture || !view || !up)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to choose a view of", objects ? "box or view" : "objects");
    const int width = picture->width, height = picture->height;
    if (width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE)
        return fxs_fail_as(FXS_ERR_SIZE, message, "a picture of %dx%d: each side has 1 to %d pixels", width, height,
                           FXS_MAX_SIZE);
    const int error = choose(objects, count, box, up, &chosen, message);
    if (error)
        return error;
    memcpy(up, chosen.up, sizeof chosen.up);
    return fxs_first_view_make(&chosen, picture->fov, width, height, view, message);
}

int fxs_opened_first_view(const fxs_opened *opened, const fxs_picture *picture, fxs_view *view, fxs_message *message)
{
    double box[2][3], up[3];
    fxs_object object;
    memcpy(box[0], opened->report->inner_low, sizeof box[0]);
    memcpy(box[1], opened->report->inner_high, sizeof box[1]);
    memcpy(up, opened->info->start.up, sizeof up);
    fxs_object_init(&object, opened->scene);
    return fxs_first_view(&object, 1, box, up, picture, view, message);
}

int fxs_opened_camera(const fxs_opened *opened, int32_t width, int32_t height, fxs_camera *camera,
                      fxs_message *message)
{
    fxs_view view;
    if (!opened || !camera)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to frame", opened ? "camera" : "scene");
    if (fxs_view_of_start(&view, opened->data, width, height)) {
        view.near = fxs_near_of_box(opened->report->inner_low, opened->report->inner_high);
        return fxs_camera_from_view(camera, &view, message);
    }
    if (opened->pager) {
        const double usual[3] = {0, -1, 0}, *up = opened->info->start.up;
        const int is_known = up[0] != 0 || up[1] != 0 || up[2] != 0;
        FXS_TRY(fxs_view_frame_box(&view, opened->report->inner_low, opened->report->inner_high, is_known ? up : usual,
                                   &(fxs_picture){50, width, height}, message));
        view.near = fxs_near_of_box(opened->report->inner_low, opened->report->inner_high);
        return fxs_camera_from_view(camera, &view, message);
    }
    const int error = fxs_opened_first_view(opened, &(fxs_picture){50, width, height}, &view, message);
    return error ? error : fxs_camera_from_view(camera, &view, message);
}
