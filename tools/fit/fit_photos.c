/* Runs `fixsplat fit`: finds the cameras, reads the photographs, and opens or resumes the fit. */
#include "cmd_fit.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/fit_more.h>
#include "src/base/os_calls.h"
#include "src/image/photograph.h"
#include "tools/command/file_guard.h"
#include "film_frames.h"
#include "fit_result.h"

static void say_sizes(const fxs_photos *photos, size_t begins)
{
    int width = 0, height = 0;
    for (size_t i = 0; i < photos->fit_count; i++) {
        const fxs_view *view = &photos->fit[i].view;
        width = view->width > width ? view->width : width;
        height = view->height > height ? view->height : height;
    }
    note("%zu photographs to fit, %zu held out, up to %dx%d; %zu points", photos->fit_count,
         photos->held_out_count, width, height, begins);
}

static void say_left_out(void *argument, const char *why)
{
    const fit_command *c = argument;
    const size_t length = c->found.folder ? strlen(c->found.folder) : 0;
    if (!length || strncmp(why, c->found.folder, length) || strncmp(why + length, "/images: ", 9))
        note("left out: %s", why);
}

static int show_reading(void *argument, double done)
{
    static char label[] = "reading";
    static uint64_t shown;
    const uint64_t now = fxs_clock(0);
    (void)argument;
    shown = shown ? shown : now;
    if (!fxs_is_terminal(stderr) && now - shown >= 10000000000u) {
        note("%s photographs: %d %%", label, (int)(100 * done));
        shown = now;
    }
    return progress_bar(label, done);
}

static double share_ignored(const fxs_photos *photos)
{
    const fxs_fit_photo *lists[] = {photos->fit, photos->held_out};
    const size_t counts[] = {photos->fit_count, photos->held_out_count};
    double pixels = 0, ignored = 0;
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < counts[k]; i++) {
            const fxs_fit_photo *photo = &lists[k][i];
            const size_t size = (size_t)photo->view.width * (size_t)photo->view.height;
            pixels += (double)size;
            for (size_t p = 0; p < size && photo->mask; p++)
                ignored += !photo->mask[p];
        }
    return pixels > 0 ? ignored / pixels : 0;
}

static void say_masks(const fit_command *c, const fxs_photos *photos)
{
    if (photos->with_mask)
        note("%s: masks of %zu photographs", c->in, photos->with_mask);
    if (photos->without_mask)
        note("%s: no mask of %zu photograph%s, of which all is used", c->in, photos->without_mask,
             photos->without_mask > 1 ? "s" : "");
    if (photos->with_mask || c->reading.ignore_transparent)
        note("%s: %.1f %% of the pixels are ignored", c->in, 100 * share_ignored(photos));
}

static int check_masks(const fit_command *c, const fxs_photos *photos)
{
    return c->reading.invert_masks && !photos->with_mask
               ? fail(EXIT_FAILED, "--invert-masks: no photograph of %s has a mask", c->in) : 0;
}

void fit_say_photos(const fit_command *c, const fxs_photos *photos, size_t begins)
{
    if (photos->skipped)
        note("%s: photographs left out: %zu, taken: %zu", c->in, photos->skipped,
             photos->fit_count + photos->held_out_count);
    say_masks(c, photos);
    if (photos->points_are_random && !c->resume)
        note("%s: no points: begins with %zu random ones", c->in, photos->point_count);
    say_sizes(photos, begins);
}

static int check_resumed(const fit_command *c, const fxs_fit *fit)
{
    const fxs_fit_options *given = &c->options, *is = fxs_fit_options_of(fit);
    const struct {
        const char *name;
        int same;
    } options[] = {
        {"recipe", given->recipe == is->recipe}, {"quality", given->recipe == is->recipe},
        {"seed", given->seed == is->seed},
        {"batch", given->batch == is->batch}, {"sh-degree", given->sh_degree == is->sh_degree},
        {"max-gaussians", given->max_gaussians == is->max_gaussians}, {"cutoff", given->cutoff == is->cutoff},
        {"profile", given->profile == is->profile}, {"exposure", given->exposure == is->exposure},
        {"refine-poses", given->refine_poses == is->refine_poses},
        {"antialiased", given->antialiased == is->antialiased}, {"surfaces", given->surfaces == is->surfaces},
        {"sky", given->sky == is->sky},
        {"of", given->antialiased == is->antialiased && given->sky == is->sky},
        {"photos", given->exposure == is->exposure},
        {"background", !memcmp(given->background, is->background, sizeof is->background)}
    };
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (is_given(options[i].name) && !options[i].same)
            return fail(EXIT_USAGE, "--%s: %s was begun with another value", options[i].name, c->resume);
    return 0;
}

