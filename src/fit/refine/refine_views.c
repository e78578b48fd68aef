/* Chooses views of a packed scene for refining its levels of detail. Without given cameras, views look from a spiral
 * about the up axis, a golden angle apart (Vogel 1979), at several distances. Closer cameras look at points farther
 * from the scene's middle. */
#include "refine_views.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "src/base/os_calls.h"
#include "src/base/try_internal.h"
#include "src/camera/camera_internal.h"
#include "src/camera/first_view.h"
#include "src/fit/fit_internal.h"
#include "src/base/random.h"

enum { LEAST = 720, MOST = 1920 };     /* limits of the longer side of a large picture, in pixels */
enum { FOV = 50, PARTS = 6 };

#define LOWEST (-0.3)                  /* lowest and highest sine of the cameras' elevation angles */
#define HIGHEST 0.95
#define TURN_COSINE (-0.7373688780783197)   /* cosine of the golden angle, 2.39996 radians */
#define TURN_SINE 0.6754902942615238

#define FEW 1048576.0                  /* For scenes with up to this number of Gaussians, large pictures have the longer
                                          side LEAST. */
static const double parts[PARTS] = {1, 0.7, 0.5, 0.35, 0.25, 0.15};

static uint32_t most_views(const fxs_refine_options *o)
{
    return o->steps ? FXS_REFINE_VIEWS : FXS_REFINE_MEASURED;
}

static double random_between(uint32_t view, uint32_t axis)
{
    return 2 * (double)fxs_random_uniform(fxs_random(0, view, axis)) - 1;
}

/* Returns the longer side of a scene's pictures in pixels. Scenes with more Gaussians need larger pictures to stay
   sharp. */
static int longer_of(const fxs_scene *scene, int size)
{
    const double longer = LEAST * sqrt(scene->count / FEW);
    const int large = longer < LEAST ? LEAST : longer < MOST ? (int)longer : MOST;
    return size == FXS_REFINE_LARGE ? large : large / 3 * 2;
}

static size_t picture_bytes(const fxs_scene *scene)
{
    const size_t longer = (size_t)longer_of(scene, FXS_REFINE_LARGE);
    return 3 * longer * longer;
}

static int look_around(fxs_view views[FXS_REFINE_VIEWS], const fxs_scene *scene, const fxs_refine_options *o,
                       const double low[3], const double high[3], fxs_message *message)
{
    const int longer = longer_of(scene, FXS_REFINE_LARGE), shorter = longer / 3 * 2;
    const uint32_t count = most_views(o);
    fxs_first_choice c;
    fxs_object object;
    double back[3], up[3], cosine = 1, sine = 0;
    fxs_object_init(&object, scene);
    FXS_TRY(fxs_first_view_choose(&c, o->context, &object, 1, low, high, NULL, message));
    FXS_TRY(fxs_level_back(back, up, c.up, message));
    memcpy(c.low, low, sizeof c.low);
    memcpy(c.high, high, sizeof c.high);
    const double side[3] = {up[1] * back[2] - up[2] * back[1], up[2] * back[0] - up[0] * back[2],
                            up[0] * back[1] - up[1] * back[0]};
    for (uint32_t i = 0; i < count; i++) {
        const double rise = LOWEST + (HIGHEST - LOWEST) * (i + 0.5) / count, out = sqrt(1 - rise * rise);
        const double turned = cosine;
        double eye[3], target[3];
        c.part = parts[i % PARTS];
        for (int k = 0; k < 3; k++)
            c.from[k] = out * (cosine * back[k] + sine * side[k]) + rise * up[k];
        FXS_TRY(fxs_first_view_make(&c, FOV, longer, shorter, &views[i], message));
        for (int k = 0; k < 3; k++) {
            eye[k] = views[i].position[k];
            target[k] = (low[k] + high[k]) / 2 + (1 - c.part) * (high[k] - low[k]) / 2 * random_between(i, (uint32_t)k);
        }
        FXS_TRY(fxs_view_look_at(&views[i], eye, target, up, &(fxs_picture){FOV, longer, shorter}, message));
        views[i].near = fxs_near_of_box(low, high);
        cosine = cosine * TURN_COSINE - sine * TURN_SINE;
        sine = sine * TURN_COSINE + turned * TURN_SINE;
    }
    return (int)count;
}

static void limit(fxs_view *view, int most)
{
    const int64_t longer = view->width > view->height ? view->width : view->height;
    if (longer > most)
        fxs_view_resize(view, (int)((view->width * most + longer / 2) / longer),
                        (int)((view->height * most + longer / 2) / longer));
}

