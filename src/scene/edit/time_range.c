/* Ranges of time of moving scenes, as streams of moving Gaussians, and the places on the ways of Gaussians. */
#include <fixsplat/internal/time_range.h>

#include <math.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include "src/gaussian/attributes.h"
#include "src/pack/lives.h"
#include "course_internal.h"

/* ---- Ways -------------------------------------------------------------------------------------------------------- */

fxs_course fxs_course_of(const fxs_gaussian *g, const fxs_motion *m, const fxs_time *time)
{
    enum { STEPS_MOST = 256 };
    fxs_course course = {g, m, 0, 0, 1};
    if (!m)
        return course;
    const fxs_life life = fxs_life_of(m, fxs_opacity_of_logit(g->opacity), time);
    const double sigma = fxs_exp((double)fmaxf(g->scale[0], fmaxf(g->scale[1], g->scale[2])));
    const double seconds = (double)life.to - life.from;
    const double far = fmax(fabs((double)life.from - m->centre), fabs((double)life.to - m->centre));
    double length = 0;
    for (int i = 0; i < 3; i++)
        length += seconds * (fabs((double)m->drift[0][i]) + far * (2 * fabs((double)m->drift[1][i]) +
                                                                  far * 3 * fabs((double)m->drift[2][i])));
    course.from = life.from;
    if (length > 0)
        course.count += (int)ceil(fmin(fmax(length / sigma, 1), STEPS_MOST));
    course.step = seconds / (course.count - (course.count > 1));
    return course;
}

void fxs_course_place(const fxs_course *course, int number, double place[3])
{
    const fxs_motion *m = course->motion;
    const double d = m ? course->from + number * course->step - m->centre : 0;
    for (int i = 0; i < 3; i++)
        place[i] = course->gaussian->position[i] +
                   (m ? d * (m->drift[0][i] + d * (m->drift[1][i] + d * m->drift[2][i])) : 0);
}

/* ---- Ranges ------------------------------------------------------------------------------------------------------ */

/* Part of the time from `from` to `to`, which begin at time 0 of the result. In a scene that loops, part k shows the
   scene from its time 0 on, k durations later. In another, part -1 is before time 0 and part 1 after the duration,
   where Gaussians stay as they are at the time `seconds`. */
typedef struct time_part {
    double low, high;              /* within the time of the scene, seconds */
    double later;                  /* time of the result - time of the scene */
    int stays;
    double seconds;
} time_part;

typedef struct range_reader {
    const fxs_reader *reader;      /* of the whole scene */
    void *data;
    const fxs_allocator *allocator;
    fxs_time time;
    double from, to;
    int first, last, part;
    fxs_motion motions[FXS_MOTIONS];
} range_reader;

/* Times that are nearer than this count as equal: seconds. Windows of frames are rounded to floats, and durations to
   2^-16 seconds. */
static double rounding(const fxs_time *time)
{
    return fmin(ldexp(1, -12), (time->rate > 0 ? 1 / time->rate : time->duration) / 64);
}

/* Rounds a time to the start of a frame that is nearly the same. */
static double to_frame(const fxs_time *time, double seconds)
{
    const double frame = time->rate > 0 ? floor(seconds * time->rate + 0.5) / time->rate : seconds;
    return fabs(frame - seconds) < rounding(time) ? frame : seconds;
}

static time_part part_of(const range_reader *r)
{
    const double duration = r->time.duration, start = r->time.loops ? r->part * duration : 0;
    const int stays = !r->time.loops && r->part;
    const double low = stays ? (r->part < 0 ? -INFINITY : duration) : 0;
    const double high = stays ? (r->part < 0 ? 0 : INFINITY) : duration;
    return (time_part){fmax(r->from - start, low), fmin(r->to - start, high), start - r->from, stays,
                       r->part < 0 ? 0 : duration};
}

static int is_always_the_same(const fxs_motion *m, const fxs_time *time)
{
    int is = m->fade == INFINITY && m->from <= 0 && m->to >= time->duration;
    for (int i = 0; i < 9; i++)
        is &= m->drift[i / 3][i % 3] == 0;
    for (int i = 0; i < 4; i++)
        is &= m->turn[i] == 0;
    return is;
}

