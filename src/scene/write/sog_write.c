/* Writes .sog version 2: a zip archive of images and JSON. */
#include "sog_internal.h"
#include "src/base/report.h"

#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_ZIP)

#include <errno.h>
#include <stdlib.h>

typedef struct sog_writer {
    fxs_held held;
    int antialiased;
    const fxs_progress *progress;
} sog_writer;

static int sog_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    sog_writer *w = writer;
    if (o->count > FXS_SOG_MOST)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: more Gaussians than an image of %dx%d has pixels", path,
                           FXS_SOG_SIDE, FXS_SOG_SIDE);
    w->antialiased = o->antialiased;
    return fxs_held_open(&w->held, path, o, message);
}

static int sog_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_held_put(&((sog_writer *)writer)->held, gaussians, n, message);
}

static int progress_of_files(void *writer, double done)
{
    const sog_writer *w = writer;
    return fxs_report(w->progress, 0.1 + 0.9 * done);
}

static void write_files(sog_writer *w, const fxs_sog_source *from, fxs_message *message)
{
    fxs_zip_entry files[FXS_SOG_FILES];
    fxs_sog *sog = fxs_sog_make(from, &(fxs_progress){progress_of_files, w}, &w->held.output.error);
    if (!w->held.output.error)
        fxs_zip_write(&w->held.output, files, fxs_sog_files(sog, files), message);
    fxs_sog_free(sog);
}

static int sog_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                     fxs_message *message)
{
    sog_writer *w = writer;
    fxs_held *h = &w->held;
    (void)report;
    w->progress = progress;
    if (fxs_held_order(h)) {
        fxs_sog_source from = {malloc((h->count + 1) * sizeof *from.gaussians),
                               malloc((h->count + 1) * sizeof *from.sh), h->count, h->coefficients, w->antialiased};
        if (!from.gaussians || !from.sh)
            h->output.error = ENOMEM;
        for (uint32_t i = 0; i < h->count && !h->output.error; i++) {
            from.gaussians[i] = &h->gaussians[h->order[i]];
            from.sh[i] = h->sh + (size_t)h->order[i] * h->coefficients;
        }
        if (!h->output.error)
            write_files(w, &from, message);
        free(from.gaussians);
        free(from.sh);
    }
    return fxs_held_close(h, message);
}

const fxs_writer fxs_write_sog = {sizeof(sog_writer), sog_open, sog_put, sog_close, NULL};

#else

static int sog_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    (void)writer, (void)o;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot write .sog: built without libwebp or libzip", path);
}

const fxs_writer fxs_write_sog = {0, sog_open, NULL, NULL, NULL};

#endif
