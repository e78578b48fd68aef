#include <fixsplat/scene_write.h>

#include <stdlib.h>
#include <string.h>

#include <fixsplat/message.h>

#include "formats_internal.h"

struct fxs_scene_writer {
    const fxs_writer *writer;
    void *data;
    fxs_scene_write_report report;
};

int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *o, fxs_scene_writer **writer,
                          fxs_message *message)
{
    const fxs_format_row *format = fxs_format_to_write(o->format, path);
    *writer = NULL;
    if (!format)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no format is written that has this %s", path,
                           o->format ? "name" : "ending");
    if (o->sh_degree < 0 || o->sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: SH degree %d, not 0 to 3", path, o->sh_degree);
    fxs_scene_writer *made = calloc(1, sizeof *made + format->writer->size);
    if (!made)
        return fxs_fail_memory(message, path, sizeof *made + format->writer->size);
    made->writer = format->writer;
    made->data = made + 1;
    made->report.lost_sh = format->about.sh_degree < o->sh_degree ? o->sh_degree : 0;
    made->report.lost_antialiased = o->antialiased && !format->about.antialiased;
    const int error = made->writer->open(made->data, path, o, message);
    if (error)
        free(made);
    else
        *writer = made;
    return error;
}

int fxs_scene_writer_put(fxs_scene_writer *w, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return w->writer->put(w->data, gaussians, n, message);
}

int fxs_scene_writer_close(fxs_scene_writer *w, fxs_scene_write_report *report, fxs_progress_fn *progress,
                           void *argument, fxs_message *message)
{
    fxs_scene_write_report unwanted;
    report = report ? report : &unwanted;
    memset(report, 0, sizeof *report);
    if (!w)
        return 0;
    *report = w->report;
    const int result = w->writer->close(w->data, report, progress, argument, message);
    free(w);
    return result;
}
