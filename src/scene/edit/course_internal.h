/* The course of a moving Gaussian: places on its way, for crops. */
#ifndef FXS_COURSE_INTERNAL_H
#define FXS_COURSE_INTERNAL_H

#include "src/gaussian/stream_internal.h"

/* Places on the way of a Gaussian while it is visible: from the first to the last in steps of at most its largest
   sigma, but in at most 256 steps. A still Gaussian has a way of one place. */
typedef struct fxs_course {
    const fxs_gaussian *gaussian;
    const fxs_motion *motion;
    double from, step;             /* seconds */
    int count;
} fxs_course;

/* Returns the way of a Gaussian; motion: null for a still one. */
fxs_course fxs_course_of(const fxs_gaussian *gaussian, const fxs_motion *motion, const fxs_time *time);

/* Writes the place on a way with a number from 0 to course->count - 1, relative to the stream's origin. */
void fxs_course_place(const fxs_course *course, int number, double place[3]);

#endif
