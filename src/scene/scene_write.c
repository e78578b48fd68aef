#include <fixsplat/scene_write.h>

#include <stdlib.h>
#include <string.h>

#include <fixsplat/ply_write.h>
#include "src/scene/write/scene_write_internal.h"
#include <fixsplat/splat_write.h>

struct fxs_scene_writer {
    const fxs_write_format *format;
    void *writer;
    fxs_scene_write_report report;
};

/* ---- Formats with a header of their own -------------------------------------------------------------------------- */

static int open_ply(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    return fxs_ply_writer_open(path, o->count, o->sh_degree, o->antialiased, writer, message);
}

static int put_ply(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_ply_writer_put(*(fxs_ply_writer **)writer, gaussians, n, message);
}

static int close_ply(void *writer, fxs_progress_fn *progress, void *argument, fxs_message *message)
{
    (void)progress, (void)argument;
    return fxs_ply_writer_close(*(fxs_ply_writer **)writer, message);
}

static int open_splat(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    return fxs_splat_writer_open(path, o->count, writer, message);
}

static int put_splat(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_splat_writer_put(*(fxs_splat_writer **)writer, gaussians, n, message);
}

static int close_splat(void *writer, fxs_progress_fn *progress, void *argument, fxs_message *message)
{
    (void)progress, (void)argument;
    return fxs_splat_writer_close(*(fxs_splat_writer **)writer, message);
}

static int open_spz(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    const int version = o->spz_version ? o->spz_version : 4;
    return fxs_spz_writer_open(path, version, o->count, o->sh_degree, o->antialiased, writer, message);
}

static int put_spz(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_spz_writer_put(*(fxs_spz_writer **)writer, gaussians, n, message);
}

static int close_spz(void *writer, fxs_progress_fn *progress, void *argument, fxs_message *message)
{
    return fxs_spz_writer_close(*(fxs_spz_writer **)writer, progress, argument, message);
}

static const fxs_write_format ply = {".ply", sizeof(fxs_ply_writer *), 1, 1, open_ply, put_ply, close_ply},
                              splat = {".splat", sizeof(fxs_splat_writer *), 0, 0, open_splat, put_splat, close_splat},
                              spz = {".spz", sizeof(fxs_spz_writer *), 1, 1, open_spz, put_spz, close_spz};

/* ---- The writer -------------------------------------------------------------------------------------------------- */

/* The first whose ending a name has, so the longer of two comes first; null: none. */
static const fxs_write_format *format_of(const char *path)
{
    static const fxs_write_format *const formats[] = {&fxs_write_compressed_ply, &ply, &splat, &spz, &fxs_write_sog,
                                                      &fxs_write_glb, &fxs_write_csv};
    const size_t length = strlen(path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const size_t ending = strlen(formats[i]->ending);
        if (length > ending && !strcmp(path + length - ending, formats[i]->ending))
            return formats[i];
    }
    return NULL;
}

int fxs_scene_is_written(const char *path)
{
    return format_of(path) != NULL;
}

int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *o, fxs_scene_writer **writer,
                          fxs_message *message)
{
    const fxs_write_format *format = format_of(path);
    *writer = NULL;
    if (!format)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no format is written that has this ending", path);
    if (o->sh_degree < 0 || o->sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: SH degree %d, not 0 to 3", path, o->sh_degree);
    fxs_scene_writer *made = calloc(1, sizeof *made + format->writer_size);
    if (!made)
        return fxs_fail_memory(message, path, sizeof *made + format->writer_size);
    made->format = format;
    made->writer = made + 1;
    made->report.lost_sh = format->holds_sh ? 0 : o->sh_degree;
    made->report.lost_antialiased = o->antialiased && !format->holds_antialiased;
    const int error = format->open(made->writer, path, o, message);
    if (error)
        free(made);
    else
        *writer = made;
    return error;
}

int fxs_scene_writer_put(fxs_scene_writer *w, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return w->format->put(w->writer, gaussians, n, message);
}

int fxs_scene_writer_close(fxs_scene_writer *w, fxs_scene_write_report *report, fxs_progress_fn *progress,
                           void *argument, fxs_message *message)
{
    memset(report, 0, sizeof *report);
    if (!w)
        return 0;
    *report = w->report;
    if (w->format == &spz)
        report->clamped = fxs_spz_writer_finish(*(fxs_spz_writer **)w->writer);
    const int result = w->format->close(w->writer, progress, argument, message);
    free(w);
    return result;
}
