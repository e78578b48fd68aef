/* Reads coarse fits of whole scenes. Starts the fits of single blocks of space from their Gaussians, exposures and
 * poses. */
#include "coarse.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/fit_more.h>
#include <fixsplat/internal/message.h>
#include "src/base/random.h"
#include "src/base/try_internal.h"

uint64_t fxs_fit_camera_key(const fxs_fit_camera *camera)
{
    uint32_t words[12];
    uint64_t key = 0;
    memcpy(words, camera->rotation, sizeof camera->rotation);
    memcpy(words + 9, camera->eye, sizeof camera->eye);
    for (int i = 0; i < 12; i++)
        key = fxs_random_mix(key ^ words[i]);
    return key;
}

static int compare_cameras(const void *a, const void *b)
{
    const fxs_fit_coarse_camera *x = a, *y = b;
    if (x->key != y->key)
        return (x->key > y->key) - (x->key < y->key);
    return (x->number > y->number) - (x->number < y->number);
}

static const fxs_fit_coarse_camera *find_camera(const fxs_fit_coarse *coarse, const fxs_fit_camera *camera)
{
    const uint64_t key = fxs_fit_camera_key(camera);
    size_t first = 0, end = coarse->camera_count;
    while (first < end) {
        const size_t middle = first + (end - first) / 2;
        if (coarse->cameras[middle].key < key)
            first = middle + 1;
        else
            end = middle;
    }
    return first < coarse->camera_count && coarse->cameras[first].key == key ? &coarse->cameras[first] : NULL;
}

int fxs_fit_coarse_read(fxs_fit_coarse **coarse, const char *path, fxs_message *message)
{
    fxs_fit_coarse *c = *coarse = calloc(1, sizeof *c);
    int error = c && (c->fit = calloc(1, sizeof *c->fit)) ? fxs_fit_checkpoint_read(c, path, message)
                                                          : fxs_fail_memory(message, path, sizeof *c->fit);
    if (!error && !c->fit->model.count)
        error = fxs_fail(message, "%s: a fit without Gaussians", path);
    if (error) {
        fxs_fit_coarse_free(c);
        *coarse = NULL;
        return error;
    }
    if (c->camera_count)
        qsort(c->cameras, c->camera_count, sizeof *c->cameras, compare_cameras);
    if (c->fit->profile.chunks)
        fxs_fit_profile_end(&c->fit->profile, &c->fit->model);
    return 0;
}

void fxs_fit_coarse_free(fxs_fit_coarse *coarse)
{
    if (!coarse)
        return;
    fxs_fit_destroy(coarse->fit);
    free(coarse->cameras);
    free(coarse);
}

uint32_t fxs_fit_coarse_steps(const fxs_fit_coarse *coarse)
{
    return coarse->fit->step;
}

uint64_t fxs_fit_coarse_number(const fxs_fit_coarse *coarse)
{
    return coarse->number;
}

static int sort_photos(const fxs_fit_coarse *coarse, const char *path, fxs_fit_photo *photos, size_t count,
                       fxs_fit_photo *sorted, fxs_message *message)
{
    size_t known = 0, behind = coarse->camera_count;
    for (size_t i = 0; i < count; i++) {
        fxs_fit_camera camera;
        fxs_fit_set_camera(&camera, &photos[i].view);
        const fxs_fit_coarse_camera *found = find_camera(coarse, &camera);
        const size_t at = found ? found->number : behind++;
        if (at < count && !sorted[at].pixels)
            sorted[at] = photos[i];
        known += found != NULL;
    }
    if (known != coarse->camera_count || behind != count)
        return fxs_fail(message, "%s: a fit of %zu photographs, of which %zu are here", path, coarse->camera_count,
                        known);
    memcpy(photos, sorted, count * sizeof *photos);
    return 0;
}

int fxs_fit_saved_order(const char *path, fxs_fit_photo *photos, size_t photo_count, size_t *count,
                        fxs_message *message)
{
    fxs_fit_coarse *coarse;
    FXS_TRY(fxs_fit_coarse_read(&coarse, path, message));
    fxs_fit_photo *sorted = calloc(photo_count + 1, sizeof *sorted);
    const int error = sorted ? sort_photos(coarse, path, photos, photo_count, sorted, message)
                             : fxs_fail_memory(message, path, photo_count * sizeof *sorted);
    *count = coarse->camera_count;
    free(sorted);
    fxs_fit_coarse_free(coarse);
    return error;
}

