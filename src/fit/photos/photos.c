/* Reads a set of photographs (photos.h): first the pixels, in batches on the thread pool, then the initial points. Sets
 * without points start with random ones in a cube around the cameras. */
#include <fixsplat/fit.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/fit_more.h>
#include "src/base/run.h"
#include "src/base/report.h"
#include "src/base/options.h"
#include "photo_list.h"
#include "photo_pixels.h"
#include "photo_points.h"
#include "photos_internal.h"

enum { BATCH = 32, LONGER_SIDE = 1600 };

#define BLENDER_HALF 1.3           /* half the side of the cube of random points in synthetic scenes (Kerbl et al.
                                      2023) */
#define OF_CAMERAS 3               /* side of the cube of random points in other scenes, relative to the side of the
                                      cameras' bounding box */

typedef struct result {
    fxs_photo_pixels photo;
    fxs_message message;
    int error, has_mask;
} result;

typedef struct reading {
    const fxs_photo_list *list;
    const fxs_view_list *views;
    const fxs_photos_options *options;
    size_t first;
    result *results;
} reading;

static int read_one(const reading *r, const fxs_listed_view *view, result *made)
{
    const int resolution = r->options->resolution ? r->options->resolution : LONGER_SIDE;
    char path[FXS_PHOTO_PATH];
    fxs_photo_masking masking;
    fxs_camera camera;
    made->photo.pixels = made->photo.mask = NULL;
    FXS_TRY(fxs_photo_list_image(r->list, view, path, &made->message));
    FXS_TRY(fxs_photo_mask_find(r->list, r->options, view, path, &masking, &made->message));
    made->has_mask = *masking.path != 0;
    FXS_TRY(fxs_photo_read(path, view, resolution, r->options->background, &masking, &made->photo, &made->message));
    return fxs_camera_from_view(&camera, &made->photo.view, &made->message);
}

static void read_job(void *argument, uint32_t i)
{
    reading *r = argument;
    result *made = &r->results[i];
    made->error = read_one(r, &r->views->views[r->first + i], made);
}

static int keep(const reading *r, uint32_t count, fxs_fit_photo *photos, size_t *kept, fxs_photos *all,
                fxs_message *message)
{
    int error = 0;
    for (uint32_t i = 0; i < count; i++) {
        result *made = &r->results[i];
        if (!error && !made->error) {
            photos[*kept] = (fxs_fit_photo){made->photo.view, made->photo.pixels, made->photo.exposure,
                                            made->photo.mask};
            ++*kept;
            *(made->has_mask ? &all->with_mask : &all->without_mask) += 1;
            continue;
        }
        free(made->photo.pixels);
        free(made->photo.mask);
        if (!error && r->options->skip_bad && made->error == FXS_ERR_FILE) {
            all->skipped++;
            if (r->options->left_out)
                r->options->left_out(r->options->left_out_argument, made->message.text);
        } else if (!error) {
            error = made->error;
            *message = made->message;
            if (error == FXS_ERR_FILE)
                fxs_fail(message, "%s (a photograph of %s; skip_bad, --skip-bad, leaves such out)", made->message.text,
                         r->views->path);
        }
    }
    return error;
}

static int read_all(reading *r, const fxs_view_list *views, fxs_fit_photo **photos, size_t *kept, fxs_photos *all,
                    size_t done, size_t count, fxs_message *message)
{
    const fxs_photos_options *o = r->options;
    fxs_run_fn *const run = o->workers.run ? o->workers.run : fxs_run_here;
    r->views = views;
    *photos = calloc(views->count + 1, sizeof **photos);
    if (!*photos)
        return fxs_fail_memory(message, views->path, views->count * sizeof **photos);
    for (r->first = 0; r->first < views->count; r->first += BATCH) {
        const size_t left = views->count - r->first;
        const uint32_t jobs = left < BATCH ? (uint32_t)left : BATCH;
        run(o->workers.pool, read_job, r, jobs);
        FXS_TRY(keep(r, jobs, *photos, kept, all, message));
        if (fxs_report(&o->progress, (double)(done + r->first + jobs) / (double)count))
            return fxs_fail_as(FXS_ERR_STOPPED, message, "reading of photographs stopped");
    }
    return 0;
}

