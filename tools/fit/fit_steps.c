/* Runs the steps of `fixsplat fit`, with saves, measurements, log and progress between them. A signal saves the fit
   and ends the program. */
#include "cmd_fit.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/fit_more.h>
#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "fit_result.h"

static uint32_t steps_in_all(const fxs_fit *fit)
{
    return fxs_fit_options_of(fit)->steps + fxs_fit_repeated(fit);
}

static int save(const fit_command *c, fxs_fit *fit)
{
    fxs_message message;
    return fxs_fit_save(fit, c->saved, &message) ? fail_for(&message) : 0;
}

void fit_write_command(FILE *file, const char *in, const char *left_out)
{
    char name[4096];
    snprintf(name, sizeof name, "%s%s", *in == '-' ? "./" : "", in);
    fputs("fixsplat fit", file);
    write_shell_word(file, name);
    write_options_without(file, left_out);
}

static void say_how_to_go_on(const fit_command *c, const char *why, uint32_t step, uint32_t steps)
{
    if (is_quiet())
        return;
    progress_end();
    fprintf(stderr, "fixsplat: %s after %" PRIu32 " steps of %" PRIu32 "; to go on: ", why, step, steps);
    fit_write_command(stderr, c->photographs, "resume");
    fputs(" --resume", stderr);
    write_shell_word(stderr, c->saved);
    fputc('\n', stderr);
}

int fit_save_for_later(const fit_command *c, fxs_fit *fit, const char *why)
{
    if (save(c, fit))
        return EXIT_FAILED;
    say_how_to_go_on(c, why, fxs_fit_steps(fit), steps_in_all(fit));
    return 0;
}

static int is_measured(const fit_command *c, const fit_progress *p, uint32_t step)
{
    return c->metrics_every && step % c->metrics_every == 0 && step < p->steps;
}

/* True if a step shall report its loss. A report makes a device wait, so there are at most five a second, and those for
   the log, for measurements and for the last step. */
static int wants_report(const fit_command *c, const fit_progress *p, uint32_t step)
{
    return !c->options.device_count || step >= p->steps || fxs_clock(0) - p->last > 200000000u ||
           fit_log_wants(c->log, step) || is_measured(c, p, step);
}

/* Handles a failed step. The fit is not saved then, so that the last save remains. */
static int fail_step(const fit_command *c, const fit_progress *p, uint32_t made, const fxs_message *why)
{
    char needed[64];
    fail(EXIT_FAILED, "%s%s (after some %" PRIu32 " steps)", why->text, needed_bytes(needed, why), made);
    if (p->saved)
        say_how_to_go_on(c, "the last save is", p->saved, p->steps);
    return EXIT_FAILED;
}

/* Packs and measures the current scene of a running fit. A failure does not stop the fit. */
static void measure_so_far(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fit_progress *p)
{
    fxs_photos posed = *photos;
    fxs_packed_scene packed;
    fxs_message message;
    quality q = {0};
    posed.fit = 0;
    world scene = {0};
    char psnr[32], affine[32];
    int status = fxs_fit_pack(fit, &packed, 0, &message) ? fail_for(&message) : 0;
    status = status ? status : world_open_packed(&scene, c->out, &packed);
    status = status ? status : result_pose(fit, photos, &posed.fit);
    status = status ? status : result_measure(&q, &scene, &posed, &c->frame, 0);
    free(posed.fit);
    if (!status)
        note("step %" PRIu32 ": %s dB, after the best affine map %s, SSIM %.4f; %" PRIu32 " Gaussians", p->counted,
             fxs_metrics_psnr(psnr, q.psnr, "no"), fxs_metrics_psnr(affine, q.affine_psnr, "no"), q.ssim,
             scene.gaussians);
    fit_log_write(c->log, p, status ? 0 : &q);
    if (!status && c->watcher)
        c->watcher->measured(p->counted, &q);
    quality_free(&q);
    world_close(&scene);
    fxs_packed_scene_free(&packed);
}

/* Runs the steps of a fit until the end or a signal. After a failed save the fit continues. */
static int step_to_end(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, fit_progress *p)
{
    fxs_fit_report report;
    fxs_message message;
    while (fxs_fit_steps(fit) < p->steps && !fxs_end_asked()) {
        const int status = c->watch ? fit_watch_look(c->watch, fit, p) : 0;
        if (status)
            return status;
        const uint32_t made = fxs_fit_steps(fit), step = made + 1;
        const int is_reported = wants_report(c, p, step);
        if (fxs_fit_step(fit, is_reported ? &report : NULL, &message))
            return fail_step(c, p, made, &message);
        if (is_reported)
            fit_progress_count(p, step, &report);
        if (is_reported && c->watcher) {
            const fit_now now = fit_progress_now(p, step, report.gaussians);
            c->watcher->look(fit, &now);
        }
        if (c->save_every && step % c->save_every == 0 && step < p->steps && !save(c, fit))
            p->saved = step;
        if (is_measured(c, p, step))
            measure_so_far(c, fit, photos, p);
        else if (fit_log_wants(c->log, step) && step < p->steps)
            fit_log_write(c->log, p, 0);
    }
    progress_end();
    return 0;
}

static void begin_watching(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fit_progress *p)
{
    const fit_now now = fit_progress_now(p, p->first, 0);
    if (c->watcher)
        c->watcher->begin(fit, photos, &c->frame, !c->metrics_every, &now);
}

static int stop(const fit_command *c, fxs_fit *fit)
{
    if (c->watcher)
        c->watcher->stopped();
    if (!fit_save_for_later(c, fit, "stopped"))
        fxs_end_as_asked();
    return EXIT_FAILED;
}

int fit_make_steps(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, fit_progress *p)
{
    const uint64_t now = fxs_clock(0);
    const uint32_t first = fxs_fit_steps(fit);
    *p = (fit_progress){.first = first, .counted = first, .steps = steps_in_all(fit), .start = now,
                        .last = now, .shown = now, .saved = c->saves_itself ? first : 0};
    fit_log_begin(c->log, c->resume != 0, p->steps);
    fxs_end_listen();
    begin_watching(c, fit, photos, p);
    const int status = step_to_end(c, fit, photos, p);
    fxs_end_listen_no_more();
    return !status && fxs_end_asked() ? stop(c, fit) : status;
}
