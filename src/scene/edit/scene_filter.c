/* Filters the Gaussians of a scene file. A reader that drops Gaussians takes the place of the file's own reader. The
   first pass over the file counts the remaining Gaussians. Removing floaters (isolated Gaussians) takes a second
   pass. */
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/allocator.h>

#include <math.h>
#include <string.h>

#include "src/gaussian/attributes.h"
#include "src/base/report.h"
#include "src/pack/lives.h"
#include "src/pack/weight.h"
#include "src/base/options.h"
#include "src/core/sized.h"
#include "course_internal.h"
#include "floaters_internal.h"
#include "thing_internal.h"
#include "src/scene/formats_internal.h"

typedef struct filter_reader {
    const fxs_reader *reader;
    void *data;
    const fxs_allocator *allocator;
    double origin[3];
    fxs_scene_filter filter;
    fxs_scene_filter_report report;
    fxs_floaters floaters;
    uint64_t next;             /* number of the next Gaussian of the stream */
    fxs_thing thing;
    fxs_time time;
    fxs_motion motions[FXS_MOTIONS];
} filter_reader;

void (fxs_scene_filter_init)(fxs_scene_filter *filter, uint32_t size)
{
    const fxs_scene_filter all = {.low = {-INFINITY, -INFINITY, -INFINITY}, .high = {INFINITY, INFINITY, INFINITY},
                                  .radius = INFINITY, .sh_degree = 3};
    fxs_sized_fill(filter, size, &all, sizeof all);
}

/* Returns 1 if point p is farther than r from the segment a + t u, 0 <= t <= 1. A sphere has u = 0. With w = p - a, the
   test |w - t u|^2 <= r^2 becomes |w|^2 |u|^2 - (w u)^2 <= r^2 |u|^2. */
static int is_outside(const fxs_filter_shape *s, const double p[3])
{
    const double *n = s->numbers;
    double w[3], ww = 0, uu = 0, wu = 0;
    int outside = 0;
    for (int i = 0; i < 3; i++) {
        const double u = s->kind == FXS_FILTER_CYLINDER ? n[3 + i] - n[i] : 0;
        w[i] = p[i] - n[i];
        ww += w[i] * w[i];
        uu += u * u;
        wu += w[i] * u;
        outside |= s->kind == FXS_FILTER_BOX && (p[i] < n[i] || p[i] > n[3 + i]);
    }
    if (s->kind == FXS_FILTER_SPHERE)
        return ww > n[3] * n[3];
    return s->kind == FXS_FILTER_BOX ? outside : wu < 0 || wu > uu || ww * uu - wu * wu > n[6] * n[6] * uu;
}

static int is_in_shapes(const fxs_scene_filter *filter, const double position[3])
{
    unsigned asked = 0, found = 0;
    for (uint32_t i = 0; i < filter->shape_count; i++) {
        const unsigned kind = 1u << filter->shapes[i].kind;
        asked |= kind;
        found |= is_outside(&filter->shapes[i], position) ? 0 : kind;
    }
    return asked == found;
}

static int is_inside(const fxs_scene_filter *filter, const double position[3])
{
    for (int i = 0; i < 3; i++)
        if (position[i] < filter->low[i] || position[i] > filter->high[i])
            return 0;
    const double x = position[0] - filter->middle[0], y = position[1] - filter->middle[1],
                 z = position[2] - filter->middle[2];
    return !(x * x + y * y + z * z > filter->radius * filter->radius);
}

/* True if a place on the way of a Gaussian is in the shapes. */
static int comes_inside(const filter_reader *r, const fxs_gaussian *g, const fxs_motion *m)
{
    const fxs_course course = fxs_course_of(g, m, &r->time);
    int inside = 0;
    for (int number = 0; number < course.count && !inside; number++) {
        double place[3];
        fxs_course_place(&course, number, place);
        for (int i = 0; i < 3; i++)
            place[i] += r->origin[i];
        inside = is_inside(&r->filter, place) && is_in_shapes(&r->filter, place);
    }
    return inside;
}

static int is_drawable(filter_reader *r, const fxs_gaussian *g, const fxs_motion *m)
{
    fxs_pack_dropped *dropped = &r->report.dropped;
    if (!fxs_drawable(g, r->filter.sh_degree, dropped))
        return 0;
    if (!m || fxs_motion_usable(m))
        return 1;
    dropped->not_finite++;
    dropped->weight += fxs_weight(g);
    return 0;
}

static int passes(filter_reader *r, fxs_gaussian *g, const fxs_motion *m)
{
    const int coefficients = 3 * r->filter.sh_degree * (r->filter.sh_degree + 2);
    const uint64_t at = r->next++;
    if (r->filter.deleted && at < r->filter.deleted_count && r->filter.deleted[at])
        return 0;
    r->report.read++;
    if (!comes_inside(r, g, m))
        return r->report.outside++, 0;
    if (fxs_opacity_of_logit(g->opacity) < r->filter.opacity)
        return r->report.faint++, 0;
    if (r->filter.drawable && !is_drawable(r, g, m))
        return 0;
    if (r->filter.floaters && fxs_floaters_take(&r->floaters, g))
        return r->report.floaters++, 0;
    if (r->filter.thing && fxs_thing_take(&r->thing, g))
        return r->report.outside++, 0;
    memset(g->sh + coefficients, 0, sizeof g->sh - (size_t)coefficients * sizeof *g->sh);
    r->report.dropped.kept += r->filter.drawable ? fxs_weight(g) : 0;
    r->report.kept++;
    return 1;
}