static int has_counting_pixels(const fxs_fit_photo *photo)
{
    return !photo->mask || memchr(photo->mask, 1, (size_t)photo->view.width * (size_t)photo->view.height);
}

static int check_ignored(const fxs_photo_list *list, const fxs_photos *photos, fxs_message *message)
{
    size_t ignored = 0;
    while (ignored < photos->fit_count && !has_counting_pixels(&photos->fit[ignored]))
        ignored++;
    if (ignored && ignored == photos->fit_count)
        return fxs_fail(message, "%s: all pixels of all photographs to fit are ignored; are the masks inverse?",
                        list->cameras);
    return 0;
}

int fxs_photos_pixels(const fxs_photo_list *list, const fxs_photos_options *options, fxs_photos *photos,
                      fxs_message *message)
{
    const size_t count = list->fit.count + list->held_out.count;
    reading r = {list, NULL, options, 0, calloc(BATCH, sizeof(result))};
    if (!r.results)
        return fxs_fail_memory(message, list->cameras, BATCH * sizeof(result));
    int error = read_all(&r, &list->fit, &photos->fit, &photos->fit_count, photos, 0, count, message);
    if (!error && !photos->fit_count && list->fit.count)
        error = fxs_fail(message, "none of %zu photographs can be read; of the last: %s", list->fit.count,
                         r.results[(list->fit.count - 1) % BATCH].message.text);
    if (!error)
        error = read_all(&r, &list->held_out, &photos->held_out, &photos->held_out_count, photos, list->fit.count,
                         count, message);
    if (!error)
        error = check_ignored(list, photos, message);
    photos->without_mask = fxs_photo_masks_are_there(list, options) ? photos->without_mask : 0;
    free(r.results);
    return error;
}

typedef struct box {
    double low[3], high[3];
} box;

static const box empty_box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void take_camera(box *b, const fxs_view *view)
{
    for (int k = 0; k < 3; k++) {
        b->low[k] = view->position[k] < b->low[k] ? view->position[k] : b->low[k];
        b->high[k] = view->position[k] > b->high[k] ? view->position[k] : b->high[k];
    }
}

static int random_in(fxs_photo_points *p, const box *cameras, uint64_t seed, fxs_message *message)
{
    double middle[3], wide = 0;
    for (int k = 0; k < 3; k++) {
        middle[k] = (cameras->low[k] + cameras->high[k]) / 2;
        wide = cameras->high[k] - cameras->low[k] > wide ? cameras->high[k] - cameras->low[k] : wide;
    }
    return fxs_photo_points_random(p, middle, (wide > 0 ? wide : 1) * OF_CAMERAS / 2, seed, message);
}

static int random_of_list(fxs_photo_points *p, const fxs_photo_list *list, uint64_t seed, fxs_message *message)
{
    static const double origin[3] = {0, 0, 0};
    box cameras = empty_box;
    if (list->fit.views[0].sizeless == FXS_SIZE_OF_WIDTH)
        return fxs_photo_points_random(p, origin, BLENDER_HALF, seed, message);
    for (size_t i = 0; i < list->fit.count; i++)
        take_camera(&cameras, &list->fit.views[i].view);
    return random_in(p, &cameras, seed, message);
}

int fxs_photos_random_points(const fxs_fit_photo *photos, size_t photo_count, uint64_t seed, fxs_fit_point **points,
                             size_t *point_count, fxs_message *message)
{
    fxs_photo_points p = {0};
    box cameras = empty_box;
    for (size_t i = 0; i < photo_count; i++)
        take_camera(&cameras, &photos[i].view);
    const int error = photo_count ? random_in(&p, &cameras, seed, message)
                                  : fxs_fail_as(FXS_ERR_ARGUMENT, message, "no photographs");
    if (error)
        free(p.points);
    *points = error ? NULL : p.points;
    *point_count = error ? 0 : p.count;
    return error;
}

static int in_front(const fxs_view_list *views, const fxs_fit_point *point)
{
    for (size_t i = 0; i < views->count; i++) {
        const fxs_view *v = &views->views[i].view;
        double depth = 0;
        for (int k = 0; k < 3; k++)
            depth += v->rotation[6 + k] * ((double)point->position[k] - v->position[k]);
        if (depth > 0)
            return 1;
    }
    return 0;
}

