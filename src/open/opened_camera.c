/* Chooses the first view of a scene without cameras. */
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "port/backend/processor_internal.h"
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

/* Chooses a view of a scene alone. up: the up direction of the scene's file, or all 0; receives the direction found. */
static int look_alone(const fxs_scene *scene, const void *data, double up[3], const fxs_picture *picture,
                      fxs_view *view, fxs_message *message)
{
    fxs_object object;
    double box[2][3];
    fxs_object_init(&object, scene);
    fxs_inner_box(data, box[0], box[1]);
    return fxs_first_view(&object, 1, box, up, picture, view, message);
}

int fxs_start_choose(void *data, size_t bytes, fxs_message *message)
{
    fxs_scene scene;
    fxs_start start;
    fxs_view view;
    const int error = data ? fxs_scene_open(&scene, data, bytes) : FXS_ERR_ARGUMENT;
    if (error)
        return fxs_fail_as(error, message, "%s", fxs_strerror(error));
    fxs_start_of(&start, data);
    FXS_TRY(look_alone(&scene, data, start.up, &(fxs_picture){50, 1280, 720}, &view, message));
    fxs_start_to(data, &start);
    return fxs_view_to_start(data, &view, message);
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
    fxs_start start = opened->info->start;
    FXS_TRY(look_alone(opened->scene, opened->data, start.up, &(fxs_picture){50, width, height}, &view, message));
    return fxs_camera_from_view(camera, &view, message);
}