static long filter_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    filter_reader *r = handle;
    const int moves = r->time.duration > 0;
    size_t kept = 0;
    capacity = moves && capacity > FXS_MOTIONS ? FXS_MOTIONS : capacity;
    while (kept < capacity) {
        fxs_gaussian *next = gaussians + kept;
        long n = fxs_stream_read(r->reader, r->data, next, capacity - kept, message);
        const fxs_motion *motions = moves && n > 0 ? r->reader->motions(r->data) : NULL;
        if (n < 0)
            return n;
        if (n == 0)
            break;
        for (long i = 0; i < n; i++)
            if (passes(r, &next[i], motions ? &motions[i] : NULL)) {
                if (motions)
                    r->motions[kept] = motions[i];
                gaussians[kept++] = next[i];
            }
    }
    return (long)kept;
}

static const fxs_motion *filter_motions(const void *handle)
{
    const filter_reader *r = handle;
    return r->time.duration > 0 ? r->motions : NULL;
}

static int filter_rewind(void *handle, fxs_message *message)
{
    filter_reader *r = handle;
    memset(&r->report, 0, sizeof r->report);
    r->floaters.next = 0;
    r->next = 0;
    return r->reader->rewind(r->data, message);
}

static void filter_close(void *handle)
{
    filter_reader *r = handle;
    if (r->reader->close)
        r->reader->close(r->data);
    fxs_release(r->allocator, r->data);
    fxs_floaters_free(&r->floaters, r->allocator);
    fxs_thing_free(&r->thing, r->allocator);
}

static const fxs_reader filtered = {
    NULL, sizeof(filter_reader), NULL, filter_read, filter_rewind, filter_close, filter_motions
};

static int count(fxs_scene_file *file, const filter_reader *r, uint64_t total, const fxs_progress *progress,
                 fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    for (long n; (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;) {
        if (n < 0)
            return (int)n;
        if (fxs_report(progress, (double)r->report.read / (double)total))
            return fxs_fail_as(FXS_ERR_STOPPED, message, "stopped");
    }
    return 0;
}

static int count_again(fxs_scene_file *file, filter_reader *r, uint64_t total, const fxs_progress *progress,
                       fxs_message *message)
{
    FXS_TRY(fxs_floaters_find(&r->floaters, r->allocator, message));
    FXS_TRY(fxs_scene_file_rewind(file, message));
    return count(file, r, total, progress, message);
}

static int find_thing(fxs_scene_file *file, filter_reader *r, const fxs_scene_file_info *info,
                      const fxs_progress *progress, fxs_message *message)
{
    const uint64_t total = info->count;
    FXS_TRY(fxs_thing_init(&r->thing, total, info->start.up, r->allocator, message));
    r->filter.thing = 1;
    while (r->thing.pass < FXS_THING_KEEP) {
        FXS_TRY(fxs_scene_file_rewind(file, message));
        FXS_TRY(count(file, r, total, progress, message));
        FXS_TRY(fxs_thing_next(&r->thing, message));
    }
    FXS_TRY(fxs_scene_file_rewind(file, message));
    return count(file, r, total, progress, message);
}

int fxs_scene_file_filter(fxs_scene_file *file, const fxs_scene_filter *given, fxs_scene_file_info *info,
                          fxs_scene_filter_report *report, const fxs_progress *progress,
                          fxs_message *message)
{
    fxs_scene_filter all;
    const fxs_scene_filter *const filter = &all;
    fxs_scene_filter_init(&all);
    FXS_TRY(FXS_OPTIONS_READ(fxs_scene_filter, &all, given, message));
    if (filter->floaters || filter->thing)
        FXS_TRY(fxs_stream_check_still(info, filter->thing ? "searched for a thing" : "searched for floaters",
                                       message));
    if (filter->sh_degree < 0 || filter->sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "SH degree %d, not 0 to 3", filter->sh_degree);
    if (filter->floaters < 0 || filter->floaters > FXS_FLOATER_STRENGTHS)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a strength of %d for floaters, not 0 to %d", filter->floaters,
                           FXS_FLOATER_STRENGTHS);
    for (uint32_t i = 0; i < filter->shape_count; i++)
        if ((unsigned)filter->shapes[i].kind >= FXS_FILTER_KINDS)
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "shape %u is no box, sphere or cylinder", i);
    const fxs_allocator *allocator = fxs_stream_allocator(file);
    filter_reader *r = fxs_allocate_zeroed(allocator, 1, sizeof *r);
    if (!r)
        return fxs_fail_memory(message, NULL, sizeof *r);
    r->allocator = allocator;
    r->filter = *filter;
    r->filter.thing = 0;
    r->time = info->time;
    memcpy(r->origin, info->origin, sizeof r->origin);
    r->reader = &filtered;
    r->data = r;
    fxs_stream_swap(file, &r->reader, &r->data);
    FXS_TRY(fxs_scene_file_rewind(file, message));
    if (filter->floaters)
        FXS_TRY(fxs_floaters_init(&r->floaters, filter->floaters, info->count, allocator, message));
    FXS_TRY(count(file, r, info->count, progress, message));
    if (filter->floaters)
        FXS_TRY(count_again(file, r, info->count, progress, message));
    if (filter->thing)
        FXS_TRY(find_thing(file, r, info, progress, message));
    for (int i = 0; i < 3 && filter->thing == 2; i++)
        info->start.up[i] = -r->thing.frame[1][i];
    *report = r->report;
    info->count = report->kept;
    if (report->outside)
        info->start.tangent = 0;
    info->sh_degree = info->sh_degree < filter->sh_degree ? info->sh_degree : filter->sh_degree;
    if (report->kept == 0)
        return fxs_fail(message, "none of the %llu Gaussians %s", (unsigned long long)report->read,
                        report->outside + report->faint + report->floaters < report->read ? "can be drawn" : "is left");
    return fxs_scene_file_rewind(file, message);
}
