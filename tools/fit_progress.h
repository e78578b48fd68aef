/* How far a fit is: on stderr, and in a log. */
#ifndef FIT_PROGRESS_H
#define FIT_PROGRESS_H

#include <stdint.h>
#include <stdio.h>

#include "fit_watcher.h"

enum { FIT_STAGES = 6 };

typedef struct fit_progress {
    uint32_t first, steps;          /* of this run's, and of all */
    uint32_t counted, reports;      /* the last step that was counted; how many have reported */
    uint32_t saved;                 /* the step that OUT.fit is of; 0: not of this fit */
    uint64_t start, last, shown;    /* nanoseconds: of the run, the last step, the last line */
    size_t gaussians;               /* after the last step that was counted */
    double pace, loss;              /* seconds a step and loss, means of some 50 steps */
    uint64_t stages[FIT_STAGES];    /* nanoseconds of the steps that have reported */
} fit_progress;

/* Counts the steps up to this one, which has reported, and shows how far they are. */
void fit_progress_count(fit_progress *progress, uint32_t step, const fxs_fit_report *report);

/* For a watcher. */
fit_now fit_progress_now(const fit_progress *progress, uint32_t step, size_t gaussians);

/* From the start to the last step that was counted. */
double fit_progress_seconds(const fit_progress *progress);

/* A log of a fit: a header, then a line at every hundredth of its steps and wherever it is measured, fields between
   tabs. Where a line cannot be written, that is said, and nothing is written after it. All functions do nothing for a
   log of no name. */
typedef struct fit_log {
    const char *name;              /* null: none */
    FILE *file;
    uint32_t every;                /* steps */
} fit_log;

/* Opens the file, and leaves in it what it has. Returns 0, or prints why not and returns EXIT_FAILED. */
int fit_log_open(fit_log *log, const char *name);

/* Before the first step of `steps`: the file is emptied where the fit does not go on from another. */
void fit_log_begin(fit_log *log, int goes_on, uint32_t steps);

/* Whether there is to be a line after this step. */
int fit_log_wants(const fit_log *log, uint32_t step);

/* Of the last step that was counted. `measured` may be null: then its fields are empty. */
void fit_log_write(fit_log *log, const fit_progress *progress, const quality *measured);

void fit_log_close(fit_log *log);

#endif
