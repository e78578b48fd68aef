#include "fit_log.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#include "command.h"

static void give_up(fit_log *log)
{
    progress_end();
    fail(EXIT_FAILED, "--log %s: cannot be written: %s; the fit goes on without it", log->name, strerror(errno));
    fclose(log->file);
    log->file = 0;
}

int fit_log_open(fit_log *log, const char *name)
{
    *log = (fit_log){.name = name, .file = name ? fopen(name, "a") : 0};
    return !name || log->file ? 0 : fail(EXIT_FAILED, "--log %s: cannot be written: %s", name, strerror(errno));
}

void fit_log_begin(fit_log *log, int goes_on, uint32_t steps)
{
    log->every = (steps + 99) / 100;
    if (!log->file)
        return;
    if (!goes_on && ftruncate(fileno(log->file), 0) && errno != EINVAL)    /* which a terminal or a pipe is */
        give_up(log);
    else if (fseek(log->file, 0, SEEK_END) || ftell(log->file) <= 0)
        if (fputs("step\tseconds\tgaussians\tloss\tpsnr\taffine_psnr\tssim\n", log->file) < 0 || fflush(log->file))
            give_up(log);
}

int fit_log_wants(const fit_log *log, uint32_t step)
{
    return log->file && step % log->every == 0;
}

void fit_log_write(fit_log *log, uint32_t step, double seconds, size_t gaussians, double loss, const quality *measured)
{
    char psnr[32], affine[32];
    if (!log->file)
        return;
    fprintf(log->file, "%" PRIu32 "\t%.3f\t%zu\t%.6f\t", step, seconds, gaussians, loss);
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