static int check_points(const fxs_photos *photos, const fxs_view_list *views, const char *path, fxs_message *message)
{
    for (size_t i = 0; i < photos->point_count; i++)
        if (in_front(views, &photos->points[i]))
            return 0;
    return fxs_fail(message, "%s: all of the %zu points lie behind every camera", path, photos->point_count);
}

int fxs_photos_points(const fxs_photo_list *list, const fxs_photos_options *options, fxs_photos *photos,
                      fxs_message *message)
{
    fxs_photo_points p = {0};
    int error = 0;
    if (*list->points)
        error = list->fit.format == FXS_CAMERAS_OF_COLMAP    ? fxs_photo_points_colmap(&p, list->points, message) :
                list->fit.format == FXS_CAMERAS_OF_BUNDLER ? fxs_photo_points_bundler(&p, list->points, message) :
                                                             fxs_photo_points_ply(&p, list->points, message);
    if (!error && !p.count) {
        photos->points_are_random = 1;
        error = random_of_list(&p, list, options->seed, message);
    }
    photos->points = p.points;
    photos->point_count = p.count;
    return error ? error : check_points(photos, &list->fit, *list->points ? list->points : list->cameras, message);
}

static int keep_held_out(fxs_photo_list *list, fxs_message *message)
{
    uint8_t *none = calloc(list->fit.count + 1, 1);
    if (!none)
        return fxs_fail_memory(message, list->cameras, list->fit.count);
    fxs_photo_list_keep(&list->fit, none);
    free(none);
    return 0;
}

int fxs_photos_read(const char *path, const fxs_photos_options *given, fxs_photos *photos, fxs_message *message)
{
    fxs_photo_list list;
    fxs_photos_options all;
    const fxs_photos_options *const options = &all;
    memset(photos, 0, sizeof *photos);
    fxs_photos_options_init(&all);
    FXS_TRY(FXS_OPTIONS_READ(fxs_photos_options, &all, given, message));
    if (options->resolution < 0)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a resolution of %d pixels", options->resolution);
    FXS_TRY(fxs_photo_list_find(&list, path, options->hold_out, message));
    if (options->left_out)
        fxs_photo_list_others(&list, options->left_out, options->left_out_argument);
    int error = fxs_photo_masks_check(&list, options, message);
    if (!error && options->held_out_alone && list.held_out.count)
        error = keep_held_out(&list, message);
    if (!error)
        error = fxs_photos_pixels(&list, options, photos, message);
    if (!error && photos->fit_count)
        error = fxs_photos_points(&list, options, photos, message);
    fxs_photo_list_free(&list);
    if (error)
        fxs_photos_free(photos);
    return error;
}

static int keep_wanted(fxs_photo_list *list, fxs_photo_wanted_fn *wanted, void *argument, fxs_message *message)
{
    fxs_view_list *views = &list->fit;
    uint8_t *kept = calloc(views->count + 1, 1);
    if (!kept)
        return fxs_fail_memory(message, list->cameras, views->count);
    for (size_t i = 0; i < views->count; i++)
        kept[i] = wanted(argument, views->views[i].view.name) != 0;
    fxs_photo_list_keep(views, kept);
    free(kept);
    return 0;
}

int fxs_photos_read_some(const char *path, const fxs_photos_options *given, fxs_photo_wanted_fn *wanted,
                         void *argument, fxs_photos *photos, fxs_message *message)
{
    fxs_photo_list list;
    fxs_photos_options options;
    memset(photos, 0, sizeof *photos);
    fxs_photos_options_init(&options);
    FXS_TRY(FXS_OPTIONS_READ(fxs_photos_options, &options, given, message));
    FXS_TRY(fxs_photo_list_find(&list, path, 0, message));
    int error = keep_wanted(&list, wanted, argument, message);
    if (!error && list.fit.count)
        error = fxs_photos_pixels(&list, &options, photos, message);
    fxs_photo_list_free(&list);
    if (error)
        fxs_photos_free(photos);
    return error;
}

static void free_pixels(fxs_fit_photo *photos, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        free((void *)photos[i].pixels);
        free((void *)photos[i].mask);
    }
    free(photos);
}

void fxs_photos_free(fxs_photos *photos)
{
    free_pixels(photos->fit, photos->fit_count);
    free_pixels(photos->held_out, photos->held_out_count);
    free(photos->points);
    memset(photos, 0, sizeof *photos);
}
