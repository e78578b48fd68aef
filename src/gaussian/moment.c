/* Moving Gaussians at a moment: their positions, rotations and opacities then, as a stream of still Gaussians. */
#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>

#include "attributes.h"
#include "stream_internal.h"

double fxs_time_within(const fxs_time *time, double seconds)
{
    const double turns = time->loops ? floor(seconds / time->duration) : 0;
    return fmin(fmax(seconds - turns * time->duration, 0), time->duration);
}

int fxs_gaussian_at(fxs_gaussian *g, const fxs_motion *m, const fxs_time *time, double seconds)
{
    const double d = seconds - m->centre, share = m->fade < INFINITY ? exp(-(d / m->fade) * (d / m->fade)) : 1;
    /* what exists until the end exists at the last moment */
    if (!(seconds >= m->from && (seconds < m->to || (seconds >= time->duration && m->to >= time->duration))) ||
        share < time->least)
        return 0;
    for (int i = 0; i < 3; i++)
        g->position[i] = (float)(g->position[i] + d * (m->drift[0][i] + d * (m->drift[1][i] + d * m->drift[2][i])));
    for (int i = 0; i < 4; i++)
        g->rotation[i] = (float)(g->rotation[i] + d * m->turn[i]);
    if (share < 1)
        g->opacity = fxs_logit_of_opacity(share * fxs_opacity_of_logit(g->opacity));
    return 1;
}

typedef struct moment_reader {
    const fxs_reader *reader;      /* of the moving Gaussians */
    void *data;
    const fxs_allocator *allocator;
    fxs_time time;
    double seconds;
} moment_reader;

static long moment_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    const moment_reader *r = handle;
    long read, kept = 0;
    while (kept == 0 && (read = fxs_stream_read(r->reader, r->data, gaussians, capacity, message)) != 0) {
        const fxs_motion *motions = read > 0 ? r->reader->motions(r->data) : NULL;
        for (long i = 0; i < read; i++) {
            gaussians[kept] = gaussians[i];
            kept += fxs_gaussian_at(&gaussians[kept], &motions[i], &r->time, r->seconds);
        }
        if (read < 0)
            return read;
    }
    return kept;
}

static int moment_rewind(void *handle, fxs_message *message)
{
    const moment_reader *r = handle;
    return r->reader->rewind(r->data, message);
}

static void moment_close(void *handle)
{
    moment_reader *r = handle;
    if (r->data && r->reader->close)
        r->reader->close(r->data);
    fxs_release(r->allocator, r->data);
}

static const fxs_reader moment = {NULL, sizeof(moment_reader), NULL, moment_read, moment_rewind, moment_close, NULL};

int fxs_scene_file_at(fxs_scene_file *file, double seconds, fxs_scene_file_info *info, fxs_message *message)
{
    if (!(info->time.duration > 0))
        return 0;
    moment_reader *r = fxs_allocate_zeroed(fxs_stream_allocator(file), 1, sizeof *r);
    if (!r)
        return fxs_fail_memory(message, NULL, sizeof *r);
    r->reader = &moment;
    r->data = r;
    r->allocator = fxs_stream_allocator(file);
    r->time = info->time;
    r->seconds = fxs_time_within(&info->time, seconds);
    fxs_stream_swap(file, &r->reader, &r->data);
    info->time = (fxs_time){.duration = 0};
    FXS_TRY(fxs_stream_count(file, &info->count, message));
    return info->count ? 0 : fxs_fail(message, "no Gaussian exists at %g seconds", r->seconds);
}
