/* Frames of scenes that move: options --time, --times and --fps, and the moment of each frame. */
#ifndef FRAME_TIMES_H
#define FRAME_TIMES_H

#include "command_line.h"
#include "load_world.h"

enum { TIMES_MOST = 100000 };

typedef struct times_option {
    int given, all;                         /* all: from 0 until the end of the scenes */
    double from, to;                        /* seconds; frames from `from` on, until before `to` */
    double step;                            /* seconds from frame to frame, set by times_settle like `within` */
    double within;    /* seconds that frames of a scene with a rate are later, to lie within its frames in spite of
                         rounded times: 1/256 of a frame; else 0 */
} times_option;

typedef int rate_option[2];                 /* frames per second: rate[0] / rate[1] */

take_option take_time, take_times, take_rate;

/* Each macro fills in the parser, offset and expected value of an option row. TIME is for an fxs_options.time_q32. */
#define TIME(member) take_time, FIELD(int64_t, member), .expected = "seconds, within 1000000"
#define TIMES(member) \
    take_times, FIELD(times_option, member), .expected = "A..B, seconds, B after A, within 1000000, or all"
#define RATE(member) \
    take_rate, FIELD(rate_option, member), .expected = "1 to 1000 frames per second, as 25 or 24000/1001"

int64_t seconds_q32(double seconds);

/* Returns the time of the scenes of a world: the longest duration and the highest rate; a duration of 0 if all are
   still. */
fxs_time world_time(const world *w);

/* Takes the rate from the scenes unless --fps is given, and the times of --times all. In messages, `name` stands for
   the scenes. Returns the number of frames. On failure prints the reason and returns -1. */
long times_settle(times_option *times, rate_option rate, const fxs_time *time, const char *name);

/* Returns the time in seconds of a frame, or of a moment between two frames. */
double times_at(const times_option *times, double frame);

/* Returns a time within a frame of a scene with a rate, in seconds. */
double time_within(double frame, double rate);

#endif
