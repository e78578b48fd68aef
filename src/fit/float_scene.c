/* Draws Gaussians that are not packed, with the rendering code of the fit. Before each picture, positions are made
 * relative to the camera in double precision. */
#include "float_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include "src/base/os_calls.h"
#include "fit_internal.h"
#include "src/fit/stages/planes.h"
#include "src/base/random.h"

struct fxs_float_scene {
    fxs_fit_model model;
    float *places;
    double origin[3];
    fxs_fit_stepper *stepper;
    double nudge;                  /* largest random displacement of Gaussians along each axis; 0: none */
    int sh_degree, antialiased;
};

static float within(float x, float farthest)
{
    return fminf(fmaxf(x, -farthest), farthest);
}

static void put(const fxs_float_scene *s, size_t i, const fxs_gaussian *g)
{
    const fxs_fit_model *m = &s->model;
    for (int k = 0; k < 3; k++) {
        s->places[(size_t)k * m->stride + i] = g->position[k];
        plane(m, FXS_FIT_SCALE + k)[i] = within(g->scale[k], FXS_FIT_FARTHEST);
        plane(m, FXS_FIT_COLOUR + k)[i] = g->dc[k];
    }
    for (int k = 0; k < 4; k++)
        plane(m, FXS_FIT_ROTATION + k)[i] = g->rotation[k];
    plane(m, FXS_FIT_OPACITY)[i] = within(g->opacity, FXS_FIT_FARTHEST);
    for (int k = 0; k < 3 * FXS_SH_COUNT(s->sh_degree); k++)
        plane(m, FXS_FIT_SH + k)[i] = g->sh[k];
}

static int read_all(fxs_float_scene *s, fxs_scene_file *file, uint64_t most, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    fxs_pack_dropped dropped = {0};
    uint64_t read = 0;
    int error = fxs_scene_file_rewind(file, message);
    for (long n = 1; n && !error; read += (uint64_t)n) {
        n = fxs_scene_file_read(file, batch, BATCH, message);
        if (n < 0)
            return (int)n;
        if ((uint64_t)n > most - read)
            return fxs_fail(message, "more Gaussians than before");
        for (long i = 0; i < n; i++)
            if (fxs_drawable(&batch[i], s->sh_degree, &dropped))
                put(s, s->model.count++, &batch[i]);
    }
    return error;
}

static int make_room(fxs_float_scene *s, const fxs_scene_file_info *info, fxs_message *message)
{
    const uint64_t planes = FXS_FIT_SH + 3 * (uint64_t)FXS_SH_COUNT(info->sh_degree);
    const uint64_t stride = (info->count + FXS_FIT_GROUP - 1) / FXS_FIT_GROUP * FXS_FIT_GROUP;
    const uint64_t bytes = stride * (planes + 3) * sizeof(float);
    const int fits = info->count <= FXS_MAX_COUNT && bytes <= SIZE_MAX - 64;
    void *memory = fits ? fxs_aligned_allocate((size_t)bytes + 64) : NULL;
    if (!memory)
        return fxs_fail_memory(message, "a scene in floats", bytes);
    s->model.parameters = memory;
    s->model.stride = (size_t)stride;
    s->places = s->model.parameters + planes * stride;
    return 0;
}

static void fill_rest(const fxs_float_scene *s)
{
    for (size_t i = s->model.count; i < s->model.stride; i++)
        put(s, i, &(fxs_gaussian){.rotation = {1, 0, 0, 0}});
}

int fxs_float_scene_read(fxs_float_scene **scene, fxs_scene_file *file, const fxs_scene_file_info *info,
                         fxs_run_fn *run, void *pool, uint32_t threads, fxs_message *message)
{
    fxs_float_scene *s = calloc(1, sizeof *s);
    *scene = NULL;
    if (s)
        s->stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(~0u), run, pool, threads, NULL);
    int error = s && s->stepper ? 0 : fxs_fail_memory(message, "a scene in floats", 0);
    if (!error) {
        s->sh_degree = info->sh_degree;
        s->antialiased = info->antialiased;
        memcpy(s->origin, info->origin, sizeof s->origin);
        error = make_room(s, info, message);
    }
    if (!error)
        error = read_all(s, file, info->count, message);
    if (error) {
        fxs_float_scene_free(s);
        return error;
    }
    fill_rest(s);
    *scene = s;
    return 0;
}

void fxs_float_scene_free(fxs_float_scene *s)
{
    if (!s)
        return;
    fxs_fit_stepper_free(s->stepper);
    fxs_aligned_free(s->model.parameters);
    free(s);
}

void fxs_float_scene_nudge(fxs_float_scene *s, double distance)
{
    s->nudge = distance;
}

static double by_chance(uint64_t axis, uint64_t i)
{
    return 2 * (double)fxs_random_uniform(fxs_random(1, axis, i)) - 1;
}

static void place_from(const fxs_float_scene *s, const double eye[3])
{
    for (int k = 0; k < 3; k++) {
        const float *from = s->places + (size_t)k * s->model.stride;
        float *to = plane(&s->model, FXS_FIT_POSITION + k);
        for (size_t i = 0; i < s->model.stride; i++)
            to[i] = (float)((double)from[i] - (eye[k] - s->origin[k]) +
                            (s->nudge > 0 ? s->nudge * by_chance((uint64_t)k, i) : 0));
    }
}

int fxs_float_scene_draw(fxs_float_scene *s, const fxs_view *view, enum fxs_cutoff cutoff, uint8_t *rgba,
                         fxs_message *message)
{
    const fxs_fit_step_options options = {.sh_degree = s->sh_degree};
    fxs_fit_camera camera;
    fxs_camera usable;
    fxs_fit_plane planes[3];
    if (fxs_camera_from_view(&usable, view, message))
        return FXS_ERR_ARGUMENT;
    fxs_fit_set_camera(&camera, view);
    memset(camera.eye, 0, sizeof camera.eye);
    camera.is_antialiased = s->antialiased;
    camera.is_square = cutoff == FXS_CUTOFF_SQUARE;
    place_from(s, view->position);
    if (fxs_fit_draw(s->stepper, &s->model, &camera, &options, planes))
        return fxs_fail_memory(message, "a picture in floats", 0);
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++, rgba += 4) {
            for (int c = 0; c < 3; c++)
                rgba[c] = (uint8_t)(255 * fminf(planes[c].first[y * planes[c].stride + x], 1) + 0.5f);
            rgba[3] = 255;
        }
    return 0;
}