/* Changes a Gaussian to how it is in a part of the time. Returns 0 if it is not seen then. */
static int take_part(const range_reader *r, const time_part *part, fxs_gaussian *g, fxs_motion *m)
{
    const double near = rounding(&r->time);
    fxs_life life = {.from = (float)part->low, .to = (float)part->high};
    if (!fxs_motion_usable(m))
        return r->part == r->first;
    const int is_same = is_always_the_same(m, &r->time);
    if (part->stays && !fxs_gaussian_at(g, m, &r->time, part->seconds))
        return 0;
    if (part->stays || is_same)
        *m = fxs_still;
    if (is_same)
        return r->part == r->first;
    if (!part->stays)
        life = fxs_life_of(m, fxs_opacity_of_logit(g->opacity), &r->time);
    if (fmin(m->to, part->high) - fmax(m->from, part->low) < near || life.to < part->low || life.from > part->high)
        return 0;
    m->from = (float)(life.from > part->low + near ? m->from + part->later
                      : r->part == r->first ? -INFINITY : part->low + part->later);
    m->to = (float)(life.to < part->high - near ? m->to + part->later
                    : r->part == r->last ? INFINITY : part->high + part->later);
    m->centre = (float)(m->centre + part->later);
    return 1;
}

static long range_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    range_reader *r = handle;
    long kept = 0;
    capacity = capacity < FXS_MOTIONS ? capacity : FXS_MOTIONS;
    while (kept == 0) {
        const time_part part = part_of(r);
        const long read = fxs_stream_read(r->reader, r->data, gaussians, capacity, message);
        const fxs_motion *motions = read > 0 ? r->reader->motions(r->data) : NULL;
        for (long i = 0; i < read; i++) {
            gaussians[kept] = gaussians[i];
            r->motions[kept] = motions[i];
            kept += take_part(r, &part, &gaussians[kept], &r->motions[kept]);
        }
        if (read < 0 || (read == 0 && r->part == r->last))
            return read;
        if (read == 0) {
            r->part++;
            FXS_TRY(r->reader->rewind(r->data, message));
        }
    }
    return kept;
}

static int range_rewind(void *handle, fxs_message *message)
{
    range_reader *r = handle;
    r->part = r->first;
    return r->reader->rewind(r->data, message);
}

static const fxs_motion *range_motions(const void *handle)
{
    return ((const range_reader *)handle)->motions;
}

static void range_close(void *handle)
{
    range_reader *r = handle;
    if (r->reader->close)
        r->reader->close(r->data);
    fxs_release(r->allocator, r->data);
}

static const fxs_reader range = {NULL, sizeof(range_reader), NULL, range_read, range_rewind, range_close,
                                 range_motions};

/* Puts a copy of a reader between the file and its own reader, and counts the Gaussians that it gives. */
static int attach(fxs_scene_file *file, const range_reader *how, fxs_scene_file_info *info, fxs_message *message)
{
    range_reader *r = fxs_allocate_zeroed(fxs_stream_allocator(file), 1, sizeof *r);
    if (!r)
        return fxs_fail_memory(message, NULL, sizeof *r);
    *r = *how;
    r->reader = &range;
    r->data = r;
    r->allocator = fxs_stream_allocator(file);
    fxs_stream_swap(file, &r->reader, &r->data);
    return fxs_stream_count(file, &info->count, message);
}

int fxs_scene_file_between(fxs_scene_file *file, double from, double to, fxs_scene_file_info *info,
                           fxs_message *message)
{
    const fxs_time time = info->time;
    const double near = rounding(&time), duration = time.duration, most = 4096;
    if (!(duration > 0))
        return 0;
    if (!(to - from >= ldexp(1, -10) && to - from < ldexp(FXS_MOTION_DURATION_MOST, -16) && fabs(from) < 1e9))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "times %g to %g: expected 1/1024 to 16384 seconds", from, to);
    if ((to - from) / duration > most)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "times %g to %g: a scene of %g seconds is repeated at most %g "
                           "times", from, to, duration, most);
    range_reader how = {.time = time, .from = to_frame(&time, from), .to = to_frame(&time, to)};
    if (time.loops) {
        const double turns = floor((how.from + near) / duration);
        how.from -= turns * duration;
        how.to -= turns * duration;
        how.last = (int)ceil((how.to - near) / duration) - 1;
    } else {
        how.first = how.from < -near ? -1 : how.from > duration - near;
        how.last = how.to > duration + near ? 1 : -(how.to < near);
    }
    if (fabs(how.from) < near && fabs(how.to - duration) < near)
        return 0;
    FXS_TRY(attach(file, &how, info, message));
    info->time.duration = how.to - how.from;
    return info->count ? 0 : fxs_fail(message, "no Gaussian exists from %g to %g seconds", how.from, how.to);
}
