/* Passes Gaussians to the writer of a file format. The format is chosen by its name or the path's ending. */
#include <fixsplat/scene.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>

#include "formats_internal.h"
#include "src/base/options.h"
#include "src/gaussian/origin_internal.h"

struct fxs_scene_writer {
    const fxs_writer *writer;
    void *data;
    double origin[3];   /* origin that is added to positions; 0 if the format's writer adds the origin itself */
    fxs_scene_write_report report;
};

int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *options, fxs_scene_writer **writer,
                          fxs_message *message)
{
    fxs_scene_write_options all;
    const fxs_scene_write_options *const o = &all;
    *writer = NULL;
    fxs_scene_write_options_init(&all);
    FXS_TRY(FXS_OPTIONS_READ(fxs_scene_write_options, &all, options, message));
    const fxs_format_row *format = fxs_format_to_write(o->format, path);
    if (!format)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no format is written that has this %s", path,
                           o->format ? "name" : "ending");
    if (o->time.duration > 0 && !format->about.moves)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: this format does not keep motion", path);
    if (o->sh_degree < 0 || o->sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: SH degree %d, not 0 to 3", path, o->sh_degree);
    fxs_scene_writer *made = calloc(1, sizeof *made + format->writer->size);
    if (!made)
        return fxs_fail_memory(message, path, sizeof *made + format->writer->size);
    made->writer = format->writer;
    made->data = made + 1;
    made->report.lost_sh = format->about.sh_degree < o->sh_degree ? o->sh_degree : 0;
    made->report.lost_antialiased = o->antialiased && !format->about.antialiased;
    if (!format->about.far)
        memcpy(made->origin, o->origin, sizeof made->origin);
    const int error = made->writer->open(made->data, path, o, message);
    if (error)
        free(made);
    else
        *writer = made;
    return error;
}

static void add_origin(fxs_scene_writer *w, fxs_gaussian *g)
{
    for (int i = 0; i < 3; i++) {
        const double place = w->origin[i] + (double)g->position[i];
        g->position[i] = (float)place;
        w->report.moved = fmax(w->report.moved, fabs(place - (double)g->position[i]));
    }
}

static int put(fxs_scene_writer *w, const fxs_gaussian *gaussians, const fxs_motion *motions, size_t n,
               fxs_message *message)
{
    return motions ? w->writer->put_moving(w->data, gaussians, motions, n, message)
                   : w->writer->put(w->data, gaussians, n, message);
}

static int put_moved(fxs_scene_writer *w, const fxs_gaussian *gaussians, const fxs_motion *motions, size_t n,
                     fxs_message *message)
{
    enum { BATCH = 64 };
    fxs_gaussian batch[BATCH];
    if (!fxs_has_origin(w->origin))
        return put(w, gaussians, motions, n, message);
    for (size_t at = 0, count; at < n; at += count) {
        count = n - at < BATCH ? n - at : BATCH;
        memcpy(batch, gaussians + at, count * sizeof *batch);
        for (size_t i = 0; i < count; i++)
            add_origin(w, &batch[i]);
        FXS_TRY(put(w, batch, motions ? motions + at : NULL, count, message));
    }
    return 0;
}

int fxs_scene_writer_put(fxs_scene_writer *w, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return put_moved(w, gaussians, NULL, n, message);
}

int fxs_scene_writer_put_moving(fxs_scene_writer *w, const fxs_gaussian *gaussians, const fxs_motion *motions, size_t n,
                                fxs_message *message)
{
    if (!w->writer->put_moving)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "this format does not keep motion");
    return put_moved(w, gaussians, motions, n, message);
}

int fxs_scene_writer_close(fxs_scene_writer *w, fxs_scene_write_report *report, const fxs_progress *progress,
                           fxs_message *message)
{
    fxs_scene_write_report unwanted;
    report = report ? report : &unwanted;
    memset(report, 0, sizeof *report);
    if (!w)
        return 0;
    *report = w->report;
    const int result = w->writer->close(w->data, report, progress, message);
    free(w);
    return result;
}
