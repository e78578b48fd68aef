/* A view of a scene in a window of Android: chooses the way to draw, keeps the clock, opens a lost device again. */
#include "window_way.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/view_more.h>

#define PI 3.14159265358979323846
#define LEAST_BUDGET 65536u
#define LEAST_SCALE_Q16 32768u
#define LEAST_POOL (16u << 20)
#define TRIES 3    /* to draw a frame, if the device is lost */

int fxs_system_function(const char *library, const char *name, void *function)
{
    void *const here = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    void *const address = here ? dlsym(here, name) : 0;
    memcpy(function, &address, sizeof address);
    return address != 0;
}

/* ---- Cameras ----------------------------------------------------------------------------------------------------- */

int fxs_window_camera(const fxs_opened *opened, int32_t width, int32_t height, double numbers[FXS_NUMBERS],
                      fxs_message *why)
{
    fxs_camera camera;
    const int error = fxs_opened_camera(opened, width, height, &camera, why);
    const fxs_pack_report *const report = opened->report;
    double depth = 0;
    if (error)
        return error;
    for (int i = 0; i < 3; i++) {
        numbers[FXS_EYE + i] = ldexp((double)camera.position_q32[i], -32);
        numbers[FXS_UP + i] = -ldexp(camera.rotation_q30[3 + i], -30);
        depth += ((report->inner_low[i] + report->inner_high[i]) / 2 - numbers[FXS_EYE + i]) *
                 ldexp(camera.rotation_q30[6 + i], -30);
    }
    depth = fmax(depth, 10 * fxs_near_of_box(report->inner_low, report->inner_high));
    for (int i = 0; i < 3; i++)
        numbers[FXS_LOOKED_AT + i] = numbers[FXS_EYE + i] + depth * ldexp(camera.rotation_q30[6 + i], -30);
    const int across = width < height ? width : height;
    numbers[FXS_FOV] = atan(across / 2.0 / ldexp(camera.fy_q12, -12)) * 2 * 180 / PI;
    return 0;
}

static int make_camera(const fxs_window_view *view, const double numbers[FXS_NUMBERS], uint32_t scale_q16,
                       fxs_camera *camera, fxs_message *why)
{
    const int width = (int)(((uint64_t)view->width * scale_q16 + 32768) >> 16);
    const int height = (int)(((uint64_t)view->height * scale_q16 + 32768) >> 16);
    fxs_picture picture = {numbers[FXS_FOV], width > 1 ? width : 1, height > 1 ? height : 1};
    fxs_view made;
    if (picture.height > picture.width)
        picture.fov = fmin(170, atan(tan(picture.fov * PI / 360) * picture.height / picture.width) * 360 / PI);
    int error = fxs_view_look_at(&made, numbers + FXS_EYE, numbers + FXS_LOOKED_AT, numbers + FXS_UP, &picture, why);
    if (error)
        return error;
    made.near = fxs_near_of_box(view->opened->report->inner_low, view->opened->report->inner_high);
    return fxs_camera_from_view(camera, &made, why);
}

static int make_request(const fxs_window_view *view, const double numbers[FXS_NUMBERS], uint32_t scale_q16,
                        fxs_object *object, fxs_request *request, fxs_message *why)
{
    fxs_object_init(object, view->opened->scene);
    fxs_request_init(request, object, 1);
    request->options.budget = view->paced ? view->pace.budget : view->pace.budget_most;
    return make_camera(view, numbers, scale_q16, &request->cameras[0], why);
}

/* ---- The device -------------------------------------------------------------------------------------------------- */

static void close_way(fxs_window_view *view)
{
    if (view->way)
        view->way->close(view->self);
    view->way = NULL;
}

static int open_way(fxs_window_view *view, fxs_message *why)
{
    static const fxs_window_way *const ways[] = {&fxs_window_vulkan, &fxs_window_egl};
    int error = 0;
    for (size_t i = 0; i < sizeof ways / sizeof *ways && !view->way; i++) {
        error = ways[i]->open(&view->self, view->window, view->pool_bytes, why);
        view->way = error ? NULL : ways[i];
    }
    return error;
}

int fxs_window_take(fxs_window_view *view, void *window, const fxs_window_library *library, fxs_message *why)
{
    void *const before = view->window;
    int error = 0;
    view->width = window ? library->width(window) : 0;
    view->height = window ? library->height(window) : 0;
    view->window = view->width > 0 && view->height > 0 ? window : NULL;
    if (view->way && (error = view->way->take(view->self, view->window, why)) != 0) {
        close_way(view);                               /* the next frame opens it again, or tells why not */
        error = error == FXS_ERR_DEVICE ? 0 : error;
    }
    if (window && !view->window)
        library->release(window);
    if (before)
        library->release(before);
    return error;
}