static int is_usable(const fxs_view *view)
{
    fxs_camera camera;
    fxs_message unwanted;
    fxs_view small = *view;
    limit(&small, LEAST / 3 * 2);
    return view->projection == FXS_PERSPECTIVE && !fxs_camera_from_view(&camera, &small, &unwanted);
}

static int choose_given(fxs_view views[FXS_REFINE_VIEWS], const fxs_refine_options *o)
{
    size_t usable = 0, seen = 0;
    uint32_t count = 0;
    for (size_t i = 0; i < o->view_count; i++)
        usable += (size_t)is_usable(&o->views[i]);
    const size_t most = usable < most_views(o) ? usable : most_views(o);
    for (size_t i = 0; i < o->view_count && count < most; i++) {
        if (!is_usable(&o->views[i]) || seen++ != count * usable / most)
            continue;
        views[count] = o->views[i];
        count++;
    }
    return (int)count;
}

static int render(const fxs_context *context, const fxs_scene *scene, const fxs_view *view, uint8_t *rgba,
                  fxs_message *message)
{
    fxs_object object;
    fxs_request request;
    fxs_object_init(&object, scene);
    fxs_request_init(&request, &object, 1);
    FXS_TRY(fxs_camera_from_view(&request.cameras[0], view, message));
    request.targets[0].colour = (fxs_image){rgba, 4 * (ptrdiff_t)view->width};
    const size_t bytes = fxs_request_bytes(context, &request, NULL);
    void *memory = bytes ? fxs_aligned_allocate(bytes) : NULL;
    if (!memory)
        return fxs_fail_memory(message, "a picture of the scene", bytes);
    const int error = fxs_render(context, &request, memory, bytes, NULL);
    fxs_aligned_free(memory);
    return error ? fxs_fail_as(error, message, "%s", fxs_strerror(error)) : 0;
}

static int take_photograph(fxs_fit_photograph *p, uint8_t *to, const fxs_view *view, const fxs_scene *scene,
                           const fxs_context *context, fxs_message *message)
{
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    uint8_t *rgba = malloc(4 * pixels);
    const int error = rgba ? render(context, scene, view, rgba, message)
                           : fxs_fail_memory(message, "a picture of the scene", 4 * pixels);
    *p = (fxs_fit_photograph){.pixels = to, .width = view->width, .height = view->height, .divisor = 1};
    fxs_fit_set_camera(&p->camera, view);
    p->camera.is_antialiased = scene->antialiased;
    for (size_t i = 0; i < pixels && !error; i++)
        memcpy(to + 3 * i, rgba + 4 * i, 3);
    free(rgba);
    return error;
}

static int take_photographs(fxs_refine_views *v, const fxs_view *views, const fxs_scene *scene,
                            const fxs_refine_options *o, fxs_message *message)
{
    const int first = o->steps ? FXS_REFINE_LARGE : FXS_REFINE_SMALL;
    const size_t each = picture_bytes(scene), bytes = (size_t)(FXS_REFINE_SIZES - first) * v->count * each;
    uint8_t *to = v->pixels = malloc(bytes);
    if (!to)
        return fxs_fail_memory(message, "pictures of the scene", bytes);
    for (int size = first; size < FXS_REFINE_SIZES; size++)
        for (uint32_t i = 0; i < v->count; i++, to += each) {
            fxs_view view = views[i];
            limit(&view, longer_of(scene, size));
            FXS_TRY(take_photograph(&v->photographs[size][i], to, &view, scene, o->context, message));
        }
    return 0;
}

int fxs_refine_views_make(fxs_refine_views *v, const fxs_scene *scene, const void *data, const fxs_refine_options *o,
                          fxs_message *message)
{
    fxs_view views[FXS_REFINE_VIEWS];
    double low[3], high[3], square = 0;
    memset(v, 0, sizeof *v);
    fxs_inner_box(data, low, high);
    for (int k = 0; k < 3; k++)
        square += (high[k] - low[k]) * (high[k] - low[k]);
    v->extent = square > 0 ? (float)(sqrt(square) / 2) : 1;
    int count = choose_given(views, o);
    if (!count)
        count = look_around(views, scene, o, low, high, message);
    if (count < 0)
        return count;
    v->count = (uint32_t)count;
    return take_photographs(v, views, scene, o, message);
}

void fxs_refine_views_free(fxs_refine_views *v)
{
    free(v->pixels);
    memset(v, 0, sizeof *v);
}
