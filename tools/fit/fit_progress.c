/* Shows the progress of a fit: running means of loss and speed, a line on stderr, and a log file. */
#include "fit_progress.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "tools/command/command.h"

static void say_duration(char text[32], double seconds)
{
    const uint64_t s = (uint64_t)seconds;
    if (s < 60)
        snprintf(text, 32, "%d s", (int)s);
    else if (s < 3600)
        snprintf(text, 32, "%d min %02d s", (int)(s / 60), (int)(s % 60));
    else
        snprintf(text, 32, "%" PRIu64 " h %02d min", s / 3600, (int)(s / 60 % 60));
}

static void show(fit_progress *p, uint32_t step, size_t gaussians, uint64_t now)
{
    char text[160], left[32];
    const int is_line = fxs_is_terminal(stderr), is_last = step == p->steps && !is_line;
    const uint64_t pause = is_line ? 200000000u : p->shown == p->start ? 1000000000u : 10000000000u;
    if (is_quiet() || (now - p->shown < pause && !is_last))
        return;
    say_duration(left, p->pace * (p->steps - step));
    snprintf(text, sizeof text, "%" PRIu32 "/%" PRIu32 ", loss %.4f, %zu Gaussians, %.1f steps/s, %s left",
             step, p->steps, p->loss, gaussians, p->pace > 0 ? 1 / p->pace : 0, left);
    if (is_line)
        progress_line(text);
    else
        fprintf(stderr, "%s\n", text);
    p->shown = now;
}

void fit_progress_count(fit_progress *p, uint32_t step, const fxs_fit_report *report)
{
    const uint64_t now = fxs_clock(0);
    const double done = step - p->first, more = step - p->counted, all = done < 50 ? done : 50;
    const double share = more < all ? more / all : 1;
    p->pace += share * ((double)(now - p->last) * 1e-9 / more - p->pace);
    p->loss += share * (0.8 * report->absolute + 0.2 * report->dissimilar - p->loss);
    p->last = now;
    p->counted = step;
    p->gaussians = report->gaussians;
    p->reports++;
    for (int i = 0; i < FIT_STAGES; i++)
        p->stages[i] += report->nanoseconds[i];
    show(p, step, report->gaussians, now);
}

fit_now fit_progress_now(const fit_progress *p, uint32_t step, size_t gaussians)
{
    return (fit_now){step, p->steps, gaussians, p->loss, p->pace * (p->steps - step)};
}

double fit_progress_seconds(const fit_progress *p)
{
    return (double)(p->last - p->start) * 1e-9;
}

static void give_up(fit_log *log)
{
    progress_end();
    fail(EXIT_FAILED, "--log %s: cannot be written: %s; the fit goes on without it", log->name, strerror(errno));
    fclose(log->file);
    log->file = 0;
}

int fit_log_open(fit_log *log, const char *name)
{
    *log = (fit_log){.name = name, .file = name ? fxs_stream_open(name, "ab") : 0};
    return !name || log->file ? 0 : fail(EXIT_FAILED, "--log %s: cannot be written: %s", name, strerror(errno));
}

void fit_log_begin(fit_log *log, int goes_on, uint32_t steps)
{
    log->every = (steps + 99) / 100;
    if (!log->file)
        return;
    if (!goes_on && fxs_stream_empty(log->file) && errno != EINVAL)    /* EINVAL: a terminal or a pipe, which cannot be
                                                                          emptied */
        give_up(log);
    else if (fseek(log->file, 0, SEEK_END) || ftell(log->file) <= 0)
        if (fputs("step\tseconds\tgaussians\tloss\tpsnr\taffine_psnr\tssim\n", log->file) < 0 || fflush(log->file))
            give_up(log);
}

int fit_log_wants(const fit_log *log, uint32_t step)
{
    return log->file && step % log->every == 0;
}

void fit_log_write(fit_log *log, const fit_progress *p, const quality *measured)
{
    char psnr[32], affine[32];
    if (!log->file)
        return;
    fprintf(log->file, "%" PRIu32 "\t%.3f\t%zu\t%.6f\t", p->counted, fit_progress_seconds(p), p->gaussians, p->loss);
    if (measured)
        fprintf(log->file, "%s\t%s\t%.6f", fxs_metrics_psnr(psnr, measured->psnr, "inf"),
                fxs_metrics_psnr(affine, measured->affine_psnr, "inf"), measured->ssim);
    else
        fputs("\t\t", log->file);
    fputc('\n', log->file);
    if (fflush(log->file) || ferror(log->file))
        give_up(log);
}

void fit_log_close(fit_log *log)
{
    if (log->file && fclose(log->file))
        fail(EXIT_FAILED, "--log %s: cannot be written: %s", log->name, strerror(errno));
    log->file = 0;
}