int fit_open(const fit_command *c, const fxs_photos *photos, const fxs_fit_block *block, fxs_fit **fit)
{
    const fxs_fit_options *o = &c->options;
    fxs_message message;
    const int error = c->resume   ? fxs_fit_resume(fit, c->resume, photos->fit, photos->fit_count, o, &message)
                      : c->coarse ? fxs_fit_create_block(fit, block->coarse, block, o, &message)
                                  : fxs_fit_create(fit, photos->fit, photos->fit_count, photos->points,
                                                   photos->point_count, o, &message);
    if (error)
        return fail_for(&message);
    if (c->coarse && is_given("exposure") && o->exposure != fxs_fit_options_of(*fit)->exposure)
        return fail(EXIT_USAGE, "--exposure: %s was begun with another value", c->coarse);
    if (c->coarse && o->refine_poses && !fxs_fit_options_of(*fit)->refine_poses)
        return fail(EXIT_USAGE, "--refine-poses: %s was begun without it", c->coarse);
    if (c->coarse && o->antialiased && !fxs_fit_options_of(*fit)->antialiased)
        return fail(EXIT_USAGE, "--antialiased: %s was begun without it", c->coarse);
    if (c->coarse && o->surfaces && !fxs_fit_options_of(*fit)->surfaces)
        return fail(EXIT_USAGE, "--surfaces: %s was begun without it", c->coarse);
    if (c->coarse && is_given("sky") && o->sky != fxs_fit_options_of(*fit)->sky)
        return fail(EXIT_USAGE, "--sky: %s was begun with another value", c->coarse);
    return c->resume ? check_resumed(c, *fit) : 0;
}

static void say_sky(const fit_command *c, const fxs_fit *fit)
{
    const size_t count = fxs_fit_sky_count(fit);
    if (count)
        note("%s: begins with a sky of %zu Gaussians", c->in, count);
    else if (c->options.sky && !c->resume && !c->coarse)
        note("%s: no sky added: points lie wherever a photograph looks", c->in);
}

/* Renders with the cut-off (where Gaussians end) and the background of the fit, since a resumed fit has its own. */
static void draw_as_fitted(fit_command *c, const fxs_fit *fit)
{
    const fxs_fit_options *o = fxs_fit_options_of(fit);
    c->frame.render.cutoff = o->cutoff;
    memcpy(c->frame.render.background, o->background, sizeof o->background);
}

int fit_make(fit_command *c, const fxs_photos *photos, const fxs_fit_block *block)
{
    fxs_fit *fit = 0;
    fit_progress progress;
    if (c->compare)
        result_tell_pictures(photos, c->compare);
    int status = files_check();     /* outputs are checked again, since the photographs' names are known now */
    if (!status)
        status = fit_open(c, photos, block, &fit);
    if (!status) {
        say_sky(c, fit);
        draw_as_fitted(c, fit);
        status = fit_make_steps(c, fit, photos, &progress);
    }
    if (!status)
        status = fit_end(c, fit, photos, block, &progress);
    fxs_fit_destroy(fit);
    return status;
}

static int fit_whole(fit_command *c)
{
    fxs_photos photos;
    fxs_message message;
    const int error = fxs_photos_read(c->in, &c->reading, &photos, &message);
    progress_end();
    if (error)
        return fail_for(&message);
    fit_say_photos(c, &photos, photos.point_count);
    if (c->of && c->options.sky && photos.points_are_random && !is_given("sky")) {
        note("%s has no points to find the sky from: --of outdoors adds none", c->in);
        c->options.sky = 0;
    }
    const int status = c->options.sky && photos.points_are_random && !c->resume
                           ? fail(EXIT_FAILED, "--sky: %s has no points to find the sky from", c->in)
                       : check_masks(c, &photos) ? EXIT_FAILED
                                                 : fit_make(c, &photos, 0);
    fxs_photos_free(&photos);
    return status;
}