int fxs_fit_coarse_check(const fxs_fit_coarse *coarse, const fxs_view_list *views, int skip_bad, fxs_message *message)
{
    size_t known = 0;
    const char *unknown = "";
    for (size_t i = 0; i < views->count; i++) {
        fxs_fit_camera camera;
        fxs_fit_set_camera(&camera, &views->views[i].view);
        if (find_camera(coarse, &camera))
            known++;
        else
            unknown = views->views[i].view.name;
    }
    return known == views->count || (known && skip_bad)
               ? 0
               : fxs_fail(message, "the coarse fit is of other photographs: it has none from where %s was taken",
                          unknown);
}

static void take_plane(float *to, const float *from, const fxs_fit_block *block)
{
    for (size_t i = 0; i < block->gaussian_count; i++)
        to[i] = from[block->gaussians[i]];
}

static int take_model(fxs_fit_model *m, const fxs_fit_model *whole, const fxs_fit_block *block)
{
    if (fxs_fit_model_room(m, block->gaussian_count))
        return FXS_ERR_MEMORY;
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++) {
        take_plane(m->parameters + k * m->stride, whole->parameters + k * whole->stride, block);
        take_plane(m->means + k * m->stride, whole->means + k * whole->stride, block);
        take_plane(m->squares + k * m->stride, whole->squares + k * whole->stride, block);
    }
    take_plane(m->by_centre, whole->by_centre, block);
    take_plane(m->views, whole->views, block);
    return 0;
}

static void take_photographs(fxs_fit *f, const fxs_fit_coarse *coarse)
{
    for (size_t i = 0; i < f->count; i++) {
        const fxs_fit_coarse_camera *found = find_camera(coarse, &f->photographs[i].camera);
        if (found && f->options.exposure)
            f->gains.of[i] = coarse->fit->gains.of[found->number];
        if (found && f->options.refine_poses)
            f->poses.of[i] = coarse->fit->poses.of[found->number];
    }
}

int fxs_fit_create_block(fxs_fit **fit, const fxs_fit_coarse *coarse, const fxs_fit_block *block,
                         const fxs_fit_options *options, fxs_message *message)
{
    const fxs_photos *photos = &block->photos;
    fxs_fit_options all = *options;
    all.exposure = coarse->fit->options.exposure;
    all.refine_poses = coarse->fit->options.refine_poses;
    all.antialiased = coarse->fit->options.antialiased;
    all.surfaces = coarse->fit->options.surfaces;
    all.sky = coarse->fit->options.sky;
    *fit = NULL;
    if (options->steps <= coarse->fit->step - coarse->fit->repeated)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "the coarse fit has made %u steps, and a block goes on from "
                           "there: %u steps are too few", (unsigned)coarse->fit->step, (unsigned)options->steps);
    if (options->recipe != coarse->fit->options.recipe)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "the coarse fit has another recipe, whose course a block goes on "
                           "with");
    int error = fxs_fit_begin(fit, photos->fit, photos->fit_count, &all, message);
    if (!error && take_model(&(*fit)->model, &coarse->fit->model, block))
        error = fxs_fail_memory(message, "a fit", block->gaussian_count * 4 * FXS_FIT_PARAMETERS * sizeof(float));
    if (!error) {
        (*fit)->step = coarse->fit->step;
        (*fit)->repeated = coarse->fit->repeated;
        (*fit)->extent = coarse->fit->extent;
        (*fit)->far = coarse->fit->far;
        take_photographs(*fit, coarse);
        fxs_fit_set_order(*fit, (uint64_t)(*fit)->step * (*fit)->options.batch);
        error = fxs_fit_hand_over(*fit, message);
    }
    if (error) {
        fxs_fit_destroy(*fit);
        *fit = NULL;
    }
    return error;
}

static long read_outside(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const fxs_fit_block *block = argument;
    const fxs_fit_model *m = &block->coarse->fit->model;
    const size_t left = block->gaussian_count - (size_t)first, count = left < capacity ? left : capacity;
    for (size_t i = 0; i < count; i++)
        fxs_fit_model_give(m, block->gaussians[(size_t)first + i], &out[i]);
    return (long)count;
}

void fxs_fit_block_gaussians(const fxs_fit_block *block, fxs_gaussian_source *gaussians)
{
    memset(gaussians, 0, sizeof *gaussians);
    gaussians->count = block->gaussian_count;
    gaussians->sh_degree = block->coarse->fit->options.sh_degree;
    gaussians->antialiased = block->coarse->fit->options.antialiased;
    gaussians->read = read_outside;
    gaussians->argument = (void *)block;
}
