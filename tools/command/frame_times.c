/* Frames of scenes that move: parses --time, --times and --fps, and counts the frames. */
#include "frame_times.h"

#include <math.h>
#include <string.h>

#define SECONDS_MOST 1e6
#define WITHIN (1.0 / 256)      /* frames */
#define ROUNDED (1.0 / 64)      /* frames that a duration may be too long */

int64_t seconds_q32(double seconds)
{
    return (int64_t)llrint(ldexp(seconds, 32));
}

int take_time(const option_row *row, void *field, const char *value)
{
    double seconds = 0;
    if (!parse_vector(value, 1, &seconds) || !(fabs(seconds) <= SECONDS_MOST))
        return wrong_value(row, value);
    *(int64_t *)field = seconds_q32(seconds);
    return 0;
}

int take_times(const option_row *row, void *field, const char *value)
{
    times_option *times = field;
    const char *dots = strstr(value, "..");
    char from[32] = "";
    *times = (times_option){.given = 1, .all = !strcmp(value, "all")};
    if (times->all)
        return 0;
    if (dots && (size_t)(dots - value) < sizeof from)
        memcpy(from, value, (size_t)(dots - value));
    return dots && parse_vector(from, 1, &times->from) && parse_vector(dots + 2, 1, &times->to) &&
           times->from < times->to && times->from >= -SECONDS_MOST && times->to <= SECONDS_MOST
               ? 0 : wrong_value(row, value);
}

int take_rate(const option_row *row, void *field, const char *value)
{
    int *rate = field;
    char comma[32];
    const char *slash = strchr(value, '/');
    rate[1] = 1;
    snprintf(comma, sizeof comma, "%s", value);
    if (slash && slash - value < (ptrdiff_t)sizeof comma)
        comma[slash - value] = ',';
    return strlen(value) < sizeof comma && parse_counts(comma, slash ? 2 : 1, 1, 1000000, rate) &&
           rate[0] >= rate[1] && rate[0] <= 1000 * rate[1] ? 0 : wrong_value(row, value);
}

fxs_time world_time(const world *w)
{
    fxs_time time = {.loops = 1};
    for (uint32_t i = 0; i < w->placed.file_count; i++) {
        const fxs_motion_info info = fxs_scene_motion(w->scenes[i].opened->scene);
        time.duration = fmax(time.duration, ldexp((double)info.duration_q32, -32));
        time.rate = fmax(time.rate, ldexp((double)info.rate_q32, -32));
        time.loops &= !info.duration_q32 || info.loops;
    }
    return time;
}

/* Takes the rate of a scene as a fraction: whole, whole / 1.001 as in television, or in thousandths. */
static void take_scene_rate(rate_option rate, double wanted)
{
    const double whole = fmin(fmax(wanted, 1), 1000);
    const int by[] = {1, 1001, 1000}, times[] = {1, 1000, 1};
    for (int i = 0; i < 3; i++) {
        rate[0] = (int)lrint(whole * by[i] / times[i]) * times[i];
        rate[1] = by[i];
        if (fabs((double)rate[0] / rate[1] - whole) < 1e-4 * whole)
            return;
    }
}

long times_settle(times_option *times, rate_option rate, const fxs_time *time, const char *name)
{
    if (!(time->duration > 0))
        return fail(-1, "%s: does not move: no --times", name);
    const int is_own = !is_given("fps") && time->rate > 0;
    if (is_own)
        take_scene_rate(rate, time->rate);
    times->step = is_own ? 1 / time->rate : (double)rate[1] / rate[0];
    times->within = time->rate > 0 ? WITHIN / time->rate : 0;
    if (times->all) {
        times->from = 0;
        times->to = time->duration - (time->rate > 0 ? ROUNDED * times->step : 0);
    }
    const double frames = ceil((times->to - times->from) / times->step - 1e-6);
    return frames <= TIMES_MOST ? (long)fmax(frames, 1)
                                : fail(-1, "--times: %.0f frames: at most %d", frames, TIMES_MOST);
}

double times_at(const times_option *times, double frame)
{
    return times->from + times->within + frame * times->step;
}

double time_within(double frame, double rate)
{
    return (frame + WITHIN) / rate;
}