void fxs_window_scene(fxs_window_view *view, fxs_opened *opened)
{
    if (view->opened) {
        if (view->way)
            view->way->drop(view->self, view->opened->scene);
        fxs_renderer_forget(view->processor, view->opened->scene);
    }
    view->opened = opened;
    view->state = (fxs_window_state){0};
}

void fxs_window_end(fxs_window_view *view, const fxs_window_library *library)
{
    fxs_window_scene(view, NULL);
    close_way(view);
    fxs_renderer_destroy(view->processor);
    if (view->window)
        library->release(view->window);
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

void fxs_window_pace(fxs_window_view *view, uint32_t frame_nanoseconds, uint32_t budget)
{
    fxs_pace_init(&view->pace);
    view->paced = frame_nanoseconds > 0;
    if (view->paced)
        view->pace.frame_nanoseconds = frame_nanoseconds;
    view->pace.budget_most = budget;
    view->pace.budget_least = budget < LEAST_BUDGET ? budget : LEAST_BUDGET;
    view->pace.scale_least_q16 = LEAST_SCALE_Q16;
    fxs_pace_step(&view->pace, 0, 0, view->pace.number);
}

void fxs_window_trim(fxs_window_view *view)
{
    fxs_pace *const pace = &view->pace;
    pace->budget_most = pace->budget_most / 2 > LEAST_BUDGET ? pace->budget_most / 2 : pace->budget_least;
    if (pace->budget > pace->budget_most)
        pace->budget = pace->budget_most;
    view->pool_bytes = view->pool_bytes / 2 > LEAST_POOL ? view->pool_bytes / 2 : LEAST_POOL;
    if (!view->window)
        close_way(view);
    else if (view->way)
        view->way->limit(view->self, view->pool_bytes);
    fxs_renderer_destroy(view->processor);
    view->processor = NULL;
}

static int draw_once(fxs_window_view *view, const fxs_request *request, fxs_message *why)
{
    fxs_stats stats = {0};
    int error = view->way ? 0 : open_way(view, why);
    if (error)
        return error;
    const uint64_t begin = fxs_clock(NULL);
    error = view->way->draw(view->self, request, &stats, why);
    const uint64_t took = fxs_clock(NULL) - begin;
    if (error || (error = view->way->show(view->self, why)) != 0)
        return error;
    view->state.missing = stats.missing;
    view->state.budget = request->options.budget;
    view->state.width = request->cameras[0].width;
    view->state.height = request->cameras[0].height;
    view->state.changed = view->paced && fxs_pace_step(&view->pace, took, stats.drawn, view->pace.number) == 1;
    return 0;
}

int fxs_window_draw(fxs_window_view *view, const double numbers[FXS_NUMBERS], fxs_message *why)
{
    fxs_pager *const pager = view->opened ? view->opened->pager : NULL;
    fxs_pager_state state = {0};
    fxs_object object;
    fxs_request request;
    if (!view->opened || !view->window)
        return 0;
    int late = 0, error = make_request(view, numbers, view->paced ? view->pace.scale_q16 : 65536, &object, &request,
                                       why);
    if (error)
        return error;
    if (pager) {
        fxs_pager_turn(pager, NULL, why);
        request.options.want = (fxs_want){fxs_pager_want, pager};
    }
    error = draw_once(view, &request, why);
    for (int i = 1; i < TRIES && error == FXS_ERR_DEVICE; i++) {
        close_way(view);
        error = draw_once(view, &request, why);
    }
    if (error)
        close_way(view);
    else if (pager)
        late = fxs_pager_turn(pager, &state, why);
    view->state.coming = state.coming + state.lost;
    return error ? error : late;
}

int fxs_window_pick(fxs_window_view *view, const double numbers[FXS_NUMBERS], int32_t x, int32_t y,
                    fxs_pick_result *result, fxs_message *why)
{
    fxs_object object;
    fxs_request request;
    if (!view->opened || x < 0 || y < 0 || x >= view->width || y >= view->height)
        return 0;
    int error = make_request(view, numbers, 65536, &object, &request, why);
    if (!error && !view->processor)
        error = fxs_renderer_create("cpu", NULL, &view->processor, why);
    return error ? error : fxs_renderer_pick(view->processor, &request, x, y, result, why);
}
