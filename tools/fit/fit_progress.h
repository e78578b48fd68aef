/* Progress of a fit, on stderr and in a log. */
#ifndef FIT_PROGRESS_H
#define FIT_PROGRESS_H

#include <stdint.h>
#include <stdio.h>

#include "fit_watcher.h"

enum { FIT_STAGES = 6 };

typedef struct fit_progress {
    uint32_t first, steps;          /* first step of this run; number of all steps */
    uint32_t counted, reports;      /* last counted step; number of reports */
    uint32_t saved;                 /* step saved in OUT.fit; 0: none */
    uint64_t start, last, shown;    /* nanoseconds: start of the run, last step, last line */
    size_t gaussians;               /* after the last counted step */
    double pace, loss;              /* seconds per step, and loss; running means over about 50 steps */
    uint64_t stages[FIT_STAGES];    /* nanoseconds per stage, summed over the reports */
} fit_progress;

/* Counts the steps up to `step`, which has a report, and shows progress. */
void fit_progress_count(fit_progress *progress, uint32_t step, const fxs_fit_report *report);

/* Returns the state that a watcher shows. */
fit_now fit_progress_now(const fit_progress *progress, uint32_t step, size_t gaussians);

/* Returns the seconds from the start to the last counted step. */
double fit_progress_seconds(const fit_progress *progress);

/* A log of a fit: a header, then tab-separated lines at every hundredth of the steps and at every measurement. A
   failed write is reported once and ends the log. */
typedef struct fit_log {
    const char *name;              /* null: no log, and all functions do nothing */
    FILE *file;
    uint32_t every;                /* steps between lines */
} fit_log;

/* Opens the file without emptying it. Returns 0, or prints the reason and returns EXIT_FAILED. */
int fit_log_open(fit_log *log, const char *name);

/* Call before the first of `steps` steps. goes_on 1: appends to the log of a resumed fit; 0: empties the file. */
void fit_log_begin(fit_log *log, int goes_on, uint32_t steps);

/* Tests whether a step gets a line. */
int fit_log_wants(const fit_log *log, uint32_t step);

/* Writes a line for the last counted step. `measured` may be null. */
void fit_log_write(fit_log *log, const fit_progress *progress, const quality *measured);

void fit_log_close(fit_log *log);

#endif