static int measure_scene(fit_command *c)
{
    fxs_photos photos;
    fxs_message message;
    quality q = {0};
    world scene = {0};
    c->reading.held_out_alone = 1;
    const int error = fxs_photos_read(c->in, &c->reading, &photos, &message);
    progress_end();
    if (error)
        return fail_for(&message);
    say_masks(c, &photos);
    if (c->compare)
        result_tell_pictures(&photos, c->compare);
    int status = check_masks(c, &photos);
    if (!status)
        status = files_check();
    if (!status)
        status = world_open(&scene, &(world_options){.scenes = (char **)&c->measure, .scene_count = 1}, &c->frame.load);
    if (!status)
        status = result_measure(&q, &scene, &photos, &c->frame, c->compare);
    if (!status)
        fit_print_measured(c, &photos, &scene, &q);
    quality_free(&q);
    world_close(&scene);
    fxs_photos_free(&photos);
    return status;
}

/* Fits a block (part of the scene) as if its photographs and points were all that exist. */
static int fit_block(fit_command *c)
{
    fxs_fit_block block;
    fxs_fit_coarse *coarse = 0;
    fxs_message message;
    if (c->coarse && fxs_fit_coarse_read(&coarse, c->coarse, &message))
        return fail_for(&message);
    const int error = fxs_fit_block_read(c->in, &c->reading, coarse, c->block, c->blocks, &block, &message);
    progress_end();
    int status = error ? fail_for(&message) : 0;
    if (!status && c->block) {
        c->options.extent = block.extent;
        c->options.block = c->block;
        c->options.blocks = c->blocks;
        c->options.coarse = coarse ? fxs_fit_coarse_number(coarse) : 0;
        fit_say_photos(c, &block.photos, coarse ? block.gaussian_count : block.photos.point_count);
        status = fit_make(c, &block.photos, &block);
    } else if (!status) {
        status = fit_write_outside(c, &block);
    }
    if (!error)
        fxs_fit_block_free(&block);
    fxs_fit_coarse_free(coarse);
    return status;
}

static int find_cameras(fit_command *c)
{
    const reconstruct_options how = {c->in, c->out, c->frames, c->frame.threads, c->quality, c->reading.skip_bad,
                                     c->reading.masks, c->reading.invert_masks, c->photos};
    if (c->photos && film_is_named(c->in))
        return fail(EXIT_USAGE, "--photos mixed: %s is a film, of one camera", c->in);
    if (c->frames && !film_is_named(c->in))
        return fail(EXIT_USAGE, "--frames: %s is not a film", c->in);
    if (fxs_photograph_kind_of(c->in) && fxs_file_kind(c->in) == FXS_FILE_REGULAR)
        return fail(EXIT_USAGE, "%s: a photograph: fit takes the folder that has all of them", c->in);
    if (c->watch_seconds)
        return 0;
    if (c->measure || !reconstruct_is_needed(c->in))
        return c->cameras_only ? fail(EXIT_USAGE, "--cameras-only: %s has cameras", c->in) : 0;
    const int status = reconstruct(&how, &c->found);
    if (status)
        return status;
    c->in = c->found.folder;
    if (c->reading.masks && *c->reading.masks)
        c->reading.masks = 0;      /* masks in the reconstructed folder replace the masks of the options */
    c->reading.invert_masks = 0;
    return 0;
}

int fit_photos(fit_command *c)
{
    const int status = find_cameras(c);
    if (status || c->cameras_only)
        return status;
    fxs_pool *pool = fxs_pool_create(c->frame.threads);
    c->options.workers = (fxs_workers){pool ? fxs_pool_run : 0, pool, pool ? c->frame.threads : 1};
    c->reading.workers = c->options.workers;
    c->reading.progress = (fxs_progress){show_reading, c};
    c->reading.left_out = say_left_out;
    c->reading.left_out_argument = c;
    const int made = c->measure         ? measure_scene(c)
                     : c->watch_seconds ? fit_watched(c)
                     : c->moving        ? fit_moving(c)
                     : c->blocks        ? fit_block(c)
                                        : fit_whole(c);
    fxs_pool_destroy(pool);
    return made;
}
