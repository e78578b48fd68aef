/* Measures the time of a frame's stages. */
#ifndef FXS_TIMES_H
#define FXS_TIMES_H

#include "frame.h"

enum { FXS_SORTED, FXS_LISTED_TILES, FXS_BLENDED, FXS_RESOLVED, FXS_LAPS };

/* Adds the time since the previous lap (timed step) to the sum of step `which`, if the macro tile is timed. */
void fxs_lap(const fxs_frame *f, fxs_laps *laps, int which);

/* Divides the wall time since `start` among the stages of a frame in f->stats, in proportion to the times of the jobs.
   `times` has `columns` times per job; column c belongs to stages[c]. */
void fxs_share_time(fxs_frame *f, uint64_t start, const uint64_t *times, uint32_t jobs, uint32_t columns,
                    const enum fxs_stage *stages);

#endif
