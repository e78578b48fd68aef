/* Shows the progress of a fit, on stderr and in a log file. */
#ifndef FIT_PROGRESS_H
#define FIT_PROGRESS_H

#include <stdint.h>
#include <stdio.h>

#include "fit_watcher.h"

enum { FIT_STAGES = 6 };

typedef struct fit_progress {
    uint32_t first, steps;          /* first step of this run of the program; number of all steps */
    uint32_t counted, reports;
    uint32_t saved;                 /* step at which the fit was last saved; 0: never */
    uint64_t start, last, shown;    /* times of the start, of the last step and of the last output in nanoseconds */
    size_t gaussians;
    double pace, loss;              /* running means of seconds per step and of the loss */
    uint64_t stages[FIT_STAGES];    /* nanoseconds in each stage, summed over all reports */
} fit_progress;

/* Counts the steps of a fit up to number `step`, and shows progress. */
void fit_progress_count(fit_progress *progress, uint32_t step, const fxs_fit_report *report);

fit_now fit_progress_now(const fit_progress *progress, uint32_t step, size_t gaussians);

double fit_progress_seconds(const fit_progress *progress);

/* A log of a fit, with a tab-separated line at every hundredth of the steps and at every measurement. A failed write
   ends the log. */
typedef struct fit_log {
    const char *name;              /* path of the log; null: no log */
    FILE *file;
    uint32_t every;
} fit_log;

/* Opens the log file of a fit without emptying it. */
int fit_log_open(fit_log *log, const char *name);

/* Begins the log of a fit of `steps` steps. goes_on 1: appends to the log of a resumed fit; 0: empties the file. */
void fit_log_begin(fit_log *log, int goes_on, uint32_t steps);

int fit_log_wants(const fit_log *log, uint32_t step);

/* Writes a log line about the last counted step. `measured`, the quality of the scene, may be null. */
void fit_log_write(fit_log *log, const fit_progress *progress, const quality *measured);

void fit_log_close(fit_log *log);

#endif
